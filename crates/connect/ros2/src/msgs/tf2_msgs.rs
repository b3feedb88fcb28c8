//! Transforms.

use super::geometry_msgs::TransformStamped;
use crate::message::message;

message! {
    /// Transforms, as on `/tf`.
    TFMessage = "tf2_msgs/msg/TFMessage" {
        /// The transforms.
        transforms: Vec<TransformStamped>,
    }
}
