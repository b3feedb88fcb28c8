//! Planning of timed paths for several robots of a cell that move at the same time (`elbowroom plan --robot a … --robot b …`).

use std::io::{self, Write};
use std::time::Instant;

use elbowroom_cell::region_constraint::RegionConstraints;
use elbowroom_cell::{Cell, Follow, OutOfReachProofs, QueryModel};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::{JointTrajectory, TrajectoryRow};
use elbowroom_planner::{
    PrioritizedMotion, PrioritizedPlanner, PrioritizedPlannerError, RobotGoal, RrtConnectError, RrtConnectSettings,
};
use elbowroom_robot::RobotId;
use elbowroom_scene::SceneState;
use serde::Serialize;

use super::answer::write_csv;
use super::request_validation::{check_joint_values, joint_limits, planner_error, select_robot};
use crate::cover_cache::CoverCache;

/// Request for the path of one of the robots.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotPathRequest {
    /// Name of the robot.
    pub robot: String,
    /// Values of all joints in the order of the chain, rad or m; `None`: the robot's `start`.
    pub from: Option<Vec<f64>>,
    /// Goal: values of all joints in the order of the chain, rad or m.
    pub to: Vec<f64>,
}

/// A request for paths of several robots.
#[derive(Debug, Clone, PartialEq)]
pub struct SeveralPathsRequest {
    /// The robots, each once. Earlier ones have priority, if that leaves a path for all.
    pub robots: Vec<RobotPathRequest>,
    /// Time limit for all robots together, clearance and seed.
    pub options: RrtConnectSettings,
    /// Period of the samples, s; `None`: the cell's tick.
    pub period_s: Option<f64>,
}

/// Result of planning for several robots. Serialized in SI units, without the rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeveralPathsAnswer {
    /// True if all robots have a path.
    pub found: bool,
    /// Reason if no paths were found.
    pub reason: Option<String>,
    /// Paths in the order of the request; empty if none were found.
    pub robots: Vec<RobotPath>,
    /// End of the last motion, s.
    pub duration_s: Option<f64>,
    /// Time of the search, of shortcutting, and of the proof that the motions are free together, µs.
    pub planning_us: u64,
    /// The motion of all joints of these robots on a common time.
    #[serde(skip)]
    pub trajectory: JointTrajectory,
}

/// The path of one of several robots.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotPath {
    /// Name of the robot.
    pub robot: String,
    /// Names of its joints, in the order of the values.
    pub joints: Vec<String>,
    /// Names of the regions that the path avoids.
    pub regions: Vec<String>,
    /// Waypoints, straight in joint space in between, rad or m.
    pub waypoints: Vec<Vec<f64>>,
    /// Euclidean length in joint space, rad (and m).
    pub cost_rad: f64,
    /// Start of its motion, s.
    pub start_s: f64,
    /// End of its motion, s.
    pub end_s: f64,
    /// Number of corners with a stop.
    pub stops: usize,
}

/// Plans collision-free motions of several robots at the same time: [`PrioritizedPlanner`] with the regions of each robot.
/// All other robots stay at their start.
///
/// # Errors
/// As for [`plan`](super::plan), for each robot; also a robot that is named twice, and a region that one of the robots
/// must avoid and another one carries.
pub fn plan_several(cell: &Cell, request: &SeveralPathsRequest) -> Result<SeveralPathsAnswer, Diagnostic> {
    let scene = QueryModel::of_cell(cell).scene(OutOfReachProofs::Omit)?;
    let (mut goals, mut starts) = (Vec::new(), cell.robots.iter().map(|r| r.start.clone()).collect::<Vec<_>>());
    for one in &request.robots {
        let (id, robot) = select_robot(cell, Some(&one.robot))?;
        if goals.iter().any(|goal: &RobotGoal| goal.robot == id) {
            let what = format!("robot \"{}\" has two goals", robot.name);
            return Err(Diagnostic::new(&cell.file, robot.line, what).hint("each robot once"));
        }
        let from = one.from.as_ref().unwrap_or(&robot.start);
        check_joint_values(cell, robot, "start", from)?;
        check_joint_values(cell, robot, "goal", &one.to)?;
        starts[id.0].clone_from(from);
        goals.push(RobotGoal { robot: id, q: one.to.clone(), limits: joint_limits(cell, robot)?.to_vec() });
    }
    let mut state = SceneState::new(&scene);
    for (i, q) in starts.iter().enumerate() {
        let refused = |e: elbowroom_scene::SceneError| planner_error(cell, &cell.robots[i], &e.into());
        state.set_q(&scene, RobotId(i), q).map_err(refused)?;
    }
    let clearance_m = if request.options.clearance_m.is_finite() { request.options.clearance_m } else { 0.0 };
    let constraints = RegionConstraints::new(cell, starts.iter().map(Vec::as_slice), clearance_m)?;
    let regions: Vec<Vec<String>> = goals
        .iter()
        .map(|goal| constraints.of_robot(goal.robot).map(|constraint| constraint.names()).unwrap_or_default())
        .collect();
    refuse_carried_regions(cell, &goals, &regions)?;
    let period_s = request.period_s.unwrap_or(cell.timing.tick_s);
    let begin = Instant::now();
    let covers = CoverCache::of_user();
    let planner = PrioritizedPlanner::new(&scene).with_covers(&covers).with_constraints(&constraints);
    let planned = planner.plan(&state, &goals, period_s, &request.options);
    let planning_us = u64::try_from(begin.elapsed().as_micros()).unwrap_or(u64::MAX);
    match planned {
        Ok(motions) => Ok(found(cell, &motions, regions, period_s, planning_us)),
        Err(error) => {
            let reason = not_found(cell, &goals, &error)?;
            let (robots, trajectory) = (Vec::new(), JointTrajectory::default());
            Ok(SeveralPathsAnswer {
                found: false,
                reason: Some(reason),
                robots,
                duration_s: None,
                planning_us,
                trajectory,
            })
        }
    }
}

