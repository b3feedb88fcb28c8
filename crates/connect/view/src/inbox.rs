//! Input that waits for the engine: the newest status, and the commands of the pages.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use elbowroom_status::CellStatus;

use crate::event_log::EventLog;
use crate::source::Command;

/// Most commands that wait; older ones are dropped.
const MAX_COMMANDS: usize = 64;

/// The newest status and commands. The lock is never held for longer than it takes to move a value.
#[derive(Debug, Default)]
pub(crate) struct Inbox {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Waiting {
    status: Option<CellStatus>,
    events: EventLog,
    commands: VecDeque<Command>,
    stopped: bool,
}

/// Input that the engine takes in one call.
#[derive(Debug, Default)]
pub(crate) struct Taken {
    pub(crate) status: Option<CellStatus>,
    pub(crate) commands: VecDeque<Command>,
    pub(crate) stopped: bool,
}

impl Inbox {
    /// Replaces a status that has not been taken; its events are kept.
    pub(crate) fn publish(&self, mut status: CellStatus) {
        let mut events = std::mem::take(&mut status.events);
        // A service may list an event at the robot, at the cell, or at both.
        for event in status.robots.iter_mut().flat_map(|robot| std::mem::take(&mut robot.service.events)) {
            if !events.contains(&event) {
                events.push(event);
            }
        }
        let replaced = {
            let mut waiting = self.lock();
            waiting.events.extend(events);
            waiting.status.replace(status)
        };
        self.changed.notify_one();
        // Freed after the lock is released.
        drop(replaced);
    }

    /// Adds a command. It replaces a waiting command that moves the same robot in the same way.
    pub(crate) fn command(&self, command: Command) {
        let mut waiting = self.lock();
        waiting.commands.retain(|other| !command.replaces(other));
        if waiting.commands.len() == MAX_COMMANDS {
            waiting.commands.pop_front();
        }
        waiting.commands.push_back(command);
        drop(waiting);
        self.changed.notify_one();
    }

    /// Ends [`Self::take`].
    pub(crate) fn stop(&self) {
        self.lock().stopped = true;
        self.changed.notify_one();
    }

    /// Takes the input since the last call; waits for input if there is none, and returns empty after `at_most`.
    pub(crate) fn take(&self, at_most: Duration) -> Taken {
        let waiting = self.lock();
        let is_empty = |w: &mut Waiting| w.status.is_none() && w.commands.is_empty() && !w.stopped;
        let (mut waiting, _) =
            self.changed.wait_timeout_while(waiting, at_most, is_empty).unwrap_or_else(PoisonError::into_inner);
        Taken {
            status: waiting.status.take(),
            commands: std::mem::take(&mut waiting.commands),
            stopped: waiting.stopped,
        }
    }

    /// Calls a function with the events so far.
    pub(crate) fn with_events<R>(&self, use_them: impl FnOnce(&EventLog) -> R) -> R {
        use_them(&self.lock().events)
    }

    /// Adds events.
    pub(crate) fn add_events(&self, events: Vec<elbowroom_status::EventStatus>) {
        self.lock().events.extend(events);
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        // A panic elsewhere never leaves the values half changed.
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
