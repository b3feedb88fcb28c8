//! Contact of a mesh and a box or a convex hull: triangles against the flat faces.

use elbowroom_spatial::{Pose, Vec3};

use super::contact_point::ContactPoint;
use super::crossing::LongestCrossing;
use super::surface::outward_normal;
use crate::bvh::BoxDistance;
use crate::triangle::{triangle_triangle, triangles_cross};
use crate::{Shape, TriMesh};

/// Corners of a box, and its faces as two triangles each.
const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];
const FACES: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

/// The contact of the surfaces; `None` if they do not meet.
pub(super) fn mesh_polyhedron(
    mesh: &TriMesh,
    in_world: &Pose,
    other: &Shape,
    other_in_mesh: &Pose,
) -> Option<ContactPoint> {
    let corners;
    let (vertices, faces): (&[Vec3], &[[u32; 3]]) = match other {
        Shape::Cuboid(c) => {
            let h = c.half_extents;
            corners = CORNERS.map(|[x, y, z]| Vec3::new(x * h.x, y * h.y, z * h.z));
            (&corners, &FACES)
        }
        Shape::Hull(hull) => (hull.vertices(), hull.triangles()),
        _ => return None,
    };
    let bounds = other.aabb(&Pose::IDENTITY);
    let query = BoxDistance::new(&mesh.bvh, &bounds, other_in_mesh);
    // Rounding may leave a gap of this size between surfaces that touch.
    let size = mesh.aabb().extent().max_element() + bounds.extent().max_element();
    let tolerance = 1e-12 * (size + other_in_mesh.translation.length());
    let limit = BoxDistance::limit(&mesh.bvh, tolerance);
    let mut longest = LongestCrossing::new(size);
    mesh.bvh.traverse(&query, limit, &mut |triangle| {
        let s = mesh.corners(triangle);
        for (number, face) in faces.iter().enumerate() {
            let t = face.map(|i| other_in_mesh.transform_point(vertices[i as usize]));
            if boxes_touch(&s, &t, tolerance) && triangles_touch(&s, &t, tolerance) {
                longest.offer(s, t, (triangle as u32, number as u32));
            }
        }
        limit
    });
    let c = longest.found()?;
    let (x, y) = c.triangles;
    let [p, q, r] = faces[y as usize].map(|i| other_in_mesh.transform_point(vertices[i as usize]));
    let normal = (q - p).cross(r - p).try_normalize().unwrap_or(Vec3::Z);
    Some(ContactPoint {
        on_a: in_world.transform_point(c.on_a),
        on_b: in_world.transform_point(c.on_b),
        normal_a: in_world.transform_vector(outward_normal(mesh, x as usize, c.on_a, -normal)),
        normal_b: in_world.transform_vector(normal),
        triangle_a: Some(x),
        triangle_b: None,
        touching: true,
    })
}

fn boxes_touch(s: &[Vec3; 3], t: &[Vec3; 3], tolerance: f64) -> bool {
    (0..3).all(|k| {
        let range = |t: &[Vec3; 3]| (t[0][k].min(t[1][k]).min(t[2][k]), t[0][k].max(t[1][k]).max(t[2][k]));
        let ((a, b), (c, d)) = (range(s), range(t));
        a - d <= tolerance && c - b <= tolerance
    })
}

fn triangles_touch(s: &[Vec3; 3], t: &[Vec3; 3], tolerance: f64) -> bool {
    triangles_cross(*s, *t) || triangle_triangle(*s, *t).squared <= tolerance * tolerance
}
