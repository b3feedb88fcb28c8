//! Where two surfaces meet: the collision point, its triangle, and the normals there (S4).
//!
//! | | the point |
//! | --- | --- |
//! | mesh – mesh, box, hull | on both surfaces: the middle of the segment in which two triangles cross, of the pair that crosses longest |
//! | mesh – ball, capsule, cylinder, half-space | of the mesh, deepest in the other (cylinder: nearly), and the other's surface next to it |
//! | simple – simple | the nearest points after the shortest way [out](crate::escape()), moved back: as far apart as they overlap |
//! | one wholly inside the other | a point of the inner one, and the surface of the outer one next to it |
//! | not touching, within a limit | the nearest points |
//!
//! What decides is computed in f64 without fused operations, so that every instruction set tells the same point. Equally long
//! crossings (to a billionth of the size) are told apart by the numbers of their triangles, smaller first, in the same way
//! whichever shape is named first.

mod faces;
mod meshes;
mod round;
mod simple;

use elbowroom_spatial::{Pose, Vec3};

use crate::mesh::{Scratch, bound_at, bound_of};
use crate::separation::usable;
use crate::{Shape, TriMesh};

/// How closely surfaces are looked at: the level of detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Detail {
    /// Boxes of the trees of meshes down to this depth; 0 is the box around all of a mesh, along the axes of its own frame.
    /// [`mesh::depth`](crate::mesh::depth) tells how deep a mesh goes. On the safe side: what is told free is.
    Boxes(u8),
    /// Triangles.
    #[default]
    Exact,
}

/// A point where two shapes touch, or where they are nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// On the surface of the first shape, in the world.
    pub on_a: Vec3,
    /// On the surface of the second: the same point, or next to it (see [the table](self)).
    pub on_b: Vec3,
    /// Outward normal of the first surface at its point, unit vector in the world.
    pub normal_a: Vec3,
    /// Outward normal of the second.
    pub normal_b: Vec3,
    /// The triangle of the first that the point is on, where it is a mesh.
    pub triangle_a: Option<u32>,
    /// The triangle of the second.
    pub triangle_b: Option<u32>,
    /// False where the shapes are apart, and the points are the nearest ones.
    pub touching: bool,
}

impl ContactPoint {
    fn swapped(self) -> Self {
        Self {
            on_a: self.on_b,
            on_b: self.on_a,
            normal_a: self.normal_b,
            normal_b: self.normal_a,
            triangle_a: self.triangle_b,
            triangle_b: self.triangle_a,
            ..self
        }
    }
}

/// The point where two shapes meet, or where they are nearest; `None` where they are certainly farther apart than `limit`
/// metres. A pose or a dimension that is not a number touches everything: the points are the origins then.
///
/// Allocates only for hulls (and boxes, cylinders and hulls against each other not at all). All pairs of triangles that
/// touch are looked at, so that deep overlaps of fine meshes take long.
///
/// ```
/// use elbowroom_proximity::contact::contact_point;
/// use elbowroom_proximity::{Cuboid, Shape, TriMesh, mesh::Scratch};
/// use elbowroom_spatial::{Pose, Vec3};
/// use std::sync::Arc;
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let wedge = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let wedge = Shape::Mesh(Arc::new(wedge));
/// let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(2.0, 2.0, 0.1) });
/// let in_the_table = Pose::from_translation(Vec3::Z * 0.09);
/// let met = contact_point(&wedge, &in_the_table, &table, &Pose::IDENTITY, 0.0, &mut Scratch::new()).unwrap();
/// assert!((met.on_a.z - 0.1).abs() < 1e-15 && met.on_a == met.on_b && met.normal_b == Vec3::Z);
/// assert!(met.triangle_a.is_some() && met.triangle_b.is_none());
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn contact_point(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    scratch: &mut Scratch,
) -> Option<ContactPoint> {
    if !(usable(a, a_in_world) && usable(b, b_in_world)) {
        return Some(unknown(a_in_world, b_in_world));
    }
    let limit = if limit.is_nan() { f64::INFINITY } else { limit.max(0.0) };
    match (a, b) {
        (Shape::Mesh(m), Shape::Mesh(n)) => meshes::meet((m, a_in_world), (n, b_in_world), (a, b), limit, scratch),
        (Shape::Mesh(m), _) => with_simple((a, m, a_in_world), (b, b_in_world), limit, scratch),
        (_, Shape::Mesh(n)) => {
            with_simple((b, n, b_in_world), (a, a_in_world), limit, scratch).map(ContactPoint::swapped)
        }
        _ => simple::meet((a, a_in_world), (b, b_in_world), limit),
    }
}

