//! Bounds of angle, radius and height about an axis: the data of an obstacle that slices use.

use std::f64::consts::{PI, TAU};

use elbowroom_proximity::{Capsule, Shape, separation};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::enclosure::Enclosure;

/// A sector of a ring about z that encloses a solid, radians and metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SectorBounds {
    /// First angle, radians.
    pub first: f64,
    /// Width of the angle, radians: a whole turn if the solid contains the axis.
    pub width: f64,
    /// Radii `near` and `far`, metres.
    pub near: f64,
    pub far: f64,
    /// Heights `low` and `high`, metres.
    pub low: f64,
    pub high: f64,
}

impl SectorBounds {
    /// Computes the bounds of a solid in a frame; `None` for an unbounded solid.
    pub fn new(shape: &Shape, in_frame: &Pose) -> Option<Self> {
        let solid = Enclosure::new(shape, *in_frame)?;
        let margin = solid.margin;
        let (mut low, mut high, mut far) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for p in &solid.points {
            (low, high, far) = (low.min(p.z - margin), high.max(p.z + margin), far.max(p.x.hypot(p.y) + margin));
        }
        // Distance from the axis within the height of the solid.
        let axis = Shape::Capsule(Capsule { half_length: 0.5 * (high - low), radius: 0.0 });
        let on_axis = Pose::new(Rotation::IDENTITY, Vec3::Z * (0.5 * (low + high)));
        let near = (separation(shape, in_frame, &axis, &on_axis).lower_bound * (1.0 - 1e-12)).max(0.0);
        let (first, width) = angle_range(&solid, near);
        Some(Self { first, width, near, far, low, high })
    }
}

/// First angle and width of the range that a solid covers about z, radians; a full turn if the solid contains the axis.
fn angle_range(solid: &Enclosure, near: f64) -> (f64, f64) {
    if near <= 0.0 {
        return (-PI, TAU);
    }
    // The axis is outside the solid: the range is less than half a turn about the direction of the centre, unless the
    // convex hull contains the axis.
    let middle = solid.center.y.atan2(solid.center.x);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for p in &solid.points {
        let off = (p.y.atan2(p.x) - middle + PI).rem_euclid(TAU) - PI;
        let Some(side) = Some(solid.margin / p.x.hypot(p.y)).filter(|s| *s < 1.0) else { return (-PI, TAU) };
        (least, most) = (least.min(off - side.asin()), most.max(off + side.asin()));
    }
    if most - least >= PI {
        return (-PI, TAU);
    }
    let rounding = 1e-9;
    (middle + least - rounding, most - least + 2.0 * rounding)
}
