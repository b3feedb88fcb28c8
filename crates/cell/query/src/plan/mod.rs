//! Planning of a timed path for one robot of a cell (`elbowroom plan`).
//!
//! Planning uses the scene of [`evaluate`](crate::evaluate()): objects, other robots at their `start`, the robot with tool and
//! load, the allowed collision matrix. Permanent forbidden regions of the robot are path constraints on its guarded
//! volumes.

mod answer;
mod kept_axis;
mod map_planner;
mod on_map;
mod path_goal;
mod path_query;
mod point_path;
pub(crate) mod request_validation;
mod several;
mod tcp_motion;

use std::time::Instant;

use elbowroom_cell::region_constraint::RegionConstraint;
use elbowroom_cell::{Cell, CellRobot, OutOfReachProofs, QueryModel, region_constraint};
use elbowroom_formats::Diagnostic;
use elbowroom_planner::{
    CoverModels, CoverObstacles, GoalLimits, RobotPlanner, RrtConnect, RrtConnectError, RrtConnectSettings,
};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Attachment, Scene, SceneState};
use elbowroom_spatial::Pose;

use crate::cover_cache::CoverCache;
use crate::map::mapped_joints::MappedJoints;
use map_planner::PURPOSE;
use on_map::MapQuery;
use path_goal::goals;
use path_query::Query;

pub use answer::{PathAnswer, write_csv};
pub use elbowroom_cell::{KeptAxis, PathPlanner};
pub use kept_axis::KeptDirection;
pub use map_planner::{MapPlanner, MapPlannerError};
pub use path_goal::PathGoal;
pub use point_path::PointPath;
pub use request_validation::select_robot;
pub use several::{RobotPath, RobotPathRequest, SeveralPathsAnswer, SeveralPathsRequest, plan_several};
pub(crate) use tcp_motion::LINE_TOLERANCE;
pub use tcp_motion::TcpMotion;

/// A request for a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathRequest {
    /// Name of the robot; optional if there is only one.
    pub robot: Option<String>,
    /// Values of all joints in the order of the chain, rad or m; `None`: the robot's `start`.
    pub from: Option<Vec<f64>>,
    /// The goal.
    pub to: PathGoal,
    /// The planner.
    pub planner: PathPlanner,
    /// How the TCP moves.
    pub tcp_motion: TcpMotion,
    /// Fraction of the joints' speeds that the motion uses, above 0 and at most 1.
    pub speed: f64,
    /// Time limit, clearance and seed.
    pub options: RrtConnectSettings,
    /// Period of the samples, s; `None`: the cell's tick.
    pub period_s: Option<f64>,
    /// Whether the search continues until the time limit, with shorter and shorter paths.
    pub optimize: bool,
    /// Objects at other poses than at the start of the cell's programs, with their pose in the world.
    pub placed: Vec<(ObjectId, Pose)>,
    /// Objects that a robot carries.
    pub carried: Vec<(ObjectId, Attachment)>,
}

impl Default for PathRequest {
    fn default() -> Self {
        let options = RrtConnectSettings::default();
        Self {
            robot: None,
            from: None,
            to: PathGoal::default(),
            planner: PathPlanner::default(),
            tcp_motion: TcpMotion::default(),
            speed: 1.0,
            options,
            period_s: None,
            optimize: false,
            placed: Vec::new(),
            carried: Vec::new(),
        }
    }
}

