//! Network between simulated processes: late, lossy, in any order, cut in places.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, HashMap};
use std::fmt;
use std::sync::{Arc, Mutex, Weak};

use elbowroom_testkit::random::SplitMix;

use super::process_clock::{ProcessId, true_us};
use crate::locked::locked;
use crate::network::{Handler, Network, NetworkError, Publisher, Subscription, Urgency};

/// A computer: processes on it reach each other while the cables are cut.
pub(super) type Host = usize;

/// A state of the connection from one host to another.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Link {
    /// True time until which nothing arrives, microseconds.
    pub(super) cut_until: u64,
    /// True time until which messages are late by up to `lateness`, microseconds.
    pub(super) late_until: u64,
    pub(super) lateness: u64,
}

/// A message on its way. The order is that of arrival.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct OnTheWay {
    due_us: u64,
    number: u64,
    to: ProcessId,
    listener: usize,
    bytes: Arc<[u8]>,
}

struct Listener {
    process: ProcessId,
    handler: Weak<Handler>,
}

/// All cables, and what is on its way in them.
pub(super) struct Wires {
    random: SplitMix,
    listeners: Vec<Listener>,
    of_key: HashMap<String, Vec<usize>>,
    on_the_way: BinaryHeap<Reverse<OnTheWay>>,
    sent: u64,
    /// Host per process, and whether the process runs.
    processes: Vec<(Host, bool)>,
    links: BTreeMap<(Host, Host), Link>,
    /// Some of the messages that were sent, for strangers who repeat them.
    seen: Vec<(String, Arc<[u8]>)>,
}

/// The network as one process sees it.
#[derive(Clone)]
pub(super) struct SimulatedNetwork {
    wires: Arc<Mutex<Wires>>,
    process: ProcessId,
}

/// Share of all messages that are lost, and that arrive twice.
const LOST: f64 = 0.01;
const TWICE: f64 = 0.005;
/// Usual longest time on the way, microseconds.
const USUAL_US: u64 = 1_500;
/// Number of messages that are kept for strangers.
const KEPT: usize = 64;

impl fmt::Debug for SimulatedNetwork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SimulatedNetwork")
    }
}

impl Wires {
    pub(super) fn new(seed: u64) -> Self {
        Self {
            random: SplitMix(seed),
            listeners: Vec::new(),
            of_key: HashMap::new(),
            on_the_way: BinaryHeap::new(),
            sent: 0,
            processes: Vec::new(),
            links: BTreeMap::new(),
            seen: Vec::new(),
        }
    }

    pub(super) fn add_process(&mut self, host: Host) -> ProcessId {
        self.processes.push((host, true));
        self.processes.len() - 1
    }

    /// From now on the process neither sends nor receives.
    pub(super) fn end_process(&mut self, process: ProcessId) {
        self.processes[process].1 = false;
    }

    pub(super) fn link(&mut self, from: Host, to: Host) -> &mut Link {
        self.links.entry((from, to)).or_default()
    }

    fn send(&mut self, from: ProcessId, key: &str, bytes: &[u8]) {
        let (host, runs) = self.processes[from];
        if !runs {
            return;
        }
        let bytes: Arc<[u8]> = bytes.into();
        if self.random.unit() < 0.02 {
            let at = self.random.below(KEPT);
            let message = (key.to_owned(), bytes.clone());
            if at < self.seen.len() { self.seen[at] = message } else { self.seen.push(message) }
        }
        self.carry(host, key, &bytes);
    }

    /// Puts a message on its way to all who listen to the key.
    fn carry(&mut self, host: Host, key: &str, bytes: &Arc<[u8]>) {
        let now = true_us();
        for listener in self.of_key.get(key).cloned().unwrap_or_default() {
            let to = self.listeners[listener].process;
            let (to_host, runs) = self.processes[to];
            let link = self.links.get(&(host, to_host)).copied().unwrap_or_default();
            let same = host == to_host;
            if !runs || !same && (now < link.cut_until || self.random.unit() < LOST) {
                continue;
            }
            let times = if !same && self.random.unit() < TWICE { 2 } else { 1 };
            for _ in 0..times {
                let late_us = if now < link.late_until { link.lateness } else { USUAL_US };
                let way_us = if same { 50 } else { 100 + (self.random.unit() * late_us as f64) as u64 };
                self.sent += 1;
                let (due_us, number) = (now + way_us, self.sent);
                self.on_the_way.push(Reverse(OnTheWay { due_us, number, to, listener, bytes: bytes.clone() }));
            }
        }
    }

    /// A stranger repeats a message that it has seen, whole or cut short, or sends any bytes, under a key of the cell.
    pub(super) fn repeat_a_message(&mut self, stranger: Host) {
        if self.seen.is_empty() {
            return;
        }
        let (key, bytes) = self.seen[self.random.below(self.seen.len())].clone();
        let mut changed = bytes.to_vec();
        match self.random.below(3) {
            0 => {
                let at = self.random.below(changed.len() + 1);
                changed.truncate(at);
            }
            1 => {
                for byte in &mut changed {
                    *byte = self.random.bits() as u8;
                }
            }
            _ => {}
        }
        self.carry(stranger, &key, &changed.into());
    }

    /// Takes the next message that has arrived; one for a process that pauses stays until its end.
    fn arrived(&mut self, paused_until_us: impl Fn(ProcessId) -> u64) -> Option<(Arc<Handler>, Arc<[u8]>)> {
        loop {
            let Reverse(first) = self.on_the_way.peek()?;
            if first.due_us > true_us() {
                return None;
            }
            let Reverse(mut message) = self.on_the_way.pop()?;
            let paused_us = paused_until_us(message.to);
            if paused_us > true_us() {
                message.due_us = paused_us;
                self.on_the_way.push(Reverse(message));
                continue;
            }
            let handler = self.listeners[message.listener].handler.upgrade();
            if let Some(handler) = handler.filter(|_| self.processes[message.to].1) {
                return Some((handler, message.bytes));
            }
        }
    }
}

/// Hands all messages that have arrived to those who listen.
pub(super) fn deliver(wires: &Mutex<Wires>, paused_until_us: impl Fn(ProcessId) -> u64) {
    loop {
        // The lock is released before the handler is called, as it may publish.
        let next = locked(wires).arrived(&paused_until_us);
        let Some((handler, bytes)) = next else { return };
        handler(&bytes);
    }
}

impl SimulatedNetwork {
    pub(super) fn new(wires: &Arc<Mutex<Wires>>, process: ProcessId) -> Self {
        Self { wires: wires.clone(), process }
    }
}

impl Network for SimulatedNetwork {
    fn publisher(&self, key: &str, _: Urgency) -> Result<Box<dyn Publisher>, NetworkError> {
        Ok(Box::new(SimulatedPublisher { network: self.clone(), key: key.to_owned() }))
    }

    fn subscribe(&self, key: &str, handler: Handler) -> Result<Subscription, NetworkError> {
        let handler = Arc::new(handler);
        let mut wires = locked(&self.wires);
        let listener = wires.listeners.len();
        wires.listeners.push(Listener { process: self.process, handler: Arc::downgrade(&handler) });
        wires.of_key.entry(key.to_owned()).or_default().push(listener);
        Ok(Subscription::new(handler))
    }
}

struct SimulatedPublisher {
    network: SimulatedNetwork,
    key: String,
}

impl Publisher for SimulatedPublisher {
    fn publish(&mut self, bytes: &[u8]) {
        locked(&self.network.wires).send(self.network.process, &self.key, bytes);
    }
}
