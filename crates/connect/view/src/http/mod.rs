//! What the servers of this program share: loopback addresses, connections with limits and places, requests of unknown hosts
//! refused, headers. [`HttpServer`] serves any routes with them.

mod connection;
mod connection_limits;
mod guard;
mod loopback;
mod places;
mod server;

pub(crate) use guard::read_only;

pub use connection_limits::ConnectionLimits;
pub use guard::Hosts;
pub use loopback::loopback_address;
pub use places::Place;
pub use server::HttpServer;
