//! Types that all other crates share: poses, rotations, velocities of frames, bounding boxes, units and small linear
//! algebra.
//!
//! Units are metres, radians and seconds; readers of files convert with [`units`]. A [`Pose`] named `tool_in_world`
//! maps points from the tool's frame to the world frame.
//!
//! ```
//! use elbowroom_spatial::{Pose, Rotation, Vec3};
//! let tool_in_world = Pose::new(Rotation::from_rpy(0.0, 0.0, 0.5), Vec3::new(1.0, 0.0, 0.7));
//! let p_in_world = tool_in_world.transform_point(Vec3::Z * 0.25);
//! let p_in_tool = tool_in_world.inverse().transform_point(p_in_world);
//! assert!((p_in_tool - Vec3::new(0.0, 0.0, 0.25)).length() < 1e-15);
//! ```
//!
//! **Invariant.** If a pose is finite, [`Aabb::transformed`] always contains the image of every point of the box, up
//! to rounding. For an unbounded box it is all of space.

mod aabb;
mod frame_motion;
pub mod linalg;
mod obb;
mod pose;
mod rotation;
pub mod units;
mod vec3;

pub use aabb::Aabb;
pub use frame_motion::FrameMotion;
pub use obb::Obb;
pub use pose::Pose;
pub use rotation::Rotation;
pub use vec3::Vec3;
