//! Time that the arbiter takes to grant a region, from the messages of both sides.

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

/// Time after a fault for which a process counts as disturbed: it starts, or connects again.
const RECOVERY: Duration = Duration::from_secs(3);

/// A request, until its robot has the region or no longer wants it.
#[derive(Debug, Clone, Copy)]
struct Request {
    at: Instant,
    /// Whether no other robot had, wanted or might be in the region.
    is_free: bool,
    is_granted: bool,
}

/// Results of the measurement.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// Times from the request of a free region to its grant, if the robots of the region and the arbiter had no fault.
    pub undisturbed: Latencies,
    /// All other times: the region was taken, or something had failed.
    pub others: Latencies,
    /// Times from the start of an arbiter's process to its first grant.
    pub restarts: Latencies,
    /// Waits of more than a second, and waits that are not over.
    pub waits: Vec<Wait>,
}

struct Heard {
    robots: usize,
    /// Reports per robot and region.
    reports: Vec<Vec<SlotReport>>,
    requests: Vec<Vec<Option<Request>>>,
    /// Time until which a process counts as disturbed, per process, the arbiter after the nodes; `None` during a fault.
    disturbed_until: Vec<Option<Instant>>,
    /// Last received start number of the arbiter, and the start time of its process.
    arbiter: u64,
    arbiter_started: Option<Instant>,
    measured: Measured,
}

/// Subscriptions to the messages of both sides.
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
            // The cell is starting.
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
            // A message that is not of this cell's processes.
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
            // A grant that was known before does not answer a request.
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

    /// Returns the processes that a request depends on: the robots of the region and the arbiter.
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

    /// Marks open requests as disturbed when a process that they depend on fails.
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

/// Returns the other robots that share a region.
fn neighbours(robot: usize, slot: usize) -> impl Iterator<Item = usize> {
    [slot, slot + 1].into_iter().filter(move |other| *other != robot)
}

/// Makes a wait, if it has lasted for more than a second.
fn wait(robot: usize, slot: usize, from: Instant, to: Instant) -> Option<Wait> {
    (to - from > Duration::from_secs(1)).then_some(Wait { robot, slot, from, to })
}
