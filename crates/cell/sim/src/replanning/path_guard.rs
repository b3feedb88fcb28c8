//! Checks the path of one robot against the obstacles of each picture, and decides when another one is searched for.

use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneError, Selection, SweepOptions};

use super::executed_motion::ExecutedMotion;
use super::path_ahead::PathAhead;
use super::path_replanner::{self, PathReplanner, SearchResult};
use super::path_search::{ClosedRegions, FutileSearch, PathSearch, SearchRequest, SearchScene};
use super::perceived_obstacles::{PerceivedObstacle, PerceivedObstacles, PerceivedSolid};
use super::program_hold::BlockedPath;
use super::surroundings::Surroundings;
use crate::motion::ProgramClock;
use crate::recording::PathReplan;

/// Distance to an obstacle below which a path is blocked, m: more than the motion deviates from the checked polyline.
const CLEARANCE_M: f64 = 5e-3;
/// Time (s) from a search without a path to the next search in the same step.
const RETRY_S: f64 = 0.2;

/// When a search has its result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchTiming {
    /// A search takes its time on the clock of a simulation: it is computed at its end, from where the robot is then.
    Simulated,
    /// A search is computed at once, while the robot continues: a new path leaves the present one after the longest duration of a
    /// search.
    Live,
}

/// Checks the path of one robot, and decides when another one is searched for.
#[derive(Debug)]
pub struct PathGuard {
    robot: RobotId,
    /// Scene with the robots of the cell only.
    base: Scene,
    timing: SearchTiming,
    /// How long a search may take, s.
    search_s: f64,
    /// The path that was checked last.
    path: Option<u64>,
    blocked: Option<BlockedPath>,
    search: Option<PathSearch>,
    /// The last search from rest, if it found no path.
    without_path: Option<FutileSearch>,
    not_before_s: f64,
    replans: Vec<PathReplan>,
}

