//! Random maps, and exhaustive search for paths on them.
#![allow(dead_code, reason = "each test file uses a part")]

#[path = "../../../cspace/tests/common/covers.rs"]
pub mod covers;
pub mod robots;
pub mod table1;

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use elbowroom_cspace::{CellIndex, Grid, GridAxis, OccupancyBitmap, RowSpan};
pub use elbowroom_testkit::random::Random;

/// Cells 0.1 rad wide, from −1 rad up.
pub fn grid(shape: [usize; 3]) -> Grid {
    let axis = |i: usize| GridAxis::new(format!("j{i}"), -1.0, -1.0 + 0.1 * shape[i] as f64, 0.1).unwrap();
    Grid::new([axis(0), axis(1), axis(2)]).unwrap()
}

pub fn block(occupancy: &mut OccupancyBitmap, [i, j, k]: CellIndex) {
    let row = u32::from(i) * occupancy.shape()[1] as u32 + u32::from(j);
    occupancy.block(RowSpan { row, first: k, last: k });
}

/// Single cells and boxes of cells.
pub fn random_occupancy(shape: [usize; 3], random: &mut Random) -> OccupancyBitmap {
    let mut occupancy = OccupancyBitmap::new(shape);
    let cells = shape.iter().product::<usize>() as f64;
    let single = (cells * [0.0, 0.1, 0.3, 0.5][random.index(4)]) as usize;
    for _ in 0..single {
        block(&mut occupancy, shape.map(|n| random.index(n) as u16));
    }
    for _ in 0..random.index(12) {
        let low = shape.map(|n| random.index(n));
        let high = [0, 1, 2].map(|i| (low[i] + random.index(shape[i].max(2) - 1)).min(shape[i] - 1));
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                let row = (i * shape[1] + j) as u32;
                occupancy.block(RowSpan { row, first: low[2] as u16, last: high[2].min(low[2] + 3) as u16 });
            }
        }
    }
    occupancy
}

pub fn free_cell(occupancy: &OccupancyBitmap, random: &mut Random) -> Option<CellIndex> {
    (0..200).map(|_| occupancy.shape().map(|n| random.index(n) as u16)).find(|&c| !occupancy.is_blocked(c))
}

/// A random configuration in a cell, sometimes at its centre or on its border.
pub fn random_configuration(grid: &Grid, cell: CellIndex, random: &mut Random) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let axis = &grid.axes()[i];
        let at = match random.index(4) {
            0 => 0.5,
            1 => 1e-12,
            _ => random.unit(),
        };
        axis.min() + (f64::from(cell[i]) + at) * axis.step()
    })
}

/// Whether two cells are connected through free cells with common faces.
pub fn connected(occupancy: &OccupancyBitmap, from: CellIndex, to: CellIndex) -> bool {
    let shape = occupancy.shape();
    let index = |c: CellIndex| (usize::from(c[0]) * shape[1] + usize::from(c[1])) * shape[2] + usize::from(c[2]);
    let mut seen = vec![false; shape.iter().product()];
    let mut queue = VecDeque::from([from]);
    seen[index(from)] = true;
    while let Some(cell) = queue.pop_front() {
        if cell == to {
            return true;
        }
        for (axis, up) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
            let mut next = cell;
            next[axis] = if up == 1 { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
            if !occupancy.is_blocked(next) && !seen[index(next)] {
                seen[index(next)] = true;
                queue.push_back(next);
            }
        }
    }
    false
}

/// Length (cell widths) of the shortest path over centres of cells with 26 neighbours, without cutting corners; `None`
/// if no path exists.
pub fn grid_optimum(occupancy: &OccupancyBitmap, scale: [f64; 3], from: CellIndex, to: CellIndex) -> Option<f64> {
    let shape = occupancy.shape();
    let index = |c: CellIndex| (usize::from(c[0]) * shape[1] + usize::from(c[1])) * shape[2] + usize::from(c[2]);
    let mut best = vec![f64::INFINITY; shape.iter().product()];
    let mut open = BinaryHeap::from([Reverse((0_u64, from))]);
    best[index(from)] = 0.0;
    while let Some(Reverse((bits, cell))) = open.pop() {
        let length = f64::from_bits(bits);
        if cell == to {
            return Some(length);
        }
        if length > best[index(cell)] {
            continue;
        }
        for n in (0..27).filter(|&n| n != 13) {
            let shift = [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
            let Some(next) = step(occupancy, cell, shift) else { continue };
            let far: f64 = (0..3).map(|i| (f64::from(shift[i]) * scale[i]).powi(2)).sum();
            let over = length + far.sqrt();
            if over < best[index(next)] {
                best[index(next)] = over;
                open.push(Reverse((over.to_bits(), next)));
            }
        }
    }
    None
}

/// Returns the neighbour if all cells that the step touches are free.
fn step(occupancy: &OccupancyBitmap, cell: CellIndex, shift: [i32; 3]) -> Option<CellIndex> {
    let at =
        |part: usize| [0, 1, 2].map(|i| (i32::from(cell[i]) + if part >> i & 1 == 1 { shift[i] } else { 0 }) as u16);
    (0..8).all(|part| !occupancy.is_blocked(at(part))).then(|| at(7))
}

/// Returns the first of many points along the waypoints that is in a blocked cell.
pub fn blocked_point(
    grid: &Grid,
    occupancy: &OccupancyBitmap,
    waypoints: &[[f64; 3]],
    per_segment: usize,
) -> Option<[f64; 3]> {
    let blocked = |q: &[f64; 3]| grid.cell(*q).is_none_or(|cell| occupancy.is_blocked(cell));
    let segments = waypoints.windows(2).flat_map(|w| {
        (0..=per_segment).map(move |n| {
            let t = n as f64 / per_segment as f64;
            [0, 1, 2].map(|i| w[0][i] + (w[1][i] - w[0][i]) * t)
        })
    });
    let ends = [waypoints.first(), waypoints.last()];
    let is_end = |q: &[f64; 3]| ends.contains(&Some(q));
    segments.filter(|q| !is_end(q)).find(blocked)
}
