//! ROS 2 without ROS: the service as a node of ROS 2 in the layout of `rmw_zenoh`. `docs/ros2.md` has the topics.
//!
//! What arrives from a controller that speaks ROS 2 becomes joint values of the node's own protocol, so that the same gate, the same
//! bounds and the same watchdogs count for it. The session is of its own and waited for by a thread of its own: ROS 2 can be absent,
//! slow or hostile, and no tick notices.

mod answered_factor;
mod cell_feed;
mod cell_publisher;
mod controller;
mod input_error;
mod input_report;
mod intent_input;
mod joint_names;
mod joint_state_input;
mod participant;
mod publisher_gate;
mod session;
mod settings;
mod speed_scaling;
mod watchdog;
mod worker;

pub(crate) use cell_feed::CellFeed;
pub use input_error::{MAX_MESSAGE_BYTES, RosInputError};
pub(crate) use participant::Participant;
pub use session::{RosHandler, RosPublisher, RosSample, RosSession};
pub use settings::{Ros2Error, Ros2Robot, Ros2Settings};
pub use watchdog::Watchdog;
