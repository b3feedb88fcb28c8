//! Region configurations of the running nodes of a cell, from their statuses.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use serde::Deserialize;

use crate::clock::Clock;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, NetworkError, Subscription};

/// A node without a status for this long is not waited for. It may run all the same, if its messages alone are lost.
const SILENT: Micros = Micros(1_500_000);
/// Longest wait for the nodes: a running node has built the regions by then, or stops when they are due.
const LONGEST: Micros = Micros(4_000_000);
/// Interval between checks.
const POLL: Duration = Duration::from_millis(5);

/// The part of a status that is used here.
#[derive(Deserialize)]
struct Running {
    #[serde(default)]
    configuration: String,
    #[serde(default)]
    table: (u64, u64),
}

#[derive(Debug, Clone, Default)]
struct Heard {
    configuration: String,
    /// The table of regions that the node had.
    table: (u64, u64),
    /// Time of the last status; before the first, the start of this process, as the node may have run before it.
    at: Micros,
}

/// Subscriptions to the statuses of all nodes of a cell.
pub(crate) struct NodesHeard {
    heard: Arc<Mutex<Vec<Heard>>>,
    clock: Clock,
    _subscriptions: Vec<Subscription>,
}

impl NodesHeard {
    pub(crate) fn start(cell: &Cell, network: &Arc<dyn Network>, clock: Clock) -> Result<Self, NetworkError> {
        let now = Heard { at: clock.micros(), ..Heard::default() };
        let heard = Arc::new(Mutex::new(vec![now; cell.robots.len()]));
        let keys = Keys::new(&cell.name);
        let subscribe = |(i, robot): (usize, &elbowroom_cell::CellRobot)| {
            let heard = heard.clone();
            let handler = Box::new(move |bytes: &[u8]| {
                let Ok(Running { configuration, table }) = serde_json::from_slice(bytes) else { return };
                locked(&heard)[i] = Heard { configuration, table, at: clock.micros() };
            });
            network.subscribe(&keys.status(&robot.name), handler)
        };
        let subscriptions = cell.robots.iter().enumerate().map(subscribe).collect::<Result<_, _>>()?;
        Ok(Self { heard, clock, _subscriptions: subscriptions })
    }

    /// Waits until all nodes that are heard have this configuration (the first digits of its checksum, or empty for the
    /// cell file's configuration) and have received this table, or a later one: a status that was sent before may be late,
    /// and of an earlier time with the same regions. Returns the indices of robots whose nodes are not heard with it.
    pub(crate) fn wait_for(&self, configuration: &str, table: (u64, u64)) -> Vec<usize> {
        let since = self.clock.micros();
        loop {
            let now = self.clock.micros();
            let heard = locked(&self.heard).clone();
            let has_it = |h: &Heard| {
                let has_table = h.table.0 == table.0 && h.table.1 >= table.1;
                has_table && h.configuration == configuration
            };
            let may_still_say = |h: &Heard| !has_it(h) && now - h.at <= SILENT;
            if !heard.iter().any(may_still_say) || now - since > LONGEST {
                return (0..heard.len()).filter(|robot| !has_it(&heard[*robot])).collect();
            }
            self.clock.sleep(POLL);
        }
    }
}
