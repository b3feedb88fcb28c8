//! Motion validator on sphere covers; the exact scene decides about pairs that the covers leave open.

use std::time::{Duration, Instant};

use elbowroom_robot::RobotId;
use elbowroom_scene::{SweepMove, SweepOptions};
use elbowroom_validity::{EDGES_AT_ONCE, NotCertain, Validity, ValidityChecker};

use super::cover_model::{CoverModel, CoverObstacles};
use super::disconnection_proof::{Projection, are_disconnected};
use crate::deadline::{Deadline, Interrupt};
use crate::rrt_connect::{JointRange, MotionValidator, RrtConnectError, SceneValidator};

/// Number of questions per reading of the clock, which costs as much as a short edge.
const QUESTIONS_PER_CLOCK_READING: u64 = 16;
/// Number of configurations in a block.
const BLOCK: u64 = 16;

/// Longest edge of a tree, rad (and m).
const EDGE_LENGTH: f64 = 1.0;

/// Proves edges by the covers; proves pairs that the covers leave open in the exact scene.
#[derive(Debug)]
pub(super) struct CoverValidator<'m> {
    checker: ValidityChecker<'m>,
    model: &'m CoverModel,
    obstacles: &'m CoverObstacles,
    robot: RobotId,
    deadline: Deadline,
    max_states: u64,
    /// Number of blocks before the present query.
    blocks_before: u64,
    /// Number of questions whether the search must end.
    questions: u64,
    /// Whether the time was over when the clock was last read.
    is_over: bool,
    pairs: Vec<NotCertain>,
}

impl<'m> CoverValidator<'m> {
    pub fn new(model: &'m CoverModel, obstacles: &'m CoverObstacles, robot: RobotId) -> Self {
        let checker = obstacles.checker(model);
        let (deadline, pairs) = (Deadline::new(Instant::now(), Interrupt::default()), Vec::new());
        Self {
            checker,
            model,
            obstacles,
            robot,
            deadline,
            max_states: 0,
            blocks_before: 0,
            questions: 0,
            is_over: false,
            pairs,
        }
    }

    /// Begins a query.
    pub fn begin(&mut self, deadline: Deadline, max_states: u64) {
        self.extend_deadline(deadline);
        self.max_states = max_states;
        self.blocks_before = self.checker.blocks();
    }

    /// Continues a query until another time.
    pub fn extend_deadline(&mut self, deadline: Deadline) {
        self.deadline = deadline;
        self.is_over = false;
    }

    /// Whether it is proven that no path within the ranges joins two configurations. Does not count the tests of the
    /// proof.
    pub fn are_disconnected(
        &mut self,
        ranges: &[JointRange],
        ends: [&[f64]; 2],
        projection: &Projection,
        deadline: &Deadline,
    ) -> bool {
        let before = self.checker.blocks();
        let answer = are_disconnected(&mut self.checker, ranges, ends, projection, deadline);
        self.blocks_before += self.checker.blocks() - before;
        answer
    }

    /// Number of configurations tested in this query.
    pub fn states_checked(&self) -> u64 {
        BLOCK * (self.checker.blocks() - self.blocks_before)
    }

    /// The error that no path was found within the limits.
    pub fn not_found(&self, after: Duration, nodes: usize) -> RrtConnectError {
        let states_checked = self.states_checked();
        RrtConnectError::NotFound { seconds: after.as_secs_f64(), states_checked, nodes, nearer: Vec::new() }
    }

    /// The validity of a configuration according to the covers.
    pub fn state(&mut self, q: &[f64]) -> Validity {
        self.checker.state(q).unwrap_or(Validity::Uncertain)
    }

    /// Whether an edge is proven free; pairs that the covers leave open are swept exactly.
    pub fn is_free_exactly(
        &mut self,
        exact: &mut SceneValidator,
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

impl MotionValidator for CoverValidator<'_> {
    fn motion_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.checker.edge_is_free(from, to).unwrap_or(false)
    }

    fn motions_at_once(&self) -> usize {
        EDGES_AT_ONCE
    }

    fn failing_motions(&mut self, motions: &[(&[f64], &[f64])]) -> u32 {
        self.checker.edges_in_obstacles(motions).unwrap_or(0)
    }

    fn is_exhausted(&mut self) -> bool {
        self.questions += 1;
        self.is_over |= self.questions.is_multiple_of(QUESTIONS_PER_CLOCK_READING) && self.deadline.is_over();
        self.is_over || self.states_checked() > self.max_states
    }

    fn longest_edge(&self) -> f64 {
        EDGE_LENGTH
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_scene::{SceneState, example};

    use super::*;

    #[test]
    fn a_search_that_is_over_stays_over_until_it_gets_more_time() {
        let (scene, robot) = (example::two_arms(), RobotId(0));
        let start = SceneState::new(&scene);
        let model = CoverModel::new(&scene, &start, robot, 0.0).unwrap();
        let obstacles = CoverObstacles::new(&model, &scene, &start, 0.0);
        let mut validator = CoverValidator::new(&model, &obstacles, robot);
        let interrupt = Interrupt::default();
        let later = Deadline::new(Instant::now() + Duration::from_hours(1), interrupt.clone());
        validator.begin(later.clone(), u64::MAX);
        assert!((0..100).all(|_| !validator.is_exhausted()));
        interrupt.set();
        assert!((0..QUESTIONS_PER_CLOCK_READING).any(|_| validator.is_exhausted()));
        assert!((0..100).all(|_| validator.is_exhausted()));
        validator.extend_deadline(Deadline::new(Instant::now() + Duration::from_hours(1), Interrupt::default()));
        assert!((0..100).all(|_| !validator.is_exhausted()));
    }
}
