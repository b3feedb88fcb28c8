//! Why a message of ROS 2 does not count.

use elbowroom_ros2::CdrError;
use elbowroom_ros2::rmw_zenoh::AttachmentError;
use thiserror::Error;

use crate::node::Rejected;

/// Largest message that is read.
pub const MAX_MESSAGE_BYTES: usize = 65_536;

/// Why a message of a controller does not count.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RosInputError {
    /// It has no attachment.
    #[error("the sample has no attachment: is its publisher one of rmw_zenoh?")]
    NoAttachment,
    /// Its attachment cannot be read.
    #[error("{0}")]
    Attachment(#[from] AttachmentError),
    /// Too large.
    #[error("a message of {0} bytes is larger than {MAX_MESSAGE_BYTES}")]
    Size(usize),
    /// Not such a message.
    #[error("{0}")]
    Message(#[from] CdrError),
    /// A list that does not fit to the names.
    #[error("{names} names and {values} values in `{list}`")]
    Length {
        /// The list.
        list: &'static str,
        /// Number of names.
        names: usize,
        /// Number of values.
        values: usize,
    },
    /// A name that no robot has.
    #[error("`{0}` is no joint of the robot, nor of another one that has this topic")]
    Unknown(String),
    /// A name that two robots of the topic have.
    #[error("several robots that have this topic have a joint `{0}`: put the robot's name before it, as in left_{0}")]
    Ambiguous(String),
    /// A name that is there twice.
    #[error("the joint `{0}` is there twice")]
    Twice(String),
    /// A joint that is not in the message.
    #[error("the joint `{0}` is not in the message")]
    Missing(String),
    /// Another publisher sends on the topic.
    #[error("another publisher sends on this topic within a second: only one may")]
    OtherPublisher,
    /// The number or the stamp is negative.
    #[error("the number or the stamp of the sample is negative")]
    Negative,
    /// Late, replayed, or with a stamp that is none.
    #[error("{0}")]
    Rejected(#[from] Rejected),
}