/// Plans a collision-free path and times it.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_query::plan::{PathRequest, plan};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
/// links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// [object.ball]
/// shape = "sphere"
/// at = [600, 0, 0]
/// radius = 100
/// "#)?;
/// let request = PathRequest { from: Some(vec![-1.0, 0.0]), to: vec![1.0, 0.0].into(), ..PathRequest::default() };
/// let answer = plan(&cell, &request)?;
/// let timed = answer.timed.expect("the elbow can bend");
/// assert!(timed.path.waypoints.len() > 2);
/// assert_eq!(timed.trajectory.last(), Some(&[1.0, 0.0][..]));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// An unknown robot; a robot without speed limits; an invalid start or goal: beyond limits, in collision, with a wrong
/// number of values; a goal in a region; a start in a region that no straight path leaves.
///
/// With [`PathPlanner::Grid`] also a map that does not have three joints, and a request that moves other joints. From a
/// start in a region, or nearer to it than the clearance, this planner finds no path.
pub fn plan(cell: &Cell, request: &PathRequest) -> Result<PathAnswer, Diagnostic> {
    let (id, robot) = request_validation::select_robot(cell, request.robot.as_deref())?;
    let limits = request_validation::joint_limits(cell, robot)?.iter().map(|limits| limits.slowed_to(request.speed));
    let limits: Vec<_> = limits.collect();
    let from = request.from.as_ref().unwrap_or(&robot.start);
    request_validation::check_joint_values(cell, robot, "start", from)?;
    let scene = QueryModel::of_cell(cell).scene(OutOfReachProofs::Omit)?;
    let refused = |e: RrtConnectError| request_validation::planner_error(cell, robot, &e);
    let state = start_state(cell, &scene, id, from, request).map_err(|e| refused(e.into()))?;
    let is_searched = request.planner == PathPlanner::Grid || request.optimize;
    let line = tcp_motion::line(cell, robot, request.tcp_motion, &request.to, is_searched)?;
    let is_on_map = request.planner == PathPlanner::Grid;
    let mapped = is_on_map.then(|| MappedJoints::of(cell, robot, PURPOSE, &mut Vec::new())).transpose()?;
    let mut kept = tcp_motion::kept_axis(cell, &scene, (id, from), request.tcp_motion)?;
    let moving = mapped.as_ref().map(|mapped| &mapped.joints[..]);
    let goal_limits = GoalLimits { moving, kept: kept.as_mut() };
    let goals = match line {
        Some(_) => Vec::new(),
        None => goals(cell, &scene, &state, id, &request.to, request.options.seed, goal_limits)?,
    };
    let clearance_m = if request.options.clearance_m.is_finite() { request.options.clearance_m } else { 0.0 };
    let (covers, mut models) = (CoverCache::of_user(), CoverModels::default());
    let model = if is_on_map { None } else { models.serving(&scene, &state, id, clearance_m, &covers) };
    let obstacles = model.map(|model| CoverObstacles::with_covers(model, &scene, &state, clearance_m, &covers));
    let period_s = request.period_s.unwrap_or(cell.timing.tick_s);
    let answer = region_constraint::at_start(cell, id, from, &request.carried, clearance_m, |constraint| {
        let regions = constraint.as_ref().map(RegionConstraint::names).unwrap_or_default();
        let mut exact = RrtConnect::new(&scene, id).map_err(|e| refused(e.into()))?;
        let constraints = tcp_motion::constraints(cell, (id, from), kept, constraint)?;
        if !constraints.is_empty() {
            exact = exact.with_constraint(constraints);
        }
        let (settings, optimize) = (&request.options, request.optimize);
        let query =
            Query { scene: &scene, state: &state, goals: &goals, settings, limits: &limits, period_s, optimize, line };
        if let Some(mapped) = &mapped {
            let answer = MapQuery { cell, id, mapped, query, regions: &regions }.plan(exact)?;
            return Ok(PathAnswer { regions, ..answer });
        }
        let begin = Instant::now();
        let answer = match query.plan(RobotPlanner::new(exact, model.zip(obstacles.as_ref()))) {
            Ok(timed) => PathAnswer::found(robot, timed),
            Err(e) if is_no_path(&e) => {
                PathAnswer::none(robot, begin.elapsed(), of_goals(&request.to, goals.len(), e.to_string()))
            }
            Err(e) => {
                let refused = refused(e);
                let message = of_goals(&request.to, goals.len(), refused.message.clone());
                return Err(Diagnostic { message, ..refused });
            }
        };
        Ok(PathAnswer { regions, ..answer })
    })?;
    let point = match (&request.to, &answer.timed) {
        (PathGoal::Point(point), Some(timed)) => Some(PointPath::of(&scene, (id, robot), point, timed)),
        _ => None,
    };
    Ok(PathAnswer { point, ..answer })
}

/// Why there is no path, said of the goals that were tried: others may have the point at its place too.
fn of_goals(to: &PathGoal, count: usize, why: String) -> String {
    match to {
        PathGoal::Point(_) => format!("{count} configurations with the point at its place were tried: {why}"),
        _ => why,
    }
}

/// Whether the request was right, and a path does not exist or was not found.
fn is_no_path(e: &RrtConnectError) -> bool {
    use RrtConnectError::{Disconnected, LinearMove, LinearMoveWithoutCovers, NotFound};
    matches!(e, NotFound { .. } | Disconnected { .. } | LinearMove { .. } | LinearMoveWithoutCovers)
}

/// The state with all robots at their start, except one.
fn start_state(
    cell: &Cell,
    scene: &Scene,
    robot: RobotId,
    q: &[f64],
    request: &PathRequest,
) -> Result<SceneState, elbowroom_scene::SceneError> {
    let mut state = SceneState::new(scene);
    for (i, r) in cell.robots.iter().enumerate() {
        let r: &CellRobot = r;
        let id = RobotId(i);
        state.set_q(scene, id, if id == robot { q } else { &r.start })?;
    }
    for (object, in_world) in &request.placed {
        state.place(scene, *object, *in_world)?;
    }
    for (object, attachment) in &request.carried {
        state.attach_at(scene, *object, attachment.clone())?;
    }
    Ok(state)
}
