//! The way out of an overlap.

mod depth;
mod directions;

use std::sync::Arc;

use elbowroom_spatial::{Pose, Vec3};

use crate::separation::core::{Core, rounded};
use crate::separation::{best_axis, convex, usable};
use crate::{Shape, TriMesh, collides, project_point};

/// A translation that ends an overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Escape {
    /// How far to move the first shape, metres; 0 where the shapes just touch. Infinite where no translation helps.
    pub depth: f64,
    /// Which way to move it, unit vector in the world.
    pub direction: Vec3,
}

/// The shortest translation of `a` that separates it from `b`; `None` where they are apart.
///
/// Moving by `depth * direction` always separates (up to rounding). It is the shortest way
/// - exactly, for spheres against all convex shapes, for half-spaces, for boxes (15 axes) and for capsules against
///   capsules and boxes;
/// - within 1e-9 of the size for cylinders, by a search that is tested against brute force but not proven;
/// - for hulls, within 1e-9 of the size where the difference of the two has flat faces, within about 1e-4 where it is
///   curved;
/// - for meshes, of their convex hulls: a way out of a notch of a mesh may be shorter than the one returned.
///
/// Takes no memory for pairs of spheres, capsules, cylinders, boxes and half-spaces.
///
/// ```
/// use elbowroom_proximity::{Cuboid, Shape, Sphere, escape};
/// use elbowroom_spatial::{Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.5, 0.5, 0.2) });
/// let out = escape(&ball, &Pose::from_translation(Vec3::Z * 0.15), &table, &Pose::IDENTITY).unwrap();
/// assert!((out.depth - 0.15).abs() < 1e-15 && out.direction == Vec3::Z);
/// assert!(escape(&ball, &Pose::from_translation(Vec3::Z * 0.31), &table, &Pose::IDENTITY).is_none());
/// ```
pub fn escape(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> Option<Escape> {
    if !(usable(a, a_in_world) && usable(b, b_in_world)) {
        return Some(Escape { depth: f64::INFINITY, direction: Vec3::Z });
    }
    if !collides(a, a_in_world, b, b_in_world) {
        return None;
    }
    match (a, b) {
        (Shape::HalfSpace(_), Shape::HalfSpace(_)) => Some(two_half_spaces(a_in_world, b_in_world)),
        (_, Shape::HalfSpace(_)) => Some(out_of_half_space(a, a_in_world, b_in_world)),
        (Shape::HalfSpace(_), _) => Some(reversed(out_of_half_space(b, b_in_world, a_in_world))),
        (Shape::Mesh(m), _) => Some(solid_stand_in(m, |s| out(s, a_in_world, b, b_in_world))),
        (_, Shape::Mesh(m)) => Some(solid_stand_in(m, |s| out(a, a_in_world, s, b_in_world))),
        _ => Some(out(a, a_in_world, b, b_in_world)),
    }
}

fn reversed(e: Escape) -> Escape {
    Escape { direction: -e.direction, ..e }
}

fn two_half_spaces(a_in_world: &Pose, b_in_world: &Pose) -> Escape {
    let a_in_b = b_in_world.inverse_mul(a_in_world);
    let opposite = a_in_b.rotation.z_axis().z < -1.0 + 1e-15;
    let depth = if opposite { (-a_in_b.translation.z).max(0.0) } else { f64::INFINITY };
    Escape { depth, direction: b_in_world.rotation.z_axis() }
}

fn out_of_half_space(a: &Shape, a_in_world: &Pose, b_in_world: &Pose) -> Escape {
    let normal = b_in_world.rotation.z_axis();
    let lowest = a_in_world.transform_point(a.support(-a_in_world.inverse_transform_vector(normal)));
    let height = (lowest - b_in_world.translation).dot(normal);
    Escape { depth: (-height).max(0.0), direction: normal }
}

/// A mesh's hull; where it has none because it is flat, its bounding box.
fn solid_stand_in(m: &TriMesh, question: impl Fn(&Shape) -> Escape) -> Escape {
    match m.hull() {
        Some(hull) => question(&Shape::Hull(Arc::new(hull.clone()))),
        None => question(&Shape::Mesh(Arc::new(m.clone()))),
    }
}

/// Neither is a half-space; either may still be a mesh.
fn out(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> Escape {
    if let Shape::Mesh(m) = b
        && let Some(hull) = m.hull()
    {
        return out(a, a_in_world, &Shape::Hull(Arc::new(hull.clone())), b_in_world);
    }
    let (core_a, ra) = core_of(a);
    let (core_b, rb) = core_of(b);
    let a_in_b = b_in_world.inverse_mul(a_in_world);
    if let Some(e) = shallow(a, b, &a_in_b) {
        return Escape { direction: b_in_world.transform_vector(e.direction), ..e };
    }
    match (core_a, core_b) {
        (Core::Point, _) if !matches!(b, Shape::Mesh(_)) => {
            let s = project_point(b, b_in_world, a_in_world.translation);
            Escape { depth: (ra - s.signed_distance).max(0.0), direction: s.outward }
        }
        (_, Core::Point) if !matches!(a, Shape::Mesh(_)) => {
            let s = project_point(a, a_in_world, b_in_world.translation);
            Escape { depth: (rb - s.signed_distance).max(0.0), direction: -s.outward }
        }
        (Core::Cuboid(x), Core::Cuboid(y)) => {
            let best = best_axis(&x, &y, &a_in_b);
            Escape { depth: (-best.gap).max(0.0), direction: b_in_world.transform_vector(best.axis) }
        }
        _ if core_a.projects_fast() && core_b.projects_fast() => {
            let (depth, direction) = directions::least_overlap(&core_a, &core_b, &a_in_b);
            Escape { depth: (depth + ra + rb).max(0.0), direction: b_in_world.transform_vector(direction) }
        }
        _ => {
            let (depth, direction) = depth::penetration(&core_a, &core_b, &a_in_b);
            Escape { depth: (depth + ra + rb).max(0.0), direction: b_in_world.transform_vector(direction) }
        }
    }
}

fn core_of(s: &Shape) -> (Core<'_>, f64) {
    match s {
        Shape::Mesh(m) => (Core::Points(m.vertices()), 0.0),
        _ => rounded(s).unwrap_or((Core::Point, 0.0)),
    }
}

/// Only the rounding of the shapes overlaps: out along the cores' witness points. Frame of b.
fn shallow(a: &Shape, b: &Shape, a_in_b: &Pose) -> Option<Escape> {
    let (gap, radii) = convex(a, b, a_in_b, f64::INFINITY)?;
    if !(gap.lower > 0.0) {
        return None;
    }
    let direction = (gap.on_a - gap.on_b).try_normalize()?;
    // Witnesses close to each other give a rough direction: what it takes along that direction decides.
    let (core_a, core_b) = (core_of(a).0, core_of(b).0);
    let low_of_a = a_in_b.transform_point(core_a.support(-a_in_b.inverse_transform_vector(direction)));
    let overlap = (core_b.support(direction) - low_of_a).dot(direction);
    Some(Escape { depth: (radii[0] + radii[1] + overlap.max(-gap.distance)).max(0.0), direction })
}
