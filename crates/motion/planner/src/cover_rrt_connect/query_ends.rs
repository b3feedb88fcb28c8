//! Ends of a query: start and goals, and the exits from which the covers prove edges.

use std::time::Duration;

use elbowroom_scene::{SceneState, SweepOptions};
use elbowroom_validity::Validity;

use super::constrained_validator::ConstrainedValidator;
use crate::grid_path::PathEnd;
use crate::interpolation::length;
use crate::joint_path::JointPath;
use crate::rrt_connect::{JointBounds, Random, RrtConnectError, RrtConnectSettings};

/// Number of configurations tried around an end that the covers leave open.
const EXIT_TRIALS: usize = 400;
/// Largest distance of a tried configuration from the end, rad (and m).
const EXIT_RADIUS: f64 = 0.5;

/// A start or a goal, and the configurations through which a path leaves it.
#[derive(Debug, Clone)]
struct QueryEnd {
    q: Vec<f64>,
    /// Configuration that keeps the margin of the constraint.
    constrained: Vec<f64>,
    /// Configuration that the covers prove free.
    exit: Vec<f64>,
}

impl QueryEnd {
    fn exit_length(&self) -> f64 {
        length(&self.q, &self.constrained) + length(&self.constrained, &self.exit)
    }
}

/// The start and the valid goals.
#[derive(Debug, Clone)]
pub(super) struct QueryEnds {
    start: QueryEnd,
    goals: Vec<QueryEnd>,
    /// Whether a skipped goal may be valid: no exit from it was found.
    misses_goals: bool,
}

impl QueryEnds {
    /// Exit of the start, where the search begins.
    pub fn from(&self) -> &[f64] {
        &self.start.exit
    }

    /// Exits of the goals, where the search may end.
    pub fn goals(&self) -> impl Iterator<Item = &[f64]> {
        self.goals.iter().map(|goal| &goal.exit[..])
    }

    /// Exits of the start and the goals.
    pub fn all(&self) -> impl Iterator<Item = &[f64]> {
        std::iter::once(self.from()).chain(self.goals())
    }

    /// The start and the goals themselves.
    pub fn ends(&self) -> (&[f64], impl Iterator<Item = &[f64]>) {
        (&self.start.q, self.goals.iter().map(|goal| &goal.q[..]))
    }

    /// Least difference in length between a whole path and its part between exits, rad (and m).
    pub fn exit_length(&self) -> f64 {
        self.start.exit_length() + self.goals.iter().map(QueryEnd::exit_length).fold(f64::INFINITY, f64::min)
    }

    /// Whether there may be other goals, so that a proof for these goals is not a proof for all.
    pub fn misses_goals(&self) -> bool {
        self.misses_goals
    }

    /// Extends a path between exits by the segments to the ends themselves.
    pub fn completed(&self, path: JointPath) -> JointPath {
        let reached = path.waypoints.last().and_then(|last| self.goals.iter().find(|goal| goal.exit == *last));
        let Some(goal) = reached else { return path };
        path.with_ends([self.start.constrained.clone(), goal.constrained.clone()])
            .with_ends([self.start.q.clone(), goal.q.clone()])
    }
}

impl ConstrainedValidator<'_, '_> {
    /// Returns the start and all goals that are valid and can be left; prepares the validators for the query.
    pub(super) fn query_ends<G: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        goals: &[G],
        settings: &RrtConnectSettings,
        random: &mut Random,
    ) -> Result<QueryEnds, RrtConnectError> {
        let (mut ends, mut reason): (Option<QueryEnds>, _) = (None, RrtConnectError::NoGoal);
        let mut misses_goals = false;
        for (i, goal) in goals.iter().enumerate() {
            match self.pair_of_ends(start, goal.as_ref(), settings, random) {
                Ok((from, to)) => match &mut ends {
                    Some(ends) => ends.goals.push(to),
                    None => ends = Some(QueryEnds { start: from, goals: vec![to], misses_goals }),
                },
                Err(e) => {
                    let is_open = matches!(e, RrtConnectError::NotFound { .. });
                    misses_goals |= is_open;
                    // A goal that may be valid comes first; otherwise the reason why the first goal is invalid helps
                    // most.
                    if i == 0 || is_open {
                        reason = e;
                    }
                }
            }
        }
        ends.map(|ends| QueryEnds { misses_goals, ..ends }).ok_or(reason)
    }

    fn pair_of_ends(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
        random: &mut Random,
    ) -> Result<(QueryEnd, QueryEnd), RrtConnectError> {
        let ends = self.ends(start, goal, settings)?;
        let constrained = self.exact.constraint_exits(&ends, start, random, settings)?;
        let exits = [self.exit(&constrained, 0, random)?, self.exit(&constrained, 1, random)?];
        let ([q, goal], [near, near_goal], [exit, goal_exit]) = (ends, constrained, exits);
        Ok((QueryEnd { q, constrained: near, exit }, QueryEnd { q: goal, constrained: near_goal, exit: goal_exit }))
    }

    /// Returns the ends within limits; prepares the validators for the query.
    pub(super) fn ends(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<[Vec<f64>; 2], RrtConnectError> {
        if let Some((setting, value)) = settings.invalid() {
            return Err(RrtConnectError::InvalidSetting { setting, value });
        }
        self.exact.begin(start, goal, settings)?;
        self.covers.begin(self.exact.validator.deadline.clone(), settings.max_states);
        let bounds: &JointBounds = &self.exact.validator.bounds;
        let from = bounds.clamped_end(PathEnd::Start, start.q(self.exact.robot()))?;
        let to = bounds.clamped_end(PathEnd::Goal, goal)?;
        if self.exact.has_other_robots() {
            // No block contains links that no joint moves; another robot may still touch them.
            self.exact.free_margin_m(PathEnd::Start, &from)?;
        }
        Ok([from, to])
    }

    /// Returns an end, or a nearby configuration that the covers prove free and to which an edge is proven exactly.
    fn exit(&mut self, ends: &[Vec<f64>; 2], which: usize, random: &mut Random) -> Result<Vec<f64>, RrtConnectError> {
        let q = &ends[which];
        if self.covers.state(q) == Validity::Free {
            return Ok(q.clone());
        }
        let margin = self.exact.free_margin_m([PathEnd::Start, PathEnd::Goal][which], q)?;
        let sweep = self.exact.validator.sweep;
        let sweep = SweepOptions { tolerance_m: sweep.tolerance_m.min(0.5 * margin), ..sweep };
        let region = self.exact.validator.bounds.sampling_region(q, q);
        let mut sample = q.clone();
        for trial in 0..EXIT_TRIALS {
            let share = EXIT_RADIUS * ((trial + 1) as f64 / EXIT_TRIALS as f64).powi(2).max(0.02);
            region.around(q, share, random, &mut sample);
            if self.covers.state(&sample) == Validity::Free
                && self.covers.is_free_exactly(&mut self.exact.validator, q, &sample, &sweep)
            {
                return Ok(sample);
            }
        }
        Err(self.covers.not_found(Duration::ZERO, 0))
    }
}
