//! Bounding capsule.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::margin::{MARGIN, scale};
use super::{bounding_sphere, principal_axes};
use crate::Capsule;

pub(super) fn fit(points: &[Vec3]) -> Option<(Capsule, Pose)> {
    let principal = principal_axes::principal(points);
    let starts = [
        principal,
        principal * Rotation::from_axis_angle(Vec3::X, std::f64::consts::FRAC_PI_2),
        principal * Rotation::from_axis_angle(Vec3::Y, std::f64::consts::FRAC_PI_2),
    ];
    let rotated = starts.map(|s| principal_axes::descend(s, &[Vec3::X, Vec3::Y], |r| along(points, r, 1.0).0.volume()));
    let (_, rotation) = rotated.into_iter().min_by(|x, y| x.0.total_cmp(&y.0))?;
    let best = widened(points, rotation);
    Some(verified(points, best))
}

/// The capsule along the frame's z axis with `widening` times the radius of the points projected along the axis.
fn along(points: &[Vec3], rotation: Rotation, widening: f64) -> (Capsule, Pose) {
    let local: Vec<Vec3> = points.iter().map(|&p| rotation.inverse_rotate(p)).collect();
    let projected: Vec<Vec3> = local.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
    let (center, least_radius) = bounding_sphere::smallest(&projected);
    let radius = least_radius * widening;
    // The axis is long enough for a cap to cover each point.
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (p, s) in local.iter().zip(&projected) {
        let cover = (radius * radius - (*s - center).length_squared()).max(0.0).sqrt();
        low = low.min(p.z + cover);
        high = high.max(p.z - cover);
    }
    let half_length = (0.5 * (high - low)).max(0.0);
    let middle = center + Vec3::Z * (0.5 * (high + low));
    (Capsule { half_length, radius }, Pose::new(rotation, rotation * middle))
}

/// The best widened capsule, by golden-section search: a wider capsule may be so much shorter that its volume is
/// smaller.
fn widened(points: &[Vec3], rotation: Rotation) -> (Capsule, Pose) {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut lo, mut hi) = (1.0, 1.8);
    for _ in 0..24 {
        let (x, y) = (hi - ratio * (hi - lo), lo + ratio * (hi - lo));
        if along(points, rotation, x).0.volume() < along(points, rotation, y).0.volume() {
            hi = y;
        } else {
            lo = x;
        }
    }
    let (narrow, wide) = (along(points, rotation, 1.0), along(points, rotation, 0.5 * (lo + hi)));
    if wide.0.volume() < narrow.0.volume() { wide } else { narrow }
}

fn verified(points: &[Vec3], (mut capsule, pose): (Capsule, Pose)) -> (Capsule, Pose) {
    let reach = points.iter().fold(capsule.radius, |r: f64, &p| {
        let q = pose.inverse_transform_point(p);
        r.max(q.distance(capsule.axis_point(q)))
    });
    capsule.radius = reach + MARGIN * scale(points);
    (capsule, pose)
}
