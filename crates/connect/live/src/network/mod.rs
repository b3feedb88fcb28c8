//! Messages between processes: bytes published under a key, and delivered at most once, late or never.

mod authenticated;
mod joined;
mod local;
mod pub_sub;
mod udp;
mod zenoh_network;

pub use authenticated::AuthenticatedNetwork;
pub use joined::JoinedNetworks;
pub use local::LocalNetwork;
pub use pub_sub::{Handler, Network, NetworkError, Publisher, Subscription, Urgency};
pub use udp::UdpNetwork;
pub use zenoh_network::{ZENOH_RUNTIME, ZenohNetwork, ZenohSettings};
pub(crate) use zenoh_network::{endpoint, open_session};
