//! Network over Zenoh.

use std::fmt;
use std::net::SocketAddr;

use zenoh::bytes::Encoding;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Session, Wait};

use super::pub_sub::{Handler, Network, NetworkError, Publisher, Subscription, Urgency};

/// Value of the environment variable `ZENOH_RUNTIME` with which a joint state wakes the fewest threads.
///
/// By default Zenoh reads a connection on other threads than those that wait for its sockets, so every message wakes
/// three of its threads. Zenoh reads the variable once, and a process cannot safely set its own: set it where the
/// process is started.
pub const ZENOH_RUNTIME: &str =
    "(rx:(handover:app),acc:(handover:app),tx:(handover:app),net:(handover:app),app:(worker_threads:2))";

/// Addresses of a process in the network.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ZenohSettings {
    /// Address at which the process accepts connections, and routes between the connected processes: `HOST:PORT` or
    /// `tcp/HOST:PORT`.
    pub listen: Option<String>,
    /// Address of the process to connect to; the connection is tried until it succeeds.
    pub connect: Option<String>,
}

/// A session of Zenoh over TCP, without discovery: only the given addresses are used.
pub struct ZenohNetwork {
    session: Session,
}

impl fmt::Debug for ZenohNetwork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ZenohNetwork {}", self.session.zid())
    }
}

impl ZenohNetwork {
    /// Opens a session.
    ///
    /// # Errors
    /// [`NetworkError::Address`] if the address is invalid or cannot be used; [`NetworkError::InUse`] if another
    /// program listens there.
    pub fn open(settings: &ZenohSettings) -> Result<Self, NetworkError> {
        Ok(Self { session: open_session(settings, &[])? })
    }

    /// The Zenoh session, for uses beyond the trait.
    pub fn session(&self) -> &Session {
        &self.session
    }
}

/// Opens a session with these settings and further entries of Zenoh's configuration.
///
/// Waits until it is connected, if it has to connect.
pub(crate) fn open_session(settings: &ZenohSettings, further: &[(&str, &str)]) -> Result<Session, NetworkError> {
    let listen = settings.listen.as_deref().map(endpoint).transpose()?;
    let connect = settings.connect.as_deref().map(endpoint).transpose()?;
    let mode = match (&listen, &connect) {
        (None, Some(_)) => "client",
        (None, None) => "peer",
        _ => "router",
    };
    let list = |address: &Option<String>| serde_json::json!(address.iter().collect::<Vec<_>>()).to_string();
    let entries = [
        ("mode", format!("\"{mode}\"")),
        ("listen/endpoints", list(&listen)),
        ("connect/endpoints", list(&connect)),
        ("connect/timeout_ms", "-1".to_owned()),
        ("connect/exit_on_failure", "false".to_owned()),
        ("connect/retry", r#"{"period_init_ms":50,"period_max_ms":200,"period_increase_factor":1.5}"#.to_owned()),
        ("scouting/multicast/enabled", "false".to_owned()),
        // A router waits this long to discover others; discovery is off here.
        ("scouting/delay", "0".to_owned()),
        ("scouting/gossip/enabled", "false".to_owned()),
        // A process that is cut off without closing its connection is dropped after this time, ms.
        ("transport/link/tx/lease", "1000".to_owned()),
    ];
    let address = || settings.listen.clone().or_else(|| settings.connect.clone()).unwrap_or_default();
    let wrong = |why: String| NetworkError::Address { address: address(), why };
    let mut config = zenoh::Config::default();
    let further = further.iter().map(|(key, value)| (*key, (*value).to_owned()));
    for (key, value) in entries.into_iter().chain(further) {
        config.insert_json5(key, &value).map_err(|e| wrong(format!("{key}: {e}")))?;
    }
    zenoh::open(config).wait().map_err(|e| match e.to_string() {
        // Zenoh's errors are texts that include positions in its sources.
        why if why.contains("Address already in use") => NetworkError::InUse { address: address() },
        why => wrong(why),
    })
}

/// Returns `tcp/HOST:PORT` for an address with or without `tcp/`.
pub(crate) fn endpoint(address: &str) -> Result<String, NetworkError> {
    let host_and_port = address.strip_prefix("tcp/").unwrap_or(address);
    let wrong = |why: &str| NetworkError::Address { address: address.to_owned(), why: why.to_owned() };
    if host_and_port.contains('/') {
        return Err(wrong("only tcp is supported"));
    }
    if host_and_port.parse::<SocketAddr>().is_ok() {
        return Ok(format!("tcp/{host_and_port}"));
    }
    match host_and_port.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(format!("tcp/{host_and_port}")),
        _ => Err(wrong("not HOST:PORT")),
    }
}

struct ZenohPublisher(zenoh::pubsub::Publisher<'static>);

impl Network for ZenohNetwork {
    fn publisher(&self, key: &str, urgency: Urgency) -> Result<Box<dyn Publisher>, NetworkError> {
        let is_urgent = urgency == Urgency::RealTime;
        let publisher = self
            .session
            .declare_publisher(key.to_owned())
            .encoding(if is_urgent { Encoding::ZENOH_BYTES } else { Encoding::APPLICATION_JSON })
            .congestion_control(CongestionControl::Drop)
            .priority(if is_urgent { Priority::RealTime } else { Priority::DataLow })
            .express(is_urgent)
            .wait();
        let publisher = publisher.map_err(|e| NetworkError::Key { key: key.to_owned(), why: e.to_string() })?;
        Ok(Box::new(ZenohPublisher(publisher)))
    }

    fn subscribe(&self, key: &str, handler: Handler) -> Result<Subscription, NetworkError> {
        let subscriber = self
            .session
            .declare_subscriber(key.to_owned())
            .callback(move |sample| handler(&sample.payload().to_bytes()))
            .wait();
        let subscriber = subscriber.map_err(|e| NetworkError::Key { key: key.to_owned(), why: e.to_string() })?;
        Ok(Subscription::new(subscriber))
    }
}

impl Publisher for ZenohPublisher {
    fn publish(&mut self, bytes: &[u8]) {
        // A message that cannot be sent now is superseded by the next one.
        let _ = self.0.put(bytes).wait();
    }
}

#[cfg(test)]
mod tests {
    use super::endpoint;

    #[test]
    fn addresses_are_taken_with_and_without_their_protocol() {
        for address in ["127.0.0.1:7447", "tcp/127.0.0.1:7447"] {
            assert_eq!(endpoint(address).unwrap(), "tcp/127.0.0.1:7447");
        }
        assert_eq!(endpoint("cell-7:7447").unwrap(), "tcp/cell-7:7447");
        assert_eq!(endpoint("[::1]:7447").unwrap(), "tcp/[::1]:7447");
        for address in ["", "7447", "127.0.0.1", "udp/127.0.0.1:7447", ":7447", "a:b:c", "127.0.0.1:70000"] {
            let message = endpoint(address).unwrap_err().to_string();
            assert!(message.contains("help: write HOST:PORT"), "{message}");
        }
    }
}
