//! Changes of a running cell at the request of people: an interface over HTTP with tokens, roles and a log.

mod clearance;
mod joints_heard;
mod nodes_heard;
mod refusal;
mod region_changes;
mod request_handler;
mod requests;
mod robot_overview;
mod routes;
mod server;
mod taught_regions;
mod teaching;

pub(crate) use joints_heard::JointsHeard;
pub(crate) use nodes_heard::NodesHeard;
pub(crate) use request_handler::ControlParts;
pub(crate) use server::ControlServer;
pub use server::{ControlError, ControlOptions};
#[cfg(test)]
pub(crate) use {
    refusal::Refusal,
    request_handler::{Done, RequestHandler},
    requests::{Add, Clear, Move, Remove, Switch},
};
