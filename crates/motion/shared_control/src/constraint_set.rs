//! Constraints of one step, in fixed memory.

use elbowroom_spatial::Vec3;

use crate::{LinearConstraint, project_onto_constraints};

/// Number of constraints kept. A tool touches a surface of any fineness with three; more serve smoothness alone.
const CAPACITY: usize = 64;
/// Cosine from which two normals count as one.
const SAME_DIRECTION: f64 = 1.0 - 1e-9;

/// Up to 64 constraints without doubles. If there are more, the loosest are left out: the step is proven afterwards.
#[derive(Debug, Clone)]
pub(crate) struct ConstraintSet {
    all: [LinearConstraint; CAPACITY],
    len: usize,
}

impl ConstraintSet {
    pub const EMPTY: Self =
        Self { all: [LinearConstraint { normal: Vec3::ZERO, least: f64::NEG_INFINITY }; CAPACITY], len: 0 };

    pub fn clear(&mut self) {
        self.len = 0;
    }

    pub fn as_slice(&self) -> &[LinearConstraint] {
        &self.all[..self.len]
    }

    /// Adds a constraint. Of two with the same normal the tighter is kept.
    pub fn push(&mut self, added: LinearConstraint) {
        let all = &mut self.all[..self.len];
        if let Some(same) = all.iter_mut().find(|c| c.normal.dot(added.normal) > SAME_DIRECTION) {
            if added.least > same.least {
                *same = added;
            }
        } else if self.len < CAPACITY {
            self.all[self.len] = added;
            self.len += 1;
        } else if let Some(loosest) = all.iter_mut().min_by(|a, b| a.least.total_cmp(&b.least))
            && loosest.least < added.least
        {
            *loosest = added;
        }
    }

    /// The admissible vector nearest to the wanted one, and the number of constraints that decide it.
    pub fn nearest_to(&mut self, wanted: Vec3) -> (Vec3, usize) {
        project_onto_constraints(wanted, self.as_slice())
            .or_else(|_| {
                // Two walls that both ask for more distance: neither gets it.
                self.allow_rest();
                project_onto_constraints(wanted, self.as_slice())
            })
            .unwrap_or((Vec3::ZERO, self.len))
    }

    /// Lets every constraint accept rest.
    fn allow_rest(&mut self) {
        for constraint in &mut self.all[..self.len] {
            constraint.least = constraint.least.min(0.0);
        }
    }
}
