//! Keeps a robot clear of what sensors see: its path is checked against the obstacles of each picture, replanned where that is
//! possible, and the robot stops in time where it is not.

use elbowroom_cell::region_constraint::RegionConstraint;
use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_formats::FormatError;
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneError, Selection, SweepOptions};

use super::path_ahead::PathAhead;
use super::path_replanner::{self, PathReplanner};
use super::perceived_obstacles::PerceivedObstacles;
use super::surroundings::Surroundings;
use crate::motion::ProgramClock;
use crate::recording::{Hold, HoldReason, PathReplan, PerceptionTrack};

/// A path nearer to an obstacle than this is blocked, m: more than the motion deviates from the polyline that is checked.
const CLEARANCE_M: f64 = 5e-3;
/// Time (s) after a search without a path until the next one.
const RETRY_S: f64 = 0.2;
/// A robot that stands goes on towards a blocked configuration only where it is farther away than this (s, at override 1).
const RESUME_S: f64 = 0.2;

/// Where the path of the present step is blocked.
#[derive(Debug, Clone, PartialEq)]
struct BlockedPath {
    /// Time in the step (s, at override 1) up to which it is free.
    free_until_s: f64,
    /// The obstacle.
    by: String,
}

/// One robot that keeps clear of what sensors see.
#[derive(Debug)]
pub(super) struct ObstacleGuard<'a> {
    robot: RobotId,
    /// The robots of the cell alone.
    base: Scene,
    replanner: PathReplanner<'a>,
    /// The step whose path was checked last.
    step: Option<usize>,
    blocked: Option<BlockedPath>,
    /// The robot is held now: the reason, and by what.
    held: Option<(HoldReason, String)>,
    not_before_s: f64,
    track: PerceptionTrack,
}

impl<'a> ObstacleGuard<'a> {
    /// # Errors
    /// [`FormatError`] where the scene refuses the cell.
    pub fn new(cell: &'a Cell, robot: RobotId) -> Result<Self, FormatError> {
        let model = QueryModel { objects: Vec::new(), ..QueryModel::for_motion(cell) };
        Ok(Self {
            robot,
            base: model.scene(OutOfReachProofs::Omit)?,
            replanner: PathReplanner::new(robot, &cell.robots[robot.0], cell.tick_s),
            step: None,
            blocked: None,
            held: None,
            not_before_s: 0.0,
            track: PerceptionTrack::default(),
        })
    }

    /// Checks the path of the present step where that is due: after a picture, and when a step begins. Replans a planned move
    /// whose path is blocked; true where it has a new path.
    pub fn observe<'w, 'c>(
        &mut self,
        t_s: f64,
        clock: &mut ProgramClock,
        perceived: &PerceivedObstacles<'_>,
        has_news: bool,
        surroundings: impl FnOnce() -> Surroundings<'w>,
        regions: impl FnMut(f64) -> Option<RegionConstraint<'c>>,
    ) -> bool {
        let step = clock.position().0;
        if !has_news && self.step == Some(step) {
            return false;
        }
        self.step = Some(step);
        self.blocked = None;
        let Some(ahead) = PathAhead::of(clock) else { return false };
        let surroundings = surroundings();
        let carries = surroundings.attachments.iter().flatten().any(|a| a.robot == self.robot);
        if surroundings.perceived.is_empty() || (!carries && perceived.prove_free(self.robot, &ahead.samples)) {
            return false;
        }
        let solids = match self.solids(&surroundings) {
            Ok(solids) => solids,
            Err(e) => return self.block_here(&ahead, &e),
        };
        match self.check(&ahead, &surroundings, &solids) {
            Ok(None) => return false,
            Ok(blocked) => self.blocked = blocked,
            Err(e) => return self.block_here(&ahead, &e),
        }
        let free_until_s = self.blocked.as_ref().map_or(0.0, |b| b.free_until_s);
        if clock.planned_move().is_none() || t_s < self.not_before_s {
            return false;
        }
        let begin = std::time::Instant::now();
        let scene = (&self.base, &solids[..]);
        let found = self.replanner.replan(clock, &ahead, free_until_s, &surroundings, scene, regions);
        let in_motion = found.as_ref().map(|f| f.in_motion);
        self.track.replans.push(PathReplan { t_s, search_s: begin.elapsed().as_secs_f64(), in_motion });
        let Some(found) = found else {
            self.not_before_s = t_s + RETRY_S;
            return false;
        };
        clock.replace_planned_move(found.play, found.entry_s, found.rate);
        self.blocked = None;
        true
    }

