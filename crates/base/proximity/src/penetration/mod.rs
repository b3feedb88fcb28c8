//! Penetration depth and direction.

mod expanding_polytope;
mod least_overlap;

use std::sync::Arc;

use elbowroom_spatial::{Pose, Vec3};

use crate::separation::core::{Core, rounded};
use crate::separation::{best_axis, convex};
use crate::{Shape, TriMesh, collides, project_point};

/// The penetration of two shapes: a translation that separates them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penetration {
    /// Penetration depth: the distance by which to move the first shape, metres. 0 if the shapes just touch; infinite if
    /// no translation separates them.
    pub depth: f64,
    /// Direction in which to move the first shape, a unit vector in the world.
    pub direction: Vec3,
}

/// The shortest translation of `a` that separates it from `b`; `None` if they are apart.
///
/// A translation by `depth * direction` always separates the shapes (up to rounding). It is the shortest one
/// - exactly, for spheres against all convex shapes, for half-spaces, for boxes (15 axes) and for capsules against
///   capsules and boxes;
/// - within 1e-9 of the size for cylinders, by a search that is tested against brute force but not proven;
/// - for hulls, within 1e-9 of the size if the difference of the two has flat faces, within about 1e-4 if it is
///   curved;
/// - for meshes, for their convex hulls: the translation out of a notch of a mesh may be shorter than the returned
///   one.
///
/// Does not allocate for pairs of spheres, capsules, cylinders, boxes and half-spaces.
///
/// ```
/// use elbowroom_proximity::{Cuboid, Shape, Sphere, penetration};
/// use elbowroom_spatial::{Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.5, 0.5, 0.2) });
/// let found = penetration(&ball, &Pose::from_translation(Vec3::Z * 0.15), &table, &Pose::IDENTITY).unwrap();
/// assert!((found.depth - 0.15).abs() < 1e-15 && found.direction == Vec3::Z);
/// assert!(penetration(&ball, &Pose::from_translation(Vec3::Z * 0.31), &table, &Pose::IDENTITY).is_none());
/// ```
pub fn penetration(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> Option<Penetration> {
    if !(a.is_usable(a_in_world) && b.is_usable(b_in_world)) {
        return Some(Penetration { depth: f64::INFINITY, direction: Vec3::Z });
    }
    if !collides(a, a_in_world, b, b_in_world) {
        return None;
    }
    match (a, b) {
        (Shape::HalfSpace(_), Shape::HalfSpace(_)) => Some(two_half_spaces(a_in_world, b_in_world)),
        (_, Shape::HalfSpace(_)) => Some(half_space(a, a_in_world, b_in_world)),
        (Shape::HalfSpace(_), _) => Some(reversed(half_space(b, b_in_world, a_in_world))),
        (Shape::Mesh(m), _) => Some(with_hull(m, |s| bounded(s, a_in_world, b, b_in_world))),
        (_, Shape::Mesh(m)) => Some(with_hull(m, |s| bounded(a, a_in_world, s, b_in_world))),
        _ => Some(bounded(a, a_in_world, b, b_in_world)),
    }
}

fn reversed(e: Penetration) -> Penetration {
    Penetration { direction: -e.direction, ..e }
}

fn two_half_spaces(a_in_world: &Pose, b_in_world: &Pose) -> Penetration {
    let a_in_b = b_in_world.inverse_mul(a_in_world);
    let opposite = a_in_b.rotation.z_axis().z < -1.0 + 1e-15;
    let depth = if opposite { (-a_in_b.translation.z).max(0.0) } else { f64::INFINITY };
    Penetration { depth, direction: b_in_world.rotation.z_axis() }
}

/// Penetration of a bounded shape and a half-space.
fn half_space(a: &Shape, a_in_world: &Pose, b_in_world: &Pose) -> Penetration {
    let normal = b_in_world.rotation.z_axis();
    let lowest = a_in_world.transform_point(a.support(-a_in_world.inverse_transform_vector(normal)));
    let height = (lowest - b_in_world.translation).dot(normal);
    Penetration { depth: (-height).max(0.0), direction: normal }
}

/// Queries the hull of a mesh; a flat mesh has no hull, and its vertices are used.
fn with_hull(m: &TriMesh, query: impl Fn(&Shape) -> Penetration) -> Penetration {
    match m.hull() {
        Some(hull) => query(&Shape::Hull(Arc::new(hull.clone()))),
        None => query(&Shape::Mesh(Arc::new(m.clone()))),
    }
}

/// Penetration of two shapes that are not half-spaces; either may be a mesh.
fn bounded(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> Penetration {
    if let Shape::Mesh(m) = b
        && let Some(hull) = m.hull()
    {
        return bounded(a, a_in_world, &Shape::Hull(Arc::new(hull.clone())), b_in_world);
    }
    let (core_a, ra) = core_of(a);
    let (core_b, rb) = core_of(b);
    let a_in_b = b_in_world.inverse_mul(a_in_world);
    if let Some(e) = shallow(a, b, &a_in_b) {
        return Penetration { direction: b_in_world.transform_vector(e.direction), ..e };
    }
    match (core_a, core_b) {
        (Core::Point, _) if !matches!(b, Shape::Mesh(_)) => {
            let s = project_point(b, b_in_world, a_in_world.translation);
            Penetration { depth: (ra - s.signed_distance).max(0.0), direction: s.outward }
        }
        (_, Core::Point) if !matches!(a, Shape::Mesh(_)) => {
            let s = project_point(a, a_in_world, b_in_world.translation);
            Penetration { depth: (rb - s.signed_distance).max(0.0), direction: -s.outward }
        }
        (Core::Cuboid(x), Core::Cuboid(y)) => {
            let best = best_axis(&x, &y, &a_in_b);
            Penetration { depth: (-best.gap).max(0.0), direction: b_in_world.transform_vector(best.axis) }
        }
        _ if core_a.has_closed_projection() && core_b.has_closed_projection() => {
            let (depth, direction) = least_overlap::least_overlap(&core_a, &core_b, &a_in_b);
            Penetration { depth: (depth + ra + rb).max(0.0), direction: b_in_world.transform_vector(direction) }
        }
        _ => {
            let (depth, direction) = expanding_polytope::expanding_polytope(&core_a, &core_b, &a_in_b);
            Penetration { depth: (depth + ra + rb).max(0.0), direction: b_in_world.transform_vector(direction) }
        }
    }
}

fn core_of(s: &Shape) -> (Core<'_>, f64) {
    match s {
        Shape::Mesh(m) => (Core::Points(m.vertices()), 0.0),
        _ => rounded(s).unwrap_or((Core::Point, 0.0)),
    }
}

/// Penetration if the cores are apart and only the radii overlap: along the witness points of the cores. Frame of b.
fn shallow(a: &Shape, b: &Shape, a_in_b: &Pose) -> Option<Penetration> {
    let (gap, radii) = convex(a, b, a_in_b, f64::INFINITY)?;
    if !(gap.lower > 0.0) {
        return None;
    }
    let direction = (gap.on_a - gap.on_b).try_normalize()?;
    // Witness points close to each other give an inaccurate direction, so the overlap along it decides.
    let (core_a, core_b) = (core_of(a).0, core_of(b).0);
    let low_of_a = a_in_b.transform_point(core_a.support(-a_in_b.inverse_transform_vector(direction)));
    let overlap = (core_b.support(direction) - low_of_a).dot(direction);
    Some(Penetration { depth: (radii[0] + radii[1] + overlap.max(-gap.distance)).max(0.0), direction })
}