/// [`contact_point`] at a level of detail. At [`Detail::Boxes`] meshes are as large as their boxes at that depth: `None` is
/// certain, a contact may be none. The points are landmarks then, points of the surfaces (to f32 rounding) within the boxes
/// that are nearest, the normals the mean ones there, and there is no triangle. Simple shapes have no boxes below the one
/// around all of them; against each other, and against half-spaces, they are measured.
///
/// ```
/// use elbowroom_proximity::contact::{Detail, contact_at};
/// use elbowroom_proximity::{Cylinder, Shape, TriMesh, mesh::Scratch, tessellate::tessellate};
/// use elbowroom_spatial::{Pose, Vec3};
/// let (corners, faces) = tessellate(&Shape::Cylinder(Cylinder { half_length: 1.0, radius: 1.0 }), 0.001);
/// let post = Shape::Mesh(std::sync::Arc::new(TriMesh::new(corners, faces)?));
/// // The boxes around the posts touch, the posts do not.
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::new(1.5, 1.5, 0.0)));
/// let mut meet = |detail| contact_at(&post, &here, &post, &there, detail, 0.0, &mut Scratch::new()).is_some();
/// assert_eq!([Detail::Boxes(0), Detail::Exact].map(&mut meet), [true, false]);
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn contact_at(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    detail: Detail,
    limit: f64,
    scratch: &mut Scratch,
) -> Option<ContactPoint> {
    let Detail::Boxes(depth) = detail else { return contact_point(a, a_in_world, b, b_in_world, limit, scratch) };
    let limit = if limit.is_nan() { f64::INFINITY } else { limit.max(0.0) };
    let coarse = match (a, b) {
        (Shape::Mesh(m), Shape::Mesh(n)) => bound_at(m, a_in_world, n, b_in_world, depth, limit, scratch)?,
        (Shape::Mesh(m), _) => match bound_of(m, a_in_world, b, b_in_world, depth) {
            Some(coarse) => coarse,
            None => return contact_point(a, a_in_world, b, b_in_world, limit, scratch),
        },
        (_, Shape::Mesh(_)) => {
            return contact_at(b, b_in_world, a, a_in_world, detail, limit, scratch).map(ContactPoint::swapped);
        }
        _ => return contact_point(a, a_in_world, b, b_in_world, limit, scratch),
    };
    if coarse.lower_bound > limit {
        return None;
    }
    let toward = (coarse.on_b - coarse.on_a).try_normalize().unwrap_or(Vec3::Z);
    let or = |normal: Vec3, other| if normal == Vec3::ZERO { other } else { normal };
    Some(ContactPoint {
        on_a: coarse.on_a,
        on_b: coarse.on_b,
        normal_a: or(coarse.normal_a, toward),
        normal_b: or(coarse.normal_b, -toward),
        triangle_a: None,
        triangle_b: None,
        touching: coarse.lower_bound == 0.0,
    })
}

/// A mesh and what is none.
fn with_simple(
    (shape, mesh, in_world): (&Shape, &TriMesh, &Pose),
    (other, other_in_world): (&Shape, &Pose),
    limit: f64,
    scratch: &mut Scratch,
) -> Option<ContactPoint> {
    if scratch.collides(shape, in_world, other, other_in_world) {
        let other_in_mesh = in_world.inverse_mul(other_in_world);
        let found = match other {
            Shape::Cuboid(_) | Shape::Hull(_) => faces::meet(mesh, in_world, other, &other_in_mesh),
            _ => round::meet(mesh, in_world, other, &other_in_mesh),
        };
        return Some(found.unwrap_or_else(|| swallowed((shape, in_world), (other, other_in_world))));
    }
    nearest((shape, in_world), (other, other_in_world), limit)
}

