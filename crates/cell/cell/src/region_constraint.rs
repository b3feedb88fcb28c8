//! Interference regions as constraints of path planning.

use elbowroom_avoidance::{PathConstraint, PathConstraintSource};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Monitor, RegionDistanceQuery, SourceState};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Attachment;

use crate::Cell;
use crate::configure::{self, MonitorSetup};
use crate::frames::Frames;

/// Smallest distance (m) of paths from the border of a region: at the border the override is 0 and the robot would
/// stop.
///
/// At 5 mm the override is 5 % if the warning zone is 100 mm thick.
const BORDER_M: f64 = 0.005;

/// A region, and the distance that paths keep from it.
#[derive(Debug)]
struct ClosedRegion<'m> {
    name: &'m str,
    clearance_m: f64,
}

/// The regions closed to one robot, at their poses at one instant.
#[derive(Debug)]
pub struct RegionConstraint<'m> {
    region_distance: RegionDistanceQuery<'m>,
    /// Per region of the configuration.
    regions: Vec<ClosedRegion<'m>>,
    /// Largest clearance, m.
    max_clearance_m: f64,
}

impl<'m> RegionConstraint<'m> {
    /// The regions that the monitor closes to its robot; `None` if it closes no region.
    ///
    /// Paths keep the fraction `share` of each warning zone, which bounds the override from below, at least `least_m`
    /// (m), and never less than 5 mm.
    pub fn new(monitor: &'m Monitor, sources: &[SourceState], share: f64, least_m: f64) -> Option<Self> {
        let region_distance = monitor.region_distance(sources);
        let closed = |r: &'m elbowroom_monitor::Region| ClosedRegion {
            name: &r.name,
            clearance_m: (share * r.warning_m).max(least_m).max(BORDER_M),
        };
        let regions: Vec<_> = monitor.configuration().regions().iter().map(closed).collect();
        let clearances = region_distance.regions().iter().map(|r| regions[r.0].clearance_m);
        let max_clearance_m = clearances.fold(0.0, f64::max);
        (!region_distance.regions().is_empty()).then_some(Self { region_distance, regions, max_clearance_m })
    }

    /// Names of the regions.
    pub fn names(&self) -> Vec<String> {
        self.region_distance.regions().iter().map(|r| self.regions[r.0].name.to_owned()).collect()
    }
}

impl PathConstraint for RegionConstraint<'_> {
    fn distance_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        self.region_distance.set_q(q);
        self.region_distance.distances(limit_m).map(|(_, metres)| metres).fold(f64::INFINITY, least)
    }

    fn margin_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        self.region_distance.set_q(q);
        let near = self.region_distance.distances(limit_m + self.max_clearance_m);
        near.map(|(region, metres)| metres - self.regions[region.0].clearance_m).fold(f64::INFINITY, least)
    }

    fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        self.region_distance.motion_bound(from, to)
    }

    fn describe_nearest(&mut self, q: &[f64]) -> String {
        self.region_distance.set_q(q);
        let nearest = self.region_distance.distances(f64::INFINITY).min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or_else(String::new, |(region, _)| format!("region `{}`", self.regions[region.0].name))
    }
}

/// The regions closed to each robot before a run: permanent forbidden regions, with all robots at given joint values.
#[derive(Debug)]
pub struct RegionConstraints<'c> {
    cell: &'c Cell,
    setups: Vec<MonitorSetup>,
    monitors: Vec<Monitor>,
    states: Vec<ChainState>,
    least_m: f64,
}

impl<'c> RegionConstraints<'c> {
    /// Computes the closed regions with the robots at these joint values (rad or m), in the order of the cell.
    ///
    /// Paths keep `least_m` (m) from regions, and never less than 5 mm.
    ///
    /// # Errors
    /// Errors of the monitors' configurations.
    pub fn new<'q>(cell: &'c Cell, q: impl IntoIterator<Item = &'q [f64]>, least_m: f64) -> Result<Self, Diagnostic> {
        Self::of_setups(cell, configure::setups(cell)?, q, least_m)
    }

    fn of_setups<'q>(
        cell: &'c Cell,
        setups: Vec<MonitorSetup>,
        q: impl IntoIterator<Item = &'q [f64]>,
        least_m: f64,
    ) -> Result<Self, Diagnostic> {
        let monitors = configure::monitors(cell, &setups)?;
        let state = |(r, q): (&crate::CellRobot, &[f64])| {
            let mut state = ChainState::new(&r.robot.chain);
            state.q.copy_from_slice(q);
            r.robot.chain.forward_motion(&mut state);
            state
        };
        let states = cell.robots.iter().zip(q).map(state).collect();
        Ok(Self { cell, setups, monitors, states, least_m })
    }

    /// The regions closed to a robot; `None` if no region is closed.
    pub fn of_robot(&self, robot: RobotId) -> Option<RegionConstraint<'_>> {
        let sources = Frames::new(self.cell).sources(&self.setups[robot.0].sources, &self.states, 0.0);
        RegionConstraint::new(&self.monitors[robot.0], &sources, 0.0, self.least_m)
    }
}

impl PathConstraintSource for RegionConstraints<'_> {
    fn constraint_of(&self, robot: RobotId) -> Option<Box<dyn PathConstraint + '_>> {
        Some(Box::new(self.of_robot(robot)?))
    }
}

/// Calls `plan` with the regions closed to a robot before a run: permanent forbidden regions.
///
/// All other robots are at their start, this robot is at `q` (rad or m). The objects that it holds count as its tool.
///
/// # Errors
/// Errors of the monitors' configurations and of `plan`.
pub fn at_start<T>(
    cell: &Cell,
    robot: RobotId,
    q: &[f64],
    held: &[(ObjectId, Attachment)],
    least_m: f64,
    plan: impl FnOnce(Option<RegionConstraint<'_>>) -> Result<T, Diagnostic>,
) -> Result<T, Diagnostic> {
    let at = |(i, r): (usize, &'_ crate::CellRobot)| if RobotId(i) == robot { q.to_vec() } else { r.start.clone() };
    let all: Vec<Vec<f64>> = cell.robots.iter().enumerate().map(at).collect();
    let setups = configure::setups_holding(cell, held)?;
    let constraints = RegionConstraints::of_setups(cell, setups, all.iter().map(Vec::as_slice), least_m)?;
    plan(constraints.of_robot(robot))
}

/// The smaller value; NaN counts as smaller than any number.
fn least(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}
