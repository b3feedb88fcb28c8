//! Oriented boxes.

use crate::{Aabb, Pose, Vec3};

/// The oriented box `B = (bc, bu, bv, bw, hu, hv, hw)` of Romanelli 2011, eq. 5. Its pose has the centre `bc` and
/// the axes `bu, bv, bw`; its half extents are `hu, hv, hw`.
///
/// ```
/// use elbowroom_spatial::{Obb, Pose, Vec3};
/// let gun = Obb { pose: Pose::from_translation(Vec3::Z * 0.125), half_extents: Vec3::new(0.04, 0.04, 0.125) };
/// assert_eq!(gun.corners().len(), 8);
/// assert!((gun.volume() - 0.0016).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obb {
    /// Centre and axes in the outer frame.
    pub pose: Pose,
    /// Half edge lengths along the axes, metres.
    pub half_extents: Vec3,
}

impl Obb {
    /// The eight corners in the outer frame.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            self.pose.transform_point(self.half_extents.scale(Vec3::new(sign(0), sign(1), sign(2))))
        })
    }

    /// Volume in cubic metres.
    pub fn volume(&self) -> f64 {
        8.0 * self.half_extents.x * self.half_extents.y * self.half_extents.z
    }

    /// The smallest axis-aligned box around this box.
    pub fn aabb(&self) -> Aabb {
        Aabb::from_center(self.pose.translation, self.pose.rotation.abs_mul(self.half_extents))
    }

    /// True if the point is in the box or on it.
    pub fn contains(&self, p: Vec3) -> bool {
        let q = self.pose.inverse_transform_point(p).abs();
        q.x <= self.half_extents.x && q.y <= self.half_extents.y && q.z <= self.half_extents.z
    }
}
