//! Joint values that bring a tip to a target.
//!
//! A [`Solver`] looks at the joints between root and tip once. Six turning axes with a spherical wrist are solved in closed
//! form, whatever the file's conventions (ortho-parallel basis and spherical wrist after Brandstötter, Angerer, Hofbaur
//! 2014, by `rs-opw-kinematics`); everything else by damped least squares with joint limits and restarts from a
//! low-discrepancy sequence, so that the same question always gets the same answer.
//!
//! | chain | method | what to expect |
//! | --- | --- | --- |
//! | six axes, spherical wrist | closed form, polished on the exact chain | all solutions, singular poses included |
//! | six or more axes otherwise (UR, iiwa, rails, positioners) | numeric | one solution, near the seed where it can be |
//! | fewer than six | numeric | [`Task::Pose`] where the target lies on what the chain can do, else [`Task::Position`] |
//!
//! ```
//! use elbowroom_kinematics::inverse::{Options, Solver};
//! use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits, dh::ClassicalRow};
//! use elbowroom_spatial::Pose;
//! use std::f64::consts::FRAC_PI_2;
//!
//! // A six-axis arm by its Denavit-Hartenberg table (a, α, d, θ).
//! let rows: Vec<_> = [
//!     (0.300, FRAC_PI_2, 0.600, 0.0), (0.700, 0.0, 0.0, FRAC_PI_2), (0.185, FRAC_PI_2, 0.0, 0.0),
//!     (0.0, -FRAC_PI_2, 0.624, 0.0), (0.0, FRAC_PI_2, 0.0, 0.0), (0.0, 0.0, 0.120, 0.0),
//! ].into_iter().enumerate().map(|(i, (a, alpha, d, theta))| ClassicalRow {
//!     joint: format!("joint_{}", i + 1), kind: JointKind::Revolute, a, alpha, d, theta, limits: Limits::symmetric(3.1),
//! }).collect();
//! let chain = Chain::from_dh("arm", &rows)?;
//!
//! let mut state = ChainState::new(&chain);
//! state.q.copy_from_slice(&[0.3, -0.4, 0.5, 0.6, -0.7, 0.8]);
//! chain.forward(&mut state);
//! let target = state.link_in_root(chain.tip());
//!
//! let mut solver = Solver::new(&chain, chain.tip(), Pose::IDENTITY, Options::default());
//! let solution = solver.solve(&target, &[0.0; 6]).unwrap();
//! assert!(solution.position_error_m < 1e-12);
//! assert!(solver.solve_all(&target, &[0.0; 6]).len() > 1); // elbow up, elbow down, wrist flipped, …
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```

pub(crate) mod arm;
pub(crate) mod damped;
pub(crate) mod goal;
mod linear;
pub(crate) mod sequence;
mod solver;
mod wrist;

pub(crate) use sequence::spread_state;
pub use solver::Solver;

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
