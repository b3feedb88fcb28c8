//! A cheap lower bound of the distance between two primitives. Pairs that the bound excludes need no exact distance.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

/// Allowance for rounding errors, m per m of coordinates.
const ROUNDING: f64 = 1e-12;

/// A rounded box that encloses a shape, in the shape's frame: all points within `radius` of a box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RoundedBox {
    half_extents: Vec3,
    radius: f64,
}

impl RoundedBox {
    /// The rounded box around a shape. `None` for half-spaces, hulls and meshes, which need not be centred at their
    /// origin.
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

    /// Lower bound of the distance (m, may be negative). The first box is replaced by its bounding box along the axes of the
    /// second.
    #[inline]
    pub(crate) fn distance_bound(&self, in_world: &Pose, other: &Self, other_in_world: &Pose) -> f64 {
        let center = other_in_world.inverse_transform_point(in_world.translation);
        let reach = |axis: Vec3, half: f64| other_in_world.inverse_transform_vector(axis).abs() * half;
        let mut half = reach(in_world.rotation.z_axis(), self.half_extents.z);
        if self.half_extents.x > 0.0 || self.half_extents.y > 0.0 {
            half += reach(in_world.rotation.x_axis(), self.half_extents.x);
            half += reach(in_world.rotation.y_axis(), self.half_extents.y);
        }
        let separation = (center.abs() - half - other.half_extents).max(Vec3::ZERO);
        let size = in_world.translation.abs().max_element() + other_in_world.translation.abs().max_element();
        separation.length() - self.radius - other.radius - ROUNDING * (1.0 + size)
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
