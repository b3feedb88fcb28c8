//! One slice, copied to a range of planes: the fastest model of the joint-space paper (section III).
//!
//! A rectangle encloses an obstacle within bounds of base angle, radius and height in every plane that intersects it.
//! If a point of the arm's plane is within a distance of the obstacle, it is also within this distance of the
//! rectangle, so the spans of one plane hold for all planes.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::convex_obstacle::ConvexShape;
use crate::{ConvexObstacle, Layer, PlanarMapBuilder, RowSpan};

/// Bounds of base angle, radius and height of an obstacle, metres and radians.
struct CylindricalBounds {
    middle: f64,
    /// Half of the angle; at least π if the obstacle intersects the base axis.
    half: f64,
    near: f64,
    far: f64,
    low: f64,
    high: f64,
}

pub(super) fn build_layer(builder: &mut PlanarMapBuilder, obstacle: &ConvexObstacle, layer: &mut Layer) {
    layer.spans.clear();
    let radius = builder.arm().max_radius_m();
    let bounds = CylindricalBounds::new(obstacle);
    let half = if bounds.near > radius { bounds.half + (radius / bounds.near).asin() } else { PI };
    let angle = builder.grid().axes()[0].center(0);
    // In front of the base axis, and behind it for an arm that is bent backwards.
    let mut slices = [Layer::new(), Layer::new()];
    for (slice, side) in slices.iter_mut().zip([1.0, -1.0]) {
        let (in_base, half_extents) = bounds.in_plane(angle, side);
        builder.build_slice(&in_base, half_extents, slice);
    }
    let [base, shoulder, _] = builder.grid().axes();
    let reach = half + base.step() * 0.5 + 1e-9;
    for plane in 0..base.count() {
        let first = (plane * shoulder.count()) as u32;
        let before = layer.spans.len();
        for (slice, middle) in slices.iter().zip([bounds.middle, bounds.middle + PI]) {
            let off = base.center(plane) - middle;
            if (off - TAU * (off / TAU).round()).abs() > reach || slice.spans.is_empty() {
                continue;
            }
            let is_second = layer.spans.len() > before;
            layer.spans.extend(slice.spans.iter().map(|&span| RowSpan { row: span.row + first, ..span }));
            if is_second {
                layer.spans[before..].sort_unstable();
            }
        }
    }
}

impl CylindricalBounds {
    fn new(obstacle: &ConvexObstacle) -> Self {
        let bounds = obstacle.bounds();
        let (center, radius) = obstacle.enclosing_sphere();
        let middle = center.y.atan2(center.x);
        let radial = Vec3::new(middle.cos(), middle.sin(), 0.0);
        let (mut near, mut far, mut half) = match obstacle.solid {
            ConvexShape::Sphere { .. } => (center.dot(radial) - radius, center.dot(radial) + radius, 0.0f64),
            _ => (f64::INFINITY, 0.0, 0.0f64),
        };
        if matches!(obstacle.solid, ConvexShape::Sphere { .. }) {
            half = if near > 0.0 { (radius / center.dot(radial)).min(1.0).asin() } else { PI };
        } else {
            for corner in obstacle.corners() {
                let across = corner.x * -middle.sin() + corner.y * middle.cos();
                let along = corner.dot(radial);
                // The solid is beyond the line through its nearest corner perpendicular to the middle direction.
                near = near.min(along);
                far = far.max(along.hypot(across));
                half = half.max(across.abs().atan2(along));
            }
            if half >= FRAC_PI_2 || near <= 0.0 {
                half = PI;
            }
        }
        Self { middle, half, near: near.max(0.0), far, low: bounds.min.z, high: bounds.max.z }
    }

    /// The rectangle of radii and heights in the plane of an angle, in front of the base axis or behind it: a box
    /// without depth, given by its pose and half extents.
    fn in_plane(&self, angle: f64, side: f64) -> (Pose, Vec3) {
        let at = (self.near + self.far) * 0.5 * side;
        let middle = Vec3::new(at * angle.cos(), at * angle.sin(), (self.low + self.high) * 0.5);
        let half_extents = Vec3::new((self.far - self.near) * 0.5, 0.0, (self.high - self.low) * 0.5);
        (Pose::new(Rotation::from_axis_angle(Vec3::Z, angle), middle), half_extents)
    }
}
