//! Executes planned paths: follows the path, replans around obstacles that appear, or stops.

use std::sync::Arc;

use elbowroom_cspace::{Grid, MapReader};
use elbowroom_planner::{GridPlanner, GridPlannerError, GridPlannerSettings, Path, PathEnd, PathProgress, ReplanKind};
use elbowroom_vision::Stopwatch;

use crate::arc_limit::ArcLimit;
use crate::exact_path_checker::ExactPathChecker;
use crate::executor_settings::{ExecutorError, ExecutorSettings, first_three, validate_settings};
use crate::executor_state::{ExecutorState, HoldReason};
use crate::executor_step::ExecutorStep;
use crate::free_arc::free_arc_rad;
use crate::mapped_arm::MappedArm;
use crate::obstacle_update::{ObstacleUpdate, Prism};
use crate::path_execution::{CurveStatus, PathExecution, distance};
use crate::replan_in_motion::{InMotionSettings, replan_in_motion};
use crate::replan_result::ReplanResult;

/// Configurations nearer than this are the same, rad: it is far above rounding and far below a step of an encoder.
const SAME_CONFIGURATION_RAD: f64 = 1e-9;

/// Executes and replans the motion of one arm.
#[derive(Debug)]
pub struct ReplanningExecutor {
    arm: Arc<MappedArm>,
    grid: Grid,
    reader: MapReader,
    planner: GridPlanner,
    exact: Option<ExactPathChecker>,
    settings: ExecutorSettings,
    /// All joint values. Those of the joints that the map does not have are fixed; the others are not used.
    held: Vec<f64>,
    /// Map joint values of the current configuration.
    q: [f64; 3],
    goal: Option<[f64; 3]>,
    motion: Option<PathExecution>,
    limit: ArcLimit,
    reason: Option<HoldReason>,
    image_s: Option<f64>,
    prisms: Vec<Prism>,
}

impl ReplanningExecutor {
    /// Creates an executor for an arm that is stopped at `q` (all joint values), with a reader of the map. With an
    /// [`ExactPathChecker`], each new path is checked before the arm moves, and an arm whose cell becomes blocked may
    /// leave it. Fixed obstacles must be in the map and in the exact scene.
    ///
    /// # Errors
    /// A grid that is not the map's, joint values outside of it, settings out of range.
    pub fn new(
        arm: Arc<MappedArm>,
        grid: &Grid,
        mut reader: MapReader,
        exact: Option<ExactPathChecker>,
        settings: ExecutorSettings,
        q: &[f64],
    ) -> Result<Self, ExecutorError> {
        validate_settings(&settings)?;
        let dof = arm.robot.chain.dof();
        if q.len() != dof {
            return Err(ExecutorError::Values { found: q.len(), dof });
        }
        let planner = GridPlanner::new(grid, reader.latest().occupancy())?;
        let planar = arm.to_planar(q);
        let executor = Self {
            grid: grid.clone(),
            reader,
            planner,
            exact,
            settings,
            held: q.to_vec(),
            q: planar,
            goal: None,
            motion: None,
            limit: ArcLimit::Unlimited,
            reason: None,
            image_s: None,
            prisms: Vec::new(),
            arm,
        };
        executor.inside(planar)?;
        let at_rest = Path { waypoints: vec![planar], length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 };
        executor.planner.time_parametrize(&at_rest, &executor.settings.limits)?;
        if let Some(retreat) = executor.settings.retreat {
            executor.inside(retreat)?;
        }
        Ok(executor)
    }

    /// Map joint values (see [`MappedArm::to_planar`]) of the current configuration, radians.
    pub fn planar(&self) -> [f64; 3] {
        self.q
    }

    /// The path that is followed, map joint values; `None` where the arm is stopped without one. After a change of path in
    /// motion it begins slightly behind the configuration of that time.
    pub fn path(&self) -> Option<&Path> {
        self.motion.as_ref().map(|motion| &motion.path)
    }

    /// The planner, with its copy of the occupancy bitmap.
    pub fn planner(&self) -> &GridPlanner {
        &self.planner
    }

