//! Convex solids in the frame of one plane of the arm: linear pieces of their support functions.

use std::collections::HashMap;

use elbowroom_proximity::ConvexHull;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, SimdFloat};

use super::simd_math::{Lanes, mad, splat};

/// Directions of sixteen lanes, `(x, 0, z) + m·(lean, side, 0)`: with increasing `m` they tilt out of the plane.
#[derive(Clone, Copy)]
pub(super) struct TiltedDirections<S: Simd> {
    pub x: Lanes<S>,
    pub z: Lanes<S>,
    /// ± the tangent of half a step of θ1.
    pub lean: Lanes<S>,
    /// 1 or −1.
    pub side: Lanes<S>,
}

/// A support function that is linear in `m` near the `m` at which it was evaluated: `at + m·slope`.
#[derive(Clone, Copy)]
pub(super) struct LinearPiece<S: Simd> {
    pub at: Lanes<S>,
    pub slope: Lanes<S>,
}

/// A solid in the frame of one plane: x outward, y across, z up, from the base axis; `at` of a linear piece measures x
/// and z from the shoulder.
pub(super) trait PlaneSolid {
    /// Selects the plane of direction (cos, sin).
    fn rotate_to_plane(&mut self, plane: [f64; 2]);

    /// Directions in the plane (x outward, z up) in which the outline may have straight stretches.
    fn own_directions(&self, lean: f32) -> impl Iterator<Item = [f32; 2]>;

    /// The linear piece of the support function at `m`.
    fn linear_piece<S: Simd>(&self, simd: S, directions: &TiltedDirections<S>, m: Lanes<S>) -> LinearPiece<S>;

    /// Extents above and below the shoulder.
    fn vertical_extents(&self) -> [f32; 2];
}

/// A vector in the plane's frame.
#[derive(Debug, Clone, Copy, Default)]
struct PlaneVector {
    x: f32,
    y: f32,
    z: f32,
}

fn in_plane(v: Vec3, [cos, sin]: [f64; 2]) -> PlaneVector {
    PlaneVector { x: (v.x * cos + v.y * sin) as f32, y: (v.y * cos - v.x * sin) as f32, z: v.z as f32 }
}

/// Normal, in the plane, of the line in which the wedge's side cuts a face with normal `n`.
fn face_direction(n: PlaneVector, lean: f32) -> [f32; 2] {
    [n.x + n.y.abs() * -lean, n.z]
}

/// Normals, in the plane, of the projection of an edge along `g`.
fn edge_directions(g: PlaneVector) -> [[f32; 2]; 2] {
    // An edge across the plane leaves the wedge after a short length.
    if g.x * g.x + g.z * g.z < 0.1 * g.y * g.y {
        return [[0.0; 2]; 2];
    }
    [[-g.z, g.x], [g.z, -g.x]]
}

/// A box: a centre and three half edges.
#[derive(Debug, Clone)]
pub(super) struct PlaneBox {
    center: Vec3,
    edges: [Vec3; 3],
    shoulder: [f64; 2],
    /// In the plane: the centre, the centre with x and z from the shoulder, and the half edges.
    middle: PlaneVector,
    from_shoulder: PlaneVector,
    half: [PlaneVector; 3],
}

impl PlaneBox {
    pub fn new(in_base: &Pose, half_extents: Vec3, shoulder: [f64; 2]) -> Self {
        let h = half_extents.to_array();
        let edge = |i: usize| in_base.rotation.axis(i) * h[i];
        let none = PlaneVector::default();
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

impl PlaneSolid for PlaneBox {
    fn rotate_to_plane(&mut self, plane: [f64; 2]) {
        self.middle = in_plane(self.center, plane);
        let [offset, height] = self.shoulder;
        let x = self.center.x * plane[0] + self.center.y * plane[1] - offset;
        self.from_shoulder = PlaneVector { x: x as f32, y: self.middle.y, z: (self.center.z - height) as f32 };
        let [a, b, c] = self.edges;
        self.half = [in_plane(a, plane), in_plane(b, plane), in_plane(c, plane)];
    }

    fn own_directions(&self, lean: f32) -> impl Iterator<Item = [f32; 2]> {
        // Half edges are parallel to the faces' normals. A flat box has no normals for two of its faces and does not
        // need them.
        let faces = self.half.into_iter().flat_map(move |g| {
            let length = (g.x * g.x + g.y * g.y + g.z * g.z).sqrt().max(f32::MIN_POSITIVE);
            let n = PlaneVector { x: g.x / length, y: g.y / length, z: g.z / length };
            [face_direction(n, lean), face_direction(PlaneVector { x: -n.x, y: -n.y, z: -n.z }, lean)]
        });
        faces.chain(self.half.into_iter().flat_map(edge_directions))
    }

    #[inline(always)]
    fn linear_piece<S: Simd>(&self, simd: S, directions: &TiltedDirections<S>, m: Lanes<S>) -> LinearPiece<S> {
        let s = |value: f32| splat(simd, value);
        let mut at = mad(directions.x, s(self.from_shoulder.x), directions.z * s(self.from_shoulder.z));
        let mut slope = mad(directions.lean, s(self.middle.x), directions.side * s(self.middle.y));
        let one = s(1.0);
        for g in &self.half {
            let p = mad(directions.x, s(g.x), directions.z * s(g.z));
            let q = mad(directions.lean, s(g.x), directions.side * s(g.y));
            let sign = one.copysign(mad(m, q, p));
            at = mad(sign, p, at);
            slope = mad(sign, q, slope);
        }
        LinearPiece { at, slope }
    }

    fn vertical_extents(&self) -> [f32; 2] {
        let half: f32 = self.half.iter().map(|g| g.z.abs()).sum();
        [self.from_shoulder.z + half, half - self.from_shoulder.z]
    }
}

/// A convex polyhedron: its corners, and the faces and edges that cause straight stretches of its outline.
#[derive(Debug, Clone)]
pub(super) struct PlaneHull {
    corners: Vec<Vec3>,
    /// Normals of the largest faces, and (in the next field) directions of the longest edges.
    normals: Vec<Vec3>,
    edges: Vec<Vec3>,
    shoulder: [f64; 2],
    corners_in_plane: Vec<PlaneVector>,
    normals_in_plane: Vec<PlaneVector>,
    edges_in_plane: Vec<PlaneVector>,
}

impl PlaneHull {
    pub fn new(in_base: &Pose, hull: &ConvexHull, shoulder: [f64; 2]) -> Self {
        let corners = hull.vertices().iter().map(|&v| in_base.transform_point(v)).collect();
        let (normals, edges) = flat_features(hull);
        let to_base = |list: Vec<Vec3>| list.into_iter().map(|v| in_base.transform_vector(v)).collect();
        Self {
            corners,
            normals: to_base(normals),
            edges: to_base(edges),
            shoulder,
            corners_in_plane: Vec::new(),
            normals_in_plane: Vec::new(),
            edges_in_plane: Vec::new(),
        }
    }
}

/// Unit normals of the largest faces, and directions of the longest edges between faces that are not coplanar.
fn flat_features(hull: &ConvexHull) -> (Vec<Vec3>, Vec<Vec3>) {
    let corners = hull.vertices();
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| corners[i as usize]);
        (b - a).cross(c - a)
    };
    let mut faces: Vec<Vec3> = hull.triangles().iter().map(normal).collect();
    let mut edges = sharp_edges(hull, &faces);
    keep_longest(&mut faces, 10, Parallel::SameSense);
    keep_longest(&mut edges, 6, Parallel::EitherSense);
    (faces, edges)
}

