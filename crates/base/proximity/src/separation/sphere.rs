//! Separation of a sphere and any other shape: closed forms for the distance of its centre.

use elbowroom_spatial::{Pose, Vec3};

use super::core::Core;
use super::gap::{Gap, rounding};
use super::goal::Goal;
use super::mesh_convex::mesh_core;
use super::result::Separation;
use super::settings::WitnessPoints;
use crate::mesh_mesh::QueryStats;
use crate::{Shape, Sphere};

/// Separation of a sphere: it is its centre with a radius, and the distance of the centre has a closed form.
#[inline]
pub(super) fn sphere(
    s: Sphere,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    stats: &mut QueryStats,
) -> Option<Separation> {
    let p = b_in_world.inverse_transform_point(a_in_world.translation);
    let size = (a_in_world.translation.abs() + b_in_world.translation.abs()).max_element();
    let (q, radius) = match b {
        Shape::Sphere(o) => (Vec3::ZERO, o.radius),
        Shape::Capsule(c) => (c.axis_point(p), c.radius),
        Shape::Cylinder(c) => (c.nearest(p), 0.0),
        Shape::Cuboid(c) => (c.nearest(p), 0.0),
        Shape::HalfSpace(_) => (Vec3::new(p.x, p.y, p.z.min(0.0)), 0.0),
        Shape::Hull(h) => (h.nearest(p), 0.0),
        Shape::Mesh(m) => {
            // The nearest point to a centre is unique except for coincidence.
            let goal = Goal::Separation(WitnessPoints::Any);
            let gap = mesh_core(m, &Core::Point, &Pose::from_translation(p), limit, s.radius, goal, stats)?;
            return Some(gap.separation([0.0, s.radius], b_in_world).swapped());
        }
    };
    closed_form(p, q, size + q.abs().max_element(), [s.radius, radius], limit, b_in_world)
}

/// The separation from exact closest points of the cores; `None`, without a square root, if they are farther apart
/// than the limit.
#[inline]
pub(super) fn closed_form(
    p: Vec3,
    q: Vec3,
    scale: f64,
    radii: [f64; 2],
    limit: f64,
    b_in_world: &Pose,
) -> Option<Separation> {
    let reach = limit + radii[0] + radii[1] + 2.0 * rounding(scale + radii[0] + radii[1]);
    if (p - q).length_squared() > reach * reach && reach >= 0.0 {
        return None;
    }
    Some(Gap::closed(p, q, scale).separation(radii, b_in_world))
}
