//! Messages, keys and byte layout of ROS 2 over Zenoh, without input or output.
//!
//! [`Message`] turns the structs of [`msgs`] into CDR and back, and gives their schemas and hashes. [`rmw_zenoh`] gives the
//! keys, tokens and attachments with which a node of ROS 2 finds them. [`CellMessages`] makes the messages of a cell from its
//! status: the same bytes go on the network and into recordings. `docs/ros2.md` lists the topics.

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
