//! Inverse kinematics: joint values that bring a tip to a target.
//!
//! An [`IkSolver`] analyses the joints between root and tip once. Six revolute axes with a spherical wrist are
//! solved in closed form, whatever the file's conventions (ortho-parallel basis and spherical wrist after
//! Brandstötter, Angerer, Hofbaur 2014, by `rs-opw-kinematics`). All other chains are solved by damped least squares
//! with joint limits and restarts from a low-discrepancy sequence. The same input always gives the same answer.
//!
//! | chain | method | result |
//! | --- | --- | --- |
//! | six axes, spherical wrist | closed form, refined on the exact chain | all solutions, singular poses included |
//! | six or more axes otherwise (UR, iiwa, rails, positioners) | numeric | one solution, near the seed where possible |
//! | fewer than six | numeric | [`IkTask::Pose`] if the target lies within the chain's freedom, else [`IkTask::Position`] |
//!
//! The solutions of a spherical wrist, up to eight, have names ([`ArmConfiguration`]): shoulder front or back, elbow
//! up or down, wrist flipped or not.
//!
//! ```
//! use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
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
//! let mut solver = IkSolver::new(&chain, chain.tip(), Pose::IDENTITY, IkOptions::default());
//! let solution = solver.solve(&target, &[0.0; 6]).unwrap();
//! assert!(solution.position_error_m < 1e-12);
//! assert!(solver.solve_all(&target, &[0.0; 6]).len() > 1); // elbow up, elbow down, wrist flipped, …
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```

pub(crate) mod arm;
mod arm_configuration;
mod error;
pub(crate) mod goal;
pub(crate) mod levenberg_marquardt;
mod options;
mod pose_goal;
mod rotation_error;
pub(crate) mod sequence;
mod solution;
mod solver;
mod spherical_wrist;

pub use arm_configuration::{ArmConfiguration, ConfigurationChoice, ConfigurationWordError, Elbow, Shoulder, Wrist};
pub use error::IkError;
pub use options::{IkMethod, IkOptions, IkTask};
pub use solution::IkSolution;
pub use solver::IkSolver;
