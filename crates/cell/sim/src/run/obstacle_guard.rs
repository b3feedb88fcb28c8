//! Keeps a robot clear of what sensors see: its path is checked against the obstacles of each picture, replanned where that is
//! possible, and the robot stops in time if it is not.

use std::time::{Duration, Instant};

use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::ChainState;
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneError, Selection, SweepOptions};

use super::path_ahead::PathAhead;
use super::path_replanner::{self, PathReplanner};
use super::path_search::{ClosedRegions, FutileSearch, PathSearch, SearchScene};
use super::perceived_obstacles::{PerceivedObstacle, PerceivedObstacles, PerceivedSolid};
use super::surroundings::Surroundings;
use crate::motion::ProgramClock;
use crate::recording::{Hold, HoldReason, PathReplan, PerceptionTrack};

/// A path nearer to an obstacle than this is blocked, m: more than the motion deviates from the polyline that is checked.
const CLEARANCE_M: f64 = 5e-3;
/// Time (s) after a search without a path until the next one of the step.
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

/// The guard of a robot against what sensors see; `None` for one that no sensor guards.
pub(super) fn obstacle_guard<'a>(
    cell: &'a Cell,
    (id, clock): (RobotId, &ProgramClock),
    avoids: bool,
    perceived: &PerceivedObstacles<'_>,
    states: &[ChainState],
    notes: &mut Vec<Warning>,
) -> Result<Option<ObstacleGuard<'a>>, FormatError> {
    let Some(search_s) = perceived.search_s(id) else { return Ok(None) };
    if !avoids {
        return ObstacleGuard::new(cell, (id, clock), search_s, states).map(Some);
    }
    let robot = &cell.robots[id.0];
    let what = format!(
        "robot \"{}\" has [avoidance.{}], which does not know what sensors see: it does not keep clear of that",
        robot.name, robot.name
    );
    notes.push(Warning::new(&cell.file, robot.line, what).hint("run --no-avoidance, or robots = [...] of the sensor"));
    Ok(None)
}

/// One robot that keeps clear of what sensors see.
#[derive(Debug)]
pub(super) struct ObstacleGuard<'a> {
    robot: RobotId,
    /// The robots of the cell alone.
    base: Scene,
    replanner: PathReplanner<'a>,
    /// How long a search may take, and takes in the time of the run, s.
    search_s: f64,
    /// The step whose path was checked last.
    step: Option<usize>,
    blocked: Option<BlockedPath>,
    search: Option<PathSearch>,
    /// The last search from rest, if it found no path.
    without_path: Option<FutileSearch>,
    /// The robot is held now: the reason, and by what.
    held: Option<(HoldReason, String)>,
    not_before_s: f64,
    track: PerceptionTrack,
}

impl<'a> ObstacleGuard<'a> {
    /// # Errors
    /// [`FormatError`] if the scene refuses the cell, or a move is planned on a map that the robot does not have.
    fn new(
        cell: &'a Cell,
        (robot, clock): (RobotId, &ProgramClock),
        search_s: f64,
        states: &[ChainState],
    ) -> Result<Self, FormatError> {
        let model = QueryModel { objects: Vec::new(), ..QueryModel::of_cell(cell) };
        let base = model.scene(OutOfReachProofs::Omit)?;
        let mut replanner = PathReplanner::new(robot, &cell.robots[robot.0], cell.tick_s).with_maps(cell, clock)?;
        replanner.prepare(&base, states);
        Ok(Self {
            robot,
            base,
            replanner,
            search_s,
            step: None,
            blocked: None,
            search: None,
            without_path: None,
            held: None,
            not_before_s: 0.0,
            track: PerceptionTrack::default(),
        })
    }

