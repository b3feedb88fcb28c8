//! The gap of two convex cores, and the separation of the shapes around them.

use elbowroom_spatial::{Pose, Vec3};

use super::result::Separation;

/// Difference of the bounds at which iterative methods stop, as a fraction of the coordinates.
pub(super) const CONVERGED: f64 = 1e-13;

/// Distance of closest points, as a fraction of the coordinates, below which their direction has too few digits for
/// a proof.
pub(super) const CLOSE: f64 = 1e-6;

/// Closest points of two cores in the frame of the second, their distance, and a proven lower bound of the distance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    pub distance: f64,
    /// Distance of the two points. For continuous witness points it may exceed the smallest distance by the tie
    /// tolerance.
    pub apart: f64,
    pub lower: f64,
    pub on_a: Vec3,
    pub on_b: Vec3,
}

impl Gap {
    /// The gap from witness points of a method whose only error is the rounding of numbers up to `scale`.
    #[inline]
    pub fn closed(on_a: Vec3, on_b: Vec3, scale: f64) -> Self {
        let distance = (on_a - on_b).length();
        Self { distance, apart: distance, lower: (distance - rounding(scale)).max(0.0), on_a, on_b }
    }

    #[inline]
    pub fn touching(on_a: Vec3, on_b: Vec3) -> Self {
        Self { distance: 0.0, apart: 0.0, lower: 0.0, on_a, on_b }
    }

    /// True if the cores are proven to be farther apart than the sum of their radii: the shapes do not touch.
    #[inline]
    pub fn is_beyond(&self, radii: f64) -> bool {
        self.lower - radii - rounding(radii) > 0.0
    }

    /// The gap with a lower bound from another method. Shapes proven to be apart do not touch, whatever the rounding of
    /// the points.
    #[inline]
    pub fn at_least(self, proven: f64) -> Self {
        let lower = self.lower.max(proven);
        let raised = || (self.on_a - self.on_b).length().max(lower);
        let distance = if self.distance < lower { raised() } else { self.distance };
        Self { lower, distance, apart: self.apart.max(distance), ..self }
    }

    /// The separation, in the world, of the shapes with these radii around the cores. `frame_in_world` is the frame of
    /// the gap.
    #[inline]
    pub fn separation(self, radii: [f64; 2], frame_in_world: &Pose) -> Separation {
        let radius = radii[0] + radii[1];
        let distance = (self.distance - radius).max(0.0);
        let lower_bound = (self.lower - radius - rounding(radius)).max(0.0).min(distance);
        let (mut p, mut q) = (self.on_a, self.on_b);
        if !(lower_bound > 0.0) {
            return self.contact(radii, frame_in_world);
        }
        if radius > 0.0 {
            let toward_b = (q - p) / self.apart;
            p += toward_b * radii[0].min(self.distance);
            q -= toward_b * radii[1].min(self.distance);
        }
        Separation {
            distance,
            lower_bound,
            on_a: frame_in_world.transform_point(p),
            on_b: frame_in_world.transform_point(q),
        }
    }

    /// A contact with one point for both shapes: the middle of the segment between the cores that both radii cover.
    fn contact(&self, radii: [f64; 2], frame_in_world: &Pose) -> Separation {
        let along = (0.5 * (self.distance + radii[0] - radii[1])).max(0.0).min(self.distance);
        let share = if self.distance > 0.0 { along / self.distance } else { 0.0 };
        let shared = frame_in_world.transform_point(self.on_a + (self.on_b - self.on_a) * share);
        Separation { distance: 0.0, lower_bound: 0.0, on_a: shared, on_b: shared }
    }
}

/// Bound of the rounding error of a short computation on numbers up to `scale`.
#[inline]
pub(crate) fn rounding(scale: f64) -> f64 {
    16.0 * f64::EPSILON * scale
}
