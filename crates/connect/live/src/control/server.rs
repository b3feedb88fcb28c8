//! Server of the control interface of a running cell.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use elbowroom_cell::access::{AccessTokens, ControlLog, control_log_of};
use elbowroom_formats::Diagnostic;
use elbowroom_view::ViewError;
use elbowroom_view::http::{ConnectionLimits, Endpoint, Hosts, HttpServer};

use super::request_handler::{ControlParts, RequestHandler};
use super::routes::routes;

/// Options of the control interface of a service.
#[derive(Debug, Clone)]
pub struct ControlOptions {
    /// Endpoint of the interface.
    pub endpoint: Endpoint,
    /// The file of tokens ([`AccessTokens`]).
    pub tokens: PathBuf,
    /// The log of changes; by default `cell.control.jsonl` beside the cell file.
    pub log: Option<PathBuf>,
    /// Whether programs may switch temporary regions without a token, as in a cell without this interface.
    pub program_switches: bool,
}

/// Why the control interface does not start.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// The file of tokens or the log is wrong.
    #[error(transparent)]
    File(#[from] Diagnostic),
    /// The interface cannot be served at the address.
    #[error(transparent)]
    Address(#[from] ViewError),
}

/// A running control interface. It ends when it is dropped.
#[derive(Debug)]
pub(crate) struct ControlServer(HttpServer);

impl ControlServer {
    pub(crate) fn start(parts: ControlParts, options: &ControlOptions) -> Result<Self, ControlError> {
        let tokens = AccessTokens::read(&options.tokens)?;
        let log =
            ControlLog::open(&options.log.clone().unwrap_or_else(|| control_log_of(&parts.versions.base().file)))?;
        let handler = RequestHandler::new(parts, log);
        handler.log_start();
        let limits = ConnectionLimits {
            connections: 256,
            head: Duration::from_secs(5),
            request: Duration::from_secs(15),
            head_bytes: 16 * 1024,
        };
        let make = move |_, hosts: &Hosts| Ok(routes(handler, tokens, hosts.clone()));
        Ok(Self(HttpServer::start("control", &options.endpoint, limits, make)?))
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.0.address()
    }
}
