//! A path through the free cells of a robot's joint-space map: `plan --planner grid`.
//!
//! The map knows the objects of the cell. Other robots, the robot itself and regions are tested afterwards, in the exact scene.

use std::time::{Duration, Instant};

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_cspace::{Grid, GridAxis};
use elbowroom_formats::FormatError;
use elbowroom_planner::{
    GridPlanner, GridPlannerError, GridPlannerSettings, Path, PlannedPath, RrtConnect, RrtConnectError, TimedMotion,
};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Selection, SweepOptions};

use super::answer::PathAnswer;
use super::path_query::Query;
use super::request_validation::planner_error;
use crate::map::{MapRequest, axes, blocked_cells, map, select_map};

/// Joints that are not in the map stay within this of the start, rad or m.
const HELD: f64 = 1e-9;

/// The robot of the map, its joints, and the motion that is asked for.
pub(super) struct MapQuery<'q> {
    pub cell: &'q Cell,
    pub id: RobotId,
    pub query: Query<'q>,
}

impl MapQuery<'_> {
    /// The path to the first goal that is reached, or why there is none to the first one.
    ///
    /// # Errors
    /// [`FormatError`] where the map has not three joints, or too many cells, or the request moves other joints; where the start or
    /// all goals are in collision or beyond limits.
    pub fn plan(&self, mut exact: RrtConnect<'_>) -> Result<PathAnswer, FormatError> {
        let robot = &self.cell.robots[self.id.0];
        let (joints, grid) = self.mapped_joints(robot)?;
        let goals = self.free_goals(self.goals(robot, joints)?, &mut exact)?;
        let begin = Instant::now();
        let map = map(self.cell, &MapRequest { robot: Some(robot.name.clone()), ..MapRequest::default() })?;
        let occupancy = blocked_cells::table(grid.axes(), map.obstacles.iter().map(|o| &o.blocks));
        let map_time = begin.elapsed();
        let wrong = |e: GridPlannerError| FormatError::new(&self.cell.file, robot.line, e.to_string());
        let mut planner = GridPlanner::new(&grid, &occupancy).map_err(wrong)?;
        let mut reasons = Vec::new();
        for goal in &goals {
            match self.plan_to(goal, joints, &mut planner, &mut exact)? {
                Ok((path, motion)) => {
                    return Ok(PathAnswer { map_time: Some(map_time), ..PathAnswer::found(robot, path, motion) });
                }
                Err(reason) => reasons.push(reason),
            }
        }
        let reason = reasons.into_iter().next().unwrap_or_default();
        Ok(PathAnswer { map_time: Some(map_time), ..PathAnswer::none(robot, begin.elapsed(), reason) })
    }

    /// The path to one goal with its motion, or why there is none.
    fn plan_to(
        &self,
        goal: &[f64],
        joints: [usize; 3],
        planner: &mut GridPlanner,
        exact: &mut RrtConnect<'_>,
    ) -> Result<Result<(PlannedPath, TimedMotion), String>, FormatError> {
        let robot = &self.cell.robots[self.id.0];
        let Query { state, settings, limits, period_s, .. } = &self.query;
        let refused = |e: RrtConnectError| planner_error(self.cell, robot, &e);
        let of = |q: &[f64]| joints.map(|j| q[j]);
        let searched = Instant::now();
        let found = match planner.plan(of(state.q(self.id)), of(goal), &GridPlannerSettings::default()) {
            Ok(path) => path,
            Err(e) => return Ok(Err(in_words(&e, robot))),
        };
        let path = self.planned(&found, joints, searched.elapsed());
        if let Some(segment) = exact.first_unproven_segment(state, &path.waypoints, settings).map_err(refused)? {
            return Ok(Err(self.unproven(&path, segment)));
        }
        let motion = exact.time_parametrize(state, &path, limits, *period_s, settings).map_err(refused)?;
        Ok(Ok((path, TimedMotion::of(&motion, *period_s).map_err(refused)?)))
    }

    /// The three joints of the robot's map, and its cells.
    fn mapped_joints(&self, robot: &CellRobot) -> Result<([usize; 3], Grid), FormatError> {
        let (_, spec) = select_map(self.cell, Some(&robot.name))?;
        let wrong = |what: String, hint: String| FormatError::new(&self.cell.file, spec.line, what).hint(hint);
        let names = robot.joint_names();
        let joints = <[usize; 3]>::try_from(&spec.joints[..]).map_err(|_| {
            let what = format!(
                "the map of robot \"{}\" has {} joints, and paths on a map need 3",
                robot.name,
                spec.joints.len()
            );
            let three: Vec<String> = names.iter().take(3).map(|name| format!("\"{name}\"")).collect();
            wrong(
                what,
                format!("joints = [{}]   (in [map.{}]), or --planner rrt-connect", three.join(", "), robot.name),
            )
        })?;
        let from = self.query.state.q(self.id);
        let elsewhere = (0..from.len()).find(|j| !joints.contains(j) && (from[*j] - robot.start[*j]).abs() > HELD);
        if let Some(j) = elsewhere.filter(|_| spec.others_at_start) {
            let what = format!(
                "the map of robot \"{}\" holds `{}` at its `start`, and the path begins elsewhere",
                robot.name, names[j]
            );
            let hint = format!("others = \"any\"   (in [map.{}]), or --planner rrt-connect", robot.name);
            return Err(wrong(what, hint));
        }
        // The map itself repeats the warnings.
        let (axes, _) = axes(self.cell, robot, &spec, &mut Vec::new())?;
        let axes =
            <[GridAxis; 3]>::try_from(axes).map_err(|axes| wrong(format!("{} axes", axes.len()), String::new()))?;
        let grid = Grid::new(axes).map_err(|e| wrong(e.to_string(), "step = 2   (larger)".into()))?;
        Ok((joints, grid))
    }

    /// The goals at which the other joints are as at the start.
    fn goals(&self, robot: &CellRobot, joints: [usize; 3]) -> Result<Vec<&Vec<f64>>, FormatError> {
        let from = self.query.state.q(self.id);
        let moved = |goal: &[f64]| (0..goal.len()).find(|j| !joints.contains(j) && (goal[*j] - from[*j]).abs() > HELD);
        let goals: Vec<&Vec<f64>> = self.query.goals.iter().filter(|goal| moved(goal).is_none()).collect();
        let Some(other) = self.query.goals.first().and_then(|goal| moved(goal)).filter(|_| goals.is_empty()) else {
            return Ok(goals);
        };
        let names = robot.joint_names();
        let mapped = joints.map(|j| names[j].as_str()).join(", ");
        let what = format!("the map of robot \"{}\" is of {mapped}, and the goal moves `{}`", robot.name, names[other]);
        let hint = "a goal with the other joints as at the start, or --planner rrt-connect";
        Err(FormatError::new(&self.cell.file, robot.line, what).hint(hint))
    }

    /// Those that are free and within limits, as the start must be: a contact would show as a blocked cell only.
    fn free_goals<'g>(
        &self,
        goals: Vec<&'g Vec<f64>>,
        exact: &mut RrtConnect<'_>,
    ) -> Result<Vec<&'g Vec<f64>>, FormatError> {
        let mut free = Vec::new();
        let mut refused = None;
        for goal in goals {
            // Of one waypoint, only the ends are tested.
            match exact.first_unproven_segment(self.query.state, std::slice::from_ref(goal), self.query.settings) {
                Ok(_) => free.push(goal),
                Err(e) => refused = refused.or(Some(e)),
            }
        }
        match refused.filter(|_| free.is_empty()) {
            Some(e) => Err(planner_error(self.cell, &self.cell.robots[self.id.0], &e)),
            None => Ok(free),
        }
    }

    /// Why a segment of a path through free cells is not proven: what it touches in the scene, else a region.
    fn unproven(&self, path: &PlannedPath, segment: usize) -> String {
        let Query { scene, state, settings, .. } = &self.query;
        let mut checker = Checker::new(scene, CheckerOptions::default());
        let options = SweepOptions { clearance_m: settings.clearance_m, ..SweepOptions::default() };
        let mut pairs = checker.between(Selection::Robot(self.id), Selection::All);
        let hit = pairs.sweep_path(state, self.id, &path.waypoints, &options).ok().flatten();
        let what = match hit {
            Some((_, hit)) => {
                format!("`{}` and `{}` come too near to each other", scene.name(hit.a), scene.name(hit.b))
            }
            None => "it comes too near to a region".to_owned(),
        };
        format!(
            "the path through free cells is not proven free before waypoint {segment}: {what}; a map knows neither the robot \
             itself nor other robots nor regions: --planner rrt-connect goes around"
        )
    }

    fn planned(&self, path: &Path, joints: [usize; 3], planning_time: Duration) -> PlannedPath {
        let whole = |q: &[f64; 3]| {
            let mut all = self.query.state.q(self.id).to_vec();
            joints.iter().zip(q).for_each(|(j, v)| all[*j] = *v);
            all
        };
        let mut waypoints: Vec<Vec<f64>> = path.waypoints.iter().map(whole).collect();
        if let [only] = &waypoints[..] {
            waypoints.push(only.clone());
        }
        PlannedPath {
            waypoints,
            length_rad: path.length_rad,
            raw_length_rad: path.length_rad,
            planning_time,
            simplification_time: Duration::ZERO,
            states_checked: 0,
        }
    }
}

/// Why there is no path through free cells, and what would help.
fn in_words(e: &GridPlannerError, robot: &CellRobot) -> String {
    match e {
        GridPlannerError::Blocked { end, .. } => format!(
            "the {end} is in a blocked cell of the map, because a whole cell counts: a smaller `step` in [map.{}], or \
             --planner rrt-connect",
            robot.name
        ),
        GridPlannerError::NoPath => format!(
            "no path: the free cells of the start and those of the goal are not joined: a smaller `step` in [map.{}], or \
             --planner rrt-connect",
            robot.name
        ),
        other => other.to_string(),
    }
}
