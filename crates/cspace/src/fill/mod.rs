//! Fast conservative filling: row intervals in the arm's plane.
//!
//! For one θ1 the arm moves in a plane. A cell is blocked if any configuration in its box touches, and the three half
//! widths are taken one after the other, each without looking at the others:
//!
//! 1. θ1 sweeps the plane through a wedge. The obstacle, grown by a link's radius and cut by the wedge, projects to a
//!    convex outline in the plane: the link's axis meets it if and only if the link touches for some θ1 of the cell.
//! 2. θ2 turns the whole arm about the shoulder: instead, the outline is turned about it, to both sides.
//! 3. θ3 at fixed θ2 turns the forearm about the elbow: what meets the outline is an interval, the wrist's sphere gives
//!    one or more arcs; cells that an interval touches are blocked.
//!
//! The upper arm blocks whole rows. Backwards (`r < 0`) is a second wedge, opposite to the first.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the dispatched kernel is compiled without its instructions"
)]

mod arcs;
#[cfg(test)]
mod audit;
mod body;
mod clip;
mod convex;
mod fan;
mod intervals;
mod lanes;
mod links;
mod outline;
mod row;
mod sift;
mod slice;
mod sphere;
mod support;
mod upper;

use std::ops::Range;

use fearless_simd::{Level, dispatch};

use crate::obstacle::Solid;
use crate::{ArmError, Axis, Grid, Layer, Obstacle, PlanarArm};
use body::{BoxBody, HullBody};
use lanes::WIDTH;

/// Turns obstacles into layers for one arm and one grid; holds what does not change, sines and cosines above all.
///
/// ```
/// use elbowroom_cspace::{Axis, Filler, Grid, Layer, Obstacle, PlanarArm, Table};
/// use elbowroom_spatial::Vec3;
/// let axes = [("base", 170.0, -170.0), ("shoulder", 90.0, -90.0), ("elbow", 150.0, -120.0)];
/// let [a, b, c] = axes.map(|(name, max, min)| Axis::from_degrees(name, min, max, 2.0).unwrap());
/// let grid = Grid::new([a, b, c])?;
/// let mut filler = Filler::new(PlanarArm::KR125_SIZED, &grid)?;
/// let mut layer = Layer::new();
/// filler.fill(&Obstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?, &mut layer);
/// let mut table = Table::new(grid.shape());
/// table.add(&layer);
/// assert!(table.is_blocked(grid.cell([0.3, 0.7, 0.5]).unwrap())); // the wrist is in the ball
/// assert!(!table.is_blocked(grid.cell([2.0, 0.7, 0.5]).unwrap()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Filler {
    pub(crate) arm: PlanarArm,
    pub(crate) grid: Grid,
    level: Level,
    /// Cosine and sine of the middles of θ1's cells.
    planes: Vec<[f64; 2]>,
    /// Direction of the upper arm at the borders of θ2's cells (one more than cells), padded to whole vectors.
    borders: Directions,
    /// The same at their middles.
    middles: Directions,
    scratch: slice::Scratch,
}

/// Directions in the shoulder's frame: x outward, y down.
#[derive(Debug, Clone)]
struct Directions {
    cos: Vec<f32>,
    sin: Vec<f32>,
    /// Cell of θ3, at this θ2, in which the forearm points outward (angle 0 in the shoulder's frame).
    zero: Vec<f32>,
}

/// Why an arm and a grid cannot be filled fast.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FillError {
    /// A dimension of the arm is unusable.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A step is too coarse for the bounds.
    #[error("joint `{joint}`: a step of {degrees:.1} degrees is too coarse: at most {MOST_DEGREES} degrees")]
    Coarse {
        /// Name of the joint.
        joint: String,
        /// Its step, degrees.
        degrees: f64,
    },
}

/// Largest step. A cell that turns the arm by more than this says little, and outlines with few edges stay bounded.
pub(crate) const MOST_DEGREES: f64 = 15.0;

impl Directions {
    /// Of the upper arm, at `count` values of θ2.
    fn new(count: usize, elbow: &Axis, theta2: impl Fn(usize) -> f64) -> Self {
        let padded = count.next_multiple_of(WIDTH) + WIDTH;
        // The last value is repeated into the padding: as good as any, and finite.
        let theta2 = |i: usize| theta2(i.min(count - 1));
        let at = |i: usize| theta2(i).sin_cos();
        Self {
            zero: (0..padded).map(|i| ((-theta2(i) - elbow.min()) / elbow.step()) as f32).collect(),
            cos: (0..padded).map(|i| at(i).0 as f32).collect(),
            sin: (0..padded).map(|i| -at(i).1 as f32).collect(),
        }
    }
}