impl PathGuard {
    /// Creates the guard of a robot's path before its program moves, and the replanner of its paths. A search may take
    /// `search_s` (s). `states` are the robots of the cell.
    ///
    /// # Errors
    /// [`Diagnostic`] if the scene refuses the cell, or a move is planned on a map that the robot does not have.
    pub fn new<'a>(
        cell: &'a Cell,
        (robot, clock): (RobotId, &ProgramClock),
        (search_s, timing): (f64, SearchTiming),
        states: &[ChainState],
    ) -> Result<(Self, PathReplanner<'a>), Diagnostic> {
        let model = QueryModel { objects: Vec::new(), ..QueryModel::of_cell(cell) };
        let base = model.scene(OutOfReachProofs::Omit)?;
        let mut replanner = PathReplanner::new(robot, cell, base.clone()).with_maps(cell, clock)?;
        replanner.prepare(states);
        let guard = Self {
            robot,
            base,
            timing,
            search_s,
            path: None,
            blocked: None,
            search: None,
            without_path: None,
            not_before_s: 0.0,
            replans: Vec::new(),
        };
        Ok((guard, replanner))
    }

    /// The robot.
    pub fn robot(&self) -> RobotId {
        self.robot
    }

    /// The path that was checked last, and where it is blocked.
    pub fn checked(&self) -> (Option<u64>, Option<&BlockedPath>) {
        (self.path, self.blocked.as_ref())
    }

    /// Whether a path must be checked: because sensors saw something, or because it has not been checked yet.
    pub fn is_due(&self, path: u64, has_news: bool) -> bool {
        has_news || self.path != Some(path)
    }

    /// Checks a path that [is due](Self::is_due). If a planned move is blocked, a search for another path begins.
    pub fn observe<'c>(
        &mut self,
        t_s: f64,
        motion: &ExecutedMotion,
        perceived: &PerceivedObstacles<'_>,
        surroundings: impl FnOnce() -> Surroundings,
        regions: impl FnOnce() -> ClosedRegions<'c>,
    ) {
        if self.path != Some(motion.path) {
            (self.path, self.search, self.without_path, self.not_before_s) = (Some(motion.path), None, None, 0.0);
        }
        let Some(known) = self.check_ahead(motion, perceived, surroundings) else {
            self.search = None;
            return;
        };
        if motion.planned.is_some() && t_s >= self.not_before_s && self.search.is_none() {
            let again = self.without_path.as_ref().map(|w| w.longer_search(&SearchScene::of(&known, &regions())));
            let takes_s = again.unwrap_or(Some(1.0)).map(|factor| factor * self.search_s);
            self.search = takes_s.map(|takes_s| {
                let (after_s, lead_s) = match self.timing {
                    SearchTiming::Simulated => (takes_s, 0.0),
                    SearchTiming::Live => (0.0, takes_s),
                };
                PathSearch { due_s: t_s + after_s, takes_s, lead_s, perceived: known.perceived }
            });
        }
    }

    /// Checks the rest of the step against what is seen now. If it is blocked, returns the surroundings for the search
    /// of another path.
    fn check_ahead(
        &mut self,
        motion: &ExecutedMotion,
        perceived: &PerceivedObstacles<'_>,
        surroundings: impl FnOnce() -> Surroundings,
    ) -> Option<Surroundings> {
        self.blocked = None;
        let ahead = motion.ahead.as_ref()?;
        let known = surroundings();
        let carries = known.attachments.iter().flatten().any(|a| a.robot == self.robot);
        if known.perceived.is_empty() || (!carries && perceived.prove_free(self.robot, &ahead.samples)) {
            return None;
        }
        let checked = self.solids(&known).and_then(|solids| self.check(ahead, &known, &solids));
        // A path that cannot be checked counts as blocked.
        self.blocked =
            checked.unwrap_or_else(|e| Some(BlockedPath { free_until_s: ahead.samples[0].0, by: e.to_string() }));
        self.blocked.is_some().then_some(known)
    }

    /// Whether a search for another path than this one has its result now.
    pub fn is_search_due(&self, t_s: f64, path: u64) -> bool {
        self.path == Some(path) && self.search.as_ref().is_some_and(|search| t_s >= search.due_s)
    }

    /// Takes a search [that is due](Self::is_search_due). It knows what sensors had seen when it was decided on, and where everything
    /// else is by now. `None` if there is nothing to search for any more.
    pub fn take_search(
        &mut self,
        motion: ExecutedMotion,
        surroundings: impl FnOnce(Vec<PerceivedObstacle>) -> Surroundings,
    ) -> Option<SearchRequest> {
        let PathSearch { takes_s, lead_s, perceived, .. } = self.search.take()?;
        let free_until_s = self.blocked.as_ref()?.free_until_s;
        let mut known = surroundings(perceived);
        known.states[self.robot.0].q.clone_from(&motion.q);
        let solids = self.solids(&known).ok()?;
        Some(SearchRequest { motion, known, solids, free_until_s, takes_s, lead_s })
    }

    /// Does not search now: the next picture decides again.
    pub fn drop_search(&mut self) {
        self.search = None;
    }

    /// Takes note of the end of a search at a time (s), and whether the robot is on the path that was found.
    pub fn end_search(&mut self, t_s: f64, request: &SearchRequest, result: &SearchResult, is_entered: bool) {
        let in_motion = result.new_path.as_ref().filter(|_| is_entered).map(|new| new.in_motion);
        // A live cell runs for years: nobody reads its list.
        if self.timing == SearchTiming::Simulated {
            self.replans.push(PathReplan { t_s, search_s: result.search_s, in_motion });
        }
        if in_motion.is_none() && self.path == Some(request.motion.path) {
            self.not_before_s = t_s + RETRY_S;
            self.without_path = (request.motion.rate <= 0.0)
                .then(|| FutileSearch { scene: result.scene.clone(), factor: request.takes_s / self.search_s });
        }
    }

    /// The solid of each obstacle: where it is and will be.
    ///
    /// If the robot is already near the predicted positions of an obstacle, the obstacle counts only where it was seen:
    /// the prediction must not trap the robot.
    fn solids(&self, surroundings: &Surroundings) -> Result<Vec<PerceivedSolid>, SceneError> {
        let mut solids: Vec<PerceivedSolid> = surroundings.perceived.iter().map(|o| o.predicted.clone()).collect();
        let placed = surroundings.obstacles_only(&self.base, self.robot, &solids)?;
        let mut checker = Checker::new(&placed.scene, CheckerOptions::default());
        let mut pairs = checker.between(Selection::Robot(self.robot), Selection::Objects);
        // The path search refuses a start that is nearer than its clearance.
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

    /// Start of the blocked part of the path; `None` if the path is free to the end of the step.
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
        // The robot stops where the search for another path can still start.
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

    /// All searches, in order of time.
    pub(crate) fn into_replans(self) -> Vec<PathReplan> {
        self.replans
    }
}
