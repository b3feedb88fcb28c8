//! Replanning of a planned move around obstacles that sensors see: in motion without a stop, or from rest.

use std::sync::Arc;
use std::time::{Duration, Instant};

use elbowroom_cell::trajectory::{Playback, motion_bounds};
use elbowroom_cell::{Cell, CellRobot};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::{ChainState, JointLimits};
use elbowroom_perception::motion_entry::{acceleration_distance, first_root};
use elbowroom_planner::{
    CoverModels, CoverObstacles, JointPath, PathConstraint, RobotPlanner, RrtConnect, RrtConnectSettings, TimedPath,
};
use elbowroom_proximity::Shape;
use elbowroom_query::CoverCache;
use elbowroom_query::plan::{MapPlanner, PathPlanner};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::Pose;

use super::path_search::{ClosedRegions, SearchRequest, SearchScene};
use super::surroundings::PlacedScene;
use crate::motion::ProgramClock;

/// Largest number of validated states per attempt.
const MAX_STATES: u64 = 1_000_000;
/// Distance that paths keep from everything, m: more than the path check requires, so that noise of the outlines does
/// not block them at once.
pub(super) const CLEARANCE_M: f64 = 0.02;
/// Clearances to try, m: `CLEARANCE_M`, and a smaller one for a robot that rests nearer to something because it could
/// not stop earlier.
///
/// Both are larger than the path check requires.
const CLEARANCES_M: [f64; 2] = [CLEARANCE_M, 6e-3];
/// Fractions of each warning zone that paths keep from a region, in the order of the attempts. This fraction of the
/// override remains.
const WARNING_SHARES: [f64; 2] = [0.25, 0.0];
/// Number of stopping distances ahead at which a new path leaves the present one.
///
/// The corner is rounded over at most half of the stretch that begins one stopping distance behind the robot, so that
/// the robot could still stop before the rounding.
const LEAVE_AFTER: f64 = 3.0;
/// Smallest programmed override from which the speed at override 1 is derived.
const MIN_OVERRIDE: f64 = 0.01;
/// Speed below which a robot has no direction of motion, rad/s or m/s.
const MIN_SPEED: f64 = 1e-6;
/// Distance to the robot's configuration within which a new path must pass for the robot to enter it, rad or m.
const ENTRY_DISTANCE: f64 = 1e-6;

/// A new path to the end of a planned move.
#[derive(Debug)]
pub struct NewPath {
    /// The number of the path that it replaces.
    replaces: u64,
    play: Arc<Playback>,
    /// Whether the robot enters it in motion: without a stop in between.
    pub(super) in_motion: bool,
    /// By how much each joint may slow down in a tick, rad/s or m/s.
    slowing_per_tick: Vec<f64>,
}

impl NewPath {
    /// Puts a program onto this path. False, and the program stays on its own, if it has begun another one meanwhile, or if its robot
    /// is not where the new path passes in the direction of its motion, at a rate that the program allows.
    pub fn enter(&self, clock: &mut ProgramClock) -> bool {
        if clock.path_number() != self.replaces {
            return false;
        }
        let most = clock.programmed_override();
        let (here, velocity) = (&clock.point().q, clock.velocity().collect::<Vec<f64>>());
        let entered = if self.in_motion {
            entry(&self.play, here, &velocity).filter(|(_, rate)| self.takes(&velocity, *rate / most))
        } else {
            let is_at_start = norm(&velocity) <= MIN_SPEED && is_near(&self.play.q(0.0), here);
            is_at_start.then_some((0.0, most))
        };
        if let Some((entry_s, rate)) = entered {
            clock.replace_planned_move(self.play.clone(), entry_s, rate.min(most));
        }
        entered.is_some()
    }

    /// Whether a robot can go over to the path, at its entry so many times as fast as the path allows: two time-optimal
    /// paths differ by some thousandths on the same straight.
    fn takes(&self, velocity: &[f64], times: f64) -> bool {
        let drop = 1.0 - 1.0 / times.max(1.0);
        velocity.iter().zip(&self.slowing_per_tick).all(|(v, most)| v.abs() * drop <= *most)
    }
}

/// The end of a search.
#[derive(Debug)]
pub struct SearchResult {
    /// The path, if there is one.
    pub new_path: Option<NewPath>,
    pub(super) scene: SearchScene,
    /// Wall-clock time that it took, s.
    pub(super) search_s: f64,
}

/// Settings of one attempt.
struct Attempt {
    settings: RrtConnectSettings,
    warning_share: f64,
}

