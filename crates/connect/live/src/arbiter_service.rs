//! Arbiter of a cell's exchange regions, on the network.

use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

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

/// Capacity of the arbiter's queue, in messages; further messages are dropped, and the guards repeat them.
const WAITING: usize = 1024;
/// Interval at which the holders are published; a change is published at once.
const PERIOD: Duration = Duration::from_millis(100);

/// Longest wait for the arbiter's thread; it normally answers much sooner.
const ANSWER: Duration = Duration::from_secs(2);

/// Input of the arbiter's thread.
enum Incoming {
    /// Bytes under the key of a robot.
    Message { robot: RobotSlot, bytes: Vec<u8> },
    /// A request to clear a robot, or only the question whether it may be cleared.
    Clear { robot: RobotSlot, is_question: bool, answer: SyncSender<Result<(), Micros>> },
}

/// Why a robot is not cleared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotCleared {
    /// The robot has sent a message lately: its grants may still be valid, and it may move.
    #[error("it has spoken lately: it must be silent for another {:.1} s, so that it holds no grant and has come to rest", .0.0 as f64 * 1e-6)]
    Spoke(Micros),
    /// The arbiter has ended.
    #[error("the arbiter does not answer")]
    NoAnswer,
}

/// A running arbiter. It ends when it is dropped.
pub struct ArbiterService {
    subscriptions: Vec<Subscription>,
    inbox: Option<SyncSender<Incoming>>,
    slots: Arc<Mutex<Vec<SlotStatus>>>,
    thread: Option<JoinHandle<()>>,
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
        on_event: Option<EventHandler>,
    ) -> Result<Option<Self>, NetworkError> {
        let Some(settings) = settings(cell) else { return Ok(None) };
        let keys = Keys::new(&cell.name);
        let (inbox, waiting) = mpsc::sync_channel::<Incoming>(WAITING);
        let (mut subscriptions, mut grants) = (Vec::new(), Vec::new());
        for (slot, robot) in cell.robots.iter().enumerate() {
            let (inbox, slot) = (inbox.clone(), RobotSlot(slot));
            let handler = Box::new(move |bytes: &[u8]| {
                if bytes.len() <= wire::MAX_BYTES {
                    // A full queue drops the message; the guard repeats it.
                    let _ = inbox.try_send(Incoming::Message { robot: slot, bytes: bytes.to_vec() });
                }
            });
            subscriptions.push(network.subscribe(&keys.interlock_state(&robot.name), handler)?);
            grants.push(network.publisher(&keys.interlock_grants(&robot.name), Urgency::RealTime)?);
        }
        let published: Arc<Mutex<Vec<SlotStatus>>> = Arc::default();
        let robots: Vec<String> = cell.robots.iter().map(|r| r.name.clone()).collect();
        let in_regions = robots.iter().zip(&settings.robots);
        let watched: Vec<_> = in_regions.map(|(name, robot)| (!robot.slots.is_empty()).then(|| name.clone())).collect();
        let clock = Clock::start();
        let running = Running {
            slots: slot_regions(cell, settings.slots),
            silence: SilenceWatch::new(watched.into_iter(), clock.micros()),
            robots,
            arbiter: Arbiter::new(settings, Boot(boot)),
            grants,
            status: network.publisher(&keys.interlocks(), Urgency::Display)?,
            published: published.clone(),
            clock,
            on_event,
        };
        let thread = std::thread::Builder::new().name("arbiter".into()).spawn(move || running.run(&waiting));
        let (inbox, thread) = (Some(inbox), thread.ok());
        Ok(Some(Self { subscriptions, inbox, slots: published, thread, _network: network.clone() }))
    }

    /// Returns the holder and the queue of each exchange region.
    pub fn slots(&self) -> Vec<SlotStatus> {
        locked(&self.slots).clone()
    }

    /// Whether a robot has been silent for long enough to be cleared.
    ///
    /// # Errors
    /// [`NotCleared`].
    pub fn may_clear(&self, robot: RobotId) -> Result<(), NotCleared> {
        self.ask(robot, true)
    }

    /// Declares that a silent robot was seen at rest outside all exchange regions ([`Arbiter::clear`]).
    ///
    /// # Errors
    /// [`NotCleared`]; then nothing has changed.
    pub fn clear(&self, robot: RobotId) -> Result<(), NotCleared> {
        self.ask(robot, false)
    }

    fn ask(&self, robot: RobotId, is_question: bool) -> Result<(), NotCleared> {
        let (answer, answered) = mpsc::sync_channel(1);
        let request = Incoming::Clear { robot: RobotSlot(robot.0), is_question, answer };
        let sent = self.inbox.as_ref().is_some_and(|inbox| inbox.send(request).is_ok());
        let answer = if sent { answered.recv_timeout(ANSWER).ok() } else { None };
        answer.ok_or(NotCleared::NoAnswer)?.map_err(NotCleared::Spoke)
    }
}

