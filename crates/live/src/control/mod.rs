//! Changes of a running cell at the request of people: an interface over HTTP with tokens, roles and a log.

mod clearance;
mod desk;
mod joints_heard;
mod refusal;
mod requests;
mod routes;
mod server;

pub(crate) use desk::DeskParts;
pub(crate) use joints_heard::JointsHeard;
pub(crate) use server::ControlServer;
pub use server::{ControlError, ControlOptions};
