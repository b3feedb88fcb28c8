//! Position and orientation of one frame in another.

use std::ops::Mul;

use crate::{Rotation, Vec3};

/// A rigid transform: maps coordinates in the inner frame to coordinates in the outer one.
///
/// ```
/// use elbowroom_spatial::{Pose, Vec3};
/// let flange_in_world = Pose::from_translation(Vec3::new(1.0, 0.0, 0.5));
/// let tcp_in_flange = Pose::from_translation(Vec3::Z * 0.25);
/// let tcp_in_world = flange_in_world * tcp_in_flange;
/// assert_eq!(tcp_in_world.translation, Vec3::new(1.0, 0.0, 0.75));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Orientation of the inner frame.
    pub rotation: Rotation,
    /// Origin of the inner frame, metres.
    pub translation: Vec3,
}

impl Pose {
    /// The identity: both frames coincide.
    pub const IDENTITY: Self = Self { rotation: Rotation::IDENTITY, translation: Vec3::ZERO };

    /// A pose from orientation and origin (m).
    #[inline]
    pub const fn new(rotation: Rotation, translation: Vec3) -> Self {
        Self { rotation, translation }
    }

    /// A pose without rotation, with its origin at `translation` (metres).
    #[inline]
    pub const fn from_translation(translation: Vec3) -> Self {
        Self { rotation: Rotation::IDENTITY, translation }
    }

    /// A pose as in a URDF `<origin>`: metres, and roll, pitch, yaw in radians.
    pub fn from_xyz_rpy(xyz: [f64; 3], rpy: [f64; 3]) -> Self {
        Self::new(Rotation::from_rpy(rpy[0], rpy[1], rpy[2]), xyz.into())
    }

    /// Maps a point from the inner frame to the outer frame.
    #[inline]
    pub fn transform_point(&self, p: Vec3) -> Vec3 {
        self.rotation * p + self.translation
    }

    /// Maps a direction from the inner frame to the outer frame.
    #[inline]
    pub fn transform_vector(&self, v: Vec3) -> Vec3 {
        self.rotation * v
    }

    /// Maps a point from the outer frame to the inner frame.
    #[inline]
    pub fn inverse_transform_point(&self, p: Vec3) -> Vec3 {
        self.rotation.inverse_rotate(p - self.translation)
    }

    /// Maps a direction from the outer frame to the inner frame.
    #[inline]
    pub fn inverse_transform_vector(&self, v: Vec3) -> Vec3 {
        self.rotation.inverse_rotate(v)
    }

    /// The pose of the outer frame in the inner frame.
    #[inline]
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// `self.inverse() * other`: the pose of the other frame in this frame.
    #[inline]
    #[must_use]
    pub fn inverse_mul(&self, other: &Self) -> Self {
        self.inverse() * *other
    }

    /// The pose at the fraction `t` of the interpolation to `other`: straight line, shortest rotation.
    #[inline]
    #[must_use]
    pub fn interpolate(&self, other: &Self, t: f64) -> Self {
        Self {
            rotation: self.rotation.interpolate(other.rotation, t),
            translation: self.translation.lerp(other.translation, t),
        }
    }

    /// Row-major 3×4 matrix `[R | t]`.
    #[inline]
    pub fn to_rows(self) -> [[f64; 4]; 3] {
        let r = self.rotation.rows();
        let t = self.translation.to_array();
        std::array::from_fn(|i| [r[i][0], r[i][1], r[i][2], t[i]])
    }

    /// True if no entry is NaN or infinite.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.rotation.is_finite() && self.translation.is_finite()
    }
}

impl Mul for Pose {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self { rotation: self.rotation * o.rotation, translation: self.transform_point(o.translation) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_inverts_and_interpolation_meets_both_ends() {
        let a = Pose::from_xyz_rpy([0.1, -0.2, 0.3], [0.4, -0.5, 2.6]);
        let b = Pose::from_xyz_rpy([1.1, 0.2, -0.3], [-0.4, 0.5, 0.6]);
        let p = Vec3::new(0.7, 0.8, -0.9);
        assert!((a.inverse().transform_point(a.transform_point(p)) - p).length() < 1e-15);
        assert!((a.inverse_transform_point(a.transform_point(p)) - p).length() < 1e-15);
        for (t, end) in [(0.0, a), (1.0, b)] {
            let at = a.interpolate(&b, t);
            assert!((at.transform_point(p) - end.transform_point(p)).length() < 1e-14);
        }
    }
}