impl Drop for ArbiterService {
    fn drop(&mut self) {
        // The handlers hold the other senders.
        self.subscriptions.clear();
        self.inbox = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
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

struct Running {
    arbiter: Arbiter,
    /// Names of the regions, per slot.
    slots: Vec<Vec<String>>,
    robots: Vec<String>,
    silence: SilenceWatch,
    grants: Vec<Box<dyn Publisher>>,
    status: Box<dyn Publisher>,
    published: Arc<Mutex<Vec<SlotStatus>>>,
    clock: Clock,
    on_event: Option<EventHandler>,
}

impl Running {
    fn run(mut self, waiting: &Receiver<Incoming>) {
        let mut published: Option<Instant> = None;
        // The first question starts the arbiter's silence timers: robots that never send a message are silent from now on.
        let _ = self.clear(RobotSlot(0), true);
        loop {
            let has_changed = match waiting.recv_timeout(PERIOD) {
                Ok(Incoming::Message { robot, bytes }) => self.take(robot, &bytes),
                Ok(Incoming::Clear { robot, is_question, answer }) => {
                    let cleared = self.clear(robot, is_question);
                    // The caller may have stopped waiting.
                    let _ = answer.send(cleared);
                    !is_question && cleared.is_ok()
                }
                Err(RecvTimeoutError::Timeout) => false,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            if has_changed || published.is_none_or(|at| at.elapsed() >= PERIOD) {
                published = Some(Instant::now());
                self.publish();
                for line in self.silence.look(self.clock.micros()) {
                    self.say(&line);
                }
            }
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
        if let Some(line) = self.silence.heard(robot, now) {
            self.say(&line);
        }
        let outputs = self.arbiter.receive(&state, now);
        self.send(outputs)
    }

    fn clear(&mut self, robot: RobotSlot, is_question: bool) -> Result<(), Micros> {
        let now = self.clock.micros();
        if is_question {
            return self.arbiter.may_clear(robot, now);
        }
        let outputs = self.arbiter.clear(robot, now)?;
        self.silence.cleared(robot);
        self.send(outputs);
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
        for event in &outputs.events {
            self.say(&self.words(event));
        }
        !outputs.events.is_empty()
    }

    fn say(&self, line: &str) {
        if let Some(on_event) = &self.on_event {
            on_event(line);
        }
    }

    fn publish(&mut self) {
        let name = |robot: RobotSlot| self.robots[robot.0].clone();
        let slot = |(i, regions): (usize, &Vec<String>)| SlotStatus {
            regions: regions.clone(),
            holder: self.arbiter.holder(SlotId(i)).map(name),
            queue: self.arbiter.queue(SlotId(i)).iter().map(|r| name(*r)).collect(),
            age_s: 0.0,
        };
        let slots: Vec<SlotStatus> = self.slots.iter().enumerate().map(slot).collect();
        if let Ok(json) = serde_json::to_vec(&slots) {
            self.status.publish(&json);
        }
        *locked(&self.published) = slots;
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
