//! Handler of requests: decides about them, makes the changes and logs them.

use std::sync::{Arc, Mutex, MutexGuard};

use elbowroom_cell::access::{AccessToken, Change, ControlEntry, ControlLog, Controlled};
use elbowroom_cell::{Cell, CellRegion, CellRegionId, configure};
use elbowroom_monitor::{AccessClass, Life, RegionKind};
use elbowroom_robot::RobotId;
use serde::Serialize;

use super::clearance::{ClearanceQuery, HeardPlaces, clearances};
use super::joints_heard::JointsHeard;
use super::nodes_heard::NodesHeard;
use super::refusal::Refusal;
use super::requests::{Clear, Switch};
use super::robot_overview::RobotOverview;
use super::taught_regions::TaughtRegions;
use crate::arbiter_service::{ArbiterService, NotCleared};
use crate::cell_versions::CellVersions;
use crate::clock::Clock;
use crate::event_handler::EventHandler;
use crate::locked::locked;
use crate::measured_sources::MeasuredSources;
use crate::region_keeper::RegionKeeper;

/// Longest note, bytes.
const MAX_NOTE: usize = 500;

/// Parts of the service that decide about requests and execute them.
pub(crate) struct ControlParts {
    pub(crate) versions: Arc<CellVersions>,
    pub(crate) keeper: Arc<RegionKeeper>,
    /// `None` for a cell without exchange regions.
    pub(crate) arbiter: Option<Arc<ArbiterService>>,
    pub(crate) joints: JointsHeard,
    pub(crate) measured: MeasuredSources,
    pub(crate) nodes: NodesHeard,
    pub(crate) clock: Clock,
    pub(crate) on_event: Option<EventHandler>,
}

impl ControlParts {
    /// Where everything is.
    pub(super) fn places(&self) -> HeardPlaces {
        HeardPlaces { joints: self.joints.states(), measured: self.measured.fresh_states() }
    }
}

/// Handles one request at a time.
pub(crate) struct RequestHandler {
    pub(super) parts: ControlParts,
    log: Mutex<ControlLog>,
    taught: Mutex<TaughtRegions<ClearanceQuery>>,
}

/// A change that was made.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Done {
    /// The log entry.
    pub(crate) entry: ControlEntry,
    /// The revision that the next request must name.
    pub(crate) revision: String,
    /// Robots of the region whose position is unknown.
    pub(crate) not_heard: Vec<String>,
    /// Robots whose nodes have not confirmed the new regions: they stop, at the latest when their last table is too old, or
    /// nobody guards them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) stopped: Vec<String>,
}

/// The regions and robots of a cell.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Overview {
    pub(crate) cell: String,
    pub(crate) checksum: String,
    /// Units of lengths and angles in the cell file, and in the keys of regions.
    pub(crate) units: UnitNames,
    /// The revision that a request for a change must name.
    pub(crate) revision: String,
    pub(crate) regions: Vec<RegionOverview>,
    pub(crate) robots: Vec<RobotOverview>,
}

/// Units as the cell file names them.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct UnitNames {
    pub(crate) length: &'static str,
    pub(crate) angle: &'static str,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct RegionOverview {
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    pub(crate) life: &'static str,
    pub(crate) active: bool,
    /// Robots that the region guards against.
    pub(crate) robots: Vec<String>,
    /// Holder of an exchange region.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) holder: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) queue: Vec<String>,
}

impl RequestHandler {
    pub(crate) fn new(parts: ControlParts, log: ControlLog) -> Self {
        Self { parts, log: Mutex::new(log), taught: Mutex::default() }
    }

