//! Errors of showing a cell.

use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

use elbowroom_diagnostic::Diagnostic;

/// Why a cell cannot be shown in a browser.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The text is not an address.
    #[error("`{0}` is no address\n  write: 127.0.0.1:0 for any free port, or 127.0.0.1:8080")]
    NoAddress(String),
    /// Other computers can reach the address, and there is no certificate.
    #[error(
        "{0} can be reached from other computers, and without a certificate what is sent is not encrypted\n  \
         write: --certificate FILE.pem --certificate-key FILE.pem beside it; or 127.0.0.1:{port}, and on the other computer a tunnel: \
         ssh -L {port}:127.0.0.1:{port} HOST", port = .0.port()
    )]
    NotEncrypted(SocketAddr),
    /// Other computers can reach the address of a page that writes into the cell file.
    #[error(
        "{0} can be reached from other computers, and targets are drawn only at this one\n  \
         write: 127.0.0.1:{port}, and on the other computer a tunnel: ssh -L {port}:127.0.0.1:{port} HOST", port = .0.port()
    )]
    DrawnFromElsewhere(SocketAddr),
    /// A certificate or its key cannot be used.
    #[error("{}: {why}\n  write: {instead}", file.display())]
    Certificate {
        /// The file.
        file: PathBuf,
        /// The reason.
        why: String,
        /// What to write instead.
        instead: &'static str,
    },
    /// The server cannot listen at the address.
    #[error("{address} cannot be served at: {source}\n  write: another port, or 0 for any free one")]
    Bind {
        /// The address.
        address: SocketAddr,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The cell has no model that can be shown.
    #[error(transparent)]
    Cell(#[from] Diagnostic),
    /// The system does not provide random numbers, threads or the like.
    #[error("the system refuses what the server needs: {0}")]
    System(#[from] io::Error),
}