/// The attempts of a search, largest distances first, each with an equal part of the remaining time.
fn attempts(is_moving: bool, without_regions: bool, deadline: Instant) -> impl Iterator<Item = Attempt> {
    let clearances = if is_moving { &CLEARANCES_M[..1] } else { &CLEARANCES_M };
    let shares = if without_regions { &WARNING_SHARES[..1] } else { &WARNING_SHARES };
    let all = clearances.iter().flat_map(move |clearance_m| shares.iter().map(move |share| (*clearance_m, *share)));
    let count = (clearances.len() * shares.len()) as u32;
    all.zip((1..=count).rev()).filter_map(move |((clearance_m, warning_share), left)| {
        let time_limit = deadline.saturating_duration_since(Instant::now()) / left;
        let settings =
            RrtConnectSettings { time_limit, max_states: MAX_STATES, clearance_m, ..RrtConnectSettings::default() };
        (time_limit > Duration::ZERO).then_some(Attempt { settings, warning_share })
    })
}

/// Start of a new path.
struct Departure {
    /// Waypoints before the start of the search.
    before: Vec<Vec<f64>>,
    /// Start of the search.
    from: Vec<f64>,
}

/// Searches for paths of one robot.
#[derive(Debug)]
pub struct PathReplanner<'a> {
    robot: RobotId,
    /// Scene with the robots of the cell only.
    base: Scene,
    at: &'a CellRobot,
    tick_s: f64,
    motion_bounds: Vec<f64>,
    models: CoverModels,
    /// Maps with their clearances (m); empty if no move of the program is planned on the map.
    maps: Vec<(f64, MapPlanner)>,
}

impl<'a> PathReplanner<'a> {
    pub(super) fn new(robot: RobotId, cell: &'a Cell, base: Scene) -> Self {
        let at = &cell.robots[robot.0];
        Self {
            robot,
            base,
            at,
            tick_s: cell.timing.tick_s,
            motion_bounds: motion_bounds(at),
            models: CoverModels::default(),
            maps: Vec::new(),
        }
    }

    /// Adds the maps for the moves that are planned on them.
    ///
    /// # Errors
    /// [`Diagnostic`] if the robot has no map of three joints.
    pub(super) fn with_maps(mut self, cell: &Cell, clock: &ProgramClock) -> Result<Self, Diagnostic> {
        for q in clock.moves_on_map() {
            if self.maps.iter().any(|(_, map)| map.serves(&q)) {
                continue;
            }
            for clearance_m in CLEARANCES_M {
                self.maps.push((clearance_m, MapPlanner::new(cell, self.robot, &q, clearance_m)?));
            }
        }
        Ok(self)
    }

    /// Computes what searches need from the robot itself, so that the first search does not take that time.
    pub(super) fn prepare(&mut self, states: &[ChainState]) {
        let scene = self.base.clone();
        let mut state = SceneState::new(&scene);
        let placed = states.iter().enumerate().all(|(i, robot)| state.set_q(&scene, RobotId(i), &robot.q).is_ok());
        if placed {
            let covers = CoverCache::of_user();
            for clearance_m in CLEARANCES_M {
                let _ = self.models.serving(&scene, &state, self.robot, clearance_m, &covers);
            }
        }
    }

    /// Searches for a path to the end of the planned move, as long as the request allows.
    pub fn search(&mut self, request: &SearchRequest, regions: &ClosedRegions<'_>) -> SearchResult {
        let begin = Instant::now();
        let new_path = self.new_path(request, regions, begin + Duration::from_secs_f64(request.takes_s));
        let search_s = begin.elapsed().as_secs_f64();
        SearchResult { new_path, scene: SearchScene::of(&request.known, regions), search_s }
    }

