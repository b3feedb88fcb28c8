//! One slice, copied: the paper's fastest model (S2, section III).
//!
//! An obstacle within base angles, radii and heights is a rectangle in every plane that meets it. A point of the arm's
//! plane that is within a radius of the obstacle is within that radius of the rectangle too, so one plane serves for all.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::bounds;
use crate::obstacle::Solid;
use crate::{Axis, Filler, Layer, Obstacle, Span};

/// Base angles, radii and heights that hold an obstacle, metres and radians.
struct Sector {
    middle: f64,
    /// Half the angle; at least π where the obstacle is over the base axis.
    half: f64,
    near: f64,
    far: f64,
    low: f64,
    high: f64,
}

pub(super) fn fill(filler: &mut Filler, obstacle: &Obstacle, layer: &mut Layer) {
    layer.spans.clear();
    let arm = *filler.arm();
    let thickest = arm.upper_radius_m.max(arm.fore_radius_m).max(arm.wrist_radius_m);
    let sector = Sector::around(obstacle);
    let half = if sector.near > thickest { sector.half + (thickest / sector.near).asin() } else { PI };
    let [base, shoulder, _] = filler.grid().axes().clone();
    let mut slice = Layer::new();
    for behind in [false, true] {
        let side = if behind { -1.0 } else { 1.0 };
        let rectangle = sector.in_plane(base.center(0), side);
        filler.fill_planes(&rectangle, 0..1, &mut slice);
        let middle = if behind { sector.middle + PI } else { sector.middle };
        for plane in planes(&base, middle, half) {
            let first = (plane * shoulder.count()) as u32;
            layer.spans.extend(slice.spans.iter().map(|&span| Span { row: span.row + first, ..span }));
        }
    }
    layer.spans.sort_unstable();
    layer.spans.dedup();
}

/// Cells of θ1 within bounds of an angle.
fn planes(base: &Axis, middle: f64, half: f64) -> impl Iterator<Item = usize> + '_ {
    let reach = half + base.step() * 0.5 + 1e-9;
    (0..base.count()).filter(move |&cell| {
        let off = base.center(cell) - middle;
        (off - TAU * (off / TAU).round()).abs() <= reach
    })
}

impl Sector {
    fn around(obstacle: &Obstacle) -> Self {
        let (min, max) = bounds(obstacle);
        let (center, radius) = obstacle.enclosing_sphere();
        let middle = center.y.atan2(center.x);
        let radial = Vec3::new(middle.cos(), middle.sin(), 0.0);
        let (mut near, mut far, mut half) = match obstacle.solid {
            Solid::Sphere { .. } => (center.dot(radial) - radius, center.dot(radial) + radius, 0.0f64),
            _ => (f64::INFINITY, 0.0, 0.0f64),
        };
        if matches!(obstacle.solid, Solid::Sphere { .. }) {
            half = if near > 0.0 { (radius / center.dot(radial)).min(1.0).asin() } else { PI };
        } else {
            for corner in obstacle.corners() {
                let across = corner.x * -middle.sin() + corner.y * middle.cos();
                let along = corner.dot(radial);
                // The solid is beyond the line through its nearest corner square to the middle.
                near = near.min(along);
                far = far.max(along.hypot(across));
                half = half.max(across.abs().atan2(along));
            }
            if half >= FRAC_PI_2 || near <= 0.0 {
                half = PI;
            }
        }
        Self { middle, half, near: near.max(0.0), far, low: min.z, high: max.z }
    }

    /// The rectangle of radii and heights in the plane of an angle, ahead or behind.
    fn in_plane(&self, angle: f64, side: f64) -> Obstacle {
        let at = (self.near + self.far) * 0.5 * side;
        let middle = Vec3::new(at * angle.cos(), at * angle.sin(), (self.low + self.high) * 0.5);
        let in_base = Pose::new(Rotation::from_axis_angle(Vec3::Z, angle), middle);
        let half_extents = Vec3::new((self.far - self.near) * 0.5, 0.0, (self.high - self.low) * 0.5);
        Obstacle { solid: Solid::Cuboid { in_base, half_extents } }
    }
}
