//! Validity of edges by the covers, within the constraint of the exact planner.

use super::edge_validator::{CoverValidator, EdgeValidator};
use crate::rrt_connect::{ConstraintChecker, RrtConnect};

/// Proves edges by the covers, within the constraint of the exact planner.
pub(super) struct EdgeSearch<'p, 'm> {
    pub exact: &'p mut RrtConnect<'m>,
    pub covers: &'p mut CoverValidator<'m>,
}

impl EdgeValidator for EdgeSearch<'_, '_> {
    fn edge_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.covers.edge_is_free(from, to) && self.exact.validator.constraint_allows(from, to)
    }

    fn is_exhausted(&mut self) -> bool {
        self.covers.is_exhausted()
    }

    fn longest_edge(&self) -> f64 {
        let of_constraint = self.exact.validator.constraint.as_ref().and_then(ConstraintChecker::projected_edge_length);
        of_constraint.unwrap_or_else(|| self.covers.longest_edge())
    }

    fn project(&mut self, q: &mut [f64]) -> bool {
        let is_projected = self.exact.validator.constraint.as_mut().is_none_or(|constraint| constraint.project(q));
        is_projected && self.exact.bounds.contains(q)
    }
}