/// Refuses a region that moves with a robot: while that robot moves, the region is not where it was at the start.
fn refuse_carried_regions(cell: &Cell, goals: &[RobotGoal], regions: &[Vec<String>]) -> Result<(), Diagnostic> {
    for (goal, names) in goals.iter().zip(regions) {
        for region in cell.regions.iter().filter(|r| names.contains(&r.region.name)) {
            if let Some(Follow::Robot { robot, .. }) = region.follow
                && robot != goal.robot
                && goals.iter().any(|other| other.robot == robot)
            {
                let (name, carrier) = (&region.region.name, &cell.robots[robot.0].name);
                let moved = &cell.robots[goal.robot.0].name;
                let what = format!(
                    "region \"{name}\" moves with robot \"{carrier}\": no path of robot \"{moved}\" at the same time stays out of it for certain"
                );
                let hint = format!("a plan for \"{carrier}\", then one for \"{moved}\" from there");
                return Err(Diagnostic::new(&cell.file, region.line, what).hint(&hint));
            }
        }
    }
    Ok(())
}

fn found(
    cell: &Cell,
    motions: &[PrioritizedMotion],
    regions: Vec<Vec<String>>,
    period_s: f64,
    planning_us: u64,
) -> SeveralPathsAnswer {
    let duration_s = motions.iter().map(PrioritizedMotion::end_s).fold(0.0, f64::max);
    let last = (duration_s / period_s).round() as usize;
    let row = |tick: usize| {
        let q = motions.iter().flat_map(|motion| motion.at_tick(tick).iter().copied()).collect();
        TrajectoryRow { t_s: tick as f64 * period_s, q }
    };
    let path = |(motion, regions): (&PrioritizedMotion, Vec<String>)| {
        let robot = &cell.robots[motion.robot.0];
        RobotPath {
            robot: robot.name.clone(),
            joints: robot.joint_names(),
            regions,
            waypoints: motion.timed.path.waypoints.clone(),
            cost_rad: motion.timed.path.length_rad,
            start_s: motion.start_s,
            end_s: motion.end_s(),
            stops: motion.timed.stops,
        }
    };
    SeveralPathsAnswer {
        found: true,
        reason: None,
        robots: motions.iter().zip(regions).map(path).collect(),
        duration_s: Some(duration_s),
        planning_us,
        trajectory: JointTrajectory::new((0..=last).map(row).collect()),
    }
}

/// Reason why no paths were found; an error if the request is wrong.
fn not_found(cell: &Cell, goals: &[RobotGoal], error: &PrioritizedPlannerError) -> Result<String, Diagnostic> {
    let (robot, error) = match error {
        PrioritizedPlannerError::Robot { robot, error } => (robot, error),
        PrioritizedPlannerError::NoPriority { robot, .. } => {
            return Ok(format!("robot \"{}\": {error}", cell.robots[robot.0].name));
        }
        PrioritizedPlannerError::NoGoal => {
            return Err(Diagnostic::new(&cell.file, None, error).hint("--robot NAME --to q,…"));
        }
    };
    let of_robot = &cell.robots[robot.0];
    let others = || goals.iter().filter(|goal| goal.robot != *robot).map(|goal| &cell.robots[goal.robot.0].name);
    let is_other =
        |link: &str| others().any(|name| link.strip_prefix(name.as_str()).is_some_and(|l| l.starts_with('/')));
    match error {
        RrtConnectError::NotFound { .. } | RrtConnectError::Disconnected { .. } => {
            Ok(format!("robot \"{}\": {error}", of_robot.name))
        }
        // In every order, the goal is where another robot is at its start or at its goal.
        RrtConnectError::InCollision { end: elbowroom_planner::PathEnd::Goal, a, b, .. }
            if is_other(a) || is_other(b) =>
        {
            Ok(format!(
                "robot \"{}\": at its goal `{a}` and `{b}` are in collision, whichever robot moves first",
                of_robot.name
            ))
        }
        other => Err(planner_error(cell, of_robot, other)),
    }
}

impl SeveralPathsAnswer {
    /// Writes `t_s` and a column `robot.joint` per joint. The numbers read back to the same bits.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        let names = self.robots.iter().flat_map(|r| r.joints.iter().map(move |joint| format!("{}.{joint}", r.robot)));
        write_csv(&names.collect::<Vec<_>>(), &self.trajectory, out)
    }
}
