//! Arbiter of a cell's exchange regions, on the network.

use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::sync::mpsc::{self, RecvTimeoutError, SyncSender};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use elbowroom_cell::{Cell, configure};
use elbowroom_interlock::wire::{self, Message};
use elbowroom_interlock::{Arbiter, ArbiterEvent, ArbiterSettings, Boot, Micros, Outputs, RobotSettings};
use elbowroom_monitor::{RobotSlot, SlotId};
use elbowroom_robot::RobotId;
use elbowroom_status::SlotStatus;

use crate::clock::Clock;
use crate::configuration_number::configuration_number;
use crate::event_handler::EventHandler;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, NetworkError, Publisher, Subscription, Urgency};
use crate::silence_watch::SilenceWatch;
use crate::worker::Worker;

/// Capacity of the arbiter's queue, in messages; further messages are dropped, and the guards repeat them.
const WAITING: usize = 1024;
/// Interval at which the holders are published; a change is published at once.
const PERIOD: Duration = Duration::from_millis(100);
const PERIOD_US: Micros = Micros(100_000);

/// Bytes under the key of a robot.
struct Incoming {
    robot: RobotSlot,
    bytes: Vec<u8>,
}

/// Why a robot is not cleared: it has sent a message lately, so its grants may still be valid, and it may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it has spoken lately: it must be silent for another {:.1} s, so that it holds no grant and has come to rest", .missing.0 as f64 * 1e-6)]
pub struct NotCleared {
    /// The time for which it must still be silent.
    pub missing: Micros,
}

/// A running arbiter. It ends when it is dropped.
pub struct ArbiterService {
    core: Arc<Mutex<ArbiterCore>>,
    /// Number of messages per robot that were not processed yet.
    waiting: Arc<[AtomicUsize]>,
    on_event: Option<EventHandler>,
    subscriptions: Vec<Subscription>,
    inbox: Option<SyncSender<Incoming>>,
    worker: Option<Worker>,
    // Kept because a network may end with its last owner.
    _network: Arc<dyn Network>,
}

impl ArbiterService {
    /// Starts the arbiter of a cell; `None` for a cell without exchange regions. `boot` should be higher than at former starts.
    ///
    /// # Errors
    /// [`NetworkError`] if the keys cannot be used.
    pub fn start(
        cell: &Arc<Cell>,
        network: &Arc<dyn Network>,
        boot: u64,
        clock: Clock,
        on_event: Option<EventHandler>,
    ) -> Result<Option<Self>, NetworkError> {
        let Some(settings) = settings(cell) else { return Ok(None) };
        let keys = Keys::new(&cell.name);
        let (inbox, queue) = mpsc::sync_channel::<Incoming>(WAITING);
        let waiting: Arc<[AtomicUsize]> = cell.robots.iter().map(|_| AtomicUsize::new(0)).collect();
        let (mut subscriptions, mut grants) = (Vec::new(), Vec::new());
        for (slot, robot) in cell.robots.iter().enumerate() {
            let (inbox, slot, waiting) = (inbox.clone(), RobotSlot(slot), waiting.clone());
            let handler = Box::new(move |bytes: &[u8]| {
                if bytes.len() <= wire::MAX_BYTES {
                    waiting[slot.0].fetch_add(1, SeqCst);
                    // A full queue drops the message; the guard repeats it.
                    if inbox.try_send(Incoming { robot: slot, bytes: bytes.to_vec() }).is_err() {
                        waiting[slot.0].fetch_sub(1, SeqCst);
                    }
                }
            });
            subscriptions.push(network.subscribe(&keys.interlock_state(&robot.name), handler)?);
            grants.push(network.publisher(&keys.interlock_grants(&robot.name), Urgency::RealTime)?);
        }
        let robots: Vec<String> = cell.robots.iter().map(|r| r.name.clone()).collect();
        let in_regions = robots.iter().zip(&settings.robots);
        let watched: Vec<_> = in_regions.map(|(name, robot)| (!robot.slots.is_empty()).then(|| name.clone())).collect();
        let mut core = ArbiterCore {
            slots: slot_regions(cell, settings.slots),
            silence: SilenceWatch::new(watched.into_iter(), clock.micros()),
            robots,
            arbiter: Arbiter::new(settings, Boot(boot)),
            grants,
            status: network.publisher(&keys.interlocks(), Urgency::Display)?,
            published: None,
            clock,
            lines: Vec::new(),
        };
        // The first question starts the arbiter's silence timers: robots that never send a message are silent from now on.
        let _ = core.arbiter.may_clear(RobotSlot(0), clock.micros());
        let core = Arc::new(Mutex::new(core));
        let (running, processed, told) = (core.clone(), waiting.clone(), on_event.clone());
        let step = move |longest| match queue.recv_timeout(longest) {
            Ok(incoming) => {
                step(&running, Some(&incoming), told.as_ref());
                processed[incoming.robot.0].fetch_sub(1, SeqCst);
                true
            }
            Err(RecvTimeoutError::Timeout) => {
                step(&running, None, told.as_ref());
                true
            }
            Err(RecvTimeoutError::Disconnected) => false,
        };
        let worker = Some(Worker::start("arbiter", clock, PERIOD, Box::new(step)));
        let (inbox, network) = (Some(inbox), network.clone());
        Ok(Some(Self { core, waiting, on_event, subscriptions, inbox, worker, _network: network }))
    }

