//! Joint values that bring a tip to a target.
use elbowroom_spatial::Pose;

use crate::{Chain, LinkId};

/// How a [`Solver`] finds its answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Closed form for six axes with a spherical wrist.
    SphericalWrist,
    /// Damped least squares with restarts.
    Numeric,
}

/// What has to match the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Task {
    /// Position and orientation.
    #[default]
    Pose,
    /// Position alone; the orientation is free.
    Position,
}

/// How hard to try.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// What has to match.
    pub task: Task,
    /// Largest accepted distance from the target, m.
    pub position_tolerance_m: f64,
    /// Largest accepted turn from the target, rad.
    pub angle_tolerance_rad: f64,
    /// Numeric method: most starting points tried, the seed among them.
    pub restarts: usize,
    /// Numeric method: most iterations from one starting point.
    pub iterations: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { task: Task::Pose, position_tolerance_m: 1e-9, angle_tolerance_rad: 1e-9, restarts: 100, iterations: 60 }
    }
}

/// An answer within the joint limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// All of the chain's independent joints, rad or m; those that do not move the tip are as in the seed.
    pub q: Vec<f64>,
    /// Distance of the tip from the target, m.
    pub position_error_m: f64,
    /// Turn of the tip from the target, rad.
    pub angle_error_rad: f64,
    /// Starting points tried beyond the seed; 0 in closed form.
    pub restarts: usize,
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IkError {
    /// No joint values reach the target, limits or not.
    #[error(
        "the target is out of reach: the closest found is {position_error_m:.6} m and {angle_error_rad:.6} rad away"
    )]
    Unreachable {
        /// Distance that remains, m.
        position_error_m: f64,
        /// Turn that remains, rad.
        angle_error_rad: f64,
    },
    /// Only joint values outside the limits reach the target.
    #[error(
        "the target is reached only outside the joint limits: joint `{joint}` would have to be at {value:.6} but may be {lower:.6} to {upper:.6}"
    )]
    Limits {
        /// The joint that is farthest outside, in the answer that is least outside.
        joint: String,
        /// What it would have to be, rad or m.
        value: f64,
        /// Its lower bound, rad or m.
        lower: f64,
        /// Its upper bound, rad or m.
        upper: f64,
    },
    /// The search ended without an answer; there may be one.
    #[error(
        "no answer after {restarts} starts: the closest found is {position_error_m:.6} m and {angle_error_rad:.6} rad away; try a seed nearer to the answer, or more restarts"
    )]
    NoConvergence {
        /// Distance that remains, m.
        position_error_m: f64,
        /// Turn that remains, rad.
        angle_error_rad: f64,
        /// Starting points tried.
        restarts: usize,
    },
    /// Target or seed is no input.
    #[error("{0}")]
    BadInput(&'static str),
}

/// Inverse kinematics of one tip of one chain. Holds its own copy of the chain and all scratch memory.
pub struct Solver {
    _chain: Chain,
}

impl Solver {
    /// For the frame `tip_offset` (tool in tip) on the link `tip`.
    pub fn new(chain: &Chain, tip: LinkId, tip_offset: Pose, options: Options) -> Self {
        let _ = (tip, tip_offset, options);
        Self { _chain: chain.clone() }
    }

    /// The method in use.
    pub fn method(&self) -> Method {
        Method::Numeric
    }

    /// The answer closest to the seed.
    ///
    /// # Errors
    /// [`IkError`].
    pub fn solve(&mut self, target_in_root: &Pose, seed: &[f64]) -> Result<Solution, IkError> {
        let _ = (target_in_root, seed);
        Err(IkError::BadInput("not ready"))
    }

    /// All answers found, closest to the seed first.
    pub fn solve_all(&mut self, target_in_root: &Pose, seed: &[f64]) -> Vec<Vec<f64>> {
        let _ = (target_in_root, seed);
        Vec::new()
    }

    /// Few steps from a near `q`; no allocation.
    pub fn refine(&mut self, target_in_root: &Pose, q: &mut [f64]) -> bool {
        let _ = (target_in_root, q);
        false
    }
}
