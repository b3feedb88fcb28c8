//! Axis-aligned boxes in the world, in single precision, rounded outward: two SIMD registers of eight lanes per test.

use elbowroom_spatial::{Aabb, Obb, Pose, Vec3};

/// Lower and upper corner, each followed by the negated opposite corner, so that both directions of each axis are lanes.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(crate) struct WorldBox {
    /// `min.x, min.y, min.z, 0, -max.x, -max.y, -max.z, 0`
    low: [f32; 8],
    /// `max.x, max.y, max.z, 0, -min.x, -min.y, -min.z, 0`
    high: [f32; 8],
}

/// Coordinates (m) from which squares could overflow.
const FAR: f64 = 1e15;
/// Allowance for the rounding of poses and products, as a fraction of the largest coordinate.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl WorldBox {
    /// The whole space: the box of unknown or unbounded geometry.
    pub const EVERYTHING: Self = Self::from_corners([f32::NEG_INFINITY; 3], [f32::INFINITY; 3]);

    const fn from_corners(min: [f32; 3], max: [f32; 3]) -> Self {
        Self {
            low: [min[0], min[1], min[2], 0.0, -max[0], -max[1], -max[2], 0.0],
            high: [max[0], max[1], max[2], 0.0, -min[0], -min[1], -min[2], 0.0],
        }
    }

    /// The box around an oriented box of a link or object.
    #[inline]
    pub fn of_obb(obb: &Obb, geometry_in_world: &Pose) -> Self {
        let center = geometry_in_world.transform_point(obb.pose.translation);
        let half = (geometry_in_world.rotation * obb.pose.rotation).abs_mul(obb.half_extents);
        let reach = geometry_in_world.translation.abs() + obb.pose.translation.abs() + obb.half_extents;
        Self::around(center, half, reach.x + reach.y + reach.z)
    }

    /// The box around a box in the world.
    pub fn of_aabb(b: &Aabb) -> Self {
        let corner = |v: Vec3, sign: f64, end: f32| {
            v.to_array().map(|x| {
                if !(x.abs() < FAR) {
                    return end;
                }
                let outward = x + sign * ROUNDING * x.abs();
                if sign < 0.0 { (outward as f32).next_down() } else { (outward as f32).next_up() }
            })
        };
        Self::from_corners(corner(b.min, -1.0, f32::NEG_INFINITY), corner(b.max, 1.0, f32::INFINITY))
    }

    #[inline]
    fn around(center: Vec3, half: Vec3, size: f64) -> Self {
        // A NaN in any term fails the comparison, too.
        if !(size + half.x + half.y + half.z + (center.x + center.y + center.z).abs() < FAR) {
            return Self::EVERYTHING;
        }
        let half = half + Vec3::splat(ROUNDING * size);
        let (min, max) = ((center - half).to_array(), (center + half).to_array());
        Self::from_corners(min.map(|x| (x as f32).next_down()), max.map(|x| (x as f32).next_up()))
    }

    /// The box in double precision; `None` if it is empty or unbounded.
    pub fn aabb(&self) -> Option<Aabb> {
        let corner = |c: &[f32; 8]| Vec3::new(c[0].into(), c[1].into(), c[2].into());
        let found = Aabb { min: corner(&self.low), max: corner(&self.high) };
        (found.min.is_finite() && found.max.is_finite()).then_some(found)
    }

    /// The box around two boxes.
    #[inline]
    pub fn union(&self, o: &Self) -> Self {
        Self {
            low: std::array::from_fn(|i| self.low[i].min(o.low[i])),
            high: std::array::from_fn(|i| self.high[i].max(o.high[i])),
        }
    }

    /// The empty box: the neutral element of [`WorldBox::union`].
    pub const EMPTY: Self = Self::from_corners([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);

    /// True if the boxes are certainly farther apart than `margin` (m) along some axis.
    #[inline]
    pub fn separated(&self, o: &Self, margin: f32) -> bool {
        // Rounding is monotonic: if the rounded difference is above the margin, the exact difference is too.
        let mut separated = false;
        for i in 0..8 {
            separated |= self.low[i] - o.high[i] > margin;
        }
        separated
    }

    /// Nearest points of two boxes; a common point if they overlap.
    pub fn nearest_points(&self, o: &Self) -> (Vec3, Vec3) {
        let (mut p, mut q) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            let (a, b) = ((self.low[i], self.high[i]), (o.low[i], o.high[i]));
            let (x, y) = if a.1 < b.0 {
                (a.1, b.0)
            } else if b.1 < a.0 {
                (a.0, b.1)
            } else {
                let (from, to) = (a.0.max(b.0), a.1.min(b.1));
                let middle = if from.is_finite() && to.is_finite() { 0.5 * (from + to) } else { from.max(to.min(0.0)) };
                (middle, middle)
            };
            (p[i], q[i]) = (f64::from(x), f64::from(y));
        }
        (p.into(), q.into())
    }

    /// A lower bound (m) on the distance of the boxes.
    #[inline]
    pub fn gap(&self, o: &Self) -> f32 {
        let mut squared = 0.0;
        for i in 0..4 {
            let axis = (self.low[i] - o.high[i]).max(self.low[i + 4] - o.high[i + 4]).max(0.0);
            squared += axis * axis;
        }
        // Six roundings of a relative 6e-8 each.
        squared.sqrt() * (1.0 - 1e-6)
    }
}

/// The smallest f32 that is not below `x`; NaN stays NaN.
#[inline]
pub(crate) fn round_up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_box() -> impl Strategy<Value = Aabb> {
        let c = -3.0..3.0_f64;
        ((c.clone(), c.clone(), c), (0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64), 0..4_i32).prop_map(|(c, h, e)| {
            let s = 10.0_f64.powi(e);
            Aabb::from_center(Vec3::new(c.0, c.1, c.2) * s, Vec3::new(h.0, h.1, h.2) * s)
        })
    }

    proptest! {
        #[test]
        fn the_gap_never_exceeds_the_distance_in_double_precision(a in any_box(), b in any_box(), margin in 0.0..5.0_f64) {
            let (x, y) = (WorldBox::of_aabb(&a), WorldBox::of_aabb(&b));
            prop_assert!(f64::from(x.gap(&y)) <= a.distance(&b));
            prop_assert!(x.gap(&y) == y.gap(&x));
            if x.separated(&y, round_up(margin)) {
                prop_assert!(a.distance(&b) > margin);
            }
            // The bound is not much less than the distance.
            prop_assert!(f64::from(x.gap(&y)) >= a.distance(&b) - 1e-5 * (1.0 + a.max.length() + b.max.length()));
        }
    }

    #[test]
    fn unknown_geometry_is_everywhere() {
        let here = WorldBox::of_aabb(&Aabb::from_center(Vec3::ZERO, Vec3::splat(0.1)));
        let obb = Obb { pose: Pose::IDENTITY, half_extents: Vec3::splat(0.1) };
        for bad in [f64::NAN, f64::INFINITY, 1e200] {
            let lost = WorldBox::of_obb(&obb, &Pose::from_translation(Vec3::X * bad));
            assert!(
                !lost.separated(&here, 0.0)
                    && !here.separated(&lost, 0.0)
                    && lost.gap(&here) == 0.0
                    && lost.gap(&lost) == 0.0
            );
        }
        assert!(!here.separated(&WorldBox::EVERYTHING.union(&here), 0.0));
        assert!(WorldBox::EMPTY.separated(&here, 1e9), "the empty box is far from everything");
    }
}
