//! Continuous witness points of two convex cores with parallel, or nearly parallel, faces or edges
//! ([`witness_patch`](crate::witness_patch)).

use elbowroom_spatial::{Pose, Vec3};

use super::core::Core;
use super::gap::Gap;
use super::support_features::{bounding_sphere, for_each_face, is_corner, nearest, normal, support_feature};
use crate::Shape;
use crate::witness_patch::{
    MIN_PATCH_SIZE, PatchQuery, PatchTolerances, Polygon, SupportFeature, TIE_TOLERANCE, WitnessChoice,
    alternating_projections, anchor_between, widest_gap,
};

/// The gap with continuous witness points; unchanged if the witness points are unique.
pub(super) fn continuous_witness(a: &Core, b: &Core, a_in_b: &Pose, gap: Gap) -> Gap {
    let Some((radius_a, center_a)) = bounding_sphere(a) else { return gap };
    let Some((radius_b, center_b)) = bounding_sphere(b) else { return gap };
    let Some(toward_b) = (gap.on_b - gap.on_a).try_normalize() else { return gap };
    let tolerances = PatchTolerances::of(radius_a + radius_b);
    let toward_b_in_a = a_in_b.inverse_transform_vector(toward_b);
    // Most closest points are corners of one of the two cores: a cheap test excludes them first.
    let flatness = 2.0 * tolerances.tie / tolerances.min_size;
    if is_corner(b, -toward_b, gap.on_b, flatness * radius_b)
        || is_corner(a, toward_b_in_a, a_in_b.inverse_transform_point(gap.on_a), flatness * radius_a)
    {
        return gap;
    }
    let feature_of_a = transformed(support_feature(a, toward_b_in_a, tolerances), a_in_b);
    if !feature_of_a.may_overlap(support_feature(b, -toward_b, tolerances), tolerances) {
        return gap;
    }
    let ends = |d: Vec3| {
        let top_of_a = a_in_b.transform_point(a.support(a_in_b.inverse_transform_vector(d)));
        [top_of_a.dot(d), b.support(-d).dot(d)]
    };
    // Points that are very close give a direction with few digits; a face normal has all digits.
    let center_a = a_in_b.transform_point(center_a);
    let normal_a = normal(a, toward_b_in_a, a_in_b.inverse_transform_point(center_b));
    let normal_b = normal(b, -toward_b, center_a);
    let directions = [toward_b, a_in_b.transform_vector(normal_a), -normal_b];
    let Some(direction) = widest_gap(directions, &ends) else { return gap };
    let anchor = anchor_between(center_a, radius_a, center_b, radius_b);
    let query = PatchQuery { direction, ends: ends(direction), tolerance: tolerances.tie, anchor };
    let mut choice = WitnessChoice::new(query, tolerances, gap.on_a);
    for_each_face(a, a_in_b.inverse_transform_vector(direction), &mut |of_a| {
        let of_a = Polygon::new(of_a.iter().map(|p| a_in_b.transform_point(*p)));
        for_each_face(b, -direction, &mut |of_b| {
            if let Some(found) = choice.query.closest_points(&of_a, &Polygon::new(of_b.iter().copied())) {
                choice.note_patch(found.patch_size);
                choice.note_point(found.on_a);
                choice.offer((), found.on_a, found.on_b);
            }
        });
    });
    let Some(((), on_a, _)) = choice.chosen() else { return gap };
    let onto_a = |q: Vec3| a_in_b.transform_point(nearest(a, a_in_b.inverse_transform_point(q)));
    let (on_a, on_b) = alternating_projections(on_a, &onto_a, &|p| nearest(b, p));
    with_points(gap, on_a, on_b, tolerances.tie)
}

/// False if the closest point of `b` and a line along the unit vector `direction` is guaranteed to be unique. `to_b`
/// is the vector from the closest point of the line to that of `b`. All vectors are in the frame of `b`. Computes no
/// square root.
#[inline]
pub(super) fn is_line_ambiguous(direction: Vec3, b: &Shape, to_b: Vec3) -> bool {
    /// Squared cosine. Lines that are less parallel than this are tied over at most a few millimetres.
    const PARALLEL: f64 = 0.98;
    const SLOPE: f64 = TIE_TOLERANCE / MIN_PATCH_SIZE;
    let along = direction.dot(to_b);
    if along * along > SLOPE * SLOPE * to_b.length_squared() {
        return false;
    }
    let d = direction;
    match b {
        Shape::Capsule(_) => d.z * d.z > PARALLEL,
        Shape::Cylinder(_) => d.z * d.z > PARALLEL || to_b.x.abs().max(to_b.y.abs()) <= SLOPE * to_b.z.abs(),
        _ => {
            let (w, least) = (to_b.abs(), SLOPE * to_b.abs().max_element());
            let is_zero = |v: f64| u8::from(v <= least);
            let parallel_to_edge = (d.x * d.x).max(d.y * d.y).max(d.z * d.z) > PARALLEL;
            parallel_to_edge || is_zero(w.x) + is_zero(w.y) + is_zero(w.z) == 2
        }
    }
}

pub(super) fn transformed(feature: SupportFeature, pose: &Pose) -> SupportFeature {
    match feature {
        SupportFeature::Edge(u, width) => SupportFeature::Edge(pose.transform_vector(u), width),
        other => other,
    }
}

/// The gap with other points, unless they are farther apart than tied points: then they may result from an
/// inaccurate direction.
pub(super) fn with_points(gap: Gap, on_a: Vec3, on_b: Vec3, tie_tolerance: f64) -> Gap {
    let apart = on_a.distance(on_b);
    if apart <= gap.distance + 2.0 * tie_tolerance { Gap { apart, on_a, on_b, ..gap } } else { gap }
}
