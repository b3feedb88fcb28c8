//! Messages, keys and byte layout of ROS 2 over Zenoh, without input or output.
//!
//! [`Message`] converts the structs of [`msgs`] to CDR and back, and gives their schemas and hashes. [`rmw_zenoh`]
//! gives the keys, tokens and attachments by which ROS 2 nodes find them. [`CellMessages`] makes the messages of a cell
//! from its status: the same bytes go to the network and into recordings. `docs/ros2.md` lists the topics.
//!
//! ```
//! use elbowroom_ros2::Message;
//! use elbowroom_ros2::msgs::control_msgs::SpeedScalingFactor;
//! use elbowroom_ros2::rmw_zenoh::{Distribution, Topic};
//! // Under this key a node of ROS 2 finds the topic; it ends with the hash of the message's description.
//! let topic = Topic::of::<SpeedScalingFactor>("/left/speed_scaling", Distribution::Jazzy);
//! let key = topic.key(0);
//! assert!(key.starts_with("0/left/speed_scaling/control_msgs::msg::dds_::SpeedScalingFactor_/RIHS01_"));
//! // This is its payload.
//! let message = SpeedScalingFactor { factor: 0.5 };
//! let bytes = message.encode();
//! assert_eq!(SpeedScalingFactor::decode(&bytes)?, message);
//! assert!(SpeedScalingFactor::decode(&bytes[..11]).is_err());
//! # Ok::<(), elbowroom_ros2::CdrError>(())
//! ```
//!
//! **Invariant.** Whatever bytes arrive, [`Message::decode`] never panics and never reserves more memory than in
//! proportion to them; it returns the one message that they are exactly, or a [`CdrError`].

mod cdr;
mod cell_messages;
mod description;
mod message;
pub mod msgs;
pub mod rmw_zenoh;

pub use cdr::{CdrError, Reader, Writer};
pub use cell_messages::{CellMessages, CellUrdf, UrdfMesh};
pub use description::{ElementType, FieldType, Multiplicity, TypeSet};
pub use message::{Byte, Field, Message};
