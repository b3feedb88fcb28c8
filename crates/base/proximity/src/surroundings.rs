//! What surrounds a solid, as a solid: for a region that a robot must not leave.

use elbowroom_spatial::{Aabb, Vec3};

use crate::tessellate::tessellate;
use crate::{Cuboid, MeshError, Shape, TriMesh};

/// Vertices and triangles of the outer side, which are the last ones.
const OUTER_VERTICES: usize = 8;
const OUTER_TRIANGLES: usize = 12;

/// Why a solid has no surroundings.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SurroundingsError {
    /// The mesh is open, so that nothing is inside.
    #[error("the mesh is open: it has no inside")]
    Open,
    /// The other side of a half-space is a half-space.
    #[error("a half-space has no inside that can be enclosed")]
    HalfSpace,
    /// The solid has no surface, or one that is too large.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// A wall of the given thickness (m) around the solid, as a closed mesh in the solid's frame: a box with a cavity.
///
/// A curved surface is replaced by triangles with their vertices on it, so that the cavity of a convex solid is inside of
/// the solid and nowhere smaller by more than `chord_error_m` (m, with at most 256 segments around).
///
/// ```
/// use elbowroom_proximity::{Cuboid, Shape, Sphere, separation, surroundings::surroundings};
/// use elbowroom_spatial::{Pose, Vec3};
/// let room = Shape::Cuboid(Cuboid { half_extents: Vec3::new(2.0, 2.0, 1.0) });
/// let wall = Shape::Mesh(surroundings(&room, 1e-3, 5.0)?.into());
/// let ball = Shape::Sphere(Sphere { radius: 0.3 });
/// let to_wall = |x: f64| separation(&ball, &Pose::from_translation(Vec3::X * x), &wall, &Pose::IDENTITY).distance;
/// assert!((to_wall(1.5) - 0.2).abs() < 1e-9 && to_wall(1.8) == 0.0 && to_wall(4.0) == 0.0);
/// # Ok::<(), elbowroom_proximity::surroundings::SurroundingsError>(())
/// ```
///
/// # Errors
/// [`SurroundingsError`]: a half-space, or a mesh that is not closed.
pub fn surroundings(shape: &Shape, chord_error_m: f64, wall_m: f64) -> Result<TriMesh, SurroundingsError> {
    let faces_inwards = match shape {
        Shape::HalfSpace(_) => return Err(SurroundingsError::HalfSpace),
        Shape::Mesh(mesh) if !mesh.report().closed => return Err(SurroundingsError::Open),
        Shape::Mesh(mesh) => mesh.report().inside_out,
        _ => false,
    };
    let (mut vertices, mut triangles) = tessellate(shape, chord_error_m);
    if !faces_inwards {
        for triangle in &mut triangles {
            triangle.swap(1, 2);
        }
    }
    let bounds = Aabb::from_points(vertices.iter().copied());
    let half_extents = bounds.extent() * 0.5 + Vec3::splat(wall_m);
    let (corners, sides) = tessellate(&Shape::Cuboid(Cuboid { half_extents }), chord_error_m);
    let first = u32::try_from(vertices.len()).map_err(|_| MeshError::TooLarge(vertices.len()))?;
    vertices.extend(corners.iter().map(|corner| *corner + bounds.center()));
    triangles.extend(sides.iter().map(|side| side.map(|i| i + first)));
    Ok(TriMesh::new(vertices, triangles)?)
}

