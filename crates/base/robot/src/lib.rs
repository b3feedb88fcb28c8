//! A robot as data: a kinematic chain, the collision shapes of its links, and the link pairs to ignore.
//!
//! Model files are loaded into a [`Robot`]; the monitor, the configuration-space maps and the scene are built from
//! it. This crate does not check for collisions. It determines which pairs of links and objects must be checked
//! ([`collision_pairs`], [`Robot::exclusion`]) and which links touch in the rest pose ([`rest_pose_contacts`]).
//!
//! ```
//! use elbowroom_kinematics::LinkId;
//! use elbowroom_robot::{Exclusion, collision_pairs, example};
//! let arm = example::arm()?;
//! let (base, column, forearm) = (LinkId(0), LinkId(1), LinkId(3));
//! assert_eq!(arm.exclusion(base, column), Some(Exclusion::Adjacent));
//! assert!(arm.links_can_meet(base, forearm));
//! // Three pairs of links, and three moving links against one object.
//! assert_eq!(collision_pairs(&[&arm], 1).len(), 3 + 3);
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```
//!
//! **Invariant.** If more than one moving joint or a link with colliders is between two links with colliders, they
//! are always a collision pair, unless no joint moves one relative to the other or the SRDF disables the pair.

mod adjacency;
mod collision_pairs;
pub mod example;
mod ids;
mod joint_contact;
mod r_sequence;
mod rest_pose;
mod robot;

pub use adjacency::Exclusion;
pub use collision_pairs::collision_pairs;
pub use ids::{GeometryId, ObjectId, RobotId};
pub use joint_contact::{JointContact, JointContactKind, joint_contacts};
pub use r_sequence::RSequence;
pub use rest_pose::{RestPoseContact, rest_pose_contacts};
pub use robot::{Collider, Robot};
