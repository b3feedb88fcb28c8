//! Counter of messages without the cell's key, which are reported from time to time.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use crate::event_handler::EventHandler;
use crate::locked::locked;

/// Shortest time between two reports of refused messages.
const PERIOD: Duration = Duration::from_secs(10);

pub(super) struct Refusals {
    on_event: Option<EventHandler>,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// Refused messages since the last report.
    count: u64,
    reported: Option<Instant>,
}

impl std::fmt::Debug for Refusals {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Refusals")
    }
}

impl Refusals {
    pub(super) fn new(on_event: Option<EventHandler>) -> Self {
        Self { on_event, state: Mutex::default() }
    }

    /// Counts a message under this key.
    pub(super) fn count(&self, key: &str) {
        let count = {
            let mut state = locked(&self.state);
            state.count += 1;
            if state.reported.is_some_and(|at| at.elapsed() < PERIOD) {
                return;
            }
            state.reported = Some(Instant::now());
            std::mem::take(&mut state.count)
        };
        if let Some(on_event) = &self.on_event {
            on_event(&format!(
                "{count} message(s) refused, the last under {key}: not written with this cell's network key\n  help: give \
                 every process of the cell the same --network-key; otherwise a stranger is on its network"
            ));
        }
    }
}
