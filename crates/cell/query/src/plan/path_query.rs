//! A cell that is prepared for the search of paths.

use std::borrow::{Borrow, Cow};
use std::time::Instant;

use elbowroom_cell::region_constraint::RegionConstraint;
use elbowroom_cell::{Cell, CellRobot, Follow, OutOfReachProofs, PathPlanner, QueryModel, region_constraint};
use elbowroom_formats::Diagnostic;
use elbowroom_planner::{
    CoverModels, CoverObstacles, GoalLimits, Interrupt, RobotPlanner, RrtConnect, RrtConnectError,
};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Scene, SceneError, SceneState};
use elbowroom_spatial::Pose;

use super::answer::PathAnswer;
use super::map_planner::PURPOSE;
use super::on_map::{MapPlanners, MapSearch};
use super::path_goal::{PathGoal, goals};
use super::path_request::PathRequest;
use super::point_path::PointPath;
use super::search::Search;
use super::{request_validation, tcp_motion};
use crate::cover_cache::CoverCache;
use crate::map::mapped_joints::MappedJoints;

/// Searches paths in a cell, with one scene, and the sphere covers and the maps of its robots, for all of them.
///
/// They are built when they are first needed, which takes longer than most searches. An answer is the same whatever was asked
/// before.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_query::plan::{PathQuery, PathRequest};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }]
/// links = [{ capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// "#)?;
/// let mut query = PathQuery::new(&cell)?;
/// for q in [-1.0, 0.5, 1.0] {
///     let request = PathRequest { to: vec![q].into(), ..PathRequest::default() };
///     assert!(query.plan(&request)?.found);
/// }
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
#[derive(Debug)]
pub struct PathQuery<C> {
    cell: C,
    scene: Scene,
    models: CoverModels,
    maps: MapPlanners,
    covers: CoverCache,
}

impl<C: Borrow<Cell>> PathQuery<C> {
    /// Builds the scene of a cell.
    ///
    /// # Errors
    /// A cell without a scene, such as one with a solid that is not finite.
    pub fn new(cell: C) -> Result<Self, Diagnostic> {
        let scene = QueryModel::of_cell(cell.borrow()).scene(OutOfReachProofs::Omit)?;
        let (models, maps) = (CoverModels::default(), MapPlanners::default());
        Ok(Self { cell, scene, models, maps, covers: CoverCache::of_user() })
    }

    /// The cell.
    pub fn cell(&self) -> &Cell {
        self.cell.borrow()
    }

    /// Plans a path and times it.
    ///
    /// # Errors
    /// As for [`plan`](super::plan()).
    pub fn plan(&mut self, request: &PathRequest) -> Result<PathAnswer, Diagnostic> {
        self.plan_with(request, &Interrupt::default())
    }

