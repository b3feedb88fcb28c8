//! Live service of a cell: a [`Node`] guards each controller's robot, an arbiter grants exchange regions.
//!
//! Joint states come in and speed overrides go out through a [`network`], of Zenoh or of UDP datagrams. Every process
//! of the cell can watch.
//!
//! `docs/live.md` has the keys, the bytes and the bounds; `docs/interlocks.md` the protocol of exchange regions.
//!
//! ```
//! use std::sync::{Arc, Mutex};
//! use elbowroom_interlock::Micros;
//! use elbowroom_live::messages::{JointState, OverrideAnswer};
//! use elbowroom_live::network::{LocalNetwork, Network, Urgency};
//! use elbowroom_live::{ControllerClient, ControllerState, Keys};
//! let (network, keys) = (LocalNetwork::default(), Keys::new("welding"));
//! let inbox = |key: &str| {
//!     let messages = Arc::new(Mutex::new(Vec::new()));
//!     let arrived = Arc::clone(&messages);
//!     let subscription = network.subscribe(key, Box::new(move |bytes| arrived.lock().unwrap().push(bytes.to_vec())));
//!     subscription.map(|subscription| (messages, subscription))
//! };
//! let (states, _of_the_node) = inbox(&keys.joint_states("left"))?;
//! let (answers, _of_the_controller) = inbox(&keys.speed_override("left"))?;
//! // The controller sends its joint values.
//! let mut client = ControllerClient::new(1, 0);
//! let state = ControllerState { q: &[0.1], programmed_override: 1.0, ..Default::default() };
//! network.publisher(&keys.joint_states("left"), Urgency::RealTime)?.publish(client.joint_state(Micros(0), &state));
//! // A node would tick a monitor with them; here the override is 0.7.
//! let (mut received, mut bytes) = (JointState::default(), Vec::new());
//! received.decode(&states.lock().unwrap()[0])?;
//! let JointState { boot, sequence, .. } = received;
//! OverrideAnswer { boot, echo: sequence, sequence: 1, speed_override: 0.7, ..Default::default() }.encode(&mut bytes);
//! network.publisher(&keys.speed_override("left"), Urgency::RealTime)?.publish(&bytes);
//! // The controller applies it while it is fresh.
//! client.receive(&answers.lock().unwrap()[0])?;
//! assert_eq!(client.speed_override(Micros(2_000)), 0.7);
//! assert_eq!(client.speed_override(Micros(21_000)), 0.0); // the watchdog's 20 ms are over
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** If a controller applies the override of its [`ControllerClient`], that override is always 0 once the
//! watchdog's time has passed since it sent the last joint values that were answered, whatever the network and the
//! node do.

mod arbiter_service;
mod carried_volumes;
mod cell_observer;
mod cell_versions;
mod client;
mod clock;
mod configuration_number;
mod control;
mod event_handler;
mod keys;
mod locked;
mod measured_sources;
pub mod messages;
pub mod network;
pub mod node;
mod peer_watch;
mod region_journal;
mod region_keeper;
mod regions_table;
mod robot_claims;
pub mod ros2;
mod sensors;
mod service;
mod service_error;
mod service_options;
mod service_start;
mod silence_watch;
mod simulated_controllers;
#[cfg(test)]
mod simulated_service;
mod simulated_sources;
mod switch_requests;
mod worker;

pub use arbiter_service::{ArbiterService, NotCleared};
pub use cell_versions::{CellVersions, NoVersion};
pub use client::{ControllerClient, ControllerState, Refused};
pub use clock::{Clock, boot_number};
pub use configuration_number::configuration_number;
pub use control::{ControlError, ControlOptions};
pub use event_handler::EventHandler;
pub use keys::Keys;
pub use node::Node;
pub use region_journal::region_journal_of;
pub use region_keeper::{ProgramSwitches, RegionKeeper, SwitchRequest};
pub use regions_table::{RegionTable, RegionTableMessage};
pub use sensors::FrameInput;
pub use service::Service;
pub use service_error::ServiceError;
pub use service_options::{DEFAULT_ADDRESS, ServiceOptions};
