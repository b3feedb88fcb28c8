//! The naive oracle: the arm's three solids at one configuration against the obstacle, by the exact distances of
//! `elbowroom-proximity`, and boxes of joint space by subdivision.
#![allow(dead_code, reason = "each test file uses a part")]

use elbowroom_cspace::{
    CellIndex, ConvexObstacle, Grid, GridAxis, Layer, OccupancyBitmap, PlanarArm, PlanarMapBuilder,
};
use elbowroom_proximity::{Capsule, Shape, Sphere, separation};
use elbowroom_spatial::{Pose, Rotation, Vec3};
pub use elbowroom_testkit::random::Xorshift;

/// Number of random cases: `cases` in a long run (`ELBOWROOM_LONG=1`), otherwise `cases / one_of`.
pub fn long_run(cases: usize, one_of: usize) -> usize {
    elbowroom_testkit::extent::amount(cases / one_of, cases)
}

/// Random vectors and configurations.
pub trait RandomGeometry {
    /// Each coordinate within `half` of 0.
    fn vector(&mut self, half: f64) -> Vec3;

    fn configuration(&mut self, grid: &Grid) -> [f64; 3];

    /// A sample of a cell's box, often on its border.
    fn inside(&mut self, grid: &Grid, cell: CellIndex) -> [f64; 3];
}

impl RandomGeometry for Xorshift {
    fn vector(&mut self, half: f64) -> Vec3 {
        Vec3::from(self.within(half))
    }

    fn configuration(&mut self, grid: &Grid) -> [f64; 3] {
        let [a, b, c] = grid.axes();
        [self.between(a.min(), a.max()), self.between(b.min(), b.max()), self.between(c.min(), c.max())]
    }

    fn inside(&mut self, grid: &Grid, cell: CellIndex) -> [f64; 3] {
        let (q, half) = (grid.center(cell), grid.half_widths());
        let mut offset = || match self.index(4) {
            0 => -1.0,
            1 => 1.0,
            _ => self.between(-1.0, 1.0),
        };
        let o = [offset(), offset(), offset()];
        [q[0] + half[0] * o[0], q[1] + half[1] * o[1], q[2] + half[2] * o[2]]
    }
}

/// The baseline's grid: θ1 −170..170°, θ2 −90..90°, θ3 −120..150°.
pub fn grid(step_deg: f64) -> Grid {
    grid_of(step_deg, [[-170.0, 170.0], [-90.0, 90.0], [-120.0, 150.0]])
}

pub fn grid_of(step_deg: f64, ranges: [[f64; 2]; 3]) -> Grid {
    let axis = |name, [lo, hi]: [f64; 2]| GridAxis::from_degrees(name, lo, hi, step_deg).unwrap();
    let [a, b, c] = ranges;
    Grid::new([axis("base", a), axis("shoulder", b), axis("elbow", c)]).unwrap()
}

pub fn fill(arm: &PlanarArm, grid: &Grid, obstacle: &ConvexObstacle) -> OccupancyBitmap {
    let mut builder = PlanarMapBuilder::new(*arm, grid).unwrap();
    let mut layer = Layer::new();
    builder.build_layer(obstacle, &mut layer);
    assert!(layer.spans().windows(2).all(|w| w[0].row <= w[1].row), "rows ascend");
    let mut occupancy = OccupancyBitmap::new(grid.shape());
    occupancy.add(&layer);
    occupancy
}

fn capsule(a: Vec3, b: Vec3, radius: f64) -> (Shape, Pose) {
    let half_length = a.distance(b) * 0.5;
    (
        Shape::Capsule(Capsule { half_length, radius }),
        Pose::new(Rotation::from_z((b - a) / (2.0 * half_length)), (a + b) * 0.5),
    )
}

/// Distance between arm and obstacle, metres.
pub fn clearance(arm: &PlanarArm, q: [f64; 3], (shape, in_base): &(Shape, Pose)) -> f64 {
    let [shoulder, elbow, wrist] = arm.joints_in_base(q);
    let parts = [
        capsule(shoulder, elbow, arm.upper_radius_m),
        capsule(elbow, wrist, arm.fore_radius_m),
        (Shape::Sphere(Sphere { radius: arm.wrist_radius_m }), Pose::from_translation(wrist)),
    ];
    parts.iter().map(|(part, pose)| separation(part, pose, shape, in_base).lower_bound).fold(f64::INFINITY, f64::min)
}

pub fn touches(arm: &PlanarArm, q: [f64; 3], obstacle: &(Shape, Pose)) -> bool {
    clearance(arm, q, obstacle) <= 0.0
}

