//! A path through the free cells of a robot's joint-space map: `plan --planner grid`.
//!
//! The map knows the objects of the cell. Other robots, the robot itself and regions are tested afterwards, in the exact scene.

use std::time::{Duration, Instant};

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_cspace::{Grid, GridAxis};
use elbowroom_formats::FormatError;
use elbowroom_planner::{
    GridPlanner, GridPlannerError, GridPlannerSettings, MappedJoints, Path, PlannedPath, RrtConnect, RrtConnectError,
    TimedMotion,
};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, SweepOptions};

use super::answer::PathAnswer;
use super::path_query::Query;
use super::request_validation::planner_error;
use crate::map::{CellMap, MapRequest, blocked_cells, map, select_map};

/// Joints that are not in the map stay within this of the start, rad or m.
const HELD: f64 = 1e-9;

/// The robot of the map, its joints, and the motion that is asked for.
pub(super) struct MapQuery<'q> {
    pub cell: &'q Cell,
    pub id: RobotId,
    pub query: Query<'q>,
}

impl MapQuery<'_> {
    /// The path, or why there is none.
    ///
    /// # Errors
    /// [`FormatError`] where the map has not three joints, or the request moves others; where start or goal are in collision
    /// or beyond limits.
    pub fn plan(&self, mut exact: RrtConnect<'_>) -> Result<PathAnswer, FormatError> {
        let robot = &self.cell.robots[self.id.0];
        let joints = self.mapped_joints(robot)?;
        let goal = self.goal(robot, joints)?;
        let Query { state, settings, limits, period_s, .. } = &self.query;
        let refused = |e: RrtConnectError| planner_error(self.cell, robot, &e);
        // Of the ends alone: a contact is no matter of the map.
        exact.first_unproven_segment(state, std::slice::from_ref(&goal), settings).map_err(refused)?;
        let begin = Instant::now();
        let map = map(self.cell, &MapRequest { robot: Some(robot.name.clone()), ..MapRequest::default() })?;
        let map_time = begin.elapsed();
        let searched = Instant::now();
        let none = |reason: String| PathAnswer {
            map_time: Some(map_time),
            ..PathAnswer::none(robot, begin.elapsed(), reason)
        };
        let found = match self.search(&map, joints, &goal) {
            Ok(path) => path,
            Err(e) => return Ok(none(in_words(&e, robot))),
        };
        let planning_time = searched.elapsed();
        if let Some(reason) = self.touches(&found, joints) {
            return Ok(none(reason));
        }
        let path = self.planned(&found, joints, planning_time);
        if let Some(segment) = exact.first_unproven_segment(state, &path.waypoints, settings).map_err(refused)? {
            let reason = format!(
                "the path through free cells is not proven clear of regions and other robots before waypoint {segment}: \
                 a map does not know them; --planner rrt-connect goes around"
            );
            return Ok(none(reason));
        }
        let motion = exact.time_parametrize(state, &path, limits, *period_s, settings).map_err(refused)?;
        let motion = TimedMotion::of(&motion, *period_s).map_err(refused)?;
        Ok(PathAnswer { map_time: Some(map_time), ..PathAnswer::found(robot, path, motion) })
    }

    /// The three joints of the robot's map.
    fn mapped_joints(&self, robot: &CellRobot) -> Result<[usize; 3], FormatError> {
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
        Ok(joints)
    }

    /// The first goal at which the other joints are as at the start.
    fn goal(&self, robot: &CellRobot, joints: [usize; 3]) -> Result<Vec<f64>, FormatError> {
        let from = self.query.state.q(self.id);
        let moved = |goal: &[f64]| (0..goal.len()).find(|j| !joints.contains(j) && (goal[*j] - from[*j]).abs() > HELD);
        if let Some(goal) = self.query.goals.iter().find(|goal| moved(goal).is_none()) {
            return Ok(goal.clone());
        }
        let names = robot.joint_names();
        let mapped = joints.map(|j| names[j].as_str()).join(", ");
        let other =
            self.query.goals.first().and_then(|goal| moved(goal)).map_or("another joint", |j| names[j].as_str());
        let what = format!("the map of robot \"{}\" is of {mapped}, and the goal moves `{other}`", robot.name);
        let hint = "a goal with the other joints as at the start, or --planner rrt-connect";
        Err(FormatError::new(&self.cell.file, robot.line, what).hint(hint))
    }

    fn search(&self, map: &CellMap, joints: [usize; 3], goal: &[f64]) -> Result<Path, GridPlannerError> {
        let axes = <[GridAxis; 3]>::try_from(map.axes.clone()).map_err(|_| GridPlannerError::NoPath)?;
        let occupancy = blocked_cells::table(&axes, map.obstacles.iter().map(|o| &o.blocks));
        // A map that was made has no more cells than a grid may have.
        let grid = Grid::new(axes).map_err(|_| GridPlannerError::NoPath)?;
        let of = |q: &[f64]| joints.map(|j| q[j]);
        let mut planner = GridPlanner::new(&grid, &occupancy)?;
        planner.plan(of(self.query.state.q(self.id)), of(goal), &GridPlannerSettings::default())
    }

    /// What the path touches or comes too near to in the exact scene, in words.
    fn touches(&self, path: &Path, joints: [usize; 3]) -> Option<String> {
        let mut checker = Checker::new(self.query.scene, CheckerOptions::default());
        let options = SweepOptions { clearance_m: self.query.settings.clearance_m, ..SweepOptions::default() };
        let arm = MappedJoints { robot: self.id, joints };
        let refused = path.check(&mut checker, self.query.state, arm, &options).err()?;
        Some(format!(
            "{refused} (a map knows neither other robots nor the robot itself); --planner rrt-connect goes around"
        ))
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
