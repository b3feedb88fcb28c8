//! A point or a direction in space.

use std::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub, SubAssign};

use serde::{Deserialize, Serialize};

/// Three `f64` components: a point (metres), a direction or a velocity, as its name says.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// let v = Vec3::new(3.0, 4.0, 0.0);
/// assert_eq!(v.length(), 5.0);
/// assert_eq!(v.dot(Vec3::X), 3.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(from = "[f64; 3]", into = "[f64; 3]")]
#[repr(C)]
pub struct Vec3 {
    /// First component.
    pub x: f64,
    /// Second component.
    pub y: f64,
    /// Third component.
    pub z: f64,
}

impl Vec3 {
    /// The origin.
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);
    /// Unit vector along x.
    pub const X: Self = Self::new(1.0, 0.0, 0.0);
    /// Unit vector along y.
    pub const Y: Self = Self::new(0.0, 1.0, 0.0);
    /// Unit vector along z.
    pub const Z: Self = Self::new(0.0, 0.0, 1.0);

    /// The vector with these components.
    #[inline]
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    /// The vector whose three components are all `v`.
    #[inline]
    pub const fn splat(v: f64) -> Self {
        Self::new(v, v, v)
    }

    /// Scalar product.
    #[inline]
    pub fn dot(self, o: Self) -> f64 {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Vector product.
    #[must_use]
    #[inline]
    pub fn cross(self, o: Self) -> Self {
        Self::new(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }

    /// Euclidean norm.
    #[inline]
    pub fn length(self) -> f64 {
        self.length_squared().sqrt()
    }

    /// Square of the Euclidean norm.
    #[inline]
    pub fn length_squared(self) -> f64 {
        self.dot(self)
    }

    /// Distance between two points.
    #[inline]
    pub fn distance(self, o: Self) -> f64 {
        (self - o).length()
    }

    /// The unit vector in the same direction, or `None` if the length is zero or not finite.
    #[inline]
    pub fn try_normalize(self) -> Option<Self> {
        let length = self.length();
        if length > 0.0 && length.is_finite() {
            return Some(self / length);
        }
        self.rescaled().map(|v| v / v.length())
    }

    /// The vector scaled to a largest component of 1, for vectors so small or large that their square under- or
    /// overflows.
    fn rescaled(self) -> Option<Self> {
        let largest = self.abs().max_element();
        (largest > 0.0 && self.is_finite()).then(|| Self::new(self.x / largest, self.y / largest, self.z / largest))
    }

    /// Component-wise absolute value.
    #[must_use]
    #[inline]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// Component-wise minimum.
    #[must_use]
    #[inline]
    pub fn min(self, o: Self) -> Self {
        Self::new(self.x.min(o.x), self.y.min(o.y), self.z.min(o.z))
    }

    /// Component-wise maximum.
    #[must_use]
    #[inline]
    pub fn max(self, o: Self) -> Self {
        Self::new(self.x.max(o.x), self.y.max(o.y), self.z.max(o.z))
    }

    /// Component-wise clamp; `lo` must not exceed `hi`.
    #[must_use]
    #[inline]
    pub fn clamp(self, lo: Self, hi: Self) -> Self {
        self.max(lo).min(hi)
    }

    /// Component-wise product.
    #[must_use]
    #[inline]
    pub fn scale(self, o: Self) -> Self {
        Self::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }

    /// The largest component.
    #[inline]
    pub fn max_element(self) -> f64 {
        self.x.max(self.y).max(self.z)
    }

    /// The smallest component.
    #[inline]
    pub fn min_element(self) -> f64 {
        self.x.min(self.y).min(self.z)
    }

    /// True if no component is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// The point at the fraction `t` of the segment to `o`.
    #[must_use]
    #[inline]
    pub fn lerp(self, o: Self, t: f64) -> Self {
        self + (o - self) * t
    }

    /// Any unit vector perpendicular to this unit vector (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
    #[must_use]
    #[inline]
    pub fn any_perpendicular(self) -> Self {
        let sign = 1.0_f64.copysign(self.z);
        let a = -1.0 / (sign + self.z);
        Self::new(1.0 + sign * self.x * self.x * a, sign * self.x * self.y * a, -sign * self.x)
    }

    /// The components as an array.
    #[inline]
    pub const fn to_array(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }
}

impl Add for Vec3 {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl Sub for Vec3 {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl AddAssign for Vec3 {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Vec3 {
    #[inline]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl Neg for Vec3 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl Mul<f64> for Vec3 {
    type Output = Self;
    #[inline]
    fn mul(self, k: f64) -> Self {
        Self::new(self.x * k, self.y * k, self.z * k)
    }
}

impl Mul<Vec3> for f64 {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        v * self
    }
}

impl Div<f64> for Vec3 {
    type Output = Self;
    #[inline]
    fn div(self, k: f64) -> Self {
        Self::new(self.x / k, self.y / k, self.z / k)
    }
}

impl Index<usize> for Vec3 {
    type Output = f64;
    #[inline]
    fn index(&self, i: usize) -> &f64 {
        match i {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => panic!("a Vec3 has components 0, 1 and 2, not {i}"),
        }
    }
}

impl From<[f64; 3]> for Vec3 {
    #[inline]
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self::new(x, y, z)
    }
}

impl From<Vec3> for [f64; 3] {
    #[inline]
    fn from(v: Vec3) -> Self {
        v.to_array()
    }
}

impl From<mint::Vector3<f64>> for Vec3 {
    fn from(v: mint::Vector3<f64>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<Vec3> for mint::Vector3<f64> {
    fn from(v: Vec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<mint::Point3<f64>> for Vec3 {
    fn from(v: mint::Point3<f64>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<Vec3> for mint::Point3<f64> {
    fn from(v: Vec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<glam::DVec3> for Vec3 {
    #[inline]
    fn from(v: glam::DVec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<Vec3> for glam::DVec3 {
    #[inline]
    fn from(v: Vec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perpendicular_is_unit_and_perpendicular_even_at_the_poles() {
        for v in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Z, Vec3::new(0.6, -0.64, -0.48)] {
            let p = v.any_perpendicular();
            assert!(p.dot(v).abs() < 1e-15 && (p.length() - 1.0).abs() < 1e-15, "{v:?}");
        }
    }

    #[test]
    fn normalizing_handles_tiny_and_huge_and_refuses_zero_and_nan() {
        let n = Vec3::new(3e-200, 4e-200, 0.0).try_normalize().unwrap();
        assert!((n - Vec3::new(0.6, 0.8, 0.0)).length() < 1e-15);
        let n = Vec3::new(3e200, 4e200, 0.0).try_normalize().unwrap();
        assert!((n - Vec3::new(0.6, 0.8, 0.0)).length() < 1e-15);
        assert_eq!(Vec3::ZERO.try_normalize(), None);
        assert_eq!(Vec3::new(f64::NAN, 0.0, 1.0).try_normalize(), None);
    }
}
