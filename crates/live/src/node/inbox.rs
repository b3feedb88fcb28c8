//! What has arrived for a node since its last tick.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use elbowroom_interlock::wire::MAX_BYTES;

use super::input_gate::InputGate;
use crate::messages::JointState;
use crate::regions_table::{RegionTable, RegionTableMessage};

/// What has arrived since the last tick. Threads of the network write, the thread of the tick reads; what is written twice is
/// read once, in its newest state.
#[derive(Debug)]
pub(super) struct Inbox {
    contents: Mutex<Contents>,
    news: Condvar,
}

/// What is in the inbox.
#[derive(Debug)]
pub(super) struct Contents {
    /// The robot's own joint state.
    pub(super) own: Heard,
    /// The joint states of the robots that its regions follow, by their index in the cell; `None` for all others.
    pub(super) followed: Vec<Option<Heard>>,
    /// The bytes of the last message of the arbiter, and whether it is new.
    pub(super) grants: Vec<u8>,
    pub(super) has_grants: bool,
    /// Which regions are on, and when that was heard last.
    pub(super) regions: RegionTable,
    pub(super) regions_heard: Option<Micros>,
    pub(super) is_closed: bool,
}

/// The last joint state of a controller.
#[derive(Debug, Clone)]
pub(crate) struct Heard {
    gate: InputGate,
    scratch: JointState,
    pub(crate) state: JointState,
    /// Time of the joint values on their controller's clock; `None` before the first ones.
    pub(crate) stamp: Option<Micros>,
    /// It has arrived since the last tick.
    pub(crate) is_new: bool,
}

impl Heard {
    pub(crate) fn new(checksum: u64) -> Self {
        Self {
            gate: InputGate::new(checksum),
            scratch: JointState::with_capacity(),
            state: JointState::with_capacity(),
            stamp: None,
            is_new: false,
        }
    }

    /// Messages that did not count.
    pub(crate) fn rejected(&self) -> u64 {
        self.gate.rejected
    }

    /// Where the controller's clock stands when this process's clock shows `local`.
    pub(crate) fn now(&mut self, local: Micros) -> Micros {
        self.gate.now(local)
    }

    /// Takes a message; false where it cannot be read or does not count.
    pub(crate) fn take(&mut self, bytes: &[u8], arrived: Micros) -> bool {
        if self.scratch.decode(bytes).is_err() {
            self.gate.rejected += 1;
            return false;
        }
        let Ok(stamp) = self.gate.pass(&self.scratch, arrived) else { return false };
        std::mem::swap(&mut self.scratch, &mut self.state);
        (self.stamp, self.is_new) = (Some(stamp), true);
        true
    }
}

impl Inbox {
    pub(super) fn new(checksum: u64, followed: Vec<bool>, regions: RegionTable) -> Self {
        let contents = Contents {
            own: Heard::new(checksum),
            followed: followed.into_iter().map(|is| is.then(|| Heard::new(checksum))).collect(),
            grants: Vec::with_capacity(MAX_BYTES),
            has_grants: false,
            regions,
            regions_heard: None,
            is_closed: false,
        };
        Self { contents: Mutex::new(contents), news: Condvar::new() }
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Contents> {
        self.contents.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The robot's own joint state; wakes the tick.
    pub(super) fn take_joint_state(&self, bytes: &[u8], arrived: Micros) {
        if self.lock().own.take(bytes, arrived) {
            self.news.notify_one();
        }
    }

    /// A message of the arbiter. It has effect in the next tick, which is soon.
    pub(super) fn take_grants(&self, bytes: &[u8]) {
        let mut contents = self.lock();
        if bytes.len() <= MAX_BYTES {
            contents.grants.clear();
            contents.grants.extend_from_slice(bytes);
            contents.has_grants = true;
        }
    }

    /// The joint state of a robot that a region follows.
    pub(super) fn take_followed(&self, robot: usize, bytes: &[u8], arrived: Micros) {
        if let Some(Some(heard)) = self.lock().followed.get_mut(robot) {
            heard.take(bytes, arrived);
        }
    }

    /// Which regions are switched on.
    pub(super) fn take_regions(&self, message: &RegionTableMessage, cell: &Cell, arrived: Micros) {
        let mut contents = self.lock();
        if contents.regions.take(message, cell) {
            contents.regions_heard = Some(arrived);
        }
    }

    /// Ends the thread of the tick.
    pub(super) fn close(&self) {
        self.lock().is_closed = true;
        self.news.notify_all();
    }

    /// Waits for a joint state, or until the time is over.
    pub(super) fn wait(&self, longest: Duration) -> MutexGuard<'_, Contents> {
        let contents = self.lock();
        let is_idle = |c: &mut Contents| !c.own.is_new && !c.is_closed;
        let waited = self.news.wait_timeout_while(contents, longest, is_idle);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}
