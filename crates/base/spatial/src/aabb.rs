//! Axis-aligned boxes.

use crate::{Pose, Vec3};

/// A box whose faces are parallel to its frame's axes.
///
/// ```
/// use elbowroom_spatial::{Aabb, Vec3};
/// let a = Aabb::from_points([Vec3::ZERO, Vec3::splat(1.0)]);
/// let b = Aabb::from_points([Vec3::splat(2.0), Vec3::splat(3.0)]);
/// assert!(!a.overlaps(&b) && a.inflated(1.0).overlaps(&b));
/// assert_eq!(a.distance(&b), 3.0_f64.sqrt());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Corner of the smallest coordinates, metres.
    pub min: Vec3,
    /// Corner of the largest coordinates, metres.
    pub max: Vec3,
}

impl Aabb {
    /// The empty box: the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::splat(f64::INFINITY), max: Vec3::splat(f64::NEG_INFINITY) };

    /// All of space.
    pub const EVERYTHING: Self = Self { min: Vec3::splat(f64::NEG_INFINITY), max: Vec3::splat(f64::INFINITY) };

    /// The smallest box around the points; [`Aabb::EMPTY`] if there are none.
    #[inline]
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// A box from its centre and half extents (m).
    #[inline]
    pub fn from_center(center: Vec3, half_extents: Vec3) -> Self {
        Self { min: center - half_extents, max: center + half_extents }
    }

    /// The smallest box around this box and the other one.
    #[inline]
    #[must_use]
    pub fn union(&self, o: &Self) -> Self {
        Self { min: self.min.min(o.min), max: self.max.max(o.max) }
    }

    /// This box enlarged by `margin` metres on every side.
    #[inline]
    #[must_use]
    pub fn inflated(&self, margin: f64) -> Self {
        Self { min: self.min - Vec3::splat(margin), max: self.max + Vec3::splat(margin) }
    }

    /// The smallest axis-aligned box of the outer frame around this box with the pose `pose`; all of space if this box
    /// is unbounded.
    #[inline]
    #[must_use]
    pub fn transformed(&self, pose: &Pose) -> Self {
        if self.is_empty() {
            return *self;
        }
        if !self.extent().is_finite() {
            return Self { min: Vec3::splat(f64::NEG_INFINITY), max: Vec3::splat(f64::INFINITY) };
        }
        Self::from_center(pose.transform_point(self.center()), pose.rotation.abs_mul(self.extent() * 0.5))
    }

    /// True if the boxes share a point (touching counts).
    #[allow(clippy::needless_bitwise_bool, reason = "without branches: which comparison fails is not predictable")]
    #[inline]
    pub fn overlaps(&self, o: &Self) -> bool {
        (self.min.x <= o.max.x)
            & (o.min.x <= self.max.x)
            & (self.min.y <= o.max.y)
            & (o.min.y <= self.max.y)
            & (self.min.z <= o.max.z)
            & (o.min.z <= self.max.z)
    }

    /// True if the point is in the box or on it.
    #[inline]
    pub fn contains(&self, p: Vec3) -> bool {
        self.min.x <= p.x
            && p.x <= self.max.x
            && self.min.y <= p.y
            && p.y <= self.max.y
            && self.min.z <= p.z
            && p.z <= self.max.z
    }

    /// Distance between the boxes, 0 if they overlap (metres).
    #[inline]
    pub fn distance(&self, o: &Self) -> f64 {
        self.gap(o).length()
    }

    /// Square of [`Aabb::distance`].
    #[inline]
    pub fn distance_squared(&self, o: &Self) -> f64 {
        self.gap(o).length_squared()
    }

    /// Distance (m) between a point and the farthest point of the box; infinite or NaN if the box is unbounded or empty.
    ///
    /// ```
    /// use elbowroom_spatial::{Aabb, Vec3};
    /// let slab = Aabb { min: Vec3::new(-3.0, 0.0, 0.0), max: Vec3::new(1.0, 4.0, 0.0) };
    /// assert_eq!(slab.max_distance(Vec3::ZERO), 5.0);
    /// ```
    #[inline]
    pub fn max_distance(&self, from: Vec3) -> f64 {
        (self.min - from).abs().max((self.max - from).abs()).length()
    }

    #[inline]
    fn gap(&self, o: &Self) -> Vec3 {
        (o.min - self.max).max(self.min - o.max).max(Vec3::ZERO)
    }

    /// Centre of the box.
    #[inline]
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Edge lengths, metres.
    #[inline]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// True if the box contains no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Obb, Rotation};
    use elbowroom_testkit::random::{split_mix, unit};

    /// The box around a turned box contains its eight corners, and no side can be moved inwards.
    #[test]
    fn the_box_of_a_turned_box_is_the_smallest_one_around_its_corners() {
        let mut state = 5;
        let mut random = |scale: f64| scale * (2.0 * unit(split_mix(&mut state)) - 1.0);
        for _ in 0..2_000 {
            let mut vec3 = |scale: f64| Vec3::new(random(scale), random(scale), random(scale));
            let (a, b, translation, turn) = (vec3(2.0), vec3(2.0), vec3(5.0), vec3(3.0));
            let pose = Pose { rotation: Rotation::from_rotation_vector(turn), translation };
            let boxed = Aabb { min: a.min(b), max: a.max(b) };
            let middle = pose * Pose::from_translation(boxed.center());
            let corners = Obb { pose: middle, half_extents: boxed.extent() * 0.5 }.corners();
            let around = Aabb::from_points(corners);
            let turned = boxed.transformed(&pose);
            let off = (turned.min - around.min).length().max((turned.max - around.max).length());
            assert!(off < 1e-12, "{off}: {turned:?}, {around:?}");
        }
    }
}
