//! The running service: a [`Node`] per controller guards its robot, an arbiter grants exchange regions, and everybody can
//! see what happens. Joint states come in and speed overrides go out through a [`network`], of Zenoh or of UDP datagrams.
//!
//! `docs/live.md` has the keys, the bytes and the bounds; `docs/interlocks.md` the protocol of exchange regions.

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
pub mod messages;
pub mod network;
pub mod node;
mod region_keeper;
mod regions_table;
pub mod ros2;
mod service;
mod service_error;
mod service_options;
mod service_start;
mod simulated_controllers;

pub use arbiter_service::{ArbiterService, NotCleared};
pub use cell_versions::{CellVersions, NoVersion};
pub use client::{ControllerClient, ControllerState, Refused};
pub use clock::{Clock, boot_number};
pub use configuration_number::configuration_number;
pub use control::{ControlError, ControlOptions};
pub use event_handler::EventHandler;
pub use keys::Keys;
pub use node::Node;
pub use region_keeper::{ProgramSwitches, RegionKeeper, SwitchRequest};
pub use regions_table::{RegionTable, RegionTableMessage};
pub use service::Service;
pub use service_error::ServiceError;
pub use service_options::{DEFAULT_ADDRESS, ServiceOptions};
