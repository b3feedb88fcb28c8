//! Any two shapes, with memory of what was near.

use elbowroom_spatial::Pose;

use super::nearest::{Hint, distance_at, farther, guess};
use super::scratch::Scratch;
use super::touch::collide;
use crate::{Separation, Shape, separation_within};

impl Scratch {
    /// Like [`collides`](crate::collides).
    pub fn collides(&mut self, a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
        match (a, b) {
            (Shape::Mesh(a), Shape::Mesh(b)) => collide(a, a_in_world, b, b_in_world, self).is_some(),
            _ => crate::collides(a, a_in_world, b, b_in_world),
        }
    }

    /// Like [`within`](crate::within()).
    pub fn within(&mut self, a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose, tolerance: f64) -> bool {
        match (a, b) {
            (Shape::Mesh(a), Shape::Mesh(b)) => !farther(a, a_in_world, b, b_in_world, tolerance, self),
            _ => crate::within(a, a_in_world, b, b_in_world, tolerance),
        }
    }

    /// Like [`separation_within`]; `hint` carries what was nearest from one call to the next for the same two shapes
    /// and changes the time only.
    pub fn separation(
        &mut self,
        a: &Shape,
        a_in_world: &Pose,
        b: &Shape,
        b_in_world: &Pose,
        limit: f64,
        hint: &mut Hint,
    ) -> Option<Separation> {
        match (a, b) {
            (Shape::Mesh(a), Shape::Mesh(b)) => {
                let found = distance_at(a, a_in_world, b, b_in_world, limit, Some(*hint), self)?;
                *hint = found.hint;
                let (on_a, on_b) = (found.on_a, found.on_b);
                Some(Separation { distance: found.distance, lower_bound: found.lower_bound, on_a, on_b })
            }
            _ => separation_within(a, a_in_world, b, b_in_world, limit),
        }
    }

    /// An upper bound of the distance of two meshes, metres, for little ([`guess`]); `None` where one is no mesh or a
    /// pose is not finite. `hint` as in [`separation`](Self::separation).
    pub fn guess(
        &mut self,
        a: &Shape,
        a_in_world: &Pose,
        b: &Shape,
        b_in_world: &Pose,
        hint: &mut Hint,
    ) -> Option<f64> {
        let (Shape::Mesh(a), Shape::Mesh(b)) = (a, b) else { return None };
        let (metres, found) = guess(a, a_in_world, b, b_in_world, Some(*hint), self);
        if metres < f64::INFINITY {
            *hint = found;
            return Some(metres);
        }
        None
    }
}
