//! A cylinder about a joint's axis that encloses the geometry turned by the joint.

use std::sync::LazyLock;

use elbowroom_spatial::{Pose, Vec3};

use crate::cover::Ball;

/// Number of measured points of a circle. The largest distance may lie between two of them.
const CIRCLE_POINTS: u32 = 64;
/// The angle between two adjacent points, rad.
const CIRCLE_STEP: f64 = std::f64::consts::TAU / CIRCLE_POINTS as f64;
/// Cosine and sine of each point.
static CIRCLE: LazyLock<[[f64; 2]; CIRCLE_POINTS as usize]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let (sin, cos) = (i as f64 * CIRCLE_STEP).sin_cos();
        [cos, sin]
    })
});

/// A cylinder about the z axis of a joint's frame.
#[derive(Debug, Clone, Copy)]
pub struct AxisCylinder {
    /// Radius, m.
    pub radius: f64,
    low: f64,
    high: f64,
}

impl AxisCylinder {
    /// The cylinder about z that encloses balls.
    pub fn around(balls: impl Iterator<Item = Ball>) -> Self {
        let none = Self { radius: 0.0, low: f64::INFINITY, high: f64::NEG_INFINITY };
        balls.fold(none, |c, b| Self {
            radius: c.radius.max(b.centre.x.hypot(b.centre.y) + b.radius),
            low: c.low.min(b.centre.z - b.radius),
            high: c.high.max(b.centre.z + b.radius),
        })
    }

    /// The cylinder around all positions of a slide along the axis.
    #[must_use]
    pub fn slid(self, lower: f64, upper: f64) -> Self {
        Self { low: self.low + lower.min(0.0), high: self.high + upper.max(0.0), ..self }
    }

    /// A cylinder about another z axis that encloses this one; `pose` is the pose of this cylinder in the other frame.
    #[must_use]
    pub fn seen_from(self, pose: &Pose) -> Self {
        let axis = pose.rotation.z_axis();
        let ends = [self.low, self.high].map(|z| pose.translation + axis * z);
        let along = self.radius * (1.0 - axis.z * axis.z).max(0.0).sqrt();
        let radius = ends.into_iter().map(|end| self.farthest_from_axis(pose, end)).fold(0.0, f64::max);
        let (low, high) = (ends[0].z.min(ends[1].z) - along, ends[0].z.max(ends[1].z) + along);
        Self { radius, low, high }
    }

    /// Largest distance of a circle about this axis from the other axis, m.
    fn farthest_from_axis(self, pose: &Pose, centre: Vec3) -> f64 {
        if self.radius == 0.0 {
            return centre.x.hypot(centre.y);
        }
        // `max` would drop a NaN, and the bound with it.
        if !centre.is_finite() {
            return f64::INFINITY;
        }
        let (x, y) = (pose.rotation.x_axis() * self.radius, pose.rotation.y_axis() * self.radius);
        let squared = |&[cos, sin]: &[f64; 2]| {
            let p = centre + x * cos + y * sin;
            p.x * p.x + p.y * p.y
        };
        // Largest distance of the circle from the chord between two points.
        let between = self.radius * (1.0 - (0.5 * CIRCLE_STEP).cos());
        CIRCLE.iter().map(squared).fold(0.0, f64::max).sqrt() + between
    }
}
