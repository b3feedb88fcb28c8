//! Anytime planning: finds ever shorter paths until a deadline.

use std::time::{Duration, Instant};

use elbowroom_scene::SceneState;

use super::cost_bounded_search::CostBoundedSearch;
use super::informed_sampler::InformedSampler;
use super::path_refinement::PathRefinement;
use super::planner::CoverRrtConnect;
use super::query_ends::QueryEnds;
use crate::interpolation::{length, path_length};
use crate::joint_path::JointPath;
use crate::rrt_connect::{MotionValidator, Random, RrtConnectError, RrtConnectSettings, Shortcutting};

/// Smallest gain of a shorter path, as a fraction of the length.
const LEAST_GAIN: f64 = 1e-3;

/// A path that was shortened until a deadline.
#[derive(Debug, Clone, PartialEq)]
pub struct AnytimePath {
    /// The shortest path found.
    pub path: JointPath,
    /// Time since the beginning and length (rad, and m) of each path that was the shortest so far; the first entry is
    /// the first path.
    pub improvements: Vec<(Duration, f64)>,
    /// Whether no path can be shorter by more than 0.1 %, because the path is about as long as the straight segment.
    pub is_shortest: bool,
}

impl AnytimePath {
    /// Takes another path if it is shorter: the segments to the ends may make it longer.
    fn improve(&mut self, other: JointPath, planning_time: Duration) {
        if other.length_rad < self.path.length_rad {
            self.improvements.push((planning_time, other.length_rad));
            self.path = JointPath { planning_time, simplification_time: Duration::ZERO, ..other };
        }
    }
}

impl From<JointPath> for AnytimePath {
    /// Returns a path that was not shortened any more.
    fn from(path: JointPath) -> Self {
        let improvements = vec![(path.planning_time + path.simplification_time, path.length_rad)];
        Self { path, improvements, is_shortest: false }
    }
}

impl CoverRrtConnect<'_> {
    /// Like [`plan_to_any`](Self::plan_to_any), then searches for shorter paths, each proven free, until the time limit
    /// or the limit of configurations is reached (AORRTC).
    ///
    /// # Errors
    /// The errors of [`plan_to_any`](Self::plan_to_any).
    pub fn plan_anytime<G: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        goals: &[G],
        settings: &RrtConnectSettings,
    ) -> Result<AnytimePath, RrtConnectError> {
        let begin = Instant::now();
        let path = self.plan_to_any(start, goals, settings)?;
        let improvements = vec![(begin.elapsed(), path.length_rad)];
        let mut answer = AnytimePath { path, improvements, is_shortest: false };
        let left = RrtConnectSettings { time_limit: settings.time_limit.saturating_sub(begin.elapsed()), ..*settings };
        let mut random = Random::new(settings.seed);
        // An end may be free in the exact scene although the covers cannot leave it.
        let Ok(ends) = self.validator().query_ends(start, goals, &left, &mut random) else { return Ok(answer) };
        let refined = self.refined(answer.path.clone(), &ends, &mut random);
        answer.improve(refined, begin.elapsed());
        while !Self::is_straight(&ends, &answer.path) && !self.covers.is_exhausted() {
            let Some(other) = self.shorter(&ends, &answer.path, &mut random) else { break };
            answer.improve(other, begin.elapsed());
        }
        answer.is_shortest = Self::is_straight(&ends, &answer.path);
        Ok(answer)
    }

    /// Whether a path is hardly longer than the segment to the nearest goal.
    fn is_straight(ends: &QueryEnds, path: &JointPath) -> bool {
        !ends.misses_goals() && path.length_rad * (1.0 - LEAST_GAIN) <= ends.straight_length()
    }

    /// Searches for a path that is shorter than another by at least the smallest gain.
    fn shorter(&mut self, ends: &QueryEnds, than: &JointPath, random: &mut Random) -> Option<JointPath> {
        let before = Instant::now();
        let goals: Vec<Vec<f64>> = ends.goals().map(<[f64]>::to_vec).collect();
        let region = self.exact.validator.bounds.sampling_region_of(ends.all());
        let bound = than.length_rad * (1.0 - LEAST_GAIN) - ends.exit_length();
        let mut search = self.validator();
        let mut sampler = InformedSampler::new(ends.from().to_vec(), goals.clone(), region, random);
        let mut waypoints = CostBoundedSearch::new(&mut search, ends.from(), &goals, bound).run(&mut sampler)?;
        let raw_length_rad = path_length(&waypoints);
        Shortcutting::new(&mut search).run(&mut waypoints);
        let path = JointPath {
            length_rad: path_length(&waypoints),
            raw_length_rad,
            waypoints,
            planning_time: before.elapsed(),
            simplification_time: Duration::ZERO,
            states_checked: self.covers.states_checked(),
        };
        Some(self.refined(ends.completed(path), ends, random))
    }

    /// Makes a path shorter by random local changes.
    fn refined(&mut self, mut path: JointPath, ends: &QueryEnds, random: &mut Random) -> JointPath {
        let region = self.exact.validator.bounds.sampling_region_of(ends.all());
        let mut search = self.validator();
        PathRefinement { validator: &mut search, region: &region, random }.run(&mut path.waypoints);
        path.length_rad = path_length(&path.waypoints);
        path
    }
}

impl QueryEnds {
    /// Length of the segment to the nearest goal, rad (and m).
    fn straight_length(&self) -> f64 {
        let (start, goals) = self.ends();
        goals.map(|goal| length(start, goal)).fold(f64::INFINITY, f64::min)
    }
}