/// The proven state of a box of joint space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BoxState {
    Free,
    Touching,
    Unknown,
}

/// Proof by subdivision: a box is free if the distance at its centre is larger than the motion of any point of the arm.
pub fn box_state(arm: &PlanarArm, q: [f64; 3], half: [f64; 3], obstacle: &(Shape, Pose), depth: u32) -> BoxState {
    let gap = clearance(arm, q, obstacle);
    if gap <= 0.0 {
        return BoxState::Touching;
    }
    let radius = arm.offset_m.abs() + arm.upper_length_m + arm.fore_length_m;
    let moves = [radius, arm.upper_length_m + arm.fore_length_m, arm.fore_length_m];
    let each = [half[0] * moves[0], half[1] * moves[1], half[2] * moves[2]];
    if gap > each[0] + each[1] + each[2] {
        return BoxState::Free;
    }
    if depth == 0 {
        return BoxState::Unknown;
    }
    let widest = (0..3).max_by(|&i, &j| each[i].total_cmp(&each[j])).unwrap();
    let mut smaller = half;
    smaller[widest] *= 0.5;
    let mut result = BoxState::Free;
    for side in [-1.0, 1.0] {
        let mut middle = q;
        middle[widest] += side * smaller[widest];
        match box_state(arm, middle, smaller, obstacle, depth - 1) {
            BoxState::Touching => return BoxState::Touching,
            BoxState::Unknown => result = BoxState::Unknown,
            BoxState::Free => {}
        }
    }
    result
}

/// Free neighbours of blocked cells.
pub fn free_neighbours(occupancy: &OccupancyBitmap) -> Vec<CellIndex> {
    let shape = occupancy.shape();
    let mut found = Vec::new();
    for cell in occupancy.iter() {
        for axis in 0..3 {
            let here = cell[axis];
            for moved in [here.checked_sub(1), here.checked_add(1)].into_iter().flatten() {
                if usize::from(moved) >= shape[axis] {
                    continue;
                }
                let mut beside = cell;
                beside[axis] = moved;
                if !occupancy.is_blocked(beside) {
                    found.push(beside);
                }
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// Numbers of random configurations.
#[derive(Debug, Clone, Copy)]
pub struct SampleCounts {
    /// Configurations anywhere. A third as many more are bent backwards over the base.
    pub uniform: usize,
    /// Configurations in free neighbours of blocked cells.
    pub beside: usize,
}

/// Number of samples in contact in a free cell.
pub fn missed_contacts(
    arm: &PlanarArm,
    grid: &Grid,
    occupancy: &OccupancyBitmap,
    obstacle: &ConvexObstacle,
    samples: SampleCounts,
    random: &mut Xorshift,
) -> usize {
    let shape = obstacle.shape();
    let mut missed = 0;
    for _ in 0..samples.uniform {
        let q = random.configuration(grid);
        let cell = grid.cell(q).unwrap();
        missed += usize::from(!occupancy.is_blocked(cell) && touches(arm, q, &shape));
    }
    // An arm bent backwards reaches obstacles behind its base.
    let center = obstacle.enclosing_sphere().0;
    let behind = center.y.atan2(center.x) + std::f64::consts::PI;
    for _ in 0..samples.uniform / 3 {
        let mut q = random.configuration(grid);
        q[0] = (behind + random.between(-0.6, 0.6) + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        missed += usize::from(grid.cell(q).is_some_and(|cell| !occupancy.is_blocked(cell)) && touches(arm, q, &shape));
    }
    let cells = free_neighbours(occupancy);
    for _ in 0..samples.beside {
        if cells.is_empty() {
            break;
        }
        let cell = cells[random.index(cells.len())];
        let q = random.inside(grid, cell);
        missed += usize::from(touches(arm, q, &shape));
    }
    missed
}

/// Fraction of blocked cells that are proven free in their whole box, out of `samples` blocked cells.
pub fn needless_share(
    arm: &PlanarArm,
    grid: &Grid,
    occupancy: &OccupancyBitmap,
    obstacle: &ConvexObstacle,
    samples: usize,
    random: &mut Xorshift,
) -> f64 {
    let cells: Vec<CellIndex> = occupancy.iter().collect();
    let shape = obstacle.shape();
    let mut free = 0;
    for _ in 0..samples {
        let cell = cells[random.index(cells.len())];
        let answer = box_state(arm, grid.center(cell), grid.half_widths(), &shape, 24);
        free += usize::from(answer == BoxState::Free);
    }
    free as f64 / samples as f64
}
