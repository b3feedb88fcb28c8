//! Orientation of one frame in another.

use std::ops::Mul;

use glam::{DMat3, DQuat, DVec3};

use crate::Vec3;

/// A proper rotation, stored as a matrix because points are rotated far more often than rotations are composed.
///
/// ```
/// use elbowroom_spatial::{Rotation, Vec3};
/// let quarter = Rotation::from_axis_angle(Vec3::Z, std::f64::consts::FRAC_PI_2);
/// assert!((quarter * Vec3::X - Vec3::Y).length() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation(DMat3);

impl Default for Rotation {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Rotation {
    /// No rotation.
    pub const IDENTITY: Self = Self(DMat3::IDENTITY);

    /// A right-handed rotation by `angle` radians about the unit vector `axis`.
    #[inline]
    pub fn from_axis_angle(axis: Vec3, angle: f64) -> Self {
        Self(DMat3::from_axis_angle(axis.into(), angle))
    }

    /// A rotation from fixed-axis roll, pitch, yaw in radians as in URDF: `Rz(yaw)·Ry(pitch)·Rx(roll)`.
    pub fn from_rpy(roll: f64, pitch: f64, yaw: f64) -> Self {
        Self(DMat3::from_rotation_z(yaw) * DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll))
    }

    /// A rotation from a rotation vector: its direction is the axis, its length the angle in radians.
    pub fn from_rotation_vector(v: Vec3) -> Self {
        match v.try_normalize() {
            Some(axis) => Self::from_axis_angle(axis, v.length()),
            None => Self::IDENTITY,
        }
    }

    /// The frame whose axes are the given orthonormal right-handed columns.
    /// `None` if they are not orthonormal within `1e-6`, or left-handed.
    pub fn from_columns(x: Vec3, y: Vec3, z: Vec3) -> Option<Self> {
        let unit = |v: Vec3| (v.length() - 1.0).abs() < 1e-6;
        let orthonormal = unit(x) && unit(y) && unit(z) && x.dot(y).abs() < 1e-6 && (x.cross(y) - z).length() < 1e-6;
        orthonormal.then(|| Self(DMat3::from_cols(x.into(), y.into(), z.into())))
    }

    /// The frame whose x axis points along `x` and whose xy plane contains `xy`. `None` if the two are parallel or one
    /// of them is zero.
    pub fn from_x_and_xy(x: Vec3, xy: Vec3) -> Option<Self> {
        let ex = x.try_normalize()?;
        let ez = ex.cross(xy.try_normalize()?);
        if ez.length() < 1e-9 {
            return None;
        }
        let ez = ez.try_normalize()?;
        Some(Self(DMat3::from_cols(ex.into(), ez.cross(ex).into(), ez.into())))
    }

    /// A frame whose z axis is the unit vector `z`; its rotation about z is unspecified but reproducible.
    pub fn from_z(z: Vec3) -> Self {
        let x = z.any_perpendicular();
        Self(DMat3::from_cols(x.into(), z.cross(x).into(), z.into()))
    }

    /// A rotation from a quaternion, which is normalized first. `None` if it is zero or not finite.
    pub fn from_quaternion_xyzw(q: [f64; 4]) -> Option<Self> {
        let q = DQuat::from_array(q);
        let n = q.length();
        (n > 0.0 && n.is_finite()).then(|| Self(DMat3::from_quat(q.normalize())))
    }

    /// The unit quaternion `[x, y, z, w]`.
    pub fn to_quaternion_xyzw(self) -> [f64; 4] {
        DQuat::from_mat3(&self.0).to_array()
    }

    /// Roll, pitch, yaw in radians; at a pitch of ±90° the yaw is reported as 0.
    pub fn to_rpy(self) -> [f64; 3] {
        let m = self.rows();
        let pitch = (-m[2][0]).atan2(m[0][0].hypot(m[1][0]));
        if m[0][0].hypot(m[1][0]) < 1e-12 {
            let roll = if pitch > 0.0 { m[0][1].atan2(m[1][1]) } else { (-m[0][1]).atan2(m[1][1]) };
            return [roll, pitch, 0.0];
        }
        [m[2][1].atan2(m[2][2]), pitch, m[1][0].atan2(m[0][0])]
    }

    /// Rotation vector of the smallest angle: axis times angle in `[0, π]`.
    #[inline]
    pub fn to_rotation_vector(self) -> Vec3 {
        let q = DQuat::from_mat3(&self.0);
        let q = if q.w < 0.0 { -q } else { q };
        let v = Vec3::new(q.x, q.y, q.z);
        match v.try_normalize() {
            Some(axis) => axis * (2.0 * v.length().atan2(q.w)),
            None => Vec3::ZERO,
        }
    }

    /// Angle of the rotation in `[0, π]` radians.
    #[inline]
    pub fn angle(self) -> f64 {
        self.to_rotation_vector().length()
    }

