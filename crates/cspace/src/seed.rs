//! The paper's way: from a seed, cell by cell, until the surface is closed (S2, section IV). Kept as a reference.

use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, PI};

use elbowroom_proximity::{Capsule, Shape, Sphere, separation_within};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{Cell, Grid, Obstacle, PlanarArm, Span, Table};

/// What an expansion did.
#[derive(Debug, Clone)]
pub struct Expansion {
    /// Cells blocked.
    pub table: Table,
    /// Cells of which the distance was measured.
    pub tested: usize,
    /// Cells blocked without a measurement, because two opposite neighbours are.
    pub filled: usize,
    /// Seeds from inverse kinematics that lie in the grid.
    pub seeds: usize,
}

/// Blocks cells by expansion from seeds: inverse kinematics aims the forearm's tip and the upper arm at the obstacle (its
/// middle and its outermost points), neighbours of blocked cells are tested until no free neighbour is untested, and
/// what has two blocked opposite neighbours is blocked without a test.
///
/// A cell is tested by the distance at its middle against the farthest that its half widths can move each part. What is
/// blocked is thereby never too little *around a seed*; parts of the blocked space that no seed leads to are missed (the
/// limits of the joints can cut them off), which is why the map does not use this.
///
/// ```
/// use elbowroom_cspace::{Axis, Grid, Obstacle, PlanarArm, expand};
/// use elbowroom_spatial::Vec3;
/// let axis = |name: &str| Axis::from_degrees(name, -90.0, 90.0, 6.0);
/// let grid = Grid::new([axis("base")?, axis("shoulder")?, axis("elbow")?])?;
/// let ball = Obstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?;
/// let expansion = expand(&PlanarArm::KR125_SIZED, &grid, &ball);
/// assert!(expansion.table.blocked() > 1000 && expansion.tested < grid.cells() / 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn expand(arm: &PlanarArm, grid: &Grid, obstacle: &Obstacle) -> Expansion {
    let mut work = Work {
        test: Test::new(arm, grid, obstacle),
        shape: grid.shape(),
        found: Expansion { table: Table::new(grid.shape()), tested: 0, filled: 0, seeds: 0 },
        seen: Table::new(grid.shape()),
        list: VecDeque::new(),
    };
    for seed in seeds(arm, grid, obstacle) {
        work.found.seeds += 1;
        work.look(seed);
    }
    while let Some(cell) = work.list.pop_front() {
        neighbours(cell, work.shape).for_each(|beside| work.look(beside));
    }
    work.found
}

struct Work {
    test: Test,
    shape: [usize; 3],
    found: Expansion,
    /// One flag per cell: it was looked at.
    seen: Table,
    /// Blocked cells of which the neighbours were not looked at.
    list: VecDeque<Cell>,
}

impl Work {
    fn look(&mut self, cell: Cell) {
        if self.seen.is_blocked(cell) {
            return;
        }
        mark(&mut self.seen, cell);
        if self.between_blocked(cell) {
            self.found.filled += 1;
        } else {
            self.found.tested += 1;
            if !self.test.may_touch(cell) {
                return;
            }
        }
        mark(&mut self.found.table, cell);
        self.list.push_back(cell);
    }

    fn between_blocked(&self, cell: Cell) -> bool {
        (0..3).any(|axis| {
            let inside = cell[axis] > 0 && usize::from(cell[axis]) + 1 < self.shape[axis];
            let at = |value: u16| {
                let mut other = cell;
                other[axis] = value;
                self.found.table.is_blocked(other)
            };
            inside && at(cell[axis] - 1) && at(cell[axis] + 1)
        })
    }
}

fn mark(table: &mut Table, [i, j, k]: Cell) {
    let row = u32::from(i) * table.shape()[1] as u32 + u32::from(j);
    table.block(Span { row, first: k, last: k });
}

fn neighbours(cell: Cell, shape: [usize; 3]) -> impl Iterator<Item = Cell> {
    (0..6).filter_map(move |n: usize| {
        let mut beside = cell;
        let value = &mut beside[n / 2];
        *value = if n.is_multiple_of(2) { value.checked_sub(1)? } else { *value + 1 };
        (usize::from(*value) < shape[n / 2]).then_some(beside)
    })
}

/// The test of one cell.
struct Test {
    arm: PlanarArm,
    grid: Grid,
    shape: Shape,
    in_base: Pose,
    /// The farthest that half a cell moves upper arm, forearm and wrist, metres.
    moves: [f64; 3],
}

