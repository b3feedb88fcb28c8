//! When a search ends: at a time, or when another thread interrupts it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Ends searches from another thread. Clones end the same searches.
///
/// A search that is interrupted ends soon, with the path that it has by then.
///
/// ```
/// use elbowroom_planner::{Interrupt, RrtConnect, RrtConnectError, RrtConnectSettings};
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{SceneState, example};
/// let scene = example::two_arms();
/// let mut state = SceneState::new(&scene);
/// state.set_q(&scene, RobotId(0), &[-0.9, 1.3, 0.6])?;
/// let interrupt = Interrupt::default();
/// interrupt.set(); // any thread, at any time
/// let mut planner = RrtConnect::new(&scene, RobotId(0))?.with_interrupt(interrupt);
/// let error = planner.plan(&state, &[0.9, 1.3, 0.6], &RrtConnectSettings::default()).unwrap_err();
/// assert!(matches!(error, RrtConnectError::NotFound { .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Ends the searches, now and from now on.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the searches must end.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// When a search ends.
#[derive(Debug, Clone)]
pub(crate) struct Deadline {
    at: Instant,
    interrupt: Interrupt,
}

impl Deadline {
    pub fn new(at: Instant, interrupt: Interrupt) -> Self {
        Self { at, interrupt }
    }

    /// Whether the search must end.
    pub fn is_over(&self) -> bool {
        self.interrupt.is_set() || Instant::now() >= self.at
    }

    /// Whether another thread has ended the search.
    pub fn is_interrupted(&self) -> bool {
        self.interrupt.is_set()
    }

    /// The time that is left.
    pub fn left(&self) -> Duration {
        self.at.saturating_duration_since(Instant::now())
    }

    /// Another time, with the same interrupt.
    #[must_use]
    pub fn until(&self, at: Instant) -> Self {
        Self { at, interrupt: self.interrupt.clone() }
    }

    /// The same, or an earlier time.
    #[must_use]
    pub fn no_later_than(&self, at: Instant) -> Self {
        self.until(self.at.min(at))
    }
}
