//! Check that a placed shape has usable numbers.

use elbowroom_spatial::Pose;

use super::{Capsule, Shape};

/// Length from which lengths count as infinite: their squares would overflow.
const TOO_LARGE: f64 = 1e150;

impl Shape {
    /// True if no number of the shape or its pose is NaN, infinite or too large, and no dimension is negative.
    #[inline]
    pub(crate) fn is_usable(&self, in_world: &Pose) -> bool {
        let dimensions = match self {
            Self::Sphere(s) => s.radius >= 0.0 && s.radius < TOO_LARGE,
            Self::Capsule(Capsule { half_length: h, radius: r }) => *h >= 0.0 && *r >= 0.0 && h + r < TOO_LARGE,
            Self::Cylinder(c) => c.half_length >= 0.0 && c.radius >= 0.0 && c.half_length + c.radius < TOO_LARGE,
            Self::Cuboid(c) => {
                let h = c.half_extents;
                h.x >= 0.0 && h.y >= 0.0 && h.z >= 0.0 && h.x + h.y + h.z < TOO_LARGE
            }
            Self::HalfSpace(_) | Self::Hull(_) | Self::Mesh(_) => true,
        };
        dimensions && is_usable_pose(in_world)
    }
}

/// True if no number of the pose is NaN, infinite or too large.
#[inline]
pub(crate) fn is_usable_pose(pose: &Pose) -> bool {
    let (t, r) = (pose.translation.abs(), pose.rotation);
    let axes = r.x_axis() + r.y_axis() + r.z_axis();
    // A NaN or an infinity in any term makes the sum one.
    t.x + t.y + t.z < TOO_LARGE && (axes.x + axes.y + axes.z).is_finite()
}