    /// Like [`plan`](Self::plan); another thread may interrupt the search, which then ends soon: with the path that it has by
    /// then, or with the answer that it was interrupted. What is built first is built to its end: covers, and maps.
    ///
    /// # Errors
    /// As for [`plan`](super::plan()).
    pub fn plan_with(&mut self, request: &PathRequest, interrupt: &Interrupt) -> Result<PathAnswer, Diagnostic> {
        let (cell, scene) = (self.cell.borrow(), &self.scene);
        let (id, robot) = request_validation::select_robot(cell, request.robot.as_deref())?;
        let limits = request_validation::joint_limits(cell, robot)?.iter().map(|l| l.slowed_to(request.speed));
        let limits: Vec<_> = limits.collect();
        let from = request.from.as_ref().unwrap_or(&robot.start);
        request_validation::check_joint_values(cell, robot, "start", from)?;
        let refused = |e: RrtConnectError| request_validation::planner_error(cell, robot, &e);
        let state = start_state(cell, scene, id, from, request).map_err(|e| refused(e.into()))?;
        let is_on_map = request.planner == PathPlanner::Grid;
        let line = tcp_motion::line(cell, robot, request.tcp_motion, &request.to, is_on_map || request.optimize)?;
        let mapped = is_on_map.then(|| MappedJoints::of(cell, robot, PURPOSE, &mut Vec::new())).transpose()?;
        let mut kept = tcp_motion::kept_axis(cell, scene, (id, from), request.tcp_motion)?;
        let moving = mapped.as_ref().map(|mapped| &mapped.joints[..]);
        let goal_limits = GoalLimits { moving, kept: kept.as_mut() };
        let goals = match line {
            Some(_) => Vec::new(),
            None => goals(cell, scene, &state, id, &request.to, request.options.seed, goal_limits)?,
        };
        let clearance_m = if request.options.clearance_m.is_finite() { request.options.clearance_m } else { 0.0 };
        let model = if is_on_map { None } else { self.models.serving(scene, &state, id, clearance_m, &self.covers) };
        let of_model = |model| CoverObstacles::with_covers(model, scene, &state, clearance_m, &self.covers);
        let obstacles = model.map(of_model);
        let period_s = request.period_s.unwrap_or(cell.timing.tick_s);
        let followed = followed(cell, &request.placed);
        let answer = region_constraint::at_start(&followed, id, from, &request.carried, clearance_m, |constraint| {
            let regions = constraint.as_ref().map(RegionConstraint::names).unwrap_or_default();
            let mut exact =
                RrtConnect::new(scene, id).map_err(|e| refused(e.into()))?.with_interrupt(interrupt.clone());
            let constraints = tcp_motion::constraints(cell, (id, from), kept, constraint)?;
            if !constraints.is_empty() {
                exact = exact.with_constraint(constraints);
            }
            let (settings, optimize) = (&request.options, request.optimize);
            let search =
                Search { scene, state: &state, goals: &goals, settings, limits: &limits, period_s, optimize, line };
            let answer = match &mapped {
                Some(mapped) => {
                    MapSearch { cell, id, mapped, search, regions: &regions }.plan(exact, &mut self.maps)?
                }
                None => searched(
                    cell,
                    robot,
                    &request.to,
                    &search,
                    RobotPlanner::new(exact, model.zip(obstacles.as_ref())),
                )?,
            };
            Ok(PathAnswer { regions, ..answer })
        })?;
        let point = match (&request.to, &answer.timed) {
            (PathGoal::Point(point), Some(timed)) => Some(PointPath::of(scene, (id, robot), point, timed)),
            _ => None,
        };
        let interrupted = || "the search was interrupted".to_owned();
        let reason = answer.reason.map(|reason| if interrupt.is_set() { interrupted() } else { reason });
        Ok(PathAnswer { reason, point, ..answer })
    }
}

/// The cell in which regions that follow a placed object are where it is.
fn followed<'c>(cell: &'c Cell, placed: &[(ObjectId, Pose)]) -> Cow<'c, Cell> {
    let is_followed = |object| cell.regions.iter().any(|region| region.follow == Some(Follow::Object(object)));
    let placed: Vec<_> = placed.iter().copied().filter(|(object, _)| is_followed(*object)).collect();
    cell.with_objects_at(&placed)
}

/// Searches with random samples.
fn searched(
    cell: &Cell,
    robot: &CellRobot,
    to: &PathGoal,
    search: &Search<'_>,
    planner: RobotPlanner<'_>,
) -> Result<PathAnswer, Diagnostic> {
    let (begin, count) = (Instant::now(), search.goals.len());
    match search.plan(planner) {
        Ok(timed) => Ok(PathAnswer::found(robot, timed)),
        Err(e) if is_no_path(&e) => Ok(PathAnswer::none(robot, begin.elapsed(), of_goals(to, count, e.to_string()))),
        Err(e) => {
            let refused = request_validation::planner_error(cell, robot, &e);
            let message = of_goals(to, count, refused.message.clone());
            Err(Diagnostic { message, ..refused })
        }
    }
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
) -> Result<SceneState, SceneError> {
    let mut state = SceneState::new(scene);
    for (i, r) in cell.robots.iter().enumerate() {
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
