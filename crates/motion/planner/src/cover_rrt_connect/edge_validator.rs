//! Validity of edges: by the covers, and by the exact scene where they are not certain.

use std::time::{Duration, Instant};

use elbowroom_robot::RobotId;
use elbowroom_scene::{SweepMove, SweepOptions};
use elbowroom_validity::{NotCertain, Validity, ValidityChecker};

use super::cover_model::{CoverModel, CoverObstacles};
use super::disconnection_proof::{Projection, are_disconnected};
use crate::rrt_connect::{JointRange, MotionValidator, RrtConnectError};

/// The clock is read once in so many questions: it costs as much as a short edge.
const QUESTIONS_PER_CLOCK_READING: u64 = 16;
/// Configurations of a block.
const BLOCK: u64 = 16;

/// Longest edge of a tree, rad (and m).
const EDGE_LENGTH: f64 = 1.0;

/// What a tree search asks.
pub(super) trait EdgeValidator {
    /// True if the straight segment between two configurations is proven free.
    fn edge_is_free(&mut self, from: &[f64], to: &[f64]) -> bool;
    /// True if the search must end.
    fn is_exhausted(&mut self) -> bool;

    /// Longest edge of a tree, rad (and m).
    fn longest_edge(&self) -> f64 {
        EDGE_LENGTH
    }

    /// Moves a configuration to where a constraint is satisfied. False if that fails.
    fn project(&mut self, q: &mut [f64]) -> bool {
        let _ = q;
        true
    }
}

/// Proves edges by the covers; by the exact scene the pairs that the covers leave open.
#[derive(Debug)]
pub(super) struct CoverValidator<'m> {
    checker: ValidityChecker<'m>,
    model: &'m CoverModel,
    obstacles: &'m CoverObstacles,
    robot: RobotId,
    deadline: Instant,
    max_states: u64,
    /// Blocks before the present query.
    blocks_before: u64,
    /// How often it was asked whether the search must end.
    questions: u64,
    pairs: Vec<NotCertain>,
}

impl<'m> CoverValidator<'m> {
    pub fn new(model: &'m CoverModel, obstacles: &'m CoverObstacles, robot: RobotId) -> Self {
        let checker = obstacles.checker(model);
        let (deadline, pairs) = (Instant::now(), Vec::new());
        Self { checker, model, obstacles, robot, deadline, max_states: 0, blocks_before: 0, questions: 0, pairs }
    }

    /// Begins a query.
    pub fn begin(&mut self, deadline: Instant, max_states: u64) {
        self.deadline = deadline;
        self.max_states = max_states;
        self.blocks_before = self.checker.blocks();
    }

    /// Goes on with a query until another time.
    pub fn extend_deadline(&mut self, deadline: Instant) {
        self.deadline = deadline;
    }

    /// True if it is proven that no path within the ranges joins two configurations; what that tests is not counted.
    pub fn are_disconnected(
        &mut self,
        ranges: &[JointRange],
        ends: [&[f64]; 2],
        projection: &Projection,
        deadline: Instant,
    ) -> bool {
        let before = self.checker.blocks();
        let answer = are_disconnected(&mut self.checker, ranges, ends, projection, deadline);
        self.blocks_before += self.checker.blocks() - before;
        answer
    }

    /// Configurations that were tested in this query.
    pub fn states_checked(&self) -> u64 {
        BLOCK * (self.checker.blocks() - self.blocks_before)
    }

    /// That no path was found within the limits.
    pub fn not_found(&self, after: Duration, nodes: usize) -> RrtConnectError {
        let states_checked = self.states_checked();
        RrtConnectError::NotFound { seconds: after.as_secs_f64(), states_checked, nodes, nearer: Vec::new() }
    }

    /// What the covers say of a configuration.
    pub fn state(&mut self, q: &[f64]) -> Validity {
        self.checker.state(q).unwrap_or(Validity::Uncertain)
    }

    /// True if an edge is proven free: what the covers leave open is swept exactly.
    pub fn is_free_exactly(
        &mut self,
        exact: &mut MotionValidator,
        from: &[f64],
        to: &[f64],
        sweep: &SweepOptions,
    ) -> bool {
        let mut pairs = std::mem::take(&mut self.pairs);
        let are_known = self.checker.uncertain_pairs(from, to, &mut pairs).is_ok();
        let moves = SweepMove::Robot { robot: self.robot, to };
        let is_free = are_known
            && pairs.iter().all(|&pair| {
                let (a, b) = self.obstacles.pair(self.model, pair);
                exact.pair_sweep_is_free(a, b, from, moves, sweep)
            });
        self.pairs = pairs;
        is_free && exact.constraint_allows(from, to)
    }
}

impl EdgeValidator for CoverValidator<'_> {
    fn edge_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.checker.edge_is_free(from, to).unwrap_or(false)
    }

    fn is_exhausted(&mut self) -> bool {
        self.questions += 1;
        self.states_checked() > self.max_states
            || (self.questions.is_multiple_of(QUESTIONS_PER_CLOCK_READING) && Instant::now() >= self.deadline)
    }
}