    /// A new path, found until a deadline. A moving robot must be able to leave the present path before it is blocked.
    fn new_path(&mut self, request: &SearchRequest, regions: &ClosedRegions<'_>, deadline: Instant) -> Option<NewPath> {
        let SearchRequest { motion, known, solids, free_until_s, lead_s, .. } = request;
        let (ahead, goal) = (motion.ahead.as_ref()?, motion.planned.as_ref()?);
        let limits: Vec<JointLimits> = self.at.limits.iter().map(|limits| limits.slowed_to(goal.speed)).collect();
        let speed = norm(&motion.qd);
        let in_motion = speed > MIN_SPEED;
        let departure = if in_motion {
            let along: Vec<f64> = motion.qd.iter().map(|v| v / speed).collect();
            // The new path passes here so fast that the robot enters it at a rate that the program allows.
            let program_speed = speed / motion.programmed_override.clamp(MIN_OVERRIDE, 1.0);
            let length = acceleration_distance(program_speed, &along, &limits);
            let (passed_s, from) = ahead.straight_ahead(&along, LEAVE_AFTER * length + lead_s * speed)?;
            if passed_s >= *free_until_s {
                return None;
            }
            let behind = motion.q.iter().zip(&along).map(|(q, a)| q - a * length).collect();
            Departure { before: vec![behind], from }
        } else {
            Departure { before: Vec::new(), from: motion.q.clone() }
        };
        let mut placed = known.everything(&self.base, solids).ok()?;
        placed.state.set_q(&placed.scene, self.robot, &departure.from).ok()?;
        let boxes: Vec<_> = solids.iter().flat_map(|solid| solid.boxes.iter().cloned()).collect();
        let found = attempts(in_motion, regions.are_none(), deadline).find_map(|attempt| {
            let regions = regions.constraint(attempt.warning_share);
            let kept = goal.keep.map(|keep| keep.constraint(&placed.scene, self.robot));
            let constraints = kept.map(boxed).into_iter().chain(regions.map(boxed)).collect();
            let by = (goal.planner, &limits[..]);
            self.attempt((&placed, &boxes), &departure, &goal.q, by, (&attempt.settings, constraints))
        })?;
        let play = Arc::new(Playback::new(found.trajectory, &self.motion_bounds));
        let slowing_per_tick = self.at.limits.iter().map(|limit| limit.acceleration * self.tick_s).collect();
        (Instant::now() <= deadline).then_some(NewPath { replaces: motion.path, play, in_motion, slowing_per_tick })
    }

    fn attempt(
        &mut self,
        (placed, others): (&PlacedScene, &[(Shape, Pose)]),
        departure: &Departure,
        goal: &[f64],
        (planner, limits): (PathPlanner, &[JointLimits]),
        (settings, constraints): (&RrtConnectSettings, Vec<Box<dyn PathConstraint + '_>>),
    ) -> Option<TimedPath> {
        let PlacedScene { scene, state, .. } = placed;
        let mut exact = RrtConnect::new(scene, self.robot).ok()?;
        if !constraints.is_empty() {
            exact = exact.with_constraint(constraints);
        }
        let (tick_s, clearance_m) = (self.tick_s, settings.clearance_m);
        if planner == PathPlanner::Grid {
            let (_, map) = self.maps.iter_mut().find(|(of, map)| *of == clearance_m && map.serves(goal))?;
            map.update(scene, state, others).ok()?;
            let path = with_departure(map.plan(&mut exact, state, goal, settings).ok()?, departure);
            return RobotPlanner::Exact(exact).time_parametrize(state, path, limits, tick_s, settings).ok();
        }
        let covers = CoverCache::of_user();
        let model = self.models.serving(scene, state, self.robot, clearance_m, &covers);
        let obstacles = model.map(|model| CoverObstacles::with_covers(model, scene, state, clearance_m, &covers));
        let mut planner = RobotPlanner::new(exact, model.zip(obstacles.as_ref()));
        let path = planner.plan_to_any(state, &[goal], settings).ok()?;
        planner.time_parametrize(state, with_departure(path, departure), limits, tick_s, settings).ok()
    }
}

fn boxed<'c>(constraint: impl PathConstraint + 'c) -> Box<dyn PathConstraint + 'c> {
    Box::new(constraint)
}

fn with_departure(path: JointPath, departure: &Departure) -> JointPath {
    JointPath { waypoints: departure.before.iter().cloned().chain(path.waypoints).collect(), ..path }
}

/// Point at which a new path passes a configuration in the direction of a velocity: its time (s), and the rate at which
/// its speed equals the robot's speed.
///
/// `None` if the path does not pass.
fn entry(play: &Playback, here: &[f64], velocity: &[f64]) -> Option<(f64, f64)> {
    let speed = norm(velocity);
    let passed = |t_s: f64| {
        let q = play.q(t_s);
        q.iter().zip(here).zip(velocity).map(|((q, h), v)| (q - h) * v / speed).sum::<f64>()
    };
    let entry_s = first_root(passed, play.duration())?;
    let point = play.at(entry_s);
    let there = norm(&point.dq);
    let ahead: f64 = point.dq.iter().zip(velocity).map(|(a, b)| a * b).sum();
    (is_near(&point.q, here) && there > 0.0 && ahead > 0.0).then(|| (entry_s, speed / there))
}

fn is_near(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= ENTRY_DISTANCE)
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
