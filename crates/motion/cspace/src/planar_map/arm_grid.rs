//! Constants of one arm and one grid.

use elbowroom_validity::lanes::simd::Level as SimdLevel;

use super::simd_math::WIDTH;
use crate::{Grid, GridAxis, PlanarArm};

/// An arm, a grid, and the sines and cosines of the grid's cells.
#[derive(Debug, Clone)]
pub(super) struct ArmGrid {
    pub arm: PlanarArm,
    pub grid: Grid,
    /// Instruction set of the kernels.
    pub simd_level: SimdLevel,
    /// Cosine and sine of θ1 at the centre of each cell.
    pub planes: Vec<[f64; 2]>,
    /// Directions of the upper arm at the borders of θ2's cells: one more than there are cells.
    pub borders: ArmDirections,
    /// Directions of the upper arm at the centres of the cells.
    pub middles: ArmDirections,
}

/// Directions of the upper arm in the shoulder's frame (x outward, y down), padded to whole vectors.
#[derive(Debug, Clone)]
pub(super) struct ArmDirections {
    pub cos: Vec<f32>,
    pub sin: Vec<f32>,
    /// Cell coordinate of θ3 at which the forearm points outward (angle 0 in the shoulder's frame) at this θ2.
    pub zero: Vec<f32>,
}

impl ArmGrid {
    pub fn new(arm: PlanarArm, grid: &Grid) -> Self {
        let [base, shoulder, elbow] = grid.axes();
        let planes = (0..base.count()).map(|i| base.center(i).sin_cos()).map(|(sin, cos)| [cos, sin]).collect();
        Self {
            arm,
            simd_level: SimdLevel::new(),
            planes,
            borders: ArmDirections::new(shoulder.count() + 1, elbow, |i| shoulder.border(i)),
            middles: ArmDirections::new(shoulder.count(), elbow, |i| shoulder.center(i)),
            grid: grid.clone(),
        }
    }
}

impl ArmDirections {
    /// Computes the directions at `count` values of θ2.
    fn new(count: usize, elbow: &GridAxis, theta2: impl Fn(usize) -> f64) -> Self {
        let padded = count.next_multiple_of(WIDTH) + WIDTH;
        // The padding repeats the last value: any finite number works.
        let theta2 = |i: usize| theta2(i.min(count - 1));
        let at = |i: usize| theta2(i).sin_cos();
        Self {
            zero: (0..padded).map(|i| ((-theta2(i) - elbow.min()) / elbow.step()) as f32).collect(),
            cos: (0..padded).map(|i| at(i).0 as f32).collect(),
            sin: (0..padded).map(|i| -at(i).1 as f32).collect(),
        }
    }
}

/// Cosine and sine of half an arc; of half a turn if half the arc is more than a quarter turn.
pub(super) fn half_arc(half: f64) -> [f32; 2] {
    if half < std::f64::consts::FRAC_PI_2 { [half.cos() as f32, half.sin() as f32] } else { [-1.0, 1.0] }
}
