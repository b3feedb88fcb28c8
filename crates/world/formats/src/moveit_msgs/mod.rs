//! Messages of `MoveIt` as documents: collision objects, poses, the allowed collision matrix, the state of the robot.
//!
//! Readers of planning problems and planning scenes share this module.

pub(crate) mod collision_matrix;
pub(crate) mod field;
pub(crate) mod object;
pub(crate) mod pose;
pub(crate) mod robot_state;
pub(crate) mod solid;
pub(crate) mod types;
