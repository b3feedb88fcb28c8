//! Network that accepts only processes with the cell's key.
//!
//! Each message ends with the session of its sender, a number that increases with the sender's messages, and a keyed
//! hash (BLAKE3) of these, of the contents, and of the key under which it is published: a message that was changed, or
//! moved under another key, is refused. A message of a known session is refused unless its number is higher than the
//! last one under this key; an unknown session must first prove that it runs now. So a message is never accepted twice,
//! and a recorded one never at all.

mod message_seal;
mod proofs;
mod refusals;
mod sessions;

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use elbowroom_cell::access::NetworkKey;

use super::pub_sub::{Handler, Network, NetworkError, Publisher, Subscription, Urgency};
use crate::clock::Clock;
use crate::event_handler::EventHandler;
use crate::locked::locked;
use message_seal::MessageSeal;
use proofs::Proofs;
use refusals::Refusals;
use sessions::{Sessions, Standing};

/// A network that accepts only processes with the cell's key.
///
/// ```
/// use std::sync::{Arc, Mutex};
/// use elbowroom_cell::access::NetworkKey;
/// use elbowroom_live::network::{AuthenticatedNetwork, LocalNetwork, Network, Urgency};
/// let (cable, key) = (LocalNetwork::default(), NetworkKey::generate()?);
/// let process = || AuthenticatedNetwork::new(Arc::new(cable.clone()), &key, "elbowroom/welding", None);
/// let (node, arbiter) = (process()?, process()?);
/// let heard = Arc::new(Mutex::new(Vec::new()));
/// let log = heard.clone();
/// let _subscription = arbiter.subscribe("k", Box::new(move |bytes| log.lock().unwrap().push(bytes.to_vec())))?;
/// let mut publisher = node.publisher("k", Urgency::RealTime)?;
/// publisher.publish(b"lost: the node is asked to prove itself");
/// publisher.publish(b"heard");
/// cable.publisher("k", Urgency::RealTime)?.publish(b"of a stranger");
/// assert_eq!(*heard.lock().unwrap(), [b"heard".to_vec()]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct AuthenticatedNetwork {
    inner: Arc<dyn Network>,
    process: Arc<Process>,
    _proofs: [Subscription; 2],
}

/// State that all keys of this process share.
#[derive(Debug)]
struct Process {
    seal: MessageSeal,
    sessions: Mutex<Sessions>,
    clock: Clock,
    proofs: Proofs,
    refusals: Refusals,
}

impl AuthenticatedNetwork {
    /// Joins a network with this key.
    ///
    /// Sessions prove themselves under keys that begin with `prefix`, which must be the same for all processes of the
    /// cell. Refused messages are reported to `on_event`, at most every ten seconds.
    ///
    /// # Errors
    /// [`NetworkError`]: keys with this prefix are not accepted, or the network is closed.
    pub fn new(
        inner: Arc<dyn Network>,
        key: &NetworkKey,
        prefix: &str,
        on_event: Option<EventHandler>,
    ) -> Result<Self, NetworkError> {
        let process = Arc::new(Process {
            seal: MessageSeal::new(key)
                .map_err(|e| NetworkError::Key { key: prefix.to_owned(), why: e.to_string() })?,
            sessions: Mutex::default(),
            clock: Clock::start(),
            proofs: Proofs::new(&*inner, prefix)?,
            refusals: Refusals::new(on_event),
        });
        let (asked, proved) = (process.clone(), process.clone());
        let subscriptions = [
            inner.subscribe(&proofs::question_key(prefix), Box::new(move |b| asked.proofs.reply(&asked.seal, b)))?,
            inner.subscribe(&proofs::answer_key(prefix), Box::new(move |b| proved.take_proof(b)))?,
        ];
        Ok(Self { inner, process, _proofs: subscriptions })
    }
}

impl Process {
    fn take_proof(&self, bytes: &[u8]) {
        if let Some(proof) = self.proofs.open(&self.seal, bytes) {
            locked(&self.sessions).prove(&proof, self.clock.elapsed());
        }
    }

    /// Returns the contents of a message if it is accepted. `heard` has the last number of each session under this key.
    fn admit<'b>(&self, key: &str, bytes: &'b [u8], heard: &Mutex<HashMap<u64, u64>>) -> Option<&'b [u8]> {
        let Some(message) = self.seal.open(key, bytes) else {
            self.refusals.count(key);
            return None;
        };
        let standing = if message.session == self.seal.session() {
            Standing { heard_after: Some(0), ask: None }
        } else {
            let mut sessions = locked(&self.sessions);
            sessions.standing(message.session, self.clock.elapsed(), || self.seal.nonce())
        };
        if let Some(nonce) = standing.ask {
            self.proofs.ask(&self.seal, message.session, nonce);
        }
        let after = standing.heard_after?;
        let mut heard = locked(heard);
        let last = heard.entry(message.session).or_insert(0);
        let is_new = message.number > after.max(*last);
        *last = message.number.max(*last);
        is_new.then_some(message.contents)
    }
}

impl Network for AuthenticatedNetwork {
    fn publisher(&self, key: &str, urgency: Urgency) -> Result<Box<dyn Publisher>, NetworkError> {
        let inner = self.inner.publisher(key, urgency)?;
        let (process, key) = (self.process.clone(), key.to_owned());
        Ok(Box::new(AuthenticatedPublisher { inner, process, key, bytes: Vec::with_capacity(1024) }))
    }

    fn subscribe(&self, key: &str, handler: Handler) -> Result<Subscription, NetworkError> {
        let (process, own_key) = (self.process.clone(), key.to_owned());
        // Messages sent before are not accepted: this process continues from its last number, and the others must prove
        // themselves again.
        let heard = Mutex::new(HashMap::from([(process.seal.session(), process.seal.last_number())]));
        let others = self.process.clone();
        let handler = move |bytes: &[u8]| {
            if let Some(contents) = process.admit(&own_key, bytes, &heard) {
                handler(contents);
            }
        };
        let subscription = self.inner.subscribe(key, Box::new(handler))?;
        locked(&others.sessions).forget();
        Ok(subscription)
    }
}

struct AuthenticatedPublisher {
    inner: Box<dyn Publisher>,
    process: Arc<Process>,
    key: String,
    bytes: Vec<u8>,
}

impl Publisher for AuthenticatedPublisher {
    fn publish(&mut self, bytes: &[u8]) {
        self.process.seal.close(&self.key, bytes, &mut self.bytes);
        self.inner.publish(&self.bytes);
    }
}