    /// Sets a goal (all joint values). A motion to another goal is stopped first. The path is planned with the next
    /// [`ReplanningExecutor::update`].
    ///
    /// # Errors
    /// A wrong number of values, or a goal outside of the map.
    pub fn set_goal(&mut self, goal: &[f64]) -> Result<(), ExecutorError> {
        let dof = self.held.len();
        if goal.len() != dof {
            return Err(ExecutorError::Values { found: goal.len(), dof });
        }
        let goal = self.arm.to_planar(goal);
        self.inside(goal)?;
        if self.motion.is_some() {
            self.limit = ArcLimit::StopNow;
        }
        self.reason = Some(HoldReason::NotPlanned);
        self.goal = Some(goal);
        Ok(())
    }

    fn inside(&self, q: [f64; 3]) -> Result<(), ExecutorError> {
        let axes = self.grid.axes();
        match (0..3).find(|&i| axes[i].cell(q[i]).is_none()) {
            None => Ok(()),
            Some(joint) => {
                let (min, max) = (axes[joint].min(), axes[joint].max());
                Err(GridPlannerError::Outside { end: PathEnd::Goal, joint, value: q[joint], min, max }.into())
            }
        }
    }

    /// Takes over an obstacle update: validates the rest of the path and repairs or replans it where needed.
    pub fn update(&mut self, update: &ObstacleUpdate) -> ReplanResult {
        let mut result = ReplanResult::default();
        if !update.is_accepted() {
            return result;
        }
        self.image_s = Some(update.stamp_s);
        self.prisms.clone_from(&update.prisms);
        let mut stopwatch = Stopwatch::start();
        let updated = self.planner.update(self.reader.latest().occupancy());
        result.times.update = stopwatch.lap();
        if let Err(error) = updated {
            // The reader belongs to another map: nothing is known.
            self.image_s = None;
            result.reason = Some(HoldReason::NoPath(error.to_string()));
            return result;
        }
        match self.motion.take() {
            Some(motion) => self.revalidate(motion, &mut result),
            None => self.plan_from_rest(&mut result),
        }
        self.reason.clone_from(&result.reason);
        result
    }

    /// Validates the current motion against the new map.
    fn revalidate(&mut self, motion: PathExecution, result: &mut ReplanResult) {
        let mut stopwatch = Stopwatch::start();
        let is_stop_requested = self.limit == ArcLimit::StopNow;
        let remaining = if is_stop_requested { CurveStatus::NoExit } else { self.remaining_status(&motion) };
        result.times.path_check = stopwatch.lap();
        result.kind = Some(ReplanKind::Kept);
        let now_rad = motion.arc_rad();
        let stop_before = |arc_rad: f64| ArcLimit::StopAt(arc_rad - self.settings.stop_margin_rad);
        self.limit = match remaining {
            CurveStatus::Free => ArcLimit::Unlimited,
            CurveStatus::BlockedAt { arc_rad } => stop_before(arc_rad),
            CurveStatus::StartBlocked { exit_s, then_arc_rad } => {
                // The cell was free when the arm entered it: continue if the path leaves it and the exact check passes.
                let passes = self.exact.is_some()
                    && self.check_exactly(&motion.points(exit_s, self.settings.check_chord_rad)).is_ok();
                result.times.exact += stopwatch.lap();
                match then_arc_rad {
                    _ if !passes => ArcLimit::StopAt(now_rad),
                    None => ArcLimit::Unlimited,
                    Some(arc_rad) => stop_before(arc_rad),
                }
            }
            // A requested stop stays one until the arm is at rest.
            CurveStatus::NoExit if is_stop_requested => ArcLimit::StopNow,
            CurveStatus::NoExit => ArcLimit::StopAt(now_rad),
        };
        if self.limit == ArcLimit::Unlimited {
            self.motion = Some(motion);
            return;
        }
        result.was_blocked = true;
        result.reason = Some(HoldReason::Blocked);
        let is_stopped = motion.rate <= self.settings.stopped_rate
            || distance(motion.state().qd, [0.0; 3]) < self.settings.stopped_speed_rad_s;
        if is_stopped {
            self.motion = Some(motion);
            self.plan_from_rest(result);
            return;
        }
        let settings =
            InMotionSettings { limits: &self.settings.limits, planner: &self.planner_settings(0.0), grid: &self.grid };
        let outcome =
            if is_stop_requested { None } else { Some(replan_in_motion(&mut self.planner, &motion, &settings)) };
        let Some(replan) = outcome else {
            self.motion = Some(motion);
            return;
        };
        (result.times.replan, result.times.timing) = (replan.replan, replan.timing);
        stopwatch.lap();
        let checked = replan.found.filter(|(next, _)| {
            let is_free = self.check_exactly(&next.points(f64::INFINITY, self.settings.check_chord_rad)).is_ok();
            result.times.exact += stopwatch.lap();
            is_free
        });
        match checked {
            Some((next, kind)) => {
                (self.motion, self.limit) = (Some(next), ArcLimit::Unlimited);
                (result.kind, result.in_motion, result.reason) = (Some(kind), true, None);
            }
            None => self.motion = Some(motion),
        }
    }

