//! How long the arbiter takes to grant a region, from the messages of both sides.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use elbowroom_interlock::wire::{self, Message};
use elbowroom_interlock::{GrantsMessage, SlotReport, StateMessage};
use elbowroom_live::Keys;
use elbowroom_live::network::{Network, NetworkError, Subscription};
use elbowroom_monitor::Occupancy;

use crate::cell::name;
use crate::latencies::Latencies;
use crate::log::Wait;

/// This long after its fault a process counts as disturbed: it starts, or connects again.
const RECOVERY: Duration = Duration::from_secs(3);

/// A request, until its robot has the region or does not want it any more.
#[derive(Debug, Clone, Copy)]
struct Request {
    at: Instant,
    /// No other robot had, wanted or might be in the region.
    is_free: bool,
    is_granted: bool,
}

/// What was measured.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// From the request of a free region to its grant, of robots, neighbours and an arbiter without a fault.
    pub undisturbed: Latencies,
    /// All others: the region was taken, or something had failed.
    pub others: Latencies,
    /// From the start of an arbiter's process to its first grant.
    pub restarts: Latencies,
    /// Waits of more than a second, and those that are not over.
    pub waits: Vec<Wait>,
}

struct Heard {
    robots: usize,
    /// Per robot and region.
    reports: Vec<Vec<SlotReport>>,
    requests: Vec<Vec<Option<Request>>>,
    /// Per process, the arbiter behind the nodes: until when it counts as disturbed; `None` in a fault.
    disturbed_until: Vec<Option<Instant>>,
    /// The start of the arbiter that was heard last, and when its process was started.
    arbiter: u64,
    arbiter_started: Option<Instant>,
    measured: Measured,
}

/// Listens to both sides.
pub struct Requests {
    heard: Arc<Mutex<Heard>>,
    _subscriptions: Vec<Subscription>,
}

fn lock(heard: &Mutex<Heard>) -> MutexGuard<'_, Heard> {
    heard.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Requests {
    pub fn listen(keys: &Keys, robots: usize, network: &dyn Network) -> Result<Self, NetworkError> {
        let slots = robots - 1;
        let heard = Arc::new(Mutex::new(Heard {
            robots,
            reports: vec![vec![SlotReport::UNKNOWN; slots]; robots],
            requests: vec![vec![None; slots]; robots],
            // The cell starts.
            disturbed_until: vec![Some(Instant::now() + 3 * RECOVERY); robots + 1],
            arbiter: 0,
            arbiter_started: None,
            measured: Measured::default(),
        }));
        let mut subscriptions = Vec::new();
        for robot in 0..robots {
            for key in [keys.interlock_state(&name(robot)), keys.interlock_grants(&name(robot))] {
                let heard = heard.clone();
                let handler = Box::new(move |bytes: &[u8]| lock(&heard).take(bytes, Instant::now()));
                subscriptions.push(network.subscribe(&key, handler)?);
            }
        }
        Ok(Self { heard, _subscriptions: subscriptions })
    }

    pub fn fault_began(&self, process: usize) {
        let mut heard = lock(&self.heard);
        heard.disturbed_until[process] = None;
        heard.forget_undisturbed(process);
    }

    pub fn fault_ended(&self, process: usize, is_restarted: bool) {
        let mut heard = lock(&self.heard);
        heard.disturbed_until[process] = Some(Instant::now() + RECOVERY);
        if process == heard.robots && is_restarted {
            heard.arbiter_started = Some(Instant::now());
        }
    }

    pub fn measured(&self) -> Measured {
        let heard = lock(&self.heard);
        let mut measured = heard.measured.clone();
        for (robot, requests) in heard.requests.iter().enumerate() {
            let open = requests.iter().enumerate().filter_map(|(slot, request)| Some((slot, (*request)?.at)));
            measured.waits.extend(open.filter_map(|(slot, from)| wait(robot, slot, from, Instant::now())));
        }
        measured
    }
}

impl Heard {
    fn take(&mut self, bytes: &[u8], now: Instant) {
        match wire::decode(bytes) {
            Ok(Message::State(state)) => self.take_state(&state, now),
            Ok(Message::Grants(grants)) => self.take_grants(&grants, now),
            // Not of this cell's processes.
            Err(_) => {}
        }
    }

    fn take_state(&mut self, state: &StateMessage, now: Instant) {
        let robot = state.robot.0;
        for (slot, report) in state.slots.iter().enumerate() {
            let has_asked = report.wants && report.token.is_none();
            if !has_asked && let Some(Request { at, .. }) = self.requests[robot][slot].take() {
                self.measured.waits.extend(wait(robot, slot, at, now));
            } else if has_asked && self.requests[robot][slot].is_none() {
                let is_free = neighbours(robot, slot).all(|other| self.is_away(other, slot))
                    && self.processes_of(robot, slot).all(|process| self.is_undisturbed(process, now));
                self.requests[robot][slot] = Some(Request { at: now, is_free, is_granted: false });
            }
            self.reports[robot][slot] = *report;
        }
    }

    fn take_grants(&mut self, grants: &GrantsMessage, now: Instant) {
        let robot = grants.robot.0;
        for (slot, answer) in grants.slots.iter().enumerate().filter(|(_, answer)| answer.granted.is_some()) {
            if grants.arbiter.0 > self.arbiter {
                self.arbiter = grants.arbiter.0;
                if let Some(started) = self.arbiter_started.take() {
                    self.measured.restarts.add_us((now - started).as_micros() as u64);
                }
            }
            // A grant that was known before answers no request.
            if answer.granted == self.reports[robot][slot].token {
                continue;
            }
            if let Some(request) = self.requests[robot][slot].as_mut().filter(|request| !request.is_granted) {
                request.is_granted = true;
                let Measured { undisturbed, others, .. } = &mut self.measured;
                let latencies = if request.is_free { undisturbed } else { others };
                latencies.add_us((now - request.at).as_micros() as u64);
            }
        }
    }

    /// The processes that a request depends on: the robots of the region and the arbiter.
    fn processes_of(&self, robot: usize, slot: usize) -> impl Iterator<Item = usize> + use<> {
        neighbours(robot, slot).chain([robot, self.robots])
    }

    fn is_away(&self, robot: usize, slot: usize) -> bool {
        let report = &self.reports[robot][slot];
        report.occupancy == Occupancy::Outside && report.token.is_none() && !report.wants
    }

    fn is_undisturbed(&self, process: usize, now: Instant) -> bool {
        self.disturbed_until[process].is_some_and(|end| now >= end)
    }

    /// Requests that are open when a process that they depend on fails are not undisturbed.
    fn forget_undisturbed(&mut self, process: usize) {
        for robot in 0..self.robots {
            for slot in 0..self.robots - 1 {
                let depends = self.processes_of(robot, slot).any(|p| p == process);
                if let Some(request) = self.requests[robot][slot].as_mut().filter(|_| depends) {
                    request.is_free = false;
                }
            }
        }
    }
}

/// The other robots that share a region.
fn neighbours(robot: usize, slot: usize) -> impl Iterator<Item = usize> {
    [slot, slot + 1].into_iter().filter(move |other| *other != robot)
}

/// A wait that has lasted for more than a second.
fn wait(robot: usize, slot: usize, from: Instant, to: Instant) -> Option<Wait> {
    (to - from > Duration::from_secs(1)).then_some(Wait { robot, slot, from, to })
}
