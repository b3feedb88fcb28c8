//! Basis of the program's servers, for any routes: [`HttpServer`] with loopback addresses or TLS, limits and places of
//! connections, refusal of unknown hosts, and headers.

mod connection;
mod connection_limits;
mod endpoint;
mod guard;
mod loopback;
mod places;
mod server;
mod tls;

pub(crate) use guard::read_only;

pub use connection_limits::ConnectionLimits;
pub use endpoint::Endpoint;
pub use guard::Hosts;
pub use places::Place;
pub use server::HttpServer;
pub use tls::{TlsClient, TlsIdentity};
