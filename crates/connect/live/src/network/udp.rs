//! Network of UDP datagrams, for controllers without Zenoh: `docs/live.md` has the layout.
//!
//! A process sends its subscriptions every second, and everything it publishes, to the processes that it knows: a
//! controller knows its node, and the node need not know the controller. Everything published is also sent to the
//! subscribers of the last three seconds. A datagram is `EU`, version 1, kind (1 subscribe, 2 publish), length of the
//! key (one byte), key, contents.

use std::collections::HashMap;
use std::fmt;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, Weak};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::pub_sub::{Handler, Network, NetworkError, Publisher, Subscription, Urgency};
use crate::locked::locked;

const HEADER: [u8; 3] = [b'E', b'U', 1];
const SUBSCRIBE: u8 = 1;
const PUBLISH: u8 = 2;
/// Interval at which a subscriber repeats its subscriptions.
const REPEAT: Duration = Duration::from_secs(1);
/// Time for which a subscriber is remembered.
const LEASE: Duration = Duration::from_secs(3);
/// Most subscribers per key; further ones are refused, so that a stranger cannot fill the memory.
const MAX_SUBSCRIBERS: usize = 256;
/// Largest datagram, bytes.
const MAX_BYTES: usize = 60_000;

/// Datagrams to and from one socket.
pub struct UdpNetwork {
    shared: Arc<Shared>,
    receiver: Option<JoinHandle<()>>,
}

struct Shared {
    socket: UdpSocket,
    /// Processes that receive the subscriptions and the messages of this process.
    peers: Vec<SocketAddr>,
    state: Mutex<State>,
    is_closed: AtomicBool,
}

#[derive(Default)]
struct State {
    handlers: HashMap<String, Vec<Weak<Handler>>>,
    /// Subscribers per published key, with the time of their last subscription.
    subscribers: HashMap<String, Vec<(SocketAddr, Instant)>>,
}

impl fmt::Debug for UdpNetwork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "UdpNetwork {:?}", self.shared.socket.local_addr())
    }
}

impl UdpNetwork {
    /// Binds a socket to an address (`HOST:PORT`; port 0 for any free port).
    ///
    /// The processes at `peers` receive the subscriptions and the messages of this one.
    ///
    /// # Errors
    /// [`NetworkError::Address`] if an address cannot be used.
    pub fn bind(listen: &str, peers: &[&str]) -> Result<Self, NetworkError> {
        let wrong = |address: &str| {
            let address = address.to_owned();
            move |e: io::Error| NetworkError::Address { address, why: e.to_string() }
        };
        let socket = UdpSocket::bind(listen).map_err(wrong(listen))?;
        // With a timeout the thread below notices that the network was closed.
        socket.set_read_timeout(Some(Duration::from_millis(100))).map_err(wrong(listen))?;
        let peers = peers.iter().map(|peer| address(peer)).collect::<Result<_, _>>()?;
        let state = Mutex::default();
        let shared = Arc::new(Shared { socket, peers, state, is_closed: AtomicBool::new(false) });
        let receiver = {
            let shared = shared.clone();
            std::thread::Builder::new().name("udp".into()).spawn(move || shared.receive()).map_err(wrong(listen))?
        };
        Ok(Self { shared, receiver: Some(receiver) })
    }

    /// Returns the address of the socket.
    ///
    /// # Errors
    /// [`NetworkError::Address`] if the system does not report it.
    pub fn local_address(&self) -> Result<SocketAddr, NetworkError> {
        let address = self.shared.socket.local_addr();
        address.map_err(|e| NetworkError::Address { address: String::new(), why: e.to_string() })
    }
}

fn address(text: &str) -> Result<SocketAddr, NetworkError> {
    let wrong = |why: String| NetworkError::Address { address: text.to_owned(), why };
    let mut found = std::net::ToSocketAddrs::to_socket_addrs(text).map_err(|e| wrong(e.to_string()))?;
    found.next().ok_or_else(|| wrong("the name has no address".into()))
}

