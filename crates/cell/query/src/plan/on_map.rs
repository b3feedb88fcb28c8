//! A path through the free cells of the robot's joint-space map, proven in the exact scene (`elbowroom plan --planner
//! grid`).

use std::time::Instant;

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_formats::Diagnostic;
use elbowroom_planner::{GridPlannerError, RobotPlanner, RrtConnect};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Selection, SweepOptions};

use super::answer::PathAnswer;
use super::map_planner::{MapPlanner, MapPlannerError};
use super::request_validation::planner_error;
use super::search::Search;
use crate::map::mapped_joints::MappedJoints;

/// Most planners that are kept; then the one goes that was not used for the longest time.
const MOST_KEPT: usize = 4;

/// A path for one robot on its map.
pub(super) struct MapSearch<'q> {
    pub cell: &'q Cell,
    pub id: RobotId,
    pub mapped: &'q MappedJoints,
    pub search: Search<'q>,
    /// Names of the regions that the path avoids.
    pub regions: &'q [String],
}

/// Planners on maps that are kept for other requests.
#[derive(Debug, Default)]
pub(super) struct MapPlanners(Vec<MapPlanner>);

impl MapPlanners {
    /// The planner for a robot with these values of the joints that are not in its map.
    fn serving(
        &mut self,
        cell: &Cell,
        id: RobotId,
        q: &[f64],
        clearance_m: f64,
    ) -> Result<&mut MapPlanner, Diagnostic> {
        let known = self.0.iter().position(|planner| planner.is_of(id, q, clearance_m));
        let planner = match known {
            Some(at) => self.0.remove(at),
            None => MapPlanner::new(cell, id, q, clearance_m)?,
        };
        self.0.truncate(MOST_KEPT - 1);
        self.0.insert(0, planner);
        Ok(&mut self.0[0])
    }
}

impl MapSearch<'_> {
    /// Plans a path to the first goal that is reached, or states why the first goal is not reached.
    ///
    /// # Errors
    /// [`Diagnostic`] if the request moves other joints than those of the map, or if the start or all goals are in
    /// collision or beyond limits.
    pub fn plan(&self, mut exact: RrtConnect<'_>, kept: &mut MapPlanners) -> Result<PathAnswer, Diagnostic> {
        let robot = &self.cell.robots[self.id.0];
        let Search { scene, state, settings, limits, period_s, .. } = &self.search;
        let goals = self.goals(robot)?;
        let goals = self.free_goals(goals, &mut exact)?;
        let begin = Instant::now();
        let planner = kept.serving(self.cell, self.id, state.q(self.id), settings.clearance_m)?;
        planner
            .update(scene, state, &[])
            .map_err(|e| Diagnostic::new(&self.cell.file, robot.line, format!("robot \"{}\": {e}", robot.name)))?;
        let map_time = begin.elapsed();
        let mut reasons = Vec::new();
        for goal in &goals {
            match planner.plan(&mut exact, state, goal, settings) {
                Ok(path) => {
                    let timed = RobotPlanner::Exact(exact)
                        .time_parametrize(state, path, limits, *period_s, settings)
                        .map_err(|e| planner_error(self.cell, robot, &e))?;
                    return Ok(PathAnswer { map_time: Some(map_time), ..PathAnswer::found(robot, timed) });
                }
                Err(MapPlannerError::Exact(e)) => return Err(planner_error(self.cell, robot, &e)),
                Err(e) => reasons.push(self.in_words(&e)),
            }
        }
        let reason = reasons.into_iter().next().unwrap_or_default();
        Ok(PathAnswer { map_time: Some(map_time), ..PathAnswer::none(robot, begin.elapsed(), reason) })
    }

    /// The goals at which the other joints have their start values.
    fn goals(&self, robot: &CellRobot) -> Result<Vec<&Vec<f64>>, Diagnostic> {
        let mapped = self.mapped;
        let moved = |goal: &[f64]| mapped.moved_otherwise(self.search.state.q(self.id), goal);
        let goals: Vec<&Vec<f64>> = self.search.goals.iter().filter(|goal| moved(goal).is_none()).collect();
        let Some(other) = self.search.goals.first().and_then(|goal| moved(goal)).filter(|_| goals.is_empty()) else {
            return Ok(goals);
        };
        let names = robot.joint_names();
        let of_map = mapped.joints.map(|j| names[j].as_str()).join(", ");
        let what = format!("the map of robot \"{}\" is of {of_map}, and the goal moves `{}`", robot.name, names[other]);
        let hint = "a goal with the other joints as at the start, or the planner rrt-connect";
        Err(Diagnostic::new(&self.cell.file, robot.line, what).hint(hint))
    }

    /// The goals that are free and within limits, as the start must be: a contact would appear only as a blocked cell.
    fn free_goals<'g>(
        &self,
        goals: Vec<&'g Vec<f64>>,
        exact: &mut RrtConnect<'_>,
    ) -> Result<Vec<&'g Vec<f64>>, Diagnostic> {
        let mut free = Vec::new();
        let mut refused = None;
        for goal in goals {
            // With a single waypoint, only the ends are tested.
            match exact.first_unproven_segment(self.search.state, std::slice::from_ref(goal), self.search.settings) {
                Ok(_) => free.push(goal),
                Err(e) => refused = refused.or(Some(e)),
            }
        }
        match refused.filter(|_| free.is_empty()) {
            Some(e) => Err(planner_error(self.cell, &self.cell.robots[self.id.0], &e)),
            None => Ok(free),
        }
    }

    /// Reason why no path leads through free cells, with a remedy.
    fn in_words(&self, e: &MapPlannerError) -> String {
        let finer =
            format!("a smaller `step` in [map.{}], or the planner rrt-connect", self.cell.robots[self.id.0].name);
        match e {
            MapPlannerError::Grid(GridPlannerError::Blocked { end, .. }) => {
                format!("the {end} is in a blocked cell of the map, because a whole cell counts: {finer}")
            }
            MapPlannerError::Grid(GridPlannerError::NoPath) => {
                format!("no path: the free cells of the start do not connect to the free cells of the goal: {finer}")
            }
            MapPlannerError::Unproven { waypoints, .. } => format!(
                "{e}: {}; a map knows neither the robot itself nor other robots nor regions, and on solids no clearance: the planner \
                 rrt-connect goes around",
                self.what_is_near(waypoints)
            ),
            other => other.to_string(),
        }
    }

    /// The obstacle that a path comes too near to: something in the scene, otherwise perhaps a region.
    fn what_is_near(&self, waypoints: &[Vec<f64>]) -> String {
        let Search { scene, state, settings, .. } = &self.search;
        let mut checker = Checker::new(scene, CheckerOptions::default());
        let options = SweepOptions { clearance_m: settings.clearance_m, ..SweepOptions::default() };
        let mut pairs = checker.between(Selection::Robot(self.id), Selection::All);
        match pairs.sweep_path(state, self.id, waypoints, &options).ok().flatten() {
            Some((_, hit)) => {
                format!("`{}` and `{}` come too near to each other", scene.name(hit.a), scene.name(hit.b))
            }
            None if self.regions.is_empty() => "a sweep could not prove it".to_owned(),
            None => format!("it comes too near to one of the regions {}", self.regions.join(", ")),
        }
    }
}
