//! Joint states, and the image that a marker may carry.

use super::std_msgs::Header;
use crate::message::message;

message! {
    /// The state of joints; a sequence is empty if its values are unknown.
    JointState = "sensor_msgs/msg/JointState" {
        /// Time of the measurement.
        header: Header,
        /// Names of the joints.
        name: Vec<String>,
        /// Positions, rad or m.
        position: Vec<f64>,
        /// Velocities, rad/s or m/s.
        velocity: Vec<f64>,
        /// Efforts, N·m or N.
        effort: Vec<f64>,
    }
}

message! {
    /// A compressed picture.
    CompressedImage = "sensor_msgs/msg/CompressedImage" {
        /// Time and frame.
        header: Header,
        /// Its format, such as `png`.
        format: String,
        /// Its bytes.
        data: Vec<u8>,
    }
}
