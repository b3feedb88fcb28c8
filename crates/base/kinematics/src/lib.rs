//! Kinematic chains: forward kinematics, Jacobians, inverse kinematics, Denavit-Hartenberg tables, motion bounds.
//!
//! A [`Chain`] is constant: a tree of links and joints, checked once. A [`ChainState`] is mutable and belongs to one
//! thread: it takes joint values and provides poses and velocities of all links. After both have been built, nothing
//! allocates.
//!
//! | task | where |
//! | --- | --- |
//! | poses, velocities, accelerations of links | [`Chain::forward`], [`Chain::forward_motion`] |
//! | Jacobian of a point of a link | [`Chain::jacobian`] |
//! | joint values that bring a tip to a pose | [`inverse`] |
//! | forward and inverse kinematics of any point of a surface | [`surface_ik`] |
//! | Denavit-Hartenberg table of a chain, and chain of a table | [`dh`] |
//! | upper bounds on the motion of a link's points | [`motion_bound`] |
//! | a chain as frames with a centre and a rotation about a vector | [`frames`] |
//!
//! ```
//! use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
//! use elbowroom_spatial::{Pose, Vec3};
//!
//! let elbow = Joint {
//!     name: "elbow".into(),
//!     kind: JointKind::Revolute,
//!     parent: LinkId(0),
//!     child: LinkId(1),
//!     origin: Pose::from_translation(Vec3::Z),
//!     axis: Vec3::Y,
//!     limits: Limits::symmetric(3.0),
//!     mimic: None,
//! };
//! let chain = Chain::new("arm", vec!["base".into(), "forearm".into()], vec![elbow])?;
//! let mut state = ChainState::new(&chain);
//! state.q[0] = 0.5;
//! state.qd[0] = 2.0;
//! chain.forward_motion(&mut state);
//! let forearm = chain.link("forearm").unwrap();
//! assert_eq!(state.link_in_root(forearm).translation, Vec3::Z);
//! assert_eq!(state.link_motion(forearm).angular_velocity, Vec3::Y * 2.0);
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```
//!
//! **Invariant.** While the joints of a chain move along a straight segment of joint space, no point within a radius
//! of a link's origin ever travels farther than [`displacement_bound`](motion_bound::displacement_bound). If a value
//! is NaN, the bound is NaN.

mod build;
mod chain;
pub mod dh;
mod error;
mod forward;
mod forward_step;
pub mod frames;
pub mod inverse;
mod jacobian;
mod joint;
mod joint_limits;
pub mod motion_bound;
mod state;
pub mod surface_ik;
mod trajectory;

pub use chain::Chain;
pub use error::{ChainError, JointEnd};
pub use joint::{Joint, JointCoupling, JointId, JointKind, Limits, LinkId, Mimic};
pub use joint_limits::JointLimits;
pub use state::ChainState;
pub use trajectory::{JointTrajectory, TrajectoryPoint, TrajectoryRow};
