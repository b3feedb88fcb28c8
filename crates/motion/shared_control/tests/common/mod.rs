//! Meshes that tests and benches share: a wavy relief with valleys, thin plates, balls.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use elbowroom_proximity::contact::triangle_surface;
use elbowroom_proximity::{Cuboid, Shape, TriMesh};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;

/// A block with `side` · `side` vertices on its upper side: sharp waves along x, smooth ones along y, 0.4 m wide.
pub fn relief(side: usize) -> Arc<TriMesh> {
    let at = |i: usize| 0.4 * i as f64 / (side - 1) as f64 - 0.2;
    let mut vertices = Vec::new();
    for j in 0..side {
        for i in 0..side {
            let (x, y) = (at(i), at(j));
            let sharp = ((x / 0.04).rem_euclid(1.0) - 0.5).abs();
            vertices.push(Vec3::new(x, y, 0.01 * sharp + 0.004 * (y / 0.013).sin()));
        }
    }
    let number = |i: usize, j: usize| (j * side + i) as u32;
    let mut triangles = Vec::new();
    for j in 0..side - 1 {
        for i in 0..side - 1 {
            let (p, q, r, s) = (number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1));
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    // The sides meet in one point below.
    let below = vertices.len() as u32;
    vertices.push(Vec3::Z * -0.1);
    for k in 0..side - 1 {
        let end = side - 1;
        triangles.extend([
            [number(k + 1, 0), number(k, 0), below],
            [number(end, k + 1), number(end, k), below],
            [number(k, end), number(k + 1, end), below],
            [number(0, k), number(0, k + 1), below],
        ]);
    }
    Arc::new(TriMesh::new(vertices, triangles).unwrap())
}

/// A ball of about 2 · rings² · 2 triangles.
pub fn ball(radius: f64, rings: usize) -> Arc<TriMesh> {
    let sectors = 2 * rings;
    let mut vertices = vec![Vec3::Z * radius];
    for ring in 1..rings {
        let polar = PI * ring as f64 / rings as f64;
        for sector in 0..sectors {
            let around = TAU * sector as f64 / sectors as f64;
            vertices.push(Vec3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos()) * radius);
        }
    }
    vertices.push(Vec3::Z * -radius);
    let at = |ring: usize, sector: usize| (1 + (ring - 1) * sectors + sector % sectors) as u32;
    let last = vertices.len() as u32 - 1;
    let mut faces = Vec::new();
    for s in 0..sectors {
        faces.push([0, at(1, s), at(1, s + 1)]);
        for r in 1..rings - 1 {
            faces.push([at(r, s), at(r + 1, s), at(r + 1, s + 1)]);
            faces.push([at(r, s), at(r + 1, s + 1), at(r, s + 1)]);
        }
        faces.push([last, at(rings - 1, s + 1), at(rings - 1, s)]);
    }
    Arc::new(TriMesh::new(vertices, faces).unwrap())
}

/// A box of this size around the origin.
pub fn block(size: Vec3) -> Arc<TriMesh> {
    triangle_surface(&Shape::Cuboid(Cuboid { half_extents: size * 0.5 }), 1e-4).unwrap()
}

/// A prism along y that lies with a V-shaped valley at the origin; its walls rise at `slope` to both sides.
#[allow(dead_code, reason = "the bench has no valley")]
pub fn valley(slope: f64) -> Arc<TriMesh> {
    let section = [(-0.2, 0.2 * slope), (0.0, 0.0), (0.2, 0.2 * slope), (0.2, -0.1), (-0.2, -0.1)];
    let mut vertices: Vec<Vec3> = section.iter().map(|&(x, z)| Vec3::new(x, -0.3, z)).collect();
    vertices.extend(section.iter().map(|&(x, z)| Vec3::new(x, 0.3, z)));
    let mut triangles = Vec::new();
    for k in 0..5 {
        let next = (k + 1) % 5;
        triangles.extend([[k, next, next + 5], [k, next + 5, k + 5]]);
    }
    for front in [[0, 4, 1], [1, 4, 3], [1, 3, 2]] {
        triangles.push(front);
        triangles.push([front[0] + 5, front[2] + 5, front[1] + 5]);
    }
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    assert!(mesh.report().closed && !mesh.report().inside_out, "{:?}", mesh.report());
    Arc::new(mesh)
}

/// A point in a cube of this half width.
pub fn point(random: &mut SplitMix, half_width: f64) -> Vec3 {
    Vec3::from(random.within(half_width))
}

/// A pose in a cube of this half width, turned by up to `angle` about any axis.
#[allow(dead_code, reason = "the bench keeps the orientation")]
pub fn pose(random: &mut SplitMix, half_width: f64, angle: f64) -> Pose {
    Pose::new(Rotation::from_rotation_vector(point(random, angle)), point(random, half_width))
}