    /// Logs the start of the service, and which temporary regions are on.
    ///
    /// If the disk is full the service starts nevertheless: every change is refused until its entry can be written.
    pub(crate) fn log_start(&self) {
        let (keeper, mut log) = (&self.parts.keeper, self.log());
        let (cell, active) = (keeper.present().cell, keeper.active());
        let temporary = cell.regions.iter().zip(active).filter(|(r, _)| r.region.life == Life::Temporary);
        let change = |(r, active): (&CellRegion, bool)| Change {
            item: format!("region.{}", r.region.name),
            field: "active".into(),
            before: None,
            after: Some(active.to_string()),
        };
        let logged = log.append(Controlled {
            // A start has no requester.
            class: AccessClass::Operator,
            name: "the service",
            action: "start".into(),
            note: Some(keeper.at_start()),
            changes: temporary.map(change).collect(),
            checksums: [&self.parts.versions.base().approval.checksum, &cell.approval.checksum],
        });
        if let Err(e) = logged {
            self.report(&format!("the start is not logged: {e}"));
        }
    }

    pub(super) fn log(&self) -> MutexGuard<'_, ControlLog> {
        locked(&self.log)
    }

    /// The regions that are being taught.
    pub(super) fn taught(&self) -> MutexGuard<'_, TaughtRegions<ClearanceQuery>> {
        locked(&self.taught)
    }

    /// Lists everything that may be changed.
    pub(crate) fn overview(&self) -> Overview {
        let ControlParts { keeper, arbiter, joints, .. } = &self.parts;
        // The log is locked first, so that no request changes the regions in between.
        let log = self.log();
        let cell = keeper.present().cell;
        let (active, slots) = (keeper.active(), arbiter.as_ref().map(|a| a.slots()).unwrap_or_default());
        let region = |(r, active): (&CellRegion, bool)| {
            let slot = slots.iter().find(|slot| slot.regions.contains(&r.region.name));
            RegionOverview {
                name: r.region.name.clone(),
                kind: r.region.kind.name(),
                life: r.region.life.name(),
                active,
                robots: r.robots.iter().map(|id| cell.robots[id.0].name.clone()).collect(),
                holder: slot.and_then(|slot| slot.holder.clone()),
                queue: slot.map(|slot| slot.queue.clone()).unwrap_or_default(),
            }
        };
        let states = joints.states();
        // They tell which tools the attached volumes belong to. Without setups no monitor runs.
        let has_attached = states.iter().flatten().any(|heard| !heard.state.attached.is_empty());
        let setups = if has_attached { configure::setups(&cell).unwrap_or_default() } else { Vec::new() };
        let robots = cell.robots.iter().zip(&states).enumerate();
        let robots = robots
            .map(|(i, (r, state))| RobotOverview::new(r, setups.get(i), state.as_ref().map(|heard| &heard.state)))
            .collect();
        Overview {
            cell: cell.name.clone(),
            checksum: cell.approval.checksum.clone(),
            units: UnitNames { length: cell.units.length.symbol(), angle: cell.units.angle.symbol() },
            revision: revision(&log),
            regions: cell.regions.iter().zip(active).map(region).collect(),
            robots,
        }
    }

    /// Switches a temporary region. A region is not switched on while a robot is inside it or cannot stop outside it.
    pub(crate) fn switch(&self, who: &AccessToken, at: &str, request: &Switch) -> Result<Done, Refusal> {
        let keeper = &self.parts.keeper;
        let mut log = self.log();
        let cell = keeper.present().cell;
        let (id, region) = find(&cell, &request.region)?;
        self.require(who, Life::Temporary.needed_class(), &format!("switch region `{}`", request.region))?;
        if region.region.life == Life::Permanent {
            let error = format!("region `{}` is permanent: it is always on", request.region);
            return Err(
                Refusal::new(409, error).help("life = \"temporary\" in the cell file makes it one that is switched")
            );
        }
        is_present(&log, at)?;
        let before = keeper.active()[id.0];
        let not_heard = if request.active && !before { self.refuse_inside(&cell, region)? } else { Vec::new() };
        let change = Change {
            item: format!("region.{}", request.region),
            field: "active".into(),
            before: Some(before.to_string()),
            after: Some(request.active.to_string()),
        };
        let entry = log.append(Controlled {
            class: who.class,
            name: &who.name,
            action: format!("switch region.{}", request.region),
            note: note(request.note.as_deref())?,
            changes: vec![change],
            checksums: [&cell.approval.checksum, &cell.approval.checksum],
        })?;
        keeper.switch(id, request.active);
        let state = if request.active { "on" } else { "off" };
        self.report(&format!("{}: switched {state} by {} ({})", request.region, who.name, who.class.name()));
        Ok(Done { entry, revision: revision(&log), not_heard, stopped: Vec::new() })
    }

    /// Clears a silent robot.
    pub(crate) fn clear(&self, who: &AccessToken, at: &str, request: &Clear) -> Result<Done, Refusal> {
        let (arbiter, cell) = (&self.parts.arbiter, self.parts.keeper.present().cell);
        self.require(who, AccessClass::Integrator, "clear a robot")?;
        let robot = self.robot_to_clear(request)?;
        let no_arbiter = || Refusal::new(409, "the cell has no exchange regions, so there is nothing to clear");
        let arbiter = arbiter.as_ref().ok_or_else(no_arbiter)?;
        let mut log = self.log();
        is_present(&log, at)?;
        let refused = |why: NotCleared| refused_clear(&request.robot, why);
        arbiter.may_clear(robot).map_err(refused)?;
        let change = |region: &String| Change {
            item: format!("robot.{}", request.robot),
            field: format!("cleared of region.{region}"),
            before: None,
            after: Some("true".into()),
        };
        let controlled = |action: String, changes: Vec<Change>, note| Controlled {
            class: who.class,
            name: &who.name,
            action,
            note,
            changes,
            checksums: [&cell.approval.checksum, &cell.approval.checksum],
        };
        let action = format!("clear robot.{}", request.robot);
        let changes = request.regions.iter().map(change).collect();
        let entry = log.append(controlled(action.clone(), changes, note(request.note.as_deref())?))?;
        if let Err(why) = arbiter.clear(robot) {
            // The robot has sent a message since the question: the logged clearing was not done.
            log.append(controlled(format!("{action}: not done, it has spoken"), Vec::new(), None))?;
            return Err(refused(why));
        }
        self.report(&format!("{}: cleared by {} ({})", request.robot, who.name, who.class.name()));
        Ok(Done { entry, revision: revision(&log), not_heard: Vec::new(), stopped: Vec::new() })
    }

    /// Returns the robot, if the request names it twice and names all its exchange regions.
    fn robot_to_clear(&self, request: &Clear) -> Result<RobotId, Refusal> {
        let cell = self.parts.versions.base();
        let robot = cell.robots.iter().position(|r| r.name == request.robot).map(RobotId).ok_or_else(|| {
            let names: Vec<&str> = cell.robots.iter().map(|r| r.name.as_str()).collect();
            Refusal::new(404, format!("there is no robot `{}`", request.robot))
                .help(format!("one of {}", names.join(", ")))
        })?;
        if request.repeat_robot != request.robot {
            let error = format!("`repeat_robot` is `{}`, and `robot` is `{}`", request.repeat_robot, request.robot);
            return Err(
                Refusal::new(422, error).help("the name of the robot that you have seen at rest outside, twice")
            );
        }
        let is_own =
            |r: &&CellRegion| matches!(r.region.kind, RegionKind::Exchange { .. }) && r.robots.contains(&robot);
        let mut own: Vec<&str> = cell.regions.iter().filter(is_own).map(|r| r.region.name.as_str()).collect();
        let mut named: Vec<&str> = request.regions.iter().map(String::as_str).collect();
        own.sort_unstable();
        named.sort_unstable();
        if own != named {
            let error = format!("`regions` does not name the exchange regions of `{}`, each once", request.robot);
            let all = format!("regions = {own:?}: all that you have seen it outside of");
            return Err(Refusal::new(422, error).help(all));
        }
        Ok(robot)
    }

    /// Checks the class of a token. Refused attempts are reported, as they come from a holder of a token.
    pub(super) fn require(&self, who: &AccessToken, least: AccessClass, what: &str) -> Result<(), Refusal> {
        if who.class >= least {
            return Ok(());
        }
        let error = format!("to {what} takes the {} class, and \"{}\" is {}", least.name(), who.name, who.class.name());
        self.report(&error);
        Err(Refusal::new(403, error).help(format!("a token of the {} class", least.name())))
    }

    /// Checks that no robot is inside a region that would stop it, or unable to stop outside it.
    ///
    /// Returns the robots whose position is unknown.
    pub(super) fn refuse_inside(&self, cell: &Cell, region: &CellRegion) -> Result<Vec<String>, Refusal> {
        if matches!(region.region.kind, RegionKind::Monitored { .. }) {
            return Ok(Vec::new());
        }
        let found = clearances(cell, region, &self.parts.places(), self.parts.clock.seconds())?;
        let name = |robot: RobotId| cell.robots[robot.0].name.clone();
        if let Some((near, distance_m)) =
            found.iter().find_map(|c| Some((c, c.distance_m.filter(|d| *d <= c.stopping_m)?)))
        {
            let (robot, region, distance_mm) = (name(near.robot), &region.region.name, 1000.0 * distance_m);
            let error = if distance_m > 0.0 {
                let stopping_mm = 1000.0 * near.stopping_m;
                format!(
                    "robot `{robot}` is {distance_mm:.0} mm from region `{region}` and may need {stopping_mm:.0} mm to stop"
                )
            } else {
                format!("robot `{robot}` is inside region `{region}`: its distance is 0 mm")
            };
            let refusal = Refusal::new(409, error).help("stop the robot outside of the region before");
            return Err(Refusal { robot: Some(robot), distance_m: Some(distance_m), ..refusal });
        }
        Ok(found.iter().filter(|c| c.distance_m.is_none()).map(|c| name(c.robot)).collect())
    }

    pub(super) fn report(&self, event: &str) {
        if let Some(on_event) = &self.parts.on_event {
            on_event(event);
        }
    }
}