    /// Validates the rest of the path: the curve point by point, its straight segments cell by cell.
    fn remaining_status(&self, motion: &PathExecution) -> CurveStatus {
        let curve = motion.curve_status(self.planner.occupancy(), &self.grid);
        let (CurveStatus::Free, Some(segment)) = (curve, motion.segment()) else { return curve };
        let here = PathProgress { segment, q: motion.state().q };
        match free_arc_rad(&self.planner, &motion.path, here) {
            Ok(None) => CurveStatus::Free,
            Ok(Some(free_rad)) => CurveStatus::BlockedAt { arc_rad: motion.arc_rad() + free_rad },
            Err(_) => CurveStatus::NoExit,
        }
    }

    /// Plans from rest: to the goal, or to the retreat configuration.
    fn plan_from_rest(&mut self, result: &mut ReplanResult) {
        let in_blocked_cell = self.grid.cell(self.q).is_none_or(|cell| self.planner.occupancy().is_blocked(cell));
        let retreat = self.settings.retreat.filter(|_| in_blocked_cell);
        let goals = [self.goal.filter(|goal| distance(*goal, self.q) > SAME_CONFIGURATION_RAD), retreat];
        for goal in goals.into_iter().flatten() {
            match self.plan_to(goal, in_blocked_cell, result) {
                Ok(motion) => {
                    (self.motion, self.limit) = (Some(motion), ArcLimit::Unlimited);
                    (result.kind, result.reason) = (Some(ReplanKind::Replanned), None);
                    return;
                }
                Err(reason) => result.reason = Some(reason),
            }
        }
    }

    fn plan_to(
        &mut self,
        goal: [f64; 3],
        in_blocked_cell: bool,
        result: &mut ReplanResult,
    ) -> Result<PathExecution, HoldReason> {
        let mut stopwatch = Stopwatch::start();
        let may_search = in_blocked_cell && self.exact.is_some();
        let settings = self.planner_settings(if may_search { self.settings.free_search_rad } else { 0.0 });
        let path = self.planner.plan(self.q, goal, &settings);
        result.times.replan += stopwatch.lap();
        let mut path = path.map_err(|e| HoldReason::NoPath(e.to_string()))?;
        if path.goal_moved_rad > 0.0 {
            return Err(HoldReason::NoPath("the goal is in a blocked cell".into()));
        }
        if path.start_moved_rad > 0.0 {
            path.waypoints.insert(0, self.q);
        }
        let limits = &self.settings.limits;
        let trajectory = self.planner.time_parametrize(&path, limits).map_err(|e| HoldReason::NoPath(e.to_string()))?;
        result.times.timing += stopwatch.lap();
        let motion = PathExecution::new(path, trajectory, 0.0, 1.0, &self.grid, limits);
        let proof = self.check_exactly(&motion.points(f64::INFINITY, self.settings.check_chord_rad));
        result.times.exact += stopwatch.lap();
        proof.map(|()| motion)
    }

    fn check_exactly(&self, points: &[[f64; 3]]) -> Result<(), HoldReason> {
        self.exact
            .as_ref()
            .map_or(Ok(()), |exact| exact.check(&self.prisms, &self.held, points, self.settings.check_clearance_m))
    }

