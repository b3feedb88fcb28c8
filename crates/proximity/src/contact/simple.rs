//! Two shapes that are no meshes: the nearest points after the way out, moved back.

use elbowroom_spatial::{Pose, Vec3};

use super::{ContactPoint, nearest, surface};
use crate::{Shape, escape, separation};

/// Where two simple shapes meet, or are nearest within the limit.
pub(super) fn meet(
    (a, a_in_world): (&Shape, &Pose),
    (b, b_in_world): (&Shape, &Pose),
    limit: f64,
) -> Option<ContactPoint> {
    let Some(out) = escape(a, a_in_world, b, b_in_world) else {
        return nearest((a, a_in_world), (b, b_in_world), limit);
    };
    if !out.depth.is_finite() {
        let (on_a, on_b) = (a_in_world.translation, b_in_world.translation);
        return Some(found((a, a_in_world, on_a), (b, b_in_world, on_b), out.direction));
    }
    // A little farther than that, so that the nearest points are those of a gap and not of an overlap.
    let size = a_in_world.translation.distance(b_in_world.translation) + out.depth;
    let mut gap = 1e-9 * size.max(1e-3);
    loop {
        let step = out.direction * (out.depth + gap);
        let moved = Pose { translation: a_in_world.translation + step, ..*a_in_world };
        let apart = separation(a, &moved, b, b_in_world);
        // The way out of curved hulls is known to a ten-thousandth only.
        if apart.distance > 0.0 || gap > size + 1.0 {
            return Some(found((a, a_in_world, apart.on_a - step), (b, b_in_world, apart.on_b), out.direction));
        }
        gap *= 8.0;
    }
}

fn found(
    (a, a_in_world, on_a): (&Shape, &Pose, Vec3),
    (b, b_in_world, on_b): (&Shape, &Pose, Vec3),
    out: Vec3,
) -> ContactPoint {
    let (normal_a, normal_b) = (surface(a, a_in_world, on_a, -out).0, surface(b, b_in_world, on_b, out).0);
    ContactPoint { on_a, on_b, normal_a, normal_b, triangle_a: None, triangle_b: None, touching: true }
}
