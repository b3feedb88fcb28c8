//! Convex solids as the outline needs them: how far they reach in a direction that tilts out of the plane.

use std::collections::HashMap;

use elbowroom_proximity::ConvexHull;
use elbowroom_spatial::{Pose, Vec3};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat};

use super::lanes::{F, mad, splat};

/// Directions of sixteen lanes, `(x, 0, z) + m·(lean, side, 0)`: with growing `m` they tilt out of the plane.
#[derive(Clone, Copy)]
pub(super) struct Tilt<S: Simd> {
    pub x: F<S>,
    pub z: F<S>,
    /// ± the tangent of half a step of θ1.
    pub lean: F<S>,
    /// 1 or −1.
    pub side: F<S>,
}

/// A reach that is linear in `m` near where it was asked: `at + m·slope`.
#[derive(Clone, Copy)]
pub(super) struct Piece<S: Simd> {
    pub at: F<S>,
    pub slope: F<S>,
}

/// A solid turned into one plane: x outward, y across, z up, from the base axis; `at` of a piece counts x and z from the
/// shoulder.
pub(super) trait Body {
    /// The solid for a plane of direction (cos, sin).
    fn turn(&mut self, plane: [f64; 2]);

    /// Directions in the plane (x outward, z up) in which its outline may be straight.
    fn own_directions(&self, lean: f32) -> impl Iterator<Item = [f32; 2]>;

    /// The linear piece of the farthest point at `m`.
    fn piece<S: Simd>(&self, simd: S, tilt: &Tilt<S>, m: F<S>) -> Piece<S>;

    /// Highest and lowest point above and below the shoulder.
    fn heights(&self) -> [f32; 2];
}

/// A point or an edge in the plane's frame.
#[derive(Debug, Clone, Copy, Default)]
struct P {
    x: f32,
    y: f32,
    z: f32,
}

fn turned(v: Vec3, [cos, sin]: [f64; 2]) -> P {
    P { x: (v.x * cos + v.y * sin) as f32, y: (v.y * cos - v.x * sin) as f32, z: v.z as f32 }
}

/// Where a face or an edge gives a straight stretch: a face of normal `n` where the wedge's side cuts it, an edge along
/// `g` where it is seen.
fn of_face(n: P, lean: f32) -> [f32; 2] {
    [n.x + n.y.abs() * -lean, n.z]
}

fn of_edge(g: P) -> [[f32; 2]; 2] {
    // An edge across the plane leaves the wedge at once.
    if g.x * g.x + g.z * g.z < 0.1 * g.y * g.y {
        return [[0.0; 2]; 2];
    }
    [[-g.z, g.x], [g.z, -g.x]]
}

/// A box: a centre and three half edges.
#[derive(Debug, Clone)]
pub(super) struct BoxBody {
    center: Vec3,
    edges: [Vec3; 3],
    shoulder: [f64; 2],
    /// In the plane: the centre, the same from the shoulder (x and z), and the half edges.
    middle: P,
    from_shoulder: P,
    half: [P; 3],
}

impl BoxBody {
    pub fn new(in_base: &Pose, half_extents: Vec3, shoulder: [f64; 2]) -> Self {
        let h = half_extents.to_array();
        let edge = |i: usize| in_base.rotation.axis(i) * h[i];
        let none = P::default();
        Self {
            center: in_base.translation,
            edges: [edge(0), edge(1), edge(2)],
            shoulder,
            middle: none,
            from_shoulder: none,
            half: [none; 3],
        }
    }
}

impl Body for BoxBody {
    fn turn(&mut self, plane: [f64; 2]) {
        self.middle = turned(self.center, plane);
        let [offset, height] = self.shoulder;
        let x = self.center.x * plane[0] + self.center.y * plane[1] - offset;
        self.from_shoulder = P { x: x as f32, y: self.middle.y, z: (self.center.z - height) as f32 };
        let [a, b, c] = self.edges;
        self.half = [turned(a, plane), turned(b, plane), turned(c, plane)];
    }

    fn own_directions(&self, lean: f32) -> impl Iterator<Item = [f32; 2]> {
        // Half edges are along the faces' normals; a flat box has none for two of its faces and needs none.
        let faces = self.half.into_iter().flat_map(move |g| {
            let length = (g.x * g.x + g.y * g.y + g.z * g.z).sqrt().max(f32::MIN_POSITIVE);
            let n = P { x: g.x / length, y: g.y / length, z: g.z / length };
            [of_face(n, lean), of_face(P { x: -n.x, y: -n.y, z: -n.z }, lean)]
        });
        faces.chain(self.half.into_iter().flat_map(of_edge))
    }

    #[inline(always)]
    fn piece<S: Simd>(&self, simd: S, tilt: &Tilt<S>, m: F<S>) -> Piece<S> {
        let s = |value: f32| splat(simd, value);
        let mut at = mad(tilt.x, s(self.from_shoulder.x), tilt.z * s(self.from_shoulder.z));
        let mut slope = mad(tilt.lean, s(self.middle.x), tilt.side * s(self.middle.y));
        let one = s(1.0);
        for g in &self.half {
            let p = mad(tilt.x, s(g.x), tilt.z * s(g.z));
            let q = mad(tilt.lean, s(g.x), tilt.side * s(g.y));
            let sign = one.copysign(mad(m, q, p));
            at = mad(sign, p, at);
            slope = mad(sign, q, slope);
        }
        Piece { at, slope }
    }