    /// Returns the holder and the queue of each exchange region.
    pub fn slots(&self) -> Vec<SlotStatus> {
        locked(&self.core).slot_statuses()
    }

    /// Whether a robot has been silent for long enough to be cleared.
    ///
    /// # Errors
    /// [`NotCleared`].
    pub fn may_clear(&self, robot: RobotId) -> Result<(), NotCleared> {
        self.nothing_waits(robot)?;
        let mut core = locked(&self.core);
        let now = core.clock.micros();
        core.arbiter.may_clear(RobotSlot(robot.0), now).map_err(|missing| NotCleared { missing })
    }

    /// Declares that a silent robot was seen at rest outside all exchange regions ([`Arbiter::clear`]).
    ///
    /// # Errors
    /// [`NotCleared`]; then nothing has changed.
    pub fn clear(&self, robot: RobotId) -> Result<(), NotCleared> {
        self.nothing_waits(robot)?;
        let mut core = locked(&self.core);
        core.clear(RobotSlot(robot.0)).map_err(|missing| NotCleared { missing })?;
        tell(core, self.on_event.as_ref());
        Ok(())
    }

    /// A robot whose messages were not processed yet has spoken: this process may have paused.
    fn nothing_waits(&self, robot: RobotId) -> Result<(), NotCleared> {
        let has_spoken = self.waiting[robot.0].load(SeqCst) > 0;
        if has_spoken { Err(NotCleared { missing: PERIOD_US }) } else { Ok(()) }
    }
}

impl Drop for ArbiterService {
    fn drop(&mut self) {
        // The handlers hold the other senders.
        self.subscriptions.clear();
        self.inbox = None;
        self.worker = None;
    }
}

/// Derives the arbiter's settings from the cell; `None` without exchange regions.
fn settings(cell: &Cell) -> Option<ArbiterSettings> {
    let slots = configure::slots(cell);
    let count = slots.iter().flatten().map(|slot| slot.0 + 1).max()?;
    let robots = (0..cell.robots.len()).map(|i| {
        let is_of_robot = |r: &elbowroom_cell::CellRegion| r.robots.iter().any(|robot| robot.0 == i);
        let of_robot = slots.iter().zip(&cell.regions).filter(|(_, r)| is_of_robot(r));
        let mut own: Vec<SlotId> = of_robot.filter_map(|(slot, _)| *slot).collect();
        own.sort_unstable();
        own.dedup();
        RobotSettings { stop_time: stop_time(cell, RobotId(i)), ..RobotSettings::new(&cell.robots[i].name, own) }
    });
    let settings = ArbiterSettings::new(robots.collect(), count);
    Some(ArbiterSettings { checksum: configuration_number(cell), ..settings })
}

/// Longest time in which a robot stops from full speed after its controller stops receiving overrides.
fn stop_time(cell: &Cell, robot: RobotId) -> Micros {
    let braking = cell.robots[robot.0].limits.iter().map(|l| l.velocity / l.stop).fold(0.0, f64::max);
    let laws = &cell.monitoring;
    Micros::from_seconds(braking + laws.reaction_s + 2.0 * laws.laws.stale_s)
}

fn slot_regions(cell: &Cell, count: usize) -> Vec<Vec<String>> {
    let slots = configure::slots(cell);
    let of = |slot: SlotId| {
        let members = slots.iter().zip(&cell.regions).filter(move |(s, _)| **s == Some(slot));
        members.map(|(_, r)| r.region.name.clone()).collect()
    };
    (0..count).map(SlotId).map(of).collect()
}

/// An arbiter with its publishers.
struct ArbiterCore {
    arbiter: Arbiter,
    /// Names of the regions, per slot.
    slots: Vec<Vec<String>>,
    robots: Vec<String>,
    silence: SilenceWatch,
    grants: Vec<Box<dyn Publisher>>,
    status: Box<dyn Publisher>,
    /// Time of the last publication of the holders.
    published: Option<Micros>,
    clock: Clock,
    /// What is to be reported.
    lines: Vec<String>,
}

