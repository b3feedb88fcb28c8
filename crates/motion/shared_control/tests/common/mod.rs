//! Meshes that tests and benches share: a wavy relief with valleys, thin plates, balls.
#![allow(dead_code, reason = "every program uses a part of it")]

pub mod arm;

use std::collections::HashMap;
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

/// A ball of 20 · 4ⁿ triangles: an icosahedron, subdivided `n` times.
pub fn ball(radius: f64, n: usize) -> Arc<TriMesh> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut vertices: Vec<Vec3> = Vec::new();
    for (s, t) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        vertices.extend([Vec3::new(s, t, 0.0), Vec3::new(0.0, s, t), Vec3::new(t, 0.0, s)]);
    }
    let edge = |i: usize, j: usize, v: &[Vec3]| (v[i].distance(v[j]) - 2.0).abs() < 1e-9;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if edge(i, j, &vertices) && edge(j, k, &vertices) && edge(i, k, &vertices) {
                    let outward = (vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]).dot(vertices[i]) > 0.0;
                    triangles.push(if outward { [i, j, k] } else { [i, k, j] }.map(|v| v as u32));
                }
            }
        }
    }
    for _ in 0..n {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push((vertices[a as usize] + vertices[b as usize]) * 0.5);
                vertices.len() as u32 - 1
            })
        };
        let divided = triangles.iter().flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        });
        triangles = divided.collect();
    }
    let vertices = vertices.into_iter().map(|v| v * (radius / v.length())).collect();
    Arc::new(TriMesh::new(vertices, triangles).unwrap())
}

/// A box of this size around the origin.
pub fn block(size: Vec3) -> Arc<TriMesh> {
    triangle_surface(&Shape::Cuboid(Cuboid { half_extents: size * 0.5 }), 1e-4).unwrap()
}

/// A prism along y that lies with a V-shaped valley at the origin; its walls rise at `slope` to both sides.
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
pub fn pose(random: &mut SplitMix, half_width: f64, angle: f64) -> Pose {
    Pose::new(Rotation::from_rotation_vector(point(random, angle)), point(random, half_width))
}
