//! The naive oracle for dense maps: collision queries at random configurations.
#![allow(dead_code, reason = "each test file uses a part")]

use elbowroom_cspace::{Grid, Layer, OccupancyBitmap};
use elbowroom_kinematics::ChainState;
use elbowroom_spatial::Aabb;

use crate::common::robots::{Case, Random};

/// All layers in one map.
pub fn occupancy(grid: &Grid, layers: &[Layer]) -> OccupancyBitmap {
    let mut map = OccupancyBitmap::new(grid.shape());
    for layer in layers {
        map.add(layer);
    }
    map
}

/// Asserts that free cells contain no collision: tests all cells, and free neighbours of blocked cells. Returns the
/// number of collisions.
pub fn compare(case: &Case, grid: &Grid, map: &OccupancyBitmap, samples: usize) -> usize {
    let mut random = Random(7);
    let mut state = ChainState::new(&case.robot.chain);
    let boundary = free_neighbours(map);
    let around: Vec<Aabb> = case.obstacles.iter().map(|(shape, at)| shape.aabb(at)).collect();
    let links = case.moving_links();
    let mut collisions = 0;
    for i in 0..samples {
        let q: [f64; 3] = if i % 2 == 0 || boundary.is_empty() {
            [0, 1, 2].map(|k| random.between(grid.axes()[k].min(), grid.axes()[k].max()))
        } else {
            let cell = boundary[(random.unit() * boundary.len() as f64) as usize];
            [0, 1, 2].map(|k| {
                let axis = &grid.axes()[k];
                let low = axis.border(cell[k].into());
                random.between(low, (low + axis.step()).min(axis.max()))
            })
        };
        let all_values = case.all_values(&q, &mut random);
        if case.collides(&mut state, &all_values, &links, &around) {
            collisions += 1;
            let cell = grid.cell(q);
            assert!(cell.is_none_or(|c| map.is_blocked(c)), "{q:?} collides and {cell:?} is free");
        }
    }
    collisions
}

/// Free cells with a blocked neighbour.
pub fn free_neighbours(map: &OccupancyBitmap) -> Vec<[u16; 3]> {
    let shape = map.shape();
    let mut out = Vec::new();
    for cell in map.iter() {
        for axis in 0..3 {
            for at in [cell[axis].checked_sub(1), cell[axis].checked_add(1)].into_iter().flatten() {
                let mut next = cell;
                next[axis] = at;
                if usize::from(at) < shape[axis] && !map.is_blocked(next) {
                    out.push(next);
                }
            }
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// Fraction of some blocked cells in which a local search finds no collision.
pub fn needless_share(case: &Case, grid: &Grid, map: &OccupancyBitmap, samples: usize) -> f64 {
    let mut random = Random(3);
    let mut state = ChainState::new(&case.robot.chain);
    let cells: Vec<[u16; 3]> = map.iter().collect();
    let needless = (0..samples).filter(|_| {
        let cell = cells[(random.unit() * cells.len() as f64) as usize];
        !case.collides_in(&mut state, grid.axes(), &cell)
    });
    needless.count() as f64 / samples as f64
}
