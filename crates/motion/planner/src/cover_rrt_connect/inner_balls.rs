//! Balls inside solids, many of them points: if one of them overlaps another solid, the solids collide.

use std::collections::BTreeSet;

use elbowroom_proximity::{Capsule, Cylinder, Shape};
use elbowroom_spatial::{Pose, Vec3};

/// Number of balls along the axis of a capsule or cylinder.
const AXIS_BALLS: u32 = 9;

/// A ball that is part of a solid; its radius may be 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct InnerBall {
    /// Centre in the frame of the solid's link or object, m.
    pub centre: Vec3,
    pub radius_m: f64,
}

/// Balls inside a shape: its vertices and the centres of its triangles, or balls around its axis or centre. Empty for a
/// half-space.
pub(super) fn inner_balls(shape: &Shape, in_geometry: Pose) -> Vec<InnerBall> {
    let ball = |centre: Vec3, radius_m: f64| InnerBall { centre: in_geometry.transform_point(centre), radius_m };
    let along = |half_length: f64, radius: f64| {
        let share = |i: u32| 2.0 * f64::from(i) / f64::from(AXIS_BALLS - 1) - 1.0;
        (0..AXIS_BALLS).map(move |i| ball(Vec3::Z * (half_length * share(i)), radius)).collect()
    };
    match shape {
        Shape::Sphere(s) => vec![ball(Vec3::ZERO, s.radius)],
        Shape::Capsule(Capsule { half_length, radius }) => along(*half_length, *radius),
        Shape::Cylinder(Cylinder { half_length, radius }) => {
            let inset = radius.min(*half_length);
            along(half_length - inset, inset)
        }
        Shape::Cuboid(c) => {
            let corner = |k: usize, i: usize| if k >> i & 1 == 0 { -c.half_extents[i] } else { c.half_extents[i] };
            let corners = (0..8).map(|k| ball(Vec3::new(corner(k, 0), corner(k, 1), corner(k, 2)), 0.0));
            corners.chain([ball(Vec3::ZERO, c.half_extents.min_element())]).collect()
        }
        Shape::HalfSpace(_) => Vec::new(),
        Shape::Hull(h) => h.vertices().iter().map(|&v| ball(v, 0.0)).collect(),
        Shape::Mesh(m) => {
            let corner = |v: u32| m.vertices()[v as usize];
            let centres = m.triangles().iter().map(|&[a, b, c]| (corner(a) + corner(b) + corner(c)) / 3.0);
            // Vertices without a triangle are not part of the surface.
            let used: BTreeSet<u32> = m.triangles().iter().flatten().copied().collect();
            let corners = used.into_iter().map(corner);
            corners.chain(centres).map(|p| ball(p, 0.0)).collect()
        }
    }
}