impl Drop for UdpNetwork {
    fn drop(&mut self) {
        self.shared.is_closed.store(true, Ordering::SeqCst);
        if let Some(receiver) = self.receiver.take() {
            // The thread ends by itself; if a handler panicked it has ended already.
            let _ = receiver.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        locked(&self.state)
    }

    fn receive(&self) {
        let mut buffer = vec![0; MAX_BYTES];
        let mut repeated = Instant::now();
        while !self.is_closed.load(Ordering::SeqCst) {
            if repeated.elapsed() >= REPEAT {
                repeated = Instant::now();
                self.repeat_subscriptions();
            }
            let Ok((length, from)) = self.socket.recv_from(&mut buffer) else { continue };
            self.take(&buffer[..length], from);
        }
    }

    fn take(&self, datagram: &[u8], from: SocketAddr) {
        let Some([kind, length, rest @ ..]) = datagram.strip_prefix(&HEADER) else { return };
        let Some((key, contents)) = rest.split_at_checked(usize::from(*length)) else { return };
        let Ok(key) = std::str::from_utf8(key) else { return };
        match *kind {
            SUBSCRIBE => self.remember(key, from),
            PUBLISH => self.deliver(key, contents),
            _ => {}
        }
    }

    /// Remembers a subscriber, if this process publishes the key.
    fn remember(&self, key: &str, from: SocketAddr) {
        let mut state = self.lock();
        let Some(subscribers) = state.subscribers.get_mut(key) else { return };
        subscribers.retain(|(known, at)| *known != from && at.elapsed() < LEASE);
        if subscribers.len() < MAX_SUBSCRIBERS {
            subscribers.push((from, Instant::now()));
        }
    }

    fn deliver(&self, key: &str, contents: &[u8]) {
        let handlers: Vec<Arc<Handler>> = {
            let mut state = self.lock();
            let Some(handlers) = state.handlers.get_mut(key) else { return };
            handlers.retain(|handler| handler.strong_count() > 0);
            handlers.iter().filter_map(Weak::upgrade).collect()
        };
        for handler in handlers {
            handler(contents);
        }
    }

    fn repeat_subscriptions(&self) {
        let keys: Vec<String> = self.lock().handlers.keys().cloned().collect();
        for key in keys {
            self.subscribe_at_peers(&key);
        }
    }

    fn subscribe_at_peers(&self, key: &str) {
        let mut datagram = Vec::new();
        frame(SUBSCRIBE, key, &[], &mut datagram);
        self.peers.iter().for_each(|peer| self.send(&datagram, *peer));
    }

    fn send(&self, datagram: &[u8], to: SocketAddr) {
        // A message that cannot be sent now is superseded by the next one.
        let _ = self.socket.send_to(datagram, to);
    }
}

fn frame(kind: u8, key: &str, contents: &[u8], datagram: &mut Vec<u8>) {
    datagram.clear();
    datagram.extend_from_slice(&HEADER);
    datagram.extend_from_slice(&[kind, key.len() as u8]);
    datagram.extend_from_slice(key.as_bytes());
    datagram.extend_from_slice(contents);
}

fn check_key(key: &str) -> Result<(), NetworkError> {
    let is_short = u8::try_from(key.len()).is_ok_and(|length| length > 0);
    let why = "must have 1 to 255 bytes".to_owned();
    if is_short { Ok(()) } else { Err(NetworkError::Key { key: key.to_owned(), why }) }
}

struct UdpPublisher {
    shared: Arc<Shared>,
    key: String,
    datagram: Vec<u8>,
    to: Vec<SocketAddr>,
}

impl Network for UdpNetwork {
    fn publisher(&self, key: &str, _: Urgency) -> Result<Box<dyn Publisher>, NetworkError> {
        check_key(key)?;
        self.shared.lock().subscribers.entry(key.to_owned()).or_default();
        let to = Vec::with_capacity(MAX_SUBSCRIBERS + self.shared.peers.len());
        let datagram = Vec::with_capacity(MAX_BYTES);
        Ok(Box::new(UdpPublisher { shared: self.shared.clone(), key: key.to_owned(), datagram, to }))
    }

    fn subscribe(&self, key: &str, handler: Handler) -> Result<Subscription, NetworkError> {
        check_key(key)?;
        let handler = Arc::new(handler);
        self.shared.lock().handlers.entry(key.to_owned()).or_default().push(Arc::downgrade(&handler));
        self.shared.subscribe_at_peers(key);
        Ok(Subscription::new(handler))
    }
}

impl Publisher for UdpPublisher {
    fn publish(&mut self, bytes: &[u8]) {
        let peers = &self.shared.peers;
        self.to.clear();
        self.to.extend(peers);
        if let Some(subscribers) = self.shared.lock().subscribers.get(&self.key) {
            let present = subscribers.iter().filter(|(address, at)| at.elapsed() < LEASE && !peers.contains(address));
            self.to.extend(present.map(|(address, _)| *address));
        }
        let is_closed = self.shared.is_closed.load(Ordering::SeqCst);
        if is_closed || self.to.is_empty() || bytes.len() > MAX_BYTES - 300 {
            return;
        }
        frame(PUBLISH, &self.key, bytes, &mut self.datagram);
        self.to.iter().for_each(|to| self.shared.send(&self.datagram, *to));
    }
}
