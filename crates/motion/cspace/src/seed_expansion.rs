//! The method of the joint-space paper, section IV: expansion from seeds, cell by cell, until the surface is closed.
//! Kept as a reference.

use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, PI};

use elbowroom_proximity::{Capsule, Shape, Sphere, separation_within};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{CellIndex, ConvexObstacle, Grid, OccupancyBitmap, PlanarArm, RowSpan};

/// Result of an expansion.
#[derive(Debug, Clone)]
pub struct SeedExpansion {
    /// The blocked cells.
    pub occupancy: OccupancyBitmap,
    /// Number of cells tested by a distance query.
    pub tested: usize,
    /// Number of cells blocked without a test, between two blocked neighbours.
    pub filled: usize,
    /// Number of seeds from inverse kinematics in the grid.
    pub seeds: usize,
}

/// Blocks cells by expansion from seeds. Inverse kinematics aims the forearm's tip and the upper arm at the obstacle
/// (its centre and its outermost points). Neighbours of blocked cells are tested until all free neighbours are tested.
/// Cells between two blocked neighbours on opposite sides are blocked without a test.
///
/// The test of a cell compares the distance at its centre with a bound of the displacement of each link within its half
/// widths. The result is conservative *around a seed*, but misses components of the blocked region without a seed
/// (joint limits can separate them). For this reason the result is not a [`Layer`](crate::Layer), and a map that guards
/// a robot cannot use it. [`CoverMapBuilder::expand_from_seeds`](crate::CoverMapBuilder::expand_from_seeds) does the
/// same for any robot.
///
/// ```
/// use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, PlanarArm, expand_from_seeds};
/// use elbowroom_spatial::Vec3;
/// let axis = |name: &str| GridAxis::from_degrees(name, -90.0, 90.0, 6.0);
/// let grid = Grid::new([axis("base")?, axis("shoulder")?, axis("elbow")?])?;
/// let sphere = ConvexObstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?;
/// let expansion = expand_from_seeds(&PlanarArm::KR125_SIZED, &grid, &sphere);
/// assert!(expansion.occupancy.blocked() > 1000 && expansion.tested < grid.cells() / 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn expand_from_seeds(arm: &PlanarArm, grid: &Grid, obstacle: &ConvexObstacle) -> SeedExpansion {
    let test = CellTest::new(arm, grid, obstacle);
    expand(grid.shape(), seeds(arm, grid, obstacle), |cell| test.may_touch(cell))
}

/// Blocks the cells that a test finds around seeds, neighbour by neighbour.
pub(crate) fn expand(
    shape: [usize; 3],
    seeds: impl IntoIterator<Item = CellIndex>,
    may_touch: impl FnMut(CellIndex) -> bool,
) -> SeedExpansion {
    let mut frontier = Frontier {
        may_touch,
        shape,
        result: SeedExpansion { occupancy: OccupancyBitmap::new(shape), tested: 0, filled: 0, seeds: 0 },
        visited: OccupancyBitmap::new(shape),
        list: VecDeque::new(),
    };
    for seed in seeds {
        frontier.result.seeds += 1;
        frontier.visit(seed);
    }
    while let Some(cell) = frontier.list.pop_front() {
        neighbours(cell, shape).for_each(|beside| frontier.visit(beside));
    }
    frontier.result
}

struct Frontier<T> {
    may_touch: T,
    shape: [usize; 3],
    result: SeedExpansion,
    /// One bit per cell: whether it was visited.
    visited: OccupancyBitmap,
    /// Blocked cells whose neighbours have not been visited yet.
    list: VecDeque<CellIndex>,
}

impl<T: FnMut(CellIndex) -> bool> Frontier<T> {
    fn visit(&mut self, cell: CellIndex) {
        if self.visited.is_blocked(cell) {
            return;
        }
        block_cell(&mut self.visited, cell);
        if self.between_blocked(cell) {
            self.result.filled += 1;
        } else {
            self.result.tested += 1;
            if !(self.may_touch)(cell) {
                return;
            }
        }
        block_cell(&mut self.result.occupancy, cell);
        self.list.push_back(cell);
    }

    fn between_blocked(&self, cell: CellIndex) -> bool {
        (0..3).any(|axis| {
            let inside = cell[axis] > 0 && usize::from(cell[axis]) + 1 < self.shape[axis];
            let at = |value: u16| {
                let mut other = cell;
                other[axis] = value;
                self.result.occupancy.is_blocked(other)
            };
            inside && at(cell[axis] - 1) && at(cell[axis] + 1)
        })
    }
}

fn block_cell(table: &mut OccupancyBitmap, [i, j, k]: CellIndex) {
    let row = u32::from(i) * table.shape()[1] as u32 + u32::from(j);
    table.block(RowSpan { row, first: k, last: k });
}

