//! Messages to and from the controllers of `ros2_controllers`.

use super::std_msgs::Header;
use super::trajectory_msgs::{JointTrajectoryPoint, MultiDOFJointTrajectoryPoint};
use crate::message::message;

message! {
    /// Scales the execution of a trajectory: 1 is the programmed speed, 0 a stop.
    SpeedScalingFactor = "control_msgs/msg/SpeedScalingFactor" {
        /// The factor, never negative.
        factor: f64,
    }
}

message! {
    /// The state of a joint trajectory controller. Releases differ in the fields after `output`: read it with
    /// [`JointTrajectoryReference`].
    JointTrajectoryControllerState = "control_msgs/msg/JointTrajectoryControllerState" {
        /// Time of the state.
        header: Header,
        /// Names of the joints.
        joint_names: Vec<String>,
        /// The desired state.
        reference: JointTrajectoryPoint,
        /// The measured state.
        feedback: JointTrajectoryPoint,
        /// The difference.
        error: JointTrajectoryPoint,
        /// The command.
        output: JointTrajectoryPoint,
        /// Names of the joints with several degrees of freedom.
        multi_dof_joint_names: Vec<String>,
        /// Their desired state.
        multi_dof_reference: MultiDOFJointTrajectoryPoint,
        /// Their measured state.
        multi_dof_feedback: MultiDOFJointTrajectoryPoint,
        /// The difference.
        multi_dof_error: MultiDOFJointTrajectoryPoint,
        /// The command.
        multi_dof_output: MultiDOFJointTrajectoryPoint,
        /// The factor by which the trajectory is scaled at present.
        speed_scaling_factor: f64,
    }
}

message! {
    /// The beginning of a [`JointTrajectoryControllerState`] of any release: the intended motion. Decode it with
    /// [`Message::decode_prefix`](crate::Message::decode_prefix).
    JointTrajectoryReference = "control_msgs/msg/JointTrajectoryControllerState" {
        /// Time of the state.
        header: Header,
        /// Names of the joints.
        joint_names: Vec<String>,
        /// The desired state.
        reference: JointTrajectoryPoint,
    }
}
