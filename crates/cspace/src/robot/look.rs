//! One piece and one target: apart by so much, or not proven to be.

use elbowroom_proximity::mesh::{Hint, Scratch, farther, promising};
use elbowroom_proximity::{Shape, separation_within};
use elbowroom_spatial::Pose;

use super::target::Target;

/// What a look at a pair says.
#[derive(Debug, Clone, Copy)]
pub(super) enum Look {
    /// Certainly farther apart than was asked.
    Apart,
    /// Not proven to be: about so far apart (metres).
    Near { gap: f64 },
}

/// Whether a piece is farther from a target than `far` metres. Meshes are asked what is cheapest first: a pair of triangles
/// that are near enough ends it.
pub(super) fn look(
    scratch: &mut Scratch,
    (shape, in_world): (&Shape, &Pose),
    target: &Target,
    far: f64,
    hint: &mut Hint,
) -> Look {
    let (Shape::Mesh(a), Shape::Mesh(b)) = (shape, &target.shape) else {
        return match separation_within(shape, in_world, &target.shape, &target.in_world, far) {
            Some(s) if s.lower_bound <= far => Look::Near { gap: s.distance },
            _ => Look::Apart,
        };
    };
    let Some(near) = promising(a, in_world, b, &target.in_world, Some(*hint), scratch) else {
        return Look::Near { gap: 0.0 };
    };
    *hint = near.hint;
    if near.distance <= far {
        return Look::Near { gap: near.distance };
    }
    if farther(a, in_world, b, &target.in_world, far, scratch) {
        return Look::Apart;
    }
    // Some other triangles are near, or one is inside the other.
    Look::Near { gap: far }
}
