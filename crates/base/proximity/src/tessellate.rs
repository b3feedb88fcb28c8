//! Triangulation of shapes, for pictures and files.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use elbowroom_spatial::Vec3;

use crate::Shape;

/// Vertices and outward triangles of a shape's surface in its own frame.
///
/// No point of a curved surface is farther than `chord_error_m` (m) from the triangles (with at most 256 segments
/// around). Solids are closed, with shared vertices. A half-space is a square patch of 4 m. Hulls and meshes are
/// returned as they are.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere, TriMesh, tessellate::tessellate};
/// let (vertices, triangles) = tessellate(&Shape::Sphere(Sphere { radius: 0.1 }), 1e-3);
/// let mesh = TriMesh::new(vertices, triangles).unwrap();
/// assert!(mesh.report().closed && !mesh.report().inside_out);
/// ```
pub fn tessellate(shape: &Shape, chord_error_m: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    match shape {
        Shape::Sphere(s) => rounded(0.0, s.radius, chord_error_m),
        Shape::Capsule(c) => rounded(c.half_length, c.radius, chord_error_m),
        Shape::Cylinder(c) => {
            let profile = [(-c.half_length, c.radius), (c.half_length, c.radius)];
            revolve(&profile, [-c.half_length, c.half_length], segments(c.radius, chord_error_m))
        }
        Shape::Cuboid(c) => cuboid(c.half_extents),
        Shape::HalfSpace(_) => {
            let corner = |x: f64, y: f64| Vec3::new(x, y, 0.0);
            (
                vec![corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)],
                vec![[0, 1, 2], [0, 2, 3]],
            )
        }
        Shape::Hull(h) => (h.vertices().to_vec(), h.triangles().to_vec()),
        Shape::Mesh(m) => (m.vertices().to_vec(), m.triangles().to_vec()),
    }
}

/// Number of segments of a circle whose sagitta is below the error; a multiple of 4.
fn segments(radius: f64, chord_error: f64) -> usize {
    let cosine = (1.0 - chord_error / radius).clamp(-1.0, 1.0);
    let wanted = PI / cosine.acos();
    if wanted.is_finite() { (wanted.clamp(8.0, 256.0) as usize).div_ceil(4) * 4 } else { 256 }
}

fn rounded(half_length: f64, radius: f64, chord_error: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    // A sphere is curved in both directions, so each gets half the error.
    let around = segments(radius, 0.5 * chord_error);
    let rings = around / 4;
    let mut profile = Vec::with_capacity(2 * rings);
    for i in 1..=rings {
        let angle = FRAC_PI_2 * i as f64 / rings as f64;
        profile.push((-half_length - radius * angle.cos(), radius * angle.sin()));
    }
    let upper_from = usize::from(half_length <= 0.0);
    for i in upper_from..rings {
        let angle = FRAC_PI_2 * i as f64 / rings as f64;
        profile.push((half_length + radius * angle.sin(), radius * angle.cos()));
    }
    revolve(&profile, [-half_length - radius, half_length + radius], around)
}

/// Surface of revolution about z of a profile of `(z, radius)`, bottom to top, closed by a vertex at each end.
fn revolve(profile: &[(f64, f64)], ends: [f64; 2], around: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut vertices = vec![Vec3::Z * ends[0], Vec3::Z * ends[1]];
    for &(z, radius) in profile {
        vertices.extend((0..around).map(|k| {
            let (sin, cos) = (TAU * k as f64 / around as f64).sin_cos();
            Vec3::new(radius * cos, radius * sin, z)
        }));
    }
    let at = |ring: usize, k: usize| (2 + ring * around + k % around) as u32;
    let last = profile.len() - 1;
    let mut triangles = Vec::with_capacity(2 * around * profile.len());
    for k in 0..around {
        triangles.push([0, at(0, k + 1), at(0, k)]);
        triangles.push([1, at(last, k), at(last, k + 1)]);
        for ring in 0..last {
            triangles.push([at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)]);
            triangles.push([at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)]);
        }
    }
    (vertices, triangles)
}

fn cuboid(h: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let sign = |i: usize, bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let vertices = (0..8).map(|i| h.scale(Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2)))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (vertices, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}
