//! Bounding capsule.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::margin::{MARGIN, scale};
use super::{bounding_sphere, principal_axes};
use crate::Capsule;

/// Fits a capsule; the search starts at the principal axes.
pub(super) fn fit(points: &[Vec3], principal: Rotation) -> Option<(Capsule, Pose)> {
    let starts = [
        principal,
        principal * Rotation::from_axis_angle(Vec3::X, std::f64::consts::FRAC_PI_2),
        principal * Rotation::from_axis_angle(Vec3::Y, std::f64::consts::FRAC_PI_2),
    ];
    let mut projection = Projection::default();
    let mut volume = |rotation| {
        projection.project(points, rotation);
        projection.capsule(1.0).0.volume()
    };
    let rotated = starts.map(|s| principal_axes::descend(s, &[Vec3::X, Vec3::Y], &mut volume));
    let (_, rotation) = rotated.into_iter().min_by(|x, y| x.0.total_cmp(&y.0))?;
    projection.project(points, rotation);
    Some(verified(points, projection.smallest_capsule()))
}

/// Points projected along the z axis of a frame, and the smallest circle around them.
#[derive(Debug, Default)]
struct Projection {
    rotation: Rotation,
    /// The points in the frame, at height 0.
    flat: Vec<Vec3>,
    heights: Vec<f64>,
    center: Vec3,
    radius: f64,
}

impl Projection {
    /// Projects along the z axis of another frame; the memory is reused.
    fn project(&mut self, points: &[Vec3], rotation: Rotation) {
        self.rotation = rotation;
        self.flat.clear();
        self.heights.clear();
        for &p in points {
            let local = rotation.inverse_rotate(p);
            self.flat.push(Vec3::new(local.x, local.y, 0.0));
            self.heights.push(local.z);
        }
        (self.center, self.radius) = bounding_sphere::smallest(&self.flat);
    }

    /// The capsule along the axis with `widening` times the radius of the circle.
    fn capsule(&self, widening: f64) -> (Capsule, Pose) {
        let radius = self.radius * widening;
        // The axis is long enough for a cap to cover each point.
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (p, &z) in self.flat.iter().zip(&self.heights) {
            let cover = (radius * radius - (*p - self.center).length_squared()).max(0.0).sqrt();
            low = low.min(z + cover);
            high = high.max(z - cover);
        }
        let half_length = (0.5 * (high - low)).max(0.0);
        let middle = self.center + Vec3::Z * (0.5 * (high + low));
        (Capsule { half_length, radius }, Pose::new(self.rotation, self.rotation * middle))
    }

    /// The best widened capsule, by golden-section search: a wider capsule may be so much shorter that its volume is
    /// smaller.
    fn smallest_capsule(&self) -> (Capsule, Pose) {
        let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut lo, mut hi) = (1.0, 1.8);
        for _ in 0..24 {
            let (x, y) = (hi - ratio * (hi - lo), lo + ratio * (hi - lo));
            if self.capsule(x).0.volume() < self.capsule(y).0.volume() {
                hi = y;
            } else {
                lo = x;
            }
        }
        let (narrow, wide) = (self.capsule(1.0), self.capsule(0.5 * (lo + hi)));
        if wide.0.volume() < narrow.0.volume() { wide } else { narrow }
    }
}

fn verified(points: &[Vec3], (mut capsule, pose): (Capsule, Pose)) -> (Capsule, Pose) {
    let reach = points.iter().fold(capsule.radius, |r: f64, &p| {
        let q = pose.inverse_transform_point(p);
        r.max(q.distance(capsule.axis_point(q)))
    });
    capsule.radius = reach + MARGIN * scale(points);
    (capsule, pose)
}
