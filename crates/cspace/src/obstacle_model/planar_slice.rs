//! One slice, copied to a range of planes: the fastest model of S2 (section III).
//!
//! An obstacle within bounds of base angle, radius and height is enclosed by a rectangle in every plane that intersects it.
//! A point of the arm's plane that is within a distance of the obstacle is within that distance of the rectangle, too, so
//! the spans of one plane hold for all.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::convex_obstacle::ConvexShape;
use crate::{ConvexObstacle, GridAxis, Layer, PlanarMapBuilder, RowSpan};

/// Bounds of base angle, radius and height of an obstacle, metres and radians.
struct CylindricalBounds {
    middle: f64,
    /// Half the angle; at least π where the obstacle intersects the base axis.
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
    let [base, shoulder, _] = builder.grid().axes().clone();
    let mut slice = Layer::new();
    for behind in [false, true] {
        let side = if behind { -1.0 } else { 1.0 };
        let rectangle = bounds.in_plane(base.center(0), side);
        builder.build_planes(&rectangle, 0..1, &mut slice);
        let middle = if behind { bounds.middle + PI } else { bounds.middle };
        for plane in planes(&base, middle, half) {
            let first = (plane * shoulder.count()) as u32;
            layer.spans.extend(slice.spans.iter().map(|&span| RowSpan { row: span.row + first, ..span }));
        }
    }
    layer.spans.sort_unstable();
    layer.spans.dedup();
}

/// Cells of θ1 within bounds of an angle.
fn planes(base: &GridAxis, middle: f64, half: f64) -> impl Iterator<Item = usize> + '_ {
    let reach = half + base.step() * 0.5 + 1e-9;
    (0..base.count()).filter(move |&cell| {
        let off = base.center(cell) - middle;
        (off - TAU * (off / TAU).round()).abs() <= reach
    })
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
                // The solid lies beyond the line through its nearest corner perpendicular to the middle direction.
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

    /// The rectangle of radii and heights in the plane of an angle, in front of the base axis or behind it.
    fn in_plane(&self, angle: f64, side: f64) -> ConvexObstacle {
        let at = (self.near + self.far) * 0.5 * side;
        let middle = Vec3::new(at * angle.cos(), at * angle.sin(), (self.low + self.high) * 0.5);
        let in_base = Pose::new(Rotation::from_axis_angle(Vec3::Z, angle), middle);
        let half_extents = Vec3::new((self.far - self.near) * 0.5, 0.0, (self.high - self.low) * 0.5);
        ConvexObstacle { solid: ConvexShape::Cuboid { in_base, half_extents } }
    }
}
