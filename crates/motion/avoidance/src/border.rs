//! The border of a constraint near the robot, such as a closed region, linearized in the joints.

use elbowroom_planner::PathConstraint;

/// Step of the central differences, rad or m.
const STEP: f64 = 1e-4;

/// The margin to the nearest border and its gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Border<'a> {
    /// Distance to the border minus the required distance, m; negative if the robot is nearer.
    pub margin_m: f64,
    /// Gradient of the margin, m per rad (or m) of each joint.
    pub gradient: &'a [f64],
}

/// Linearizes constraints.
#[derive(Debug)]
pub(crate) struct BorderQuery {
    q: Vec<f64>,
    gradient: Vec<f64>,
}

impl BorderQuery {
    pub(crate) fn new(joints: usize) -> Self {
        Self { q: vec![0.0; joints], gradient: vec![0.0; joints] }
    }

    /// The border at `q`; `None` if it is farther than `reach_m` or its distance is NaN.
    pub(crate) fn near(&mut self, constraint: &mut dyn PathConstraint, q: &[f64], reach_m: f64) -> Option<Border<'_>> {
        let margin_m = constraint.margin_m(q, reach_m);
        if !(margin_m <= reach_m) {
            return None;
        }
        self.q.copy_from_slice(q);
        // Beyond the range the constraint may return any greater number, but the differences need the distance itself.
        let range_m = 2.0 * reach_m + 1.0;
        for j in 0..q.len() {
            let mut at = |offset: f64| {
                self.q[j] = q[j] + offset;
                constraint.margin_m(&self.q, range_m)
            };
            let slope = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            self.gradient[j] = if slope.is_finite() { slope } else { 0.0 };
            self.q[j] = q[j];
        }
        Some(Border { margin_m, gradient: &self.gradient })
    }
}
