//! A cheap lower bound on the distance of two primitives, to leave exact distances to the few pairs that need them.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

/// What rounding can take from the bound, m per m of coordinates; far more than it does.
const ROUNDING: f64 = 1e-12;

/// A box with rounded edges around a shape, in the shape's own frame: all points within `radius` of the box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RoundedBox {
    half_extents: Vec3,
    radius: f64,
}

impl RoundedBox {
    /// `None` for shapes without a middle: half-spaces, hulls and meshes.
    pub(crate) fn around(shape: &Shape) -> Option<Self> {
        let (half_extents, radius) = match shape {
            Shape::Sphere(s) => (Vec3::ZERO, s.radius),
            Shape::Capsule(s) => (Vec3::Z * s.half_length, s.radius),
            Shape::Cylinder(s) => (Vec3::new(s.radius, s.radius, s.half_length), 0.0),
            Shape::Cuboid(s) => (s.half_extents, 0.0),
            Shape::HalfSpace(_) | Shape::Hull(_) | Shape::Mesh(_) => return None,
        };
        Some(Self { half_extents, radius })
    }

    /// A distance (m, may be negative) that the two are not closer than: the first box is enclosed by one that is
    /// parallel to the second.
    #[inline]
    pub(crate) fn distance_bound(&self, in_world: &Pose, other: &Self, other_in_world: &Pose) -> f64 {
        let middle = other_in_world.inverse_transform_point(in_world.translation);
        let reach = |axis: Vec3, half: f64| other_in_world.inverse_transform_vector(axis).abs() * half;
        let mut half = reach(in_world.rotation.z_axis(), self.half_extents.z);
        if self.half_extents.x > 0.0 || self.half_extents.y > 0.0 {
            half += reach(in_world.rotation.x_axis(), self.half_extents.x);
            half += reach(in_world.rotation.y_axis(), self.half_extents.y);
        }
        let gap = (middle.abs() - half - other.half_extents).max(Vec3::ZERO);
        let size = in_world.translation.abs().max_element() + other_in_world.translation.abs().max_element();
        gap.length() - self.radius - other.radius - ROUNDING * (1.0 + size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Sphere, separation};
    use elbowroom_spatial::Rotation;
    use proptest::prelude::*;

    fn shape() -> impl Strategy<Value = Shape> {
        (0..4, 0.0..0.5_f64, 0.0..0.5_f64, 0.0..0.5_f64).prop_map(|(kind, a, b, c)| match kind {
            0 => Shape::Sphere(Sphere { radius: a }),
            1 => Shape::Capsule(Capsule { half_length: a, radius: b }),
            2 => Shape::Cylinder(Cylinder { half_length: a, radius: b }),
            _ => Shape::Cuboid(Cuboid { half_extents: Vec3::new(a, b, c) }),
        })
    }

    fn pose() -> impl Strategy<Value = Pose> {
        let number = || -3.0..3.0_f64;
        (number(), number(), number(), number(), number(), number())
            .prop_map(|(x, y, z, a, b, c)| Pose::new(Rotation::from_rpy(a, b, c), Vec3::new(x, y, z) * 0.4))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]
        #[test]
        fn the_bound_is_below_the_distance(a in shape(), at_a in pose(), b in shape(), at_b in pose()) {
            let (box_a, box_b) = (RoundedBox::around(&a).unwrap(), RoundedBox::around(&b).unwrap());
            let exact = separation(&a, &at_a, &b, &at_b).distance;
            prop_assert!(box_a.distance_bound(&at_a, &box_b, &at_b) <= exact);
            prop_assert!(box_b.distance_bound(&at_b, &box_a, &at_a) <= exact);
        }
    }
}
