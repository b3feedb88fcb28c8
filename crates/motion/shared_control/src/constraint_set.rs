//! Constraints of one step, in fixed memory.

use crate::LinearConstraint;

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
    pub const EMPTY: Self = Self {
        all: [LinearConstraint { normal: elbowroom_spatial::Vec3::ZERO, least: f64::NEG_INFINITY }; CAPACITY],
        len: 0,
    };

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

    /// Lets every constraint accept rest.
    pub fn allow_rest(&mut self) {
        for constraint in &mut self.all[..self.len] {
            constraint.least = constraint.least.min(0.0);
        }
    }
}
