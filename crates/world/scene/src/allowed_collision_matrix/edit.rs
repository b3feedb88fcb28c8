//! Manual changes of single pairs.

use elbowroom_robot::GeometryId;

use super::entry::{PairNumber, PairState};
use super::matrix::AllowedCollisionMatrix;
use super::reason::Reason;
use crate::{MatrixError, Scene};

/// A change of one pair.
#[derive(Debug, Clone, PartialEq)]
pub enum PairEdit {
    /// Skips the pair, with the reason.
    Skip(String),
    /// Tests the pair, with the reason.
    Test(String),
    /// Sets the security margin in metres, which replaces the sum of the paddings.
    Margin(f64),
    /// Sets the weight (dimensionless).
    Weight(f64),
}

impl AllowedCollisionMatrix {
    /// Changes one pair by hand.
    ///
    /// `scene` supplies the names for errors. An edit of a pair of objects applies while one of them is attached to a
    /// robot, and in queries that name both objects.
    ///
    /// # Errors
    /// [`MatrixError`] if the matrix has no such pair or the number is invalid.
    pub fn edit(&mut self, scene: &Scene, a: GeometryId, b: GeometryId, edit: PairEdit) -> Result<(), MatrixError> {
        let no_such_pair = || MatrixError::NoSuchPair { a: scene.name(a), b: scene.name(b) };
        if !(scene.has_shape(a) && scene.has_shape(b)) {
            return Err(no_such_pair());
        }
        let paddings_m = scene.padding_m(a) + scene.padding_m(b);
        let entry = self.entry_mut(a, b, paddings_m).ok_or_else(no_such_pair)?;
        let check = |what, value: f64| {
            if value >= 0.0 && value.is_finite() {
                return Ok(value);
            }
            Err(MatrixError::Number { a: scene.name(a), b: scene.name(b), what, value })
        };
        match edit {
            PairEdit::Skip(note) => (entry.state, entry.reason) = (PairState::Skipped, Reason::ByHand(note)),
            PairEdit::Test(note) => (entry.state, entry.reason) = (PairState::Tested, Reason::ByHand(note)),
            PairEdit::Weight(weight) => entry.weight = check(PairNumber::Weight, weight)?,
            PairEdit::Margin(margin_m) => {
                entry.margin_m = check(PairNumber::Margin, margin_m)?;
                // The geometries are out of reach of each other, but may come within the margin.
                if matches!(entry.reason, Reason::OutOfReach { least_m } if least_m <= entry.margin_m) {
                    (entry.state, entry.reason) = (PairState::Tested, Reason::Default);
                }
            }
        }
        Ok(())
    }
}
