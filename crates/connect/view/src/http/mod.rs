//! What the servers of this program share: loopback addresses or TLS, connections with limits and places, requests of unknown hosts
//! refused, headers. [`HttpServer`] serves any routes with them.

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
