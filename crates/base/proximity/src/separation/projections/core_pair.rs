//! Two cores and the tolerances of their distance.

use elbowroom_spatial::{Pose, Vec3};

use super::derivative::Projection;
use crate::separation::core::Core;
use crate::separation::gap::{CLOSE, CONVERGED, rounding};

/// Two cores, the second in its own frame, and the tolerances of their distance.
pub(super) struct CorePair<'a> {
    pub a: &'a Core<'a>,
    pub b: &'a Core<'a>,
    pub a_in_b: &'a Pose,
    /// Rounding error of a bound, metres.
    pub rounding: f64,
    /// Difference of bounds at which they have converged, metres.
    pub converged: f64,
    /// Distance of witness points below which their direction is inaccurate, metres.
    pub close: f64,
}

impl<'a> CorePair<'a> {
    #[inline]
    pub fn new(a: &'a Core<'a>, b: &'a Core<'a>, a_in_b: &'a Pose) -> Self {
        let t = a_in_b.translation.abs();
        let scale = t.x + t.y + t.z + a.size() + b.size();
        Self { a, b, a_in_b, rounding: rounding(scale), converged: CONVERGED * scale, close: CLOSE * scale }
    }

    /// The support point of `a` along `-direction`, in the frame of `b`.
    #[inline]
    pub fn low_of_a(&self, direction: Vec3) -> Vec3 {
        self.a_in_b.transform_point(self.a.support(-self.a_in_b.inverse_transform_vector(direction)))
    }

    /// Distance of the two support planes perpendicular to the unit vector, which never exceeds the exact distance.
    #[inline]
    pub fn plane_gap(&self, direction: Vec3) -> f64 {
        (self.low_of_a(direction) - self.b.support(direction)).dot(direction) - self.rounding
    }

    /// The point of `a` nearest to `q`, in the frame of `b`, and the derivative in the frame of `a`.
    #[inline]
    pub fn onto_a(&self, q: Vec3) -> Projection {
        let local = self.a.project(self.a_in_b.inverse_transform_point(q));
        Projection { point: self.a_in_b.transform_point(local.point), ..local }
    }
}
