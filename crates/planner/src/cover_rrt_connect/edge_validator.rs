//! Validity of edges: by the covers, and by the exact scene where they are not certain.

use std::time::Instant;

use elbowroom_robot::RobotId;
use elbowroom_scene::{SweepMove, SweepOptions};
use elbowroom_validity::{NotCertain, Validity, ValidityChecker};

use super::cover_model::{CoverModel, CoverObstacles};
use crate::rrt_connect::MotionValidator;

/// What a tree search asks.
pub(super) trait EdgeValidator {
    /// True where the straight segment between two configurations is proven free.
    fn edge_is_free(&mut self, from: &[f64], to: &[f64]) -> bool;
    /// True where the search must end.
    fn is_exhausted(&mut self) -> bool;
}

/// Proves edges by the covers; on request by the exact scene, for the pairs that the covers leave open.
pub(super) struct CoverValidator<'m> {
    pub checker: ValidityChecker<'m>,
    pub exact: MotionValidator<'m>,
    pub model: &'m CoverModel,
    pub obstacles: &'m CoverObstacles,
    pub robot: RobotId,
    pub deadline: Instant,
    pub max_edges: u64,
    pub edges: u64,
    pairs: Vec<NotCertain>,
}

impl<'m> CoverValidator<'m> {
    pub fn new(model: &'m CoverModel, obstacles: &'m CoverObstacles, exact: MotionValidator<'m>, robot: RobotId) -> Self {
        let checker = obstacles.checker(model);
        Self { checker, exact, model, obstacles, robot, deadline: Instant::now(), max_edges: 0, edges: 0, pairs: Vec::new() }
    }

    /// What the covers say of a configuration.
    pub fn state(&mut self, q: &[f64]) -> Validity {
        self.checker.state(q).unwrap_or(Validity::Uncertain)
    }

    /// True where an edge is free: the pairs that the covers leave open are swept exactly.
    pub fn is_free_exactly(&mut self, from: &[f64], to: &[f64], sweep: &SweepOptions) -> bool {
        let mut pairs = std::mem::take(&mut self.pairs);
        let known = self.checker.uncertain_pairs(from, to, &mut pairs).is_ok();
        let is_free = known && pairs.iter().all(|&pair| self.pair_is_free(pair, from, to, sweep));
        self.pairs = pairs;
        is_free && self.exact.constraint_allows(from, to)
    }

    fn pair_is_free(&mut self, pair: NotCertain, from: &[f64], to: &[f64], sweep: &SweepOptions) -> bool {
        let (a, b) = self.obstacles.pair(self.model, pair);
        self.exact.pair_sweep_is_free(a, b, from, SweepMove::Robot { robot: self.robot, to }, sweep)
    }
}

impl EdgeValidator for CoverValidator<'_> {
    fn edge_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.edges += 1;
        self.checker.edge_is_free(from, to).unwrap_or(false) && self.exact.constraint_allows(from, to)
    }

    fn is_exhausted(&mut self) -> bool {
        // Reading the clock costs as much as a short edge.
        self.edges > self.max_edges || (self.edges % 16 == 0 && Instant::now() >= self.deadline)
    }
}