    /// What cannot be checked is blocked.
    fn block_here(&mut self, ahead: &PathAhead, why: &SceneError) -> bool {
        self.blocked = Some(BlockedPath { free_until_s: ahead.samples[0].0, by: why.to_string() });
        false
    }

    /// The solid of each obstacle: where it is and will be. One whose predicted positions the robot is at already counts where
    /// it was seen: the prediction must not trap the robot.
    fn solids(&self, surroundings: &Surroundings<'_>) -> Result<Vec<Shape>, SceneError> {
        let mut solids: Vec<Shape> = surroundings.perceived.iter().map(|o| o.predicted.clone()).collect();
        let placed = surroundings.obstacles_only(&self.base, self.robot, &solids)?;
        let mut checker = Checker::new(&placed.scene, CheckerOptions::default());
        let mut pairs = checker.between(Selection::Robot(self.robot), Selection::Objects);
        // The search for a path refuses a start nearer than its clearance.
        pairs.distances_within(&placed.state, path_replanner::CLEARANCE_M + CLEARANCE_M, |near| {
            for id in [near.a, near.b] {
                if let GeometryId::Object(o) = id
                    && let Some(i) = placed.perceived(o)
                {
                    solids[i] = surroundings.perceived[i].observed.clone();
                }
            }
        });
        Ok(solids)
    }

    /// Where the path is blocked; `None` where it is free to the end of the step.
    fn check(
        &self,
        ahead: &PathAhead,
        surroundings: &Surroundings<'_>,
        solids: &[Shape],
    ) -> Result<Option<BlockedPath>, SceneError> {
        let placed = surroundings.obstacles_only(&self.base, self.robot, solids)?;
        let mut checker = Checker::new(&placed.scene, CheckerOptions::default());
        let mut pairs = checker.between(Selection::Robot(self.robot), Selection::Objects);
        let options = SweepOptions { clearance_m: CLEARANCE_M, ..SweepOptions::default() };
        let path = ahead.polyline();
        let Some((_, hit)) = pairs.sweep_path(&placed.state, self.robot, &path, &options)? else { return Ok(None) };
        // It stops where the search for another path can still start.
        let options = SweepOptions { clearance_m: path_replanner::CLEARANCE_M + CLEARANCE_M, ..options };
        let near = pairs.sweep_path(&placed.state, self.robot, &path, &options)?;
        Ok(near.map(|(corner, near)| {
            let object = [hit.a, hit.b].into_iter().find_map(|id| match id {
                GeometryId::Object(o) => placed.perceived(o),
                GeometryId::Link { .. } => None,
            });
            let by = object.map_or_else(String::new, |i| surroundings.perceived[i].name.clone());
            BlockedPath { free_until_s: ahead.time_before(corner, near.time), by }
        }))
    }

    /// Whether the robot must brake or stand now, and by what. It goes on as long as it can still stop in time, after `coast_s`
    /// (s) until a command takes effect.
    pub fn hold(
        &mut self,
        t_s: f64,
        clock: &ProgramClock,
        stale: Option<&str>,
        coast_s: f64,
        dt: f64,
    ) -> Option<&(HoldReason, String)> {
        let held = match stale {
            Some(sensor) => Some((HoldReason::Stale, sensor.to_owned())),
            None => self
                .blocked
                .as_ref()
                .filter(|b| self.must_brake(b, clock, coast_s, dt))
                .map(|b| (HoldReason::Obstacle, b.by.clone())),
        };
        if held != self.held {
            if let Some(open) = self.track.holds.last_mut().filter(|_| self.held.is_some()) {
                open.to_s = t_s;
            }
            self.track.holds.extend(held.iter().map(|(reason, by)| Hold {
                from_s: t_s,
                to_s: f64::INFINITY,
                reason: *reason,
                by: by.clone(),
            }));
            self.held = held;
        }
        self.held.as_ref()
    }

    fn must_brake(&self, blocked: &BlockedPath, clock: &ProgramClock, coast_s: f64, dt: f64) -> bool {
        let (_, time_s) = clock.position();
        let stands = self.held.is_some() && clock.rate() <= 0.0;
        if stands && blocked.free_until_s - time_s < RESUME_S {
            return true;
        }
        clock.rests_at(coast_s + dt, dt) > blocked.free_until_s
    }

    /// The recording, up to the end of the run (s).
    pub fn finish(mut self, end_s: f64) -> PerceptionTrack {
        for hold in &mut self.track.holds {
            hold.to_s = hold.to_s.min(end_s);
        }
        self.track.ends_held = self.held;
        self.track
    }
}