/// The nearest points of shapes that are apart.
fn nearest((a, a_in_world): (&Shape, &Pose), (b, b_in_world): (&Shape, &Pose), limit: f64) -> Option<ContactPoint> {
    if limit == 0.0 {
        // They do not touch.
        return None;
    }
    let s = crate::separation_within(a, a_in_world, b, b_in_world, limit)?;
    let ((normal_a, triangle_a), (normal_b, triangle_b)) =
        (surface(a, a_in_world, s.on_a, s.on_b - s.on_a), surface(b, b_in_world, s.on_b, s.on_a - s.on_b));
    let touching = s.distance == 0.0;
    Some(ContactPoint { on_a: s.on_a, on_b: s.on_b, normal_a, normal_b, triangle_a, triangle_b, touching })
}

/// Normal and triangle of a shape at a point of its surface, where `out` leads away from the solid.
fn surface(shape: &Shape, in_world: &Pose, on: Vec3, out: Vec3) -> (Vec3, Option<u32>) {
    let out = out.try_normalize().unwrap_or(Vec3::Z);
    if let Shape::Mesh(mesh) = shape {
        let at = in_world.inverse_transform_point(on);
        let (_, triangle) = crate::separation::nearest_on_mesh(mesh, at);
        let normal = outward(mesh, triangle, at, in_world.inverse_transform_vector(out));
        return (in_world.transform_vector(normal), Some(triangle as u32));
    }
    // From a little below the surface: above it, rounding would tell the direction.
    let below = on - out * (1e-7 * (on.distance(in_world.translation) + 1e-3));
    let normal = crate::project_point(shape, in_world, below).outward;
    // Of something thinner than that it tells the other side.
    (if normal.dot(out) >= 0.0 { normal } else { out }, None)
}

/// One inside the other, no surfaces touching: a point of the inner one, and the nearest of the outer one's surface.
fn swallowed(a: (&Shape, &Pose), b: (&Shape, &Pose)) -> ContactPoint {
    inside(a, b).or_else(|| inside(b, a).map(ContactPoint::swapped)).unwrap_or_else(|| unknown(a.1, b.1))
}

/// A point of the first inside the second.
fn inside((a, a_in_world): (&Shape, &Pose), (b, b_in_world): (&Shape, &Pose)) -> Option<ContactPoint> {
    let local = match a {
        Shape::Mesh(m) => m
            .parts()
            .iter()
            .copied()
            .find(|&p| crate::project_point(b, b_in_world, a_in_world.transform_point(p)).signed_distance <= 0.0)?,
        _ => a.support(Vec3::Z),
    };
    let on_a = a_in_world.transform_point(local);
    let beside = crate::project_point(b, b_in_world, on_a);
    if !(beside.signed_distance <= 0.0) {
        return None;
    }
    let (normal_a, triangle_a) = surface(a, a_in_world, on_a, a_in_world.rotation.z_axis());
    let (normal_b, triangle_b) = surface(b, b_in_world, beside.on_surface, beside.outward);
    Some(ContactPoint { on_a, on_b: beside.on_surface, normal_a, normal_b, triangle_a, triangle_b, touching: true })
}

fn unknown(a_in_world: &Pose, b_in_world: &Pose) -> ContactPoint {
    let (on_a, on_b) = (a_in_world.translation, b_in_world.translation);
    ContactPoint {
        on_a,
        on_b,
        normal_a: Vec3::Z,
        normal_b: -Vec3::Z,
        triangle_a: None,
        triangle_b: None,
        touching: true,
    }
}

/// Unit normal of a triangle to the outside of the mesh, mesh frame: as it is drawn, unless points beside it say that the
/// solid is on that side. A triangle without area has none: `away` then, or z.
fn outward(mesh: &TriMesh, triangle: usize, at: Vec3, away: Vec3) -> Vec3 {
    let [a, b, c] = mesh.corners(triangle);
    let Some(normal) = (b - a).cross(c - a).try_normalize() else { return away.try_normalize().unwrap_or(Vec3::Z) };
    let step = normal * (1e-7 * mesh.aabb().extent().max_element());
    if mesh.contains(at + step) && !mesh.contains(at - step) { -normal } else { normal }
}