    fn heights(&self) -> [f32; 2] {
        let half: f32 = self.half.iter().map(|g| g.z.abs()).sum();
        [self.from_shoulder.z + half, half - self.from_shoulder.z]
    }
}

/// A convex polyhedron: corners, and what its faces and edges say about straight stretches.
#[derive(Debug, Clone)]
pub(super) struct HullBody {
    corners: Vec<Vec3>,
    /// Normals of the largest faces, directions of the longest edges.
    normals: Vec<Vec3>,
    edges: Vec<Vec3>,
    shoulder: [f64; 2],
    turned: Vec<P>,
    turned_normals: Vec<P>,
    turned_edges: Vec<P>,
}

impl HullBody {
    pub fn of(in_base: &Pose, hull: &ConvexHull, shoulder: [f64; 2]) -> Self {
        let corners = hull.vertices().iter().map(|&v| in_base.transform_point(v)).collect();
        let (normals, edges) = straight(hull);
        let turn = |list: Vec<Vec3>| list.into_iter().map(|v| in_base.transform_vector(v)).collect();
        let none = Vec::new;
        Self {
            corners,
            normals: turn(normals),
            edges: turn(edges),
            shoulder,
            turned: none(),
            turned_normals: none(),
            turned_edges: none(),
        }
    }
}

/// Unit normals of the largest faces and directions of the longest edges between faces that are not in one plane.
fn straight(hull: &ConvexHull) -> (Vec<Vec3>, Vec<Vec3>) {
    let corners = hull.vertices();
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| corners[i as usize]);
        (b - a).cross(c - a)
    };
    let mut faces: Vec<Vec3> = hull.triangles().iter().map(normal).collect();
    let mut edges = sharp_edges(hull, &faces);
    longest(&mut faces, 10, 1.0);
    longest(&mut edges, 6, -1.0);
    (faces, edges)
}

/// Edges whose two faces differ in direction, by their lengths.
fn sharp_edges(hull: &ConvexHull, normals: &[Vec3]) -> Vec<Vec3> {
    let mut face_of = HashMap::new();
    for (face, t) in hull.triangles().iter().enumerate() {
        for k in 0..3 {
            face_of.insert((t[k], t[(k + 1) % 3]), face);
        }
    }
    let mut found: Vec<(u32, u32)> = Vec::new();
    for (&(a, b), &face) in &face_of {
        let Some(&other) = face_of.get(&(b, a)) else { continue };
        let (n, o) = (normals[face], normals[other]);
        if a < b && n.cross(o).length() > 1e-3 * n.length() * o.length() {
            found.push((a, b));
        }
    }
    // The order of a hash map must not show in the answer.
    found.sort_unstable();
    found.into_iter().map(|(a, b)| hull.vertices()[b as usize] - hull.vertices()[a as usize]).collect()
}

/// Keeps the `most` longest as unit vectors; parallel ones (of the same sense, or of any where `sense` is −1) are added up
/// first.
fn longest(list: &mut Vec<Vec3>, most: usize, sense: f64) {
    let mut kept: Vec<Vec3> = Vec::new();
    for &v in list.iter() {
        let parallel = |k: &&mut Vec3| {
            let along = k.dot(v);
            k.cross(v).length() < 1e-4 * k.length() * v.length() && (along > 0.0 || sense < 0.0)
        };
        match kept.iter_mut().find(parallel) {
            Some(k) => *k = if k.dot(v) < 0.0 { *k - v } else { *k + v },
            None => kept.push(v),
        }
    }
    kept.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
    kept.truncate(most);
    *list = kept.into_iter().filter_map(Vec3::try_normalize).collect();
}

impl Body for HullBody {
    fn turn(&mut self, plane: [f64; 2]) {
        let into = |list: &mut Vec<P>, from: &[Vec3]| {
            list.clear();
            list.extend(from.iter().map(|&v| turned(v, plane)));
        };
        into(&mut self.turned, &self.corners);
        into(&mut self.turned_normals, &self.normals);
        into(&mut self.turned_edges, &self.edges);
    }

    fn own_directions(&self, lean: f32) -> impl Iterator<Item = [f32; 2]> {
        let faces = self.turned_normals.iter().map(move |&n| of_face(n, lean));
        faces.chain(self.turned_edges.iter().copied().flat_map(of_edge))
    }

    #[inline(always)]
    fn piece<S: Simd>(&self, simd: S, tilt: &Tilt<S>, m: F<S>) -> Piece<S> {
        let s = |value: f32| splat(simd, value);
        let (vx, vy) = (mad(m, tilt.lean, tilt.x), m * tilt.side);
        let (mut most, mut at, mut slope) = (s(f32::NEG_INFINITY), s(0.0), s(0.0));
        for p in &self.turned {
            let along = mad(vx, s(p.x), mad(vy, s(p.y), tilt.z * s(p.z)));
            let farther = along.simd_gt(most);
            most = most.max(along);
            at = farther.select(mad(tilt.x, s(p.x), tilt.z * s(p.z)), at);
            slope = farther.select(mad(tilt.lean, s(p.x), tilt.side * s(p.y)), slope);
        }
        let [offset, height] = self.shoulder;
        Piece { at: at - mad(tilt.x, s(offset as f32), tilt.z * s(height as f32)), slope }
    }

    fn heights(&self) -> [f32; 2] {
        let height = self.shoulder[1] as f32;
        let (up, down) = self.turned.iter().fold((f32::MIN, f32::MIN), |(up, down), p| (up.max(p.z), down.max(-p.z)));
        [up - height, down + height]
    }
}