    /// Checks the path of the present step where that is due: after a picture, when a step begins, and when it has a new path.
    /// Where a planned move is blocked, a search for another path begins.
    pub fn observe<'c>(
        &mut self,
        t_s: f64,
        clock: &ProgramClock,
        perceived: &PerceivedObstacles<'_>,
        has_news: bool,
        surroundings: impl FnOnce() -> Surroundings,
        regions: impl FnOnce() -> ClosedRegions<'c>,
    ) {
        let step = clock.position().0;
        let is_new_step = self.step != Some(step);
        if is_new_step {
            (self.step, self.search, self.without_path, self.not_before_s) = (Some(step), None, None, 0.0);
        }
        if !(has_news || is_new_step) {
            return;
        }
        let Some(known) = self.check_ahead(clock, perceived, surroundings) else {
            self.search = None;
            return;
        };
        if clock.planned_move().is_some() && t_s >= self.not_before_s && self.search.is_none() {
            let again = self.without_path.as_ref().map(|w| w.longer_search(&SearchScene::of(&known, &regions())));
            let takes_s = again.unwrap_or(Some(1.0)).map(|factor| factor * self.search_s);
            self.search =
                takes_s.map(|takes_s| PathSearch { due_s: t_s + takes_s, takes_s, perceived: known.perceived });
        }
    }

    /// Checks the rest of the step against what is seen now. Where it is blocked: what another path must be clear of.
    fn check_ahead(
        &mut self,
        clock: &ProgramClock,
        perceived: &PerceivedObstacles<'_>,
        surroundings: impl FnOnce() -> Surroundings,
    ) -> Option<Surroundings> {
        self.blocked = None;
        let ahead = PathAhead::of(clock)?;
        let known = surroundings();
        let carries = known.attachments.iter().flatten().any(|a| a.robot == self.robot);
        if known.perceived.is_empty() || (!carries && perceived.prove_free(self.robot, &ahead.samples)) {
            return None;
        }
        let checked = self.solids(&known).and_then(|solids| self.check(&ahead, &known, &solids));
        // What cannot be checked is blocked.
        self.blocked =
            checked.unwrap_or_else(|e| Some(BlockedPath { free_until_s: ahead.samples[0].0, by: e.to_string() }));
        self.blocked.is_some().then_some(known)
    }

    /// Ends a search whose time is over. It knows what sensors had seen at its beginning, and where everything else is by now. True
    /// where the robot has a new path.
    pub fn end_search<'c>(
        &mut self,
        t_s: f64,
        clock: &mut ProgramClock,
        surroundings: impl FnOnce(Vec<PerceivedObstacle>) -> Surroundings,
        regions: impl FnOnce() -> ClosedRegions<'c>,
    ) -> bool {
        let Some(search) = self.search.take_if(|s| t_s >= s.due_s && self.step == Some(clock.position().0)) else {
            return false;
        };
        let (mut known, regions) = (surroundings(search.perceived), regions());
        let (Some(ahead), Some(blocked)) = (PathAhead::of(clock), &self.blocked) else { return false };
        known.states[self.robot.0].q.clone_from(&clock.point().q);
        let Ok(solids) = self.solids(&known) else { return false };
        let begin = Instant::now();
        let (path, scene) = ((&ahead, blocked.free_until_s), (&self.base, &solids[..]));
        let deadline = begin + Duration::from_secs_f64(search.takes_s);
        let found = self.replanner.replan(clock, path, &known, scene, &regions, deadline);
        let in_motion = found.as_ref().map(|f| f.in_motion);
        self.track.replans.push(PathReplan { t_s, search_s: begin.elapsed().as_secs_f64(), in_motion });
        let Some(found) = found else {
            self.not_before_s = t_s + RETRY_S;
            self.without_path = (clock.rate() <= 0.0).then(|| FutileSearch {
                scene: SearchScene::of(&known, &regions),
                factor: search.takes_s / self.search_s,
            });
            return false;
        };
        clock.replace_planned_move(found.play, found.entry_s, found.rate);
        // The new path is checked at once against what is seen by now.
        self.step = None;
        true
    }

    /// The solid of each obstacle: where it is and will be. One whose predicted positions the robot is at already counts where
    /// it was seen: the prediction must not trap the robot.
    fn solids(&self, surroundings: &Surroundings) -> Result<Vec<PerceivedSolid>, SceneError> {
        let mut solids: Vec<PerceivedSolid> = surroundings.perceived.iter().map(|o| o.predicted.clone()).collect();
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

    /// Where the path is blocked; `None` if it is free to the end of the step.
    fn check(
        &self,
        ahead: &PathAhead,
        surroundings: &Surroundings,
        solids: &[PerceivedSolid],
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

    /// Whether a search is under way.
    pub fn is_searching(&self) -> bool {
        self.search.is_some()
    }

    /// Whether the robot must brake or stand now, and by what: an obstacle in its way says more than a sensor without news. It goes
    /// on as long as it can still stop in time, after `coast_s` (s) until a command takes effect.
    pub fn hold(
        &mut self,
        t_s: f64,
        clock: &ProgramClock,
        stale: Option<&str>,
        coast_s: f64,
        dt: f64,
    ) -> Option<&(HoldReason, String)> {
        let in_the_way = self.blocked.as_ref().filter(|b| self.must_brake(b, clock, coast_s, dt));
        let held = in_the_way
            .map(|b| (HoldReason::Obstacle, b.by.clone()))
            .or_else(|| stale.map(|sensor| (HoldReason::Stale, sensor.to_owned())));
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
