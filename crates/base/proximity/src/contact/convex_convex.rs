//! Contact of two shapes that are not meshes: the witness points after moving one shape out of the other, moved
//! back.

use elbowroom_spatial::{Pose, Vec3};

use super::contact_point::ContactPoint;
use super::placed::PlacedShape;
use super::surface::{nearest_points, surface_at};
use crate::{penetration, separation};

/// The contact of two simple shapes, or their nearest points within the limit.
pub(super) fn convex_convex(a: PlacedShape, b: PlacedShape, limit: f64) -> Option<ContactPoint> {
    let Some(overlap) = penetration(a.shape, a.in_world, b.shape, b.in_world) else {
        return nearest_points(a, b, limit);
    };
    if !overlap.depth.is_finite() {
        return Some(contact(a, a.in_world.translation, b, b.in_world.translation, overlap.direction));
    }
    // Slightly farther than the depth, so that the nearest points belong to a gap and not to an overlap.
    let size = a.in_world.translation.distance(b.in_world.translation) + overlap.depth;
    let mut gap = 1e-9 * size.max(1e-3);
    loop {
        let step = overlap.direction * (overlap.depth + gap);
        let moved = Pose { translation: a.in_world.translation + step, ..*a.in_world };
        let apart = separation(a.shape, &moved, b.shape, b.in_world);
        // The penetration of curved hulls is accurate only to 1e-4.
        if apart.distance > 0.0 || gap > size + 1.0 {
            return Some(contact(a, apart.on_a - step, b, apart.on_b, overlap.direction));
        }
        gap *= 8.0;
    }
}

fn contact(a: PlacedShape, on_a: Vec3, b: PlacedShape, on_b: Vec3, direction: Vec3) -> ContactPoint {
    let (normal_a, normal_b) = (surface_at(a, on_a, -direction).normal, surface_at(b, on_b, direction).normal);
    ContactPoint { on_a, on_b, normal_a, normal_b, triangle_a: None, triangle_b: None, touching: true }
}
