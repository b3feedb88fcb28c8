//! Reasons for refusing a ROS 2 message.

use elbowroom_ros2::CdrError;
use elbowroom_ros2::rmw_zenoh::AttachmentError;
use thiserror::Error;

use crate::node::Rejected;

/// Largest message that is read, bytes.
pub const MAX_MESSAGE_BYTES: usize = 65_536;

/// Why a message of a controller is refused.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RosInputError {
    /// The message has no attachment.
    #[error("the sample has no attachment: is its publisher one of rmw_zenoh?")]
    NoAttachment,
    /// The attachment cannot be read.
    #[error("{0}")]
    Attachment(#[from] AttachmentError),
    /// The message is too large.
    #[error("a message of {0} bytes is larger than {MAX_MESSAGE_BYTES}")]
    Size(usize),
    /// The bytes are not a message of this type.
    #[error("{0}")]
    Message(#[from] CdrError),
    /// A list has another length than the list of names.
    #[error("{names} names and {values} values in `{list}`")]
    Length {
        /// The list.
        list: &'static str,
        /// Number of names.
        names: usize,
        /// Number of values.
        values: usize,
    },
    /// No robot has a joint of this name.
    #[error("`{0}` is no joint of the robot, nor of another one that has this topic")]
    Unknown(String),
    /// Two robots of the topic have a joint of this name.
    #[error("several robots that have this topic have a joint `{0}`: put the robot's name before it, as in left_{0}")]
    Ambiguous(String),
    /// The name occurs twice.
    #[error("the joint `{0}` is there twice")]
    Twice(String),
    /// A joint is missing in the message.
    #[error("the joint `{0}` is not in the message")]
    Missing(String),
    /// Another publisher sends on the topic.
    #[error("another publisher sends on this topic within a second: only one may")]
    OtherPublisher,
    /// The number or the stamp is negative.
    #[error("the number or the stamp of the sample is negative")]
    Negative,
    /// The message is late or replayed, or its stamp is invalid.
    #[error("{0}")]
    Rejected(#[from] Rejected),
}