impl Filler {
    /// Prepares for an arm and a grid.
    ///
    /// # Errors
    /// A dimension of the arm that is unusable, or a step above 15 degrees.
    pub fn new(arm: PlanarArm, grid: &Grid) -> Result<Self, FillError> {
        arm.validate()?;
        for axis in grid.axes() {
            let degrees = axis.step().to_degrees();
            if degrees > MOST_DEGREES {
                return Err(FillError::Coarse { joint: axis.joint().to_owned(), degrees });
            }
        }
        let [base, shoulder, elbow] = grid.axes();
        let planes = (0..base.count()).map(|i| base.center(i).sin_cos()).map(|(sin, cos)| [cos, sin]).collect();
        Ok(Self {
            arm,
            level: Level::new(),
            planes,
            borders: Directions::new(shoulder.count() + 1, elbow, |i| shoulder.border(i)),
            middles: Directions::new(shoulder.count(), elbow, |i| shoulder.center(i)),
            scratch: slice::Scratch::new(shoulder.count()),
            grid: grid.clone(),
        })
    }

    /// The arm.
    pub fn arm(&self) -> &PlanarArm {
        &self.arm
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Replaces a layer by what an obstacle blocks: every cell in whose box any configuration touches it.
    pub fn fill(&mut self, obstacle: &Obstacle, layer: &mut Layer) {
        self.fill_planes(obstacle, 0..self.planes.len(), layer);
    }

    /// The same for some cells of θ1 only; the others stay free.
    pub(crate) fn fill_planes(&mut self, obstacle: &Obstacle, which: Range<usize>, layer: &mut Layer) {
        layer.spans.clear();
        let level = self.level;
        let shoulder = [self.arm.offset_m, self.arm.height_m];
        let around = obstacle.enclosing_sphere();
        match &obstacle.solid {
            Solid::Sphere { center, radius } => {
                let ball = sphere::Ball { center: *center, radius: *radius };
                dispatch!(level, simd => sphere::fill(simd, self, &ball, which, layer));
            }
            Solid::Cuboid { in_base, half_extents } => {
                let mut body = BoxBody::new(in_base, *half_extents, shoulder);
                dispatch!(level, simd => convex::fill(simd, self, &mut body, around, which, layer));
            }
            Solid::Hull { in_base, hull } => {
                let mut body = HullBody::of(in_base, hull, shoulder);
                dispatch!(level, simd => convex::fill(simd, self, &mut body, around, which, layer));
            }
        }
    }
}

/// Margin for single precision as a share of the largest length that occurs (obstacle's distance and size, arm's reach).
///
/// Single precision rounds to 2⁻²⁴ = 6e-8 of a number. What a row decides on is the distance of the elbow from a line or
/// a corner: `far − (x·ex + y·ey)`. The direction is rounded once, the elbow twice, the products, their sum, the difference
/// and `far` once each: 8 roundings of numbers no larger than `size`, [`ROUNDING`]. `far` comes from a reach (three half
/// edges and a middle, each turned into the plane and multiplied by a direction: 24 roundings at most) and is turned by
/// half a step of θ2 (6 more). Together 38 · 6e-8 = 2.3e-6, and there is room. `audit` compares a million rows with double
/// precision, with half of this margin taken away.
const MARGIN: f64 = 4e-6;

/// The share that a row's own decision may lose: 8 roundings.
const ROUNDING: f64 = 0.5e-6;

/// Cosine and sine of half an arc; of half a turn where it is more than a quarter.
fn arc(half: f64) -> [f32; 2] {
    if half < std::f64::consts::FRAC_PI_2 { [half.cos() as f32, half.sin() as f32] } else { [-1.0, 1.0] }
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{Pose, Vec3};

    use super::*;

    #[test]
    fn every_instruction_set_blocks_the_same_cells() {
        let axis = |name: &str, half: f64| Axis::from_degrees(name, -half, half, 3.0).unwrap();
        let grid = Grid::new([axis("a", 170.0), axis("b", 100.0), axis("c", 140.0)]).unwrap();
        let tilted = Pose::from_xyz_rpy([0.9, 0.3, 1.2], [0.3, 0.5, 0.7]);
        let obstacles = [
            Obstacle::sphere(Vec3::new(0.2, -1.1, 0.8), 0.3).unwrap(),
            Obstacle::cuboid(tilted, Vec3::new(0.4, 0.2, 0.6)).unwrap(),
        ];
        for obstacle in &obstacles {
            let (mut best, mut plain) = (Layer::new(), Layer::new());
            let mut filler = Filler::new(PlanarArm::KR125_SIZED, &grid).unwrap();
            filler.fill(obstacle, &mut best);
            filler.level = Level::baseline();
            filler.fill(obstacle, &mut plain);
            assert_eq!(best, plain);
            assert!(!best.spans().is_empty());
        }
    }
}
