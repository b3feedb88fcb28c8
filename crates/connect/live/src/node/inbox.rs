//! Input that has arrived for a node since its last tick.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use elbowroom_cell::{Cell, RegionEdit, configure};
use elbowroom_interlock::Micros;
use elbowroom_interlock::wire::MAX_BYTES;
use elbowroom_robot::RobotId;

use super::input_gate::{InputGate, Rejected};
use super::next_configuration::NextConfiguration;
use crate::configuration_number::configuration_digits;
use crate::locked::locked;
use crate::messages::JointState;
use crate::regions_table::{RegionTable, RegionTableMessage};

/// Input that has arrived since the last tick.
///
/// Threads of the network write, the thread of the tick reads: of several messages between two ticks the tick reads the
/// newest.
pub(super) struct Inbox {
    contents: Mutex<Contents>,
    news: Condvar,
    /// Wakes the thread that builds other regions.
    work: Condvar,
}

/// Contents of the inbox.
pub(super) struct Contents {
    /// The robot's own joint state.
    pub(super) own: Heard,
    /// The joint states of the robots that its regions follow, by their index in the cell; `None` for all others.
    pub(super) followed: Vec<Option<Heard>>,
    /// The messages of the measured sources of the cell.
    pub(super) measured: Vec<Heard>,
    /// The bytes of the last message of the arbiter, and whether it is new.
    pub(super) grants: Vec<u8>,
    pub(super) has_grants: bool,
    /// The table of regions, and its time of arrival.
    pub(super) regions: RegionTable,
    pub(super) regions_heard: Option<Micros>,
    /// Time of the last table of another cell file.
    pub(super) other_cell_heard: Option<Micros>,
    /// The cell with the regions that the tick uses, and the first digits of its checksum.
    pub(super) cell: Arc<Cell>,
    pub(super) number: String,
    /// Other regions: those to be built, those that the next tick takes, and the remains of the last exchange.
    pub(super) wanted: Option<Wanted>,
    pub(super) built: Option<Box<NextConfiguration>>,
    pub(super) left_over: Option<Box<NextConfiguration>>,
    pub(super) is_closed: bool,
}

/// Regions that the tick does not use yet.
pub(super) struct Wanted {
    /// The first digits of the checksum of the cell with these regions.
    pub(super) number: String,
    pub(super) edits: Vec<RegionEdit>,
    /// Names of the regions, and whether they are on.
    pub(super) regions: Vec<(String, bool)>,
}

impl Contents {
    /// Returns the configuration for the next tick, if it is still wanted and the remains of the last exchange are freed.
    pub(super) fn take_built(&mut self) -> Option<Box<NextConfiguration>> {
        let fits = |next: &&NextConfiguration| next.number == self.regions.present && next.from == self.number;
        self.built.as_deref().filter(fits)?;
        if self.left_over.is_some() { None } else { self.built.take() }
    }
}

/// The last joint state of a controller.
#[derive(Debug, Clone)]
pub(crate) struct Heard {
    gate: InputGate,
    scratch: JointState,
    pub(crate) state: JointState,
    /// Time of the joint values on their controller's clock; `None` before the first ones.
    pub(crate) stamp: Option<Micros>,
    /// Whether it has arrived since the last tick.
    pub(crate) is_new: bool,
    /// Reason for refusing the last message; `None` if it was accepted, or could not be read.
    pub(crate) refused: Option<Rejected>,
}

impl Heard {
    /// Accepts controllers of this configuration; also controllers that accept any, if the cell has no exchange regions.
    pub(crate) fn new(checksum: u64, cell: &Cell) -> Self {
        let has_exchange = configure::slots(cell).iter().any(Option::is_some);
        Self::through(InputGate::new(checksum).needs_configuration(has_exchange))
    }

    /// Accepts those who measure encoders and objects, of this configuration or of any.
    pub(crate) fn of_source(checksum: u64) -> Self {
        Self::through(InputGate::new(checksum))
    }

    fn through(gate: InputGate) -> Self {
        Self {
            gate,
            scratch: JointState::with_capacity(),
            state: JointState::with_capacity(),
            stamp: None,
            is_new: false,
            refused: None,
        }
    }

    /// Number of refused messages.
    pub(crate) fn rejected(&self) -> u64 {
        self.gate.rejected
    }

    /// Time on the controller's clock when this process's clock shows `local`.
    pub(crate) fn now(&mut self, local: Micros) -> Micros {
        self.gate.now(local)
    }

    /// Reads a message; false if it cannot be read or is refused.
    pub(crate) fn take(&mut self, bytes: &[u8], arrived: Micros) -> bool {
        if self.scratch.decode(bytes).is_err() {
            self.gate.rejected += 1;
            return false;
        }
        let stamp = match self.gate.pass(&self.scratch, arrived) {
            Ok(stamp) => stamp,
            Err(why) => {
                self.refused = Some(why);
                return false;
            }
        };
        self.refused = None;
        std::mem::swap(&mut self.scratch, &mut self.state);
        (self.stamp, self.is_new) = (Some(stamp), true);
        true
    }
}