/// Handles a message, if there is one; publishes the holders after a change, and from time to time.
fn step(core: &Mutex<ArbiterCore>, incoming: Option<&Incoming>, on_event: Option<&EventHandler>) {
    let mut core = locked(core);
    let has_changed = incoming.is_some_and(|Incoming { robot, bytes }| core.take(*robot, bytes));
    core.publish_if_due(has_changed);
    tell(core, on_event);
}

/// Reports the lines of the core when it is not locked any more: the handler may ask the arbiter.
fn tell(mut core: MutexGuard<'_, ArbiterCore>, on_event: Option<&EventHandler>) {
    let lines = std::mem::take(&mut core.lines);
    drop(core);
    if let Some(on_event) = on_event {
        for line in &lines {
            on_event(line);
        }
    }
}

impl ArbiterCore {
    fn publish_if_due(&mut self, has_changed: bool) {
        let now = self.clock.micros();
        if has_changed || self.published.is_none_or(|at| now - at >= PERIOD_US) {
            self.published = Some(now);
            self.publish();
            self.lines.extend(self.silence.look(now));
        }
    }

    /// Processes a guard's message if its robot is the one of the key, and sends the answer. Returns whether the state
    /// of the arbiter has changed.
    fn take(&mut self, robot: RobotSlot, bytes: &[u8]) -> bool {
        let Ok(Message::State(state)) = wire::decode(bytes) else { return false };
        if state.robot != robot {
            return false;
        }
        let now = self.clock.micros();
        self.lines.extend(self.silence.heard(robot, now));
        let outputs = self.arbiter.receive(&state, now);
        self.send(outputs)
    }

    fn clear(&mut self, robot: RobotSlot) -> Result<(), Micros> {
        let outputs = self.arbiter.clear(robot, self.clock.micros())?;
        self.silence.cleared(robot);
        self.send(outputs);
        self.publish_if_due(true);
        Ok(())
    }

    /// Sends the replies of the arbiter and reports its events. Returns whether there were events.
    fn send(&mut self, outputs: Outputs) -> bool {
        for reply in outputs.replies {
            let robot = reply.robot;
            if let (Some(bytes), Some(grants)) = (wire::encode(&Message::Grants(reply)), self.grants.get_mut(robot.0)) {
                grants.publish(&bytes);
            }
        }
        let lines: Vec<String> = outputs.events.iter().map(|event| self.words(event)).collect();
        self.lines.extend(lines);
        !outputs.events.is_empty()
    }

    fn publish(&mut self) {
        if let Ok(json) = serde_json::to_vec(&self.slot_statuses()) {
            self.status.publish(&json);
        }
    }

    fn slot_statuses(&self) -> Vec<SlotStatus> {
        let name = |robot: RobotSlot| self.robots[robot.0].clone();
        let slot = |(i, regions): (usize, &Vec<String>)| SlotStatus {
            regions: regions.clone(),
            holder: self.arbiter.holder(SlotId(i)).map(name),
            queue: self.arbiter.queue(SlotId(i)).iter().map(|r| name(*r)).collect(),
            age_s: 0.0,
        };
        self.slots.iter().enumerate().map(slot).collect()
    }

    fn words(&self, event: &ArbiterEvent) -> String {
        let robot = |r: &RobotSlot| &self.robots[r.0];
        let slot = |s: &SlotId| self.slots[s.0].join(", ");
        match event {
            ArbiterEvent::Granted(s, r) => format!("{}: granted to {}", slot(s), robot(r)),
            ArbiterEvent::Released(s, r) => format!("{}: released by {}", slot(s), robot(r)),
            ArbiterEvent::FoundInside(s, r) => format!("{}: {} was found inside, and holds it", slot(s), robot(r)),
            ArbiterEvent::Conflict(s, a, b) => {
                format!("{}: {} was found inside while {} holds it: both have to stop", slot(s), robot(b), robot(a))
            }
            ArbiterEvent::Deadlock(robots) => {
                let names: Vec<&str> = robots.iter().map(|r| robot(r).as_str()).collect();
                format!("deadlock of {}", names.join(", "))
            }
            ArbiterEvent::GuardStarted(r, _) => format!("{}: its guard has started", robot(r)),
            ArbiterEvent::OtherConfiguration(r) => {
                format!("{}: has loaded another configuration, and is not trusted", robot(r))
            }
            ArbiterEvent::Cleared(r) => format!("{}: was cleared", robot(r)),
            ArbiterEvent::StartedAgain(_) => "this arbiter began again: the guards obey a later one".to_owned(),
        }
    }
}