    fn planner_settings(&self, max_end_shift_rad: f64) -> GridPlannerSettings {
        GridPlannerSettings { weights: self.settings.weights, max_end_shift_rad, ..GridPlannerSettings::default() }
    }

    /// Advances by `dt` seconds until `now_s` (on the clock of the frame stamps). A `dt` that is not finite or not
    /// above 0 moves nothing: the arm counts as stopped and continues from rest. An image stamped more than
    /// [`ExecutorSettings::stale_s`] after `now_s` counts as missing.
    pub fn tick(&mut self, now_s: f64, dt: f64) -> ExecutorStep {
        let age_s = self.image_s.map_or(f64::INFINITY, |stamp_s| now_s - stamp_s);
        // Written so that a NaN age counts as stale.
        let stale = (!(age_s.abs() <= self.settings.stale_s)).then_some(HoldReason::NoRecentImage { age_s });
        let is_valid_step = dt.is_finite() && dt > 0.0;
        let hold = (!is_valid_step).then_some(HoldReason::InvalidTimeStep { dt_s: dt }).or(stale);
        let Some(mut motion) = self.motion.take() else {
            let has_goal = self.goal.is_some_and(|goal| distance(goal, self.q) > SAME_CONFIGURATION_RAD);
            let why = hold.or_else(|| self.reason.clone()).unwrap_or(HoldReason::Blocked);
            return self.step(
                [0.0; 3],
                0.0,
                if has_goal { ExecutorState::Waiting(why) } else { ExecutorState::Arrived },
            );
        };
        if let (false, Some(why)) = (is_valid_step, &hold) {
            motion.rate = 0.0;
            self.motion = Some(motion);
            return self.step([0.0; 3], 0.0, ExecutorState::Waiting(why.clone()));
        }
        let before = motion.rate;
        let target_rate = if hold.is_some() { 0.0 } else { self.permitted_rate(&motion, dt) };
        let accelerate = first_three(&self.settings.limits.acceleration);
        (motion.tau_s, motion.rate) = motion.after(dt, target_rate, self.settings.stop, accelerate);
        let state = motion.state();
        self.q = state.q;
        let (rate, is_finished) = (motion.rate, motion.is_finished());
        let why = || hold.clone().or_else(|| self.reason.clone()).unwrap_or(HoldReason::Blocked);
        let executor_state = match () {
            () if is_finished => ExecutorState::Arrived,
            () if rate <= 0.0 => ExecutorState::Waiting(why()),
            () if rate < before => ExecutorState::Slowing(why()),
            () => ExecutorState::Moving,
        };
        let is_stop_requested = self.limit == ArcLimit::StopNow;
        if is_finished || is_stop_requested && rate <= 0.0 {
            self.limit = ArcLimit::Unlimited;
        } else {
            self.motion = Some(motion);
        }
        self.step(state.qd.map(|speed| speed * rate), rate, executor_state)
    }

    /// 1 where the arm can move for one more tick and still stop before its limit; its present rate where it cannot
    /// accelerate; 0 where it must brake.
    fn permitted_rate(&self, motion: &PathExecution, dt: f64) -> f64 {
        let limit_s = match self.limit {
            ArcLimit::Unlimited => return 1.0,
            ArcLimit::StopAt(limit_rad) if limit_rad > 0.0 => motion.time_at(limit_rad),
            ArcLimit::StopAt(_) | ArcLimit::StopNow => 0.0,
        };
        let (stop, accelerate) = (self.settings.stop, first_three(&self.settings.limits.acceleration));
        let fits = |target_rate: f64| {
            let (tau_s, rate) = motion.after(dt, target_rate, stop, accelerate);
            motion.stops_at(tau_s, rate, stop, dt) <= limit_s
        };
        [1.0, motion.rate].into_iter().find(|&rate| fits(rate)).unwrap_or(0.0)
    }

    fn step(&self, qd: [f64; 3], rate: f64, state: ExecutorState) -> ExecutorStep {
        ExecutorStep { q: self.arm.to_joints(&self.held, self.q), qd, rate, state }
    }
}