fn neighbours(cell: CellIndex, shape: [usize; 3]) -> impl Iterator<Item = CellIndex> {
    (0..6).filter_map(move |n: usize| {
        let mut beside = cell;
        let value = &mut beside[n / 2];
        *value = if n.is_multiple_of(2) { value.checked_sub(1)? } else { *value + 1 };
        (usize::from(*value) < shape[n / 2]).then_some(beside)
    })
}

/// The test of one cell.
struct CellTest {
    arm: PlanarArm,
    grid: Grid,
    shape: Shape,
    in_base: Pose,
    /// Bounds of the displacement of upper arm, forearm and wrist within half a cell, metres.
    displacements: [f64; 3],
}

impl CellTest {
    fn new(arm: &PlanarArm, grid: &Grid, obstacle: &ConvexObstacle) -> Self {
        let [half1, half2, half3] = grid.half_widths();
        let (upper, fore) = (arm.upper_length_m, arm.fore_length_m);
        let around = |length: f64| half1 * (arm.offset_m.abs() + length) + half2 * length;
        let far = around(upper + fore) + half3 * fore;
        let (shape, in_base) = obstacle.shape();
        Self { arm: *arm, grid: grid.clone(), shape, in_base, displacements: [around(upper), far, far] }
    }

    fn may_touch(&self, cell: CellIndex) -> bool {
        let [shoulder, elbow, wrist] = self.arm.joints_in_base(self.grid.center(cell));
        let ball = Shape::Sphere(Sphere { radius: self.arm.wrist_radius_m });
        let parts = [
            capsule(shoulder, elbow, self.arm.upper_radius_m),
            capsule(elbow, wrist, self.arm.fore_radius_m),
            (ball, Pose::from_translation(wrist)),
        ];
        parts.iter().zip(self.displacements).any(|((part, in_base), displacements)| {
            separation_within(part, in_base, &self.shape, &self.in_base, displacements).is_some()
        })
    }
}

fn capsule(a: Vec3, b: Vec3, radius: f64) -> (Shape, Pose) {
    let half_length = a.distance(b) * 0.5;
    let along = (b - a).try_normalize().unwrap_or(Vec3::Z);
    (Shape::Capsule(Capsule { half_length, radius }), Pose::new(Rotation::from_z(along), (a + b) * 0.5))
}

/// Cells in which inverse kinematics aims the arm at the obstacle.
fn seeds(arm: &PlanarArm, grid: &Grid, obstacle: &ConvexObstacle) -> Vec<CellIndex> {
    let (shape, in_base) = obstacle.shape();
    let outermost = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z]
        .map(|d| in_base.transform_point(shape.support(in_base.inverse_transform_vector(d))));
    let middle = obstacle.enclosing_sphere().0;
    let mut cells: Vec<CellIndex> = std::iter::once(middle)
        .chain(outermost)
        .flat_map(|target| configurations(arm, target))
        .filter_map(|q| cell_within_limits(grid, q))
        .collect();
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// Configurations that aim at a target: the base turned towards the target or away from it. In that plane, the
/// forearm's tip is at the target with the elbow on either side (the cosine rule, the paper's eqs. 9-14), or the upper
/// arm points at the target.
fn configurations(arm: &PlanarArm, target: Vec3) -> Vec<[f64; 3]> {
    let mut result = Vec::new();
    let toward = target.y.atan2(target.x);
    for (base, radial) in [(toward, target.x.hypot(target.y)), (toward + PI, -target.x.hypot(target.y))] {
        let (x, y) = (radial - arm.offset_m, target.z - arm.height_m);
        // θ2 is measured from the vertical, forward.
        let (far, pointing) = (x.hypot(y), x.atan2(y));
        let (l1, l2) = (arm.upper_length_m, arm.fore_length_m);
        // The target is out of reach, or too near for the forearm to fold back to it: stretched or folded.
        let cosine =
            |a: f64, b: f64, c: f64| ((a * a + b * b - c * c) / (2.0 * a * b).max(1e-12)).clamp(-1.0, 1.0).acos();
        let between = cosine(l1, l2, far);
        let lift = cosine(l1, far.max(1e-9), l2);
        for side in [1.0, -1.0] {
            // Stretched is θ3 = −90°; the sign of the bend π − between follows the side of the elbow.
            result.push([base, pointing - side * lift, -FRAC_PI_2 + side * (PI - between)]);
        }
        for theta3 in [-FRAC_PI_2, 0.0, FRAC_PI_2] {
            result.push([base, pointing, theta3]);
        }
    }
    result
}

/// The cell of a configuration in the turn of the axes, clamped to the limits (the paper's limit cases).
fn cell_within_limits(grid: &Grid, q: [f64; 3]) -> Option<CellIndex> {
    let mut within = q;
    for (value, axis) in within.iter_mut().zip(grid.axes()) {
        let middle = (axis.min() + axis.max()) * 0.5;
        *value -= 2.0 * PI * ((*value - middle) / (2.0 * PI)).round();
        *value = value.clamp(axis.min(), axis.max());
    }
    grid.cell(within)
}
