//! The messages, by their packages, with the fields of ROS 2 Jazzy.

pub mod builtin_interfaces;
pub mod control_msgs;
pub mod diagnostic_msgs;
pub mod elbowroom_msgs;
pub mod geometry_msgs;
pub mod sensor_msgs;
pub mod std_msgs;
pub mod tf2_msgs;
pub mod trajectory_msgs;
pub mod visualization_msgs;