/// Vertices and triangles of the cavity of a mesh that [`surroundings`] made, facing into it; `None` for any other mesh.
pub fn cavity(mesh: &TriMesh) -> Option<(Vec<Vec3>, Vec<[u32; 3]>)> {
    let inner = mesh.vertices().len().checked_sub(OUTER_VERTICES)?;
    let sides = mesh.triangles().len().checked_sub(OUTER_TRIANGLES).filter(|sides| *sides > 0)?;
    let (vertices, corners) = mesh.vertices().split_at(inner);
    let (triangles, outer) = mesh.triangles().split_at(sides);
    let half_extents = mesh.aabb().extent() * 0.5;
    let (expected, expected_sides) = tessellate(&Shape::Cuboid(Cuboid { half_extents }), 1.0);
    let near = 1e-9 * half_extents.max_element();
    let is_outer = corners.iter().zip(expected).all(|(c, e)| (*c - mesh.aabb().center()).distance(e) <= near)
        && outer.iter().zip(expected_sides).all(|(t, e)| *t == e.map(|i| i + inner as u32))
        && triangles.iter().flatten().all(|i| (*i as usize) < inner);
    is_outer.then(|| (vertices.to_vec(), triangles.to_vec()))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use elbowroom_spatial::Pose;
    use proptest::prelude::*;

    use super::*;
    use crate::{Capsule, ConvexHull, Cylinder, HalfSpace, Sphere, project_point, separation};

    const CHORD_M: f64 = 1e-3;

    /// A ring of square section: not convex.
    fn ring() -> Shape {
        let corner = |k: usize, r: f64, z: f64| {
            let angle = std::f64::consts::TAU * k as f64 / 24.0;
            Vec3::new(r * angle.cos(), r * angle.sin(), z)
        };
        let profile = [(0.5, -0.2), (1.0, -0.2), (1.0, 0.2), (0.5, 0.2)];
        let vertices = (0..24).flat_map(|k| profile.map(|(r, z)| corner(k, r, z))).collect();
        let at = |k: usize, p: usize| ((k % 24) * 4 + p % 4) as u32;
        let quad = |k: usize, p: usize| {
            [[at(k, p), at(k + 1, p), at(k + 1, p + 1)], [at(k, p), at(k + 1, p + 1), at(k, p + 1)]]
        };
        let triangles = (0..24).flat_map(|k| (0..4).flat_map(move |p| quad(k, p))).collect();
        Shape::Mesh(TriMesh::new(vertices, triangles).unwrap().into())
    }

    fn solids() -> Vec<Shape> {
        let hull = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.8, 0.8, 0.8)];
        vec![
            Shape::Sphere(Sphere { radius: 0.7 }),
            Shape::Capsule(Capsule { half_length: 0.4, radius: 0.5 }),
            Shape::Cylinder(Cylinder { half_length: 0.6, radius: 0.9 }),
            Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.5, 1.0, 0.3) }),
            Shape::Hull(Arc::new(ConvexHull::from_points(&hull).unwrap())),
            ring(),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3_000))]
        /// The depth of a point inside of the solid is its distance from the surroundings, less the chord error; a point
        /// outside of the solid is inside of the surroundings.
        #[test]
        fn the_inside_is_the_outside_of_the_surroundings(which in 0..6_usize, p in prop::array::uniform3(-1.6..1.6_f64)) {
            let shape = &solids()[which];
            let wall = Shape::Mesh(surroundings(shape, CHORD_M, 3.0).unwrap().into());
            let p = Vec3::from(p);
            let signed = project_point(shape, &Pose::IDENTITY, p).signed_distance;
            let point = Shape::Sphere(Sphere { radius: 0.0 });
            let free = separation(&point, &Pose::from_translation(p), &wall, &Pose::IDENTITY).distance;
            if signed >= 0.0 {
                prop_assert!(free <= 1e-9, "{shape:?}: {signed} outside, {free} free");
            } else {
                prop_assert!(free <= -signed + 1e-9 && free >= -signed - 1.01 * CHORD_M, "{shape:?}: {signed}, {free} free");
            }
        }
    }

    #[test]
    fn the_cavity_is_found_again_and_nothing_else_is_one() {
        for shape in solids() {
            let wall = surroundings(&shape, CHORD_M, 3.0).unwrap();
            assert!(wall.report().closed && !wall.report().inside_out);
            let (vertices, triangles) = cavity(&wall).unwrap();
            let inner = TriMesh::new(vertices, triangles).unwrap();
            assert!(inner.report().inside_out, "{shape:?}");
            assert!(inner.report().volume.abs() < wall.report().volume);
            let (vertices, triangles) = tessellate(&shape, CHORD_M);
            assert!(cavity(&TriMesh::new(vertices, triangles).unwrap()).is_none());
        }
    }

    #[test]
    fn what_has_no_inside_is_refused() {
        let open = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
        assert_eq!(surroundings(&Shape::Mesh(open.into()), CHORD_M, 1.0).unwrap_err(), SurroundingsError::Open);
        assert_eq!(surroundings(&Shape::HalfSpace(HalfSpace), CHORD_M, 1.0).unwrap_err(), SurroundingsError::HalfSpace);
    }

    #[test]
    fn a_mesh_that_faces_inwards_has_the_same_inside() {
        let Shape::Mesh(mesh) = ring() else { unreachable!() };
        let flipped = mesh.triangles().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
        let flipped = Shape::Mesh(TriMesh::new(mesh.vertices().to_vec(), flipped).unwrap().into());
        let free = |shape: &Shape| {
            let wall = Shape::Mesh(surroundings(shape, CHORD_M, 3.0).unwrap().into());
            let at = Pose::from_translation(Vec3::X * 0.7);
            separation(&Shape::Sphere(Sphere { radius: 0.0 }), &at, &wall, &Pose::IDENTITY).distance
        };
        assert!(free(&flipped) > 0.1 && free(&flipped).to_bits() == free(&ring()).to_bits());
    }
}
