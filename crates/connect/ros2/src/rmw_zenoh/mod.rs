//! Mapping of ROS 2 to Zenoh by `rmw_zenoh`: keys, liveliness tokens, attachments (its `docs/design.md`). Texts and
//! bytes only.

mod attachment;
mod entity;
mod gid;
mod names;
mod qos;

pub use attachment::{Attachment, AttachmentError};
pub use entity::{Distribution, Endpoint, EndpointKind, Node, Topic};
pub use gid::Gid;
pub use names::{ros_name, type_in_dds};
pub use qos::{Durability, Qos, Reliability};
