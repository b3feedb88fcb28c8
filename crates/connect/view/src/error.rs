//! Why a cell cannot be shown.

use std::io;
use std::net::SocketAddr;

use elbowroom_formats::FormatError;

/// Why a cell cannot be shown in a browser.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Not an address.
    #[error("`{0}` is no address\n  write: 127.0.0.1:0 for any free port, or 127.0.0.1:8080")]
    NoAddress(String),
    /// An address that other computers reach.
    #[error(
        "{0} can be reached from other computers, and what is sent is not encrypted: TLS is not built in\n  \
         write: 127.0.0.1:{port}, and on the other computer open a tunnel: ssh -L {port}:127.0.0.1:{port} HOST", port = .0.port()
    )]
    NotLoopback(SocketAddr),
    /// The address cannot be served at.
    #[error("{address} cannot be served at: {source}\n  write: another port, or 0 for any free one")]
    Bind {
        /// The address.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// The cell has no model that could be shown.
    #[error(transparent)]
    Cell(#[from] FormatError),
    /// The system gives no random numbers, threads or the like.
    #[error("the system refuses what the server needs: {0}")]
    System(#[from] io::Error),
}
