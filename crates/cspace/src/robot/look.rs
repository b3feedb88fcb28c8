//! One piece and one target: apart by so much, or not proven to be.

use elbowroom_proximity::mesh::{Hint, Scratch, farther, guess};
use elbowroom_proximity::{Shape, separation_within};
use elbowroom_spatial::Pose;

use super::target::Target;

/// `None` where a piece is certainly farther from a target than `far` metres, else about how far it is. Meshes are asked what is
/// cheapest first: a pair of triangles that are near enough ends it.
pub(super) fn look(
    scratch: &mut Scratch,
    (shape, in_world): (&Shape, &Pose),
    target: &Target,
    far: f64,
    hint: &mut Hint,
) -> Option<f64> {
    let (Shape::Mesh(a), Shape::Mesh(b)) = (shape, &target.shape) else {
        let found = separation_within(shape, in_world, &target.shape, &target.in_world, far);
        return found.filter(|s| s.lower_bound <= far).map(|s| s.distance);
    };
    let (metres, found) = guess(a, in_world, b, &target.in_world, Some(*hint), scratch);
    *hint = found;
    if metres <= far {
        return Some(metres);
    }
    // Where it is not, some other triangles are near, or one is inside the other.
    (!farther(a, in_world, b, &target.in_world, far, scratch)).then_some(far)
}
