//! Solids in small pieces: the bounds of their motion are tight, because a small piece moves almost like one point.

use std::f64::consts::PI;
use std::sync::Arc;

use elbowroom_proximity::{Capsule, Cylinder, Shape, TriMesh};
use elbowroom_spatial::{Pose, Vec3};

use crate::cuboid;

/// Largest number of pieces of one group of solids.
pub(super) const MAX_PIECES: usize = 24;
/// Largest distance of a prism from the cylinder inside it, metres.
const PRISM_TOLERANCE_M: f64 = 2e-4;
/// Largest ratio of length to width of a prism's faces.
const MAX_ASPECT_RATIO: f64 = 30.0;

/// A piece of a solid.
#[derive(Debug, Clone)]
pub(super) struct SolidPiece {
    pub shape: Shape,
    pub in_solid: Pose,
    /// Centre of a ball around the piece, in the solid's frame.
    pub center: Vec3,
    pub radius: f64,
}

impl SolidPiece {
    pub fn new(shape: Shape) -> Self {
        let bounds = shape.aabb(&Pose::IDENTITY);
        let center = bounds.center();
        let radius = match &shape {
            Shape::Mesh(mesh) => mesh.vertices().iter().map(|v| v.distance(center)).fold(0.0, f64::max),
            Shape::Sphere(s) => s.radius,
            _ => bounds.extent().length() * 0.5,
        };
        Self { shape, in_solid: Pose::IDENTITY, center, radius }
    }

    fn shifted(shape: Shape, z: f64) -> Self {
        Self::new(shape).placed(&Pose::from_translation(Vec3::Z * z))
    }

    /// Some points of the piece that are far apart, in the solid's frame.
    pub fn points(&self, count: usize) -> Vec<Vec3> {
        let Shape::Mesh(mesh) = &self.shape else { return vec![self.center] };
        let all = mesh.vertices();
        let to_center = |p: &Vec3| self.in_solid.transform_point(*p).distance(self.center);
        let first = all.iter().min_by(|a, b| to_center(a).total_cmp(&to_center(b)));
        let mut found: Vec<Vec3> = first.copied().into_iter().collect();
        while found.len() < count.min(all.len()) {
            let apart = |p: &Vec3| found.iter().map(|q| q.distance(*p)).fold(f64::INFINITY, f64::min);
            match all.iter().max_by(|a, b| apart(a).total_cmp(&apart(b))) {
                Some(p) => found.push(*p),
                None => break,
            }
        }
        found.into_iter().map(|p| self.in_solid.transform_point(p)).collect()
    }

    /// The piece with its solid placed at a pose.
    pub fn placed(self, pose: &Pose) -> Self {
        Self { in_solid: *pose * self.in_solid, center: pose.transform_point(self.center), ..self }
    }
}

/// Converts a solid to the kind of shape with the fastest queries: a mesh for flat-sided solids, a prism around a
/// cylinder.
pub(super) fn as_mesh(shape: &Shape) -> Shape {
    let faces = match shape {
        Shape::Cuboid(c) => Some((cuboid::corners(c.half_extents).to_vec(), BOX_FACES.to_vec())),
        Shape::Hull(hull) => Some((hull.vertices().to_vec(), hull.triangles().to_vec())),
        Shape::Cylinder(c) => Some(prism(c)),
        _ => None,
    };
    let mesh = faces.and_then(|(corners, faces)| TriMesh::new(corners, faces).ok());
    // A box without volume does not have an interior and does not need one: it consists only of surface.
    mesh.map_or_else(|| shape.clone(), |mesh| Shape::Mesh(Arc::new(mesh)))
}

/// A prism around a cylinder, at most about [`PRISM_TOLERANCE_M`] from it.
fn prism(cylinder: &Cylinder) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let Cylinder { half_length: h, radius } = *cylinder;
    let sides = (PI / (2.0 * PRISM_TOLERANCE_M / radius.max(PRISM_TOLERANCE_M)).sqrt()).ceil().clamp(16.0, 256.0);
    let out = radius / (PI / sides).cos() * (1.0 + 1e-12);
    let n = sides as u32;
    let corner = |i: u32| (2.0 * PI * f64::from(i) / sides).sin_cos();
    // Queries on thin triangles are slow.
    let rings = (2.0 * h * sides / (MAX_ASPECT_RATIO * 2.0 * PI * out.max(h * 1e-3))).ceil().clamp(1.0, 64.0) as u32;
    let ring = |k: u32| {
        let z = h * (2.0 * f64::from(k) / f64::from(rings) - 1.0);
        (0..n).map(corner).map(move |(s, c)| Vec3::new(out * c, out * s, z))
    };
    let corners = (0..=rings).flat_map(ring).chain([Vec3::Z * -h, Vec3::Z * h]).collect();
    let (bottom, top) = ((rings + 1) * n, (rings + 1) * n + 1);
    let mut faces = Vec::new();
    for i in 0..n {
        let j = (i + 1) % n;
        for k in 0..rings {
            let (low, high) = (k * n, (k + 1) * n);
            faces.extend([[low + i, low + j, high + j], [low + i, high + j, high + i]]);
        }
        faces.extend([[bottom, j, i], [top, rings * n + i, rings * n + j]]);
    }
    (corners, faces)
}

/// Faces of a box by the indices of [`cuboid::corners`], oriented outward.
const BOX_FACES: [[u32; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

/// Splits a capsule into pieces not longer than about twice `size`; returns other shapes unchanged.
pub(super) fn split_capsule(shape: &Shape, size: f64) -> Vec<SolidPiece> {
    match *shape {
        Shape::Capsule(Capsule { half_length, radius }) => {
            split_along_z(half_length, size.max(radius), |half_length| Shape::Capsule(Capsule { half_length, radius }))
        }
        _ => vec![SolidPiece::new(shape.clone())],
    }
}

/// Splits a long solid into a row of short ones.
fn split_along_z(half_length: f64, size: f64, shape: impl Fn(f64) -> Shape) -> Vec<SolidPiece> {
    let count = (half_length / size).ceil().clamp(1.0, MAX_PIECES as f64);
    let half = half_length / count;
    let center = |i: usize| (2.0 * i as f64 + 1.0) * half - half_length;
    (0..count as usize).map(|i| SolidPiece::shifted(shape(half), center(i))).collect()
}