    /// The product with a rotation about a coordinate axis, `self·R(axis, angle)`: axis 0 is x, 1 y, 2 z; `angle` is in
    /// radians.
    ///
    /// Equals the product with [`Rotation::from_axis_angle`], at a third of the work.
    ///
    /// # Panics
    /// Panics if `axis` is not 0, 1 or 2.
    ///
    /// ```
    /// use elbowroom_spatial::{Rotation, Vec3};
    /// let r = Rotation::from_rpy(0.1, 0.2, 0.3);
    /// let product = r * Rotation::from_axis_angle(Vec3::Y, 0.7);
    /// assert!((r.rotated_about(1, 0.7).inverse() * product).angle() < 1e-15);
    /// ```
    // Called once per joint in every forward pass: a call that is not inlined costs it 7 %.
    #[allow(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    #[must_use]
    pub fn rotated_about(self, axis: usize, angle: f64) -> Self {
        let (s, c) = angle.sin_cos();
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = self.0;
        Self(match axis {
            0 => DMat3::from_cols(x, y * c + z * s, z * c - y * s),
            1 => DMat3::from_cols(x * c - z * s, y, z * c + x * s),
            2 => DMat3::from_cols(x * c + y * s, y * c - x * s, z),
            _ => panic!("a frame has the axes 0, 1 and 2, not {axis}"),
        })
    }

    /// The inverse rotation.
    #[inline]
    #[must_use]
    pub fn inverse(self) -> Self {
        Self(self.0.transpose())
    }

    /// Applies the inverse rotation to a vector, without forming the inverse.
    #[inline]
    pub fn inverse_rotate(self, v: Vec3) -> Vec3 {
        Vec3::new(self.x_axis().dot(v), self.y_axis().dot(v), self.z_axis().dot(v))
    }

    /// The rotation at the fraction `t` of the shortest rotation to `other` (slerp).
    #[inline]
    #[must_use]
    pub fn interpolate(self, other: Self, t: f64) -> Self {
        let turn = (self.inverse() * other).to_rotation_vector();
        self * Self::from_rotation_vector(turn * t)
    }

    /// This rotation without the rounding errors of a long product.
    #[inline]
    #[must_use]
    pub fn renormalized(self) -> Self {
        let x = self.0.x_axis.normalize();
        let z = x.cross(self.0.y_axis).normalize();
        Self(DMat3::from_cols(x, z.cross(x), z))
    }

    /// First column: the x axis in the outer frame.
    #[inline]
    pub fn x_axis(self) -> Vec3 {
        self.0.x_axis.into()
    }

    /// Second column: the y axis in the outer frame.
    #[inline]
    pub fn y_axis(self) -> Vec3 {
        self.0.y_axis.into()
    }

    /// Third column: the z axis in the outer frame.
    #[inline]
    pub fn z_axis(self) -> Vec3 {
        self.0.z_axis.into()
    }

    /// Column `i`.
    #[inline]
    pub fn axis(self, i: usize) -> Vec3 {
        self.0.col(i).into()
    }

    /// The matrix by rows: `rows()[i][j]` is row i, column j.
    #[inline]
    pub fn rows(self) -> [[f64; 3]; 3] {
        self.0.transpose().to_cols_array_2d()
    }

    /// The component-wise absolute matrix applied to a non-negative vector, which gives the half extents of a rotated
    /// box.
    #[inline]
    pub fn abs_mul(self, v: Vec3) -> Vec3 {
        self.x_axis().abs() * v.x + self.y_axis().abs() * v.y + self.z_axis().abs() * v.z
    }

    /// True if no entry is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

impl Mul for Rotation {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self(self.0 * o.0)
    }
}

impl Mul<Vec3> for Rotation {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        (self.0 * DVec3::from(v)).into()
    }
}

impl From<Rotation> for mint::ColumnMatrix3<f64> {
    fn from(r: Rotation) -> Self {
        Self { x: r.x_axis().into(), y: r.y_axis().into(), z: r.z_axis().into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn rpy_round_trips_and_survives_gimbal_lock() {
        for pitch in [-FRAC_PI_2, -1.0, 0.0, 0.3, FRAC_PI_2] {
            for (roll, yaw) in [(0.0, 0.0), (1.0, -2.0), (-3.0, 3.0)] {
                let r = Rotation::from_rpy(roll, pitch, yaw);
                let [a, b, c] = r.to_rpy();
                let back = Rotation::from_rpy(a, b, c);
                assert!((r.inverse() * back).angle() < 1e-7, "{roll} {pitch} {yaw}");
            }
        }
    }

    #[test]
    fn rotation_vector_round_trips_up_to_half_a_turn() {
        for angle in [0.0, 1e-9, 0.5, 3.0, PI] {
            let v = Vec3::new(0.48, -0.6, 0.64) * angle;
            assert!((Rotation::from_rotation_vector(v).to_rotation_vector() - v).length() < 1e-9);
        }
    }
}
