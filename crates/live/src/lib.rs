//! The running service: a [`Node`] per controller guards its robot, an arbiter grants exchange regions, and everybody can
//! see what happens. Joint states come in and speed overrides go out through a [`network`], of Zenoh or of UDP datagrams.
//!
//! `docs/live.md` has the keys, the bytes and the bounds; `docs/interlocks.md` the protocol of exchange regions.

mod arbiter_service;
mod cell_observer;
mod client;
mod clock;
mod configuration_number;
mod keys;
pub mod messages;
pub mod network;
pub mod node;
mod region_keeper;
mod regions_table;
pub mod ros2;
mod service;
mod service_error;
mod simulated_controllers;

pub use arbiter_service::{ArbiterService, EventHandler};
pub use client::{ControllerClient, ControllerState, Refused};
pub use clock::{Clock, boot_number};
pub use configuration_number::configuration_number;
pub use keys::Keys;
pub use node::Node;
pub use region_keeper::{RegionKeeper, SwitchRequest};
pub use regions_table::{RegionTable, RegionTableMessage};
pub use service::{DEFAULT_ADDRESS, Service, ServiceOptions};
pub use service_error::ServiceError;