impl Test {
    fn new(arm: &PlanarArm, grid: &Grid, obstacle: &Obstacle) -> Self {
        let [half1, half2, half3] = grid.half_widths();
        let (upper, fore) = (arm.upper_length_m, arm.fore_length_m);
        let around = |length: f64| half1 * (arm.offset_m.abs() + length) + half2 * length;
        let far = around(upper + fore) + half3 * fore;
        let (shape, in_base) = obstacle.shape();
        Self { arm: *arm, grid: grid.clone(), shape, in_base, moves: [around(upper), far, far] }
    }

    fn may_touch(&self, cell: Cell) -> bool {
        let [shoulder, elbow, wrist] = self.arm.joints_in_base(self.grid.center(cell));
        let ball = Shape::Sphere(Sphere { radius: self.arm.wrist_radius_m });
        let parts = [
            capsule(shoulder, elbow, self.arm.upper_radius_m),
            capsule(elbow, wrist, self.arm.fore_radius_m),
            (ball, Pose::from_translation(wrist)),
        ];
        parts.iter().zip(self.moves).any(|((part, in_base), moves)| {
            separation_within(part, in_base, &self.shape, &self.in_base, moves).is_some()
        })
    }
}

fn capsule(a: Vec3, b: Vec3, radius: f64) -> (Shape, Pose) {
    let half_length = a.distance(b) * 0.5;
    let along = (b - a).try_normalize().unwrap_or(Vec3::Z);
    (Shape::Capsule(Capsule { half_length, radius }), Pose::new(Rotation::from_z(along), (a + b) * 0.5))
}

/// Cells that inverse kinematics aims at the obstacle.
fn seeds(arm: &PlanarArm, grid: &Grid, obstacle: &Obstacle) -> Vec<Cell> {
    let (shape, in_base) = obstacle.shape();
    let outermost = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z]
        .map(|d| in_base.transform_point(shape.support(in_base.inverse_transform_vector(d))));
    let middle = obstacle.enclosing_sphere().0;
    let mut cells: Vec<Cell> = std::iter::once(middle)
        .chain(outermost)
        .flat_map(|target| configurations(arm, target))
        .filter_map(|q| cell_within_limits(grid, q))
        .collect();
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// Base turned to the target or away from it; there the forearm's tip at it with the elbow to either side (the cosine
/// rule, equations 9 to 14 of the paper), or the upper arm pointing at it.
fn configurations(arm: &PlanarArm, target: Vec3) -> Vec<[f64; 3]> {
    let mut found = Vec::new();
    let toward = target.y.atan2(target.x);
    for (base, radial) in [(toward, target.x.hypot(target.y)), (toward + PI, -target.x.hypot(target.y))] {
        let (x, y) = (radial - arm.offset_m, target.z - arm.height_m);
        // θ2 is measured from the vertical, forward.
        let (far, pointing) = (x.hypot(y), x.atan2(y));
        let (l1, l2) = (arm.upper_length_m, arm.fore_length_m);
        // Beyond the reach, or within what the forearm cannot fold back to: stretched, or folded.
        let cosine =
            |a: f64, b: f64, c: f64| ((a * a + b * b - c * c) / (2.0 * a * b).max(1e-12)).clamp(-1.0, 1.0).acos();
        let between = cosine(l1, l2, far);
        let lift = cosine(l1, far.max(1e-9), l2);
        for side in [1.0, -1.0] {
            // Stretched is θ3 = −90°; bending by π − between follows the side the elbow is on.
            found.push([base, pointing - side * lift, -FRAC_PI_2 + side * (PI - between)]);
        }
        for theta3 in [-FRAC_PI_2, 0.0, FRAC_PI_2] {
            found.push([base, pointing, theta3]);
        }
    }
    found
}

/// The configuration in turns that the axes have, moved to the limits where it is beyond (the paper's limit cases).
fn cell_within_limits(grid: &Grid, q: [f64; 3]) -> Option<Cell> {
    let mut within = q;
    for (value, axis) in within.iter_mut().zip(grid.axes()) {
        let middle = (axis.min() + axis.max()) * 0.5;
        *value -= 2.0 * PI * ((*value - middle) / (2.0 * PI)).round();
        *value = value.clamp(axis.min(), axis.max());
    }
    grid.cell(within)
}
