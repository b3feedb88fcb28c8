//! Points of trajectories.

use super::builtin_interfaces::Duration;
use super::geometry_msgs::{Transform, Twist};
use crate::message::message;

message! {
    /// A point of a trajectory of joints.
    JointTrajectoryPoint = "trajectory_msgs/msg/JointTrajectoryPoint" {
        /// Positions, rad or m.
        positions: Vec<f64>,
        /// Velocities, rad/s or m/s.
        velocities: Vec<f64>,
        /// Accelerations, rad/s² or m/s².
        accelerations: Vec<f64>,
        /// Efforts, N·m or N.
        effort: Vec<f64>,
        /// Time since the start of the trajectory.
        time_from_start: Duration,
    }
}

message! {
    /// A point of a trajectory of joints with several degrees of freedom.
    MultiDOFJointTrajectoryPoint = "trajectory_msgs/msg/MultiDOFJointTrajectoryPoint" {
        /// Poses.
        transforms: Vec<Transform>,
        /// Velocities.
        velocities: Vec<Twist>,
        /// Accelerations.
        accelerations: Vec<Twist>,
        /// Time since the start of the trajectory.
        time_from_start: Duration,
    }
}