/// Edges between faces of different direction, as vectors.
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
    // Sorted, so that the result does not depend on the order of the hash map.
    found.sort_unstable();
    found.into_iter().map(|(a, b)| hull.vertices()[b as usize] - hull.vertices()[a as usize]).collect()
}

/// The relation by which vectors count as parallel.
#[derive(Clone, Copy, PartialEq)]
enum Parallel {
    SameSense,
    EitherSense,
}

/// Keeps the `most` longest vectors as unit vectors, after adding up parallel ones.
fn keep_longest(list: &mut Vec<Vec3>, most: usize, parallel: Parallel) {
    let mut kept: Vec<Vec3> = Vec::new();
    for &v in list.iter() {
        let is_parallel = |k: &&mut Vec3| {
            let along = k.dot(v);
            let sense = along > 0.0 || parallel == Parallel::EitherSense;
            k.cross(v).length() < 1e-4 * k.length() * v.length() && sense
        };
        match kept.iter_mut().find(is_parallel) {
            Some(k) => *k = if k.dot(v) < 0.0 { *k - v } else { *k + v },
            None => kept.push(v),
        }
    }
    kept.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
    kept.truncate(most);
    *list = kept.into_iter().filter_map(Vec3::try_normalize).collect();
}

impl PlaneSolid for PlaneHull {
    fn rotate_to_plane(&mut self, plane: [f64; 2]) {
        let rotate = |list: &mut Vec<PlaneVector>, from: &[Vec3]| {
            list.clear();
            list.extend(from.iter().map(|&v| in_plane(v, plane)));
        };
        rotate(&mut self.corners_in_plane, &self.corners);
        rotate(&mut self.normals_in_plane, &self.normals);
        rotate(&mut self.edges_in_plane, &self.edges);
    }

    fn own_directions(&self, lean: f32) -> impl Iterator<Item = [f32; 2]> {
        let faces = self.normals_in_plane.iter().map(move |&n| face_direction(n, lean));
        faces.chain(self.edges_in_plane.iter().copied().flat_map(edge_directions))
    }

    #[inline(always)]
    fn linear_piece<S: Simd>(&self, simd: S, directions: &TiltedDirections<S>, m: Lanes<S>) -> LinearPiece<S> {
        let s = |value: f32| splat(simd, value);
        let (vx, vy) = (mad(m, directions.lean, directions.x), m * directions.side);
        let (mut most, mut at, mut slope) = (s(f32::NEG_INFINITY), s(0.0), s(0.0));
        for p in &self.corners_in_plane {
            let along = mad(vx, s(p.x), mad(vy, s(p.y), directions.z * s(p.z)));
            let farther = along.simd_gt(most);
            most = most.max(along);
            at = farther.select(mad(directions.x, s(p.x), directions.z * s(p.z)), at);
            slope = farther.select(mad(directions.lean, s(p.x), directions.side * s(p.y)), slope);
        }
        let [offset, height] = self.shoulder;
        LinearPiece { at: at - mad(directions.x, s(offset as f32), directions.z * s(height as f32)), slope }
    }

    fn vertical_extents(&self) -> [f32; 2] {
        let height = self.shoulder[1] as f32;
        let extents = |(up, down): (f32, f32), p: &PlaneVector| (up.max(p.z), down.max(-p.z));
        let (up, down) = self.corners_in_plane.iter().fold((f32::MIN, f32::MIN), extents);
        [up - height, down + height]
    }
}
