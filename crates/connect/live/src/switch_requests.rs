//! Requests of a simulated program to switch regions, repeated until they are obeyed.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use elbowroom_cell::{Cell, CellRegionId, Program, ProgramBody, StepAction};
use elbowroom_robot::RobotId;

use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, NetworkError, Publisher, Subscription, Urgency};
use crate::region_keeper::SwitchRequest;
use crate::regions_table::RegionTableMessage;

/// Interval at which a request is repeated until the table of regions shows that it was obeyed.
const REPEATED: Duration = Duration::from_millis(250);

/// The requests of one program.
///
/// Each is repeated, as a message may be lost, and the process that keeps the regions may still be starting.
///
/// As in `run`, a program begins with the temporary regions off that it switches; if several programs switch a region, the
/// first one in the cell file requests that.
pub(crate) struct SwitchRequests {
    robot: String,
    cell: Arc<Cell>,
    publisher: Box<dyn Publisher>,
    switches: RegionSwitches,
    wanted: BTreeMap<String, bool>,
    sent: Option<Instant>,
}

/// Which regions are switched on, as heard last.
pub(crate) struct RegionSwitches {
    cell: Arc<Cell>,
    heard: Arc<Mutex<BTreeMap<String, bool>>>,
    _table: Subscription,
}

impl RegionSwitches {
    /// Listens to the table of regions.
    ///
    /// # Errors
    /// [`NetworkError`] if its key cannot be used.
    pub(crate) fn start(cell: &Arc<Cell>, network: &Arc<dyn Network>) -> Result<Self, NetworkError> {
        let heard: Arc<Mutex<BTreeMap<String, bool>>> = Arc::default();
        let handler = {
            let heard = heard.clone();
            Box::new(move |bytes: &[u8]| {
                let Ok(message) = serde_json::from_slice::<RegionTableMessage>(bytes) else { return };
                *locked(&heard) = message.regions.into_iter().collect();
            })
        };
        let table = network.subscribe(&Keys::new(&cell.name).regions(), handler)?;
        Ok(Self { cell: cell.clone(), heard, _table: table })
    }

    /// Whether a region is on; a region that is not heard of is.
    pub(crate) fn is_on(&self, region: CellRegionId) -> bool {
        self.heard(&self.cell.regions[region.0].region.name).unwrap_or(true)
    }

    /// Whether the region of this name is on; `None` if that was not heard.
    fn heard(&self, region: &str) -> Option<bool> {
        locked(&self.heard).get(region).copied()
    }
}

impl SwitchRequests {
    /// The requests of a robot's program, which is about to start.
    ///
    /// # Errors
    /// [`NetworkError`] if the keys cannot be used.
    pub(crate) fn new(cell: &Arc<Cell>, robot: RobotId, network: &Arc<dyn Network>) -> Result<Self, NetworkError> {
        let keys = Keys::new(&cell.name);
        let first =
            |region: CellRegionId| cell.robots.iter().position(|robot| switches(robot.program.as_ref(), region));
        let off = (0..cell.regions.len()).filter(|region| first(CellRegionId(*region)) == Some(robot.0));
        Ok(Self {
            robot: cell.robots[robot.0].name.clone(),
            publisher: network.publisher(&keys.switch(), Urgency::RealTime)?,
            switches: RegionSwitches::start(cell, network)?,
            wanted: off.map(|region| (cell.regions[region].region.name.clone(), false)).collect(),
            sent: None,
            cell: cell.clone(),
        })
    }

    /// Requests that a region is switched on or off.
    pub(crate) fn want(&mut self, region: CellRegionId, active: bool) {
        self.wanted.insert(self.cell.regions[region.0].region.name.clone(), active);
        self.sent = None;
    }

    /// Sends the requests that are not obeyed yet.
    pub(crate) fn send(&mut self) {
        if self.wanted.is_empty() {
            return;
        }
        if self.sent.is_some() {
            let switches = &self.switches;
            self.wanted.retain(|region, active| switches.heard(region) != Some(*active));
        }
        if self.sent.is_some_and(|sent| sent.elapsed() < REPEATED) {
            return;
        }
        self.sent = Some(Instant::now());
        for (region, active) in &self.wanted {
            let request = SwitchRequest { robot: self.robot.clone(), region: region.clone(), active: *active };
            if let Ok(json) = serde_json::to_vec(&request) {
                self.publisher.publish(&json);
            }
        }
    }
}

fn switches(program: Option<&Program>, region: CellRegionId) -> bool {
    let Some(Program { body: ProgramBody::Steps(steps), .. }) = program else { return false };
    steps.iter().any(|step| matches!(step.action, StepAction::Switch { region: switched, .. } if switched == region))
}