/// Finds the region of this name; returns it with its index.
pub(super) fn find<'c>(cell: &'c Cell, name: &str) -> Result<(CellRegionId, &'c CellRegion), Refusal> {
    let found = cell.regions.iter().enumerate().find(|(_, r)| r.region.name == name);
    let found = found.map(|(index, region)| (CellRegionId(index), region));
    found.ok_or_else(|| {
        let names: Vec<&str> = cell.regions.iter().map(|r| r.region.name.as_str()).collect();
        Refusal::new(404, format!("there is no region `{name}`")).help(format!("one of {}", names.join(", ")))
    })
}

pub(super) fn revision(log: &ControlLog) -> String {
    log.head().chars().take(16).collect()
}

/// Checks that a request names the present revision: a request that was recorded and is sent again is refused, and so
/// is one that came after another change.
pub(super) fn is_present(log: &ControlLog, at: &str) -> Result<(), Refusal> {
    if at == revision(log) {
        return Ok(());
    }
    let error = format!("the cell has changed since `{at}`: the revision is `{}` now", revision(log));
    Err(Refusal::new(412, error)
        .help("read GET /regions, and if the request is right still, send it with the new revision"))
}

pub(super) fn note(note: Option<&str>) -> Result<Option<&str>, Refusal> {
    match note {
        Some(text) if text.len() > MAX_NOTE => {
            Err(Refusal::new(422, format!("`note` is longer than {MAX_NOTE} bytes")).help("a sentence"))
        }
        note => Ok(note),
    }
}

fn refused_clear(robot: &str, why: NotCleared) -> Refusal {
    let refusal = Refusal::new(409, format!("robot `{robot}` is not cleared: {why}"));
    let help = "stop its node if it still runs, see that the robot stands outside, and ask again";
    Refusal { wait_s: Some(why.missing.0 as f64 * 1e-6), ..refusal.help(help) }
}
