//! ROS 2 without ROS: the service as a node of ROS 2 in the layout of `rmw_zenoh`. `docs/ros2.md` has the topics.
//!
//! Messages of a controller that uses ROS 2 become joint values of the node's own protocol, so that the same gate,
//! bounds and watchdogs apply to it. ROS 2 has a separate session, and a separate thread waits for it: a ROS 2 that is
//! absent, slow or hostile never affects a tick.

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
pub use settings::{RobotArgumentError, Ros2Error, Ros2Robot, Ros2Settings};
pub use watchdog::Watchdog;
