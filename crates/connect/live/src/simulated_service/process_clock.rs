//! Time of a simulation, and the clocks of its processes.

use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::time::Duration;

use elbowroom_interlock::Micros;

/// Index of a start of a process; a restarted process has another one.
pub(crate) type ProcessId = usize;

/// Lets simulated time pass, for a process that waits.
type Sleeper = Rc<dyn Fn(ProcessId, u64)>;

thread_local! {
    /// True time since the start of the simulation of this thread, microseconds.
    static TRUE_US: Cell<u64> = const { Cell::new(0) };
    static SLEEPER: RefCell<Option<Sleeper>> = const { RefCell::new(None) };
}

pub(super) fn true_us() -> u64 {
    TRUE_US.get()
}

pub(super) fn set_true_us(us: u64) {
    TRUE_US.set(us);
}

/// Sets what a waiting process calls; without it a process does not wait.
pub(super) fn set_sleeper(sleeper: Option<Sleeper>) {
    SLEEPER.set(sleeper);
}

/// The clock of a simulated process: it starts anywhere, and is fast or slow.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProcessClock {
    pub(super) process: ProcessId,
    pub(super) offset_us: u64,
    /// Rate, 1 ± 0.5 %.
    pub(super) rate: f64,
}

impl ProcessClock {
    pub(crate) fn micros(self) -> Micros {
        Micros(self.offset_us + (true_us() as f64 * self.rate) as u64)
    }

    /// Lets this time pass for the process.
    pub(crate) fn sleep(self, time: Duration) {
        let sleeper = SLEEPER.with_borrow(Clone::clone);
        if let Some(sleeper) = sleeper {
            sleeper(self.process, time.as_micros() as u64);
        }
    }
}
