//! Motion validator on sphere covers, within the limits and the constraint of the exact planner.

use super::cover_validator::CoverValidator;
use crate::rrt_connect::{MotionValidator, RrtConnect};

/// Proves motions by the covers, within the limits and the constraint of the exact planner.
pub(super) struct ConstrainedValidator<'p, 'm> {
    pub exact: &'p mut RrtConnect<'m>,
    pub covers: &'p mut CoverValidator<'m>,
}

impl MotionValidator for ConstrainedValidator<'_, '_> {
    fn motion_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.covers.motion_is_free(from, to) && self.exact.validator.constraint_allows(from, to)
    }

    fn motions_at_once(&self) -> usize {
        self.covers.motions_at_once()
    }

    fn failing_motions(&mut self, motions: &[(&[f64], &[f64])]) -> u32 {
        self.covers.failing_motions(motions)
    }

    fn is_exhausted(&mut self) -> bool {
        self.covers.is_exhausted()
    }

    fn longest_edge(&self) -> f64 {
        self.exact.validator.projected_edge_length().unwrap_or_else(|| self.covers.longest_edge())
    }

    fn project(&mut self, q: &mut [f64]) -> bool {
        self.exact.validator.project(q)
    }
}