impl Inbox {
    pub(super) fn new(checksum: u64, followed: Vec<bool>, cell: &Arc<Cell>) -> Self {
        let contents = Contents {
            own: Heard::new(checksum, cell),
            followed: followed.into_iter().map(|is| is.then(|| Heard::new(checksum, cell))).collect(),
            // Not cloned: clones have no memory for messages yet.
            measured: cell.frame_sources.measured.iter().map(|_| Heard::of_source(checksum)).collect(),
            grants: Vec::with_capacity(MAX_BYTES),
            has_grants: false,
            regions: RegionTable::initial(cell),
            regions_heard: None,
            other_cell_heard: None,
            cell: cell.clone(),
            number: configuration_digits(cell),
            wanted: None,
            built: None,
            left_over: None,
            is_closed: false,
        };
        Self { contents: Mutex::new(contents), news: Condvar::new(), work: Condvar::new() }
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Contents> {
        locked(&self.contents)
    }

    /// Reads a joint state of the robot, and wakes the tick.
    pub(super) fn take_joint_state(&self, bytes: &[u8], arrived: Micros) {
        if self.lock().own.take(bytes, arrived) {
            self.news.notify_one();
        }
    }

    /// Stores a message of the arbiter for the next tick, without waking it.
    pub(super) fn take_grants(&self, bytes: &[u8]) {
        let mut contents = self.lock();
        if bytes.len() <= MAX_BYTES {
            contents.grants.clear();
            contents.grants.extend_from_slice(bytes);
            contents.has_grants = true;
        }
    }

    /// Reads a joint state of a robot that a region follows.
    pub(super) fn take_followed(&self, robot: RobotId, bytes: &[u8], arrived: Micros) {
        if let Some(Some(heard)) = self.lock().followed.get_mut(robot.0) {
            heard.take(bytes, arrived);
        }
    }

    /// Reads a message of a measured source, by its index in the cell.
    pub(super) fn take_measured(&self, index: usize, bytes: &[u8], arrived: Micros) {
        if let Some(heard) = self.lock().measured.get_mut(index) {
            heard.take(bytes, arrived);
        }
    }

    /// Reads a table of regions.
    pub(super) fn take_regions(&self, message: &RegionTableMessage, arrived: Micros) {
        let mut contents = self.lock();
        let cell = contents.cell.clone();
        if message.configuration != contents.regions.configuration {
            contents.other_cell_heard = Some(arrived);
            return;
        }
        if !contents.regions.take(message, &cell) {
            return;
        }
        contents.regions_heard = Some(arrived);
        let number = contents.regions.present.clone();
        let is_built = contents.built.as_ref().is_some_and(|b| b.number == number && b.from == contents.number);
        let is_wanted = number != contents.number && !is_built;
        let wanted = || Wanted { number, edits: message.edits.clone(), regions: message.regions.clone() };
        contents.wanted = is_wanted.then(wanted);
        if is_wanted || contents.left_over.is_some() {
            self.work.notify_one();
        }
    }

    /// Waits until there is something to build or to free, at most for this time. False at the end.
    pub(super) fn wait_for_wanted(&self, longest: Duration) -> bool {
        let is_idle = |c: &mut Contents| c.wanted.is_none() && c.left_over.is_none() && !c.is_closed;
        let waited = self.work.wait_timeout_while(self.lock(), longest, is_idle);
        !waited.unwrap_or_else(PoisonError::into_inner).0.is_closed
    }

    /// Takes the regions to be built, and the present cell. Frees the remains of the last exchange.
    pub(super) fn take_wanted(&self) -> (Option<Wanted>, Arc<Cell>) {
        let mut contents = self.lock();
        let left_over = contents.left_over.take();
        let taken = (contents.wanted.take(), contents.cell.clone());
        drop(contents);
        drop(left_over);
        taken
    }

    /// Stores a configuration for the next tick.
    pub(super) fn put_built(&self, next: Box<NextConfiguration>) {
        let mut contents = self.lock();
        let outdated = contents.built.replace(next);
        drop(contents);
        drop(outdated);
    }

    /// Ends the threads that wait.
    pub(super) fn close(&self) {
        self.lock().is_closed = true;
        self.news.notify_all();
        self.work.notify_all();
    }

    /// Waits for a joint state, at most for this time.
    pub(super) fn wait(&self, longest: Duration) -> MutexGuard<'_, Contents> {
        let contents = self.lock();
        let is_idle = |c: &mut Contents| !c.own.is_new && !c.is_closed;
        let waited = self.news.wait_timeout_while(contents, longest, is_idle);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}
