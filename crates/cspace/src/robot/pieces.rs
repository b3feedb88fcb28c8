//! Solids cut into small pieces: a small piece moves nearly as one point, which tells closely how far.

use std::f64::consts::PI;
use std::sync::Arc;

use elbowroom_proximity::{Capsule, Cylinder, Shape, TriMesh};
use elbowroom_spatial::{Aabb, Pose, Vec3};

/// Pieces of what moves as one at most.
const MOST: usize = 24;
/// How far (m) a prism may stand off the cylinder in it.
const ROUND_M: f64 = 2e-4;
/// How many times longer than wide the faces of a prism may be.
const SLIM: f64 = 30.0;
/// Triangles that a solid may have after long ones were cut.
const MOST_TRIANGLES: usize = 1 << 20;

/// A piece of a solid.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub shape: Shape,
    pub in_solid: Pose,
    /// A ball around it, in the solid's frame.
    pub center: Vec3,
    pub radius: f64,
}

impl Piece {
    pub fn of(shape: Shape) -> Self {
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
        Self::of(shape).placed(&Pose::from_translation(Vec3::Z * z))
    }

    /// Some points of it, far apart, in the solid's frame.
    pub fn points(&self, count: usize) -> Vec<Vec3> {
        let Shape::Mesh(mesh) = &self.shape else { return vec![self.center] };
        let all = mesh.vertices();
        let to_middle = |p: &Vec3| self.in_solid.transform_point(*p).distance(self.center);
        let first = all.iter().min_by(|a, b| to_middle(a).total_cmp(&to_middle(b)));
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

    /// The same in the frame that its own is placed in.
    pub fn placed(self, pose: &Pose) -> Self {
        Self { in_solid: *pose * self.in_solid, center: pose.transform_point(self.center), ..self }
    }
}

/// The same solid as the fastest kind of shape: flat-sided ones as meshes, and a cylinder as a prism around it.
pub(super) fn solid(shape: &Shape) -> Shape {
    let faces = match shape {
        Shape::Cuboid(c) => {
            let h = c.half_extents;
            let side = |i: u8, bit: u8| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let corners: Vec<Vec3> =
                (0..8).map(|i| Vec3::new(side(i, 0) * h.x, side(i, 1) * h.y, side(i, 2) * h.z)).collect();
            Some((corners, BOX_FACES.to_vec()))
        }
        Shape::Hull(hull) => Some((hull.vertices().to_vec(), hull.triangles().to_vec())),
        Shape::Cylinder(c) => Some(prism(c)),
        _ => None,
    };
    let mesh = faces.and_then(|(corners, faces)| TriMesh::new(corners, faces).ok());
    // A box without volume has no inside, but a box needs none: the surface is all of it.
    mesh.map_or_else(|| shape.clone(), |mesh| Shape::Mesh(Arc::new(mesh)))
}

/// A prism around a cylinder, no farther from it than [`ROUND_M`] or so.
fn prism(cylinder: &Cylinder) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let Cylinder { half_length: h, radius } = *cylinder;
    let sides = (PI / (2.0 * ROUND_M / radius.max(ROUND_M)).sqrt()).ceil().clamp(16.0, 256.0);
    let out = radius / (PI / sides).cos() * (1.0 + 1e-12);
    let n = sides as u32;
    let corner = |i: u32| (2.0 * PI * f64::from(i) / sides).sin_cos();
    // Thin triangles take long to measure.
    let rings = (2.0 * h * sides / (SLIM * 2.0 * PI * out.max(h * 1e-3))).ceil().clamp(1.0, 64.0) as u32;
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

/// Corner `i` of a box is at the upper end along axis `b` where bit `b` of `i` is set; faces turn outwards.
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

/// A round solid in pieces no longer than about twice `size`: all of it, and nothing else.
pub(super) fn cut_round(shape: &Shape, size: f64) -> Vec<Piece> {
    match *shape {
        Shape::Capsule(Capsule { half_length, radius }) => {
            along(half_length, size.max(radius), |half_length| Shape::Capsule(Capsule { half_length, radius }))
        }
        _ => vec![Piece::of(shape.clone())],
    }
}

/// A long round solid as short ones in a row.
fn along(half_length: f64, size: f64, short: impl Fn(f64) -> Shape) -> Vec<Piece> {
    let count = (half_length / size).ceil().clamp(1.0, MOST as f64);
    let half = half_length / count;
    let middle = |i: usize| (2.0 * i as f64 + 1.0) * half - half_length;
    (0..count as usize).map(|i| Piece::shifted(short(half), middle(i))).collect()
}

/// Surfaces of flat-sided solids.
#[derive(Debug, Default)]
pub(super) struct Soup {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    pub fn add(&mut self, mesh: &TriMesh, placed: &Pose) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(mesh.vertices().iter().map(|v| placed.transform_point(*v)));
        self.triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + first)));
    }

    /// Distance of the farthest vertex from the origin.
    pub fn reach(&self) -> f64 {
        self.vertices.iter().map(|v| v.length()).fold(0.0, f64::max)
    }

    /// In pieces of about this radius; `None` where something is not finite.
    pub fn cut(mut self, size: f64) -> Option<Vec<Piece>> {
        if self.triangles.is_empty() {
            return Some(Vec::new());
        }
        self.shorten(1.5 * size);
        let mut parts = vec![Part::of(&self, (0..self.triangles.len() as u32).collect())];
        while parts.len() < MOST {
            let largest = (0..parts.len()).max_by(|&a, &b| parts[a].size.total_cmp(&parts[b].size))?;
            if parts[largest].size <= 2.0 * size {
                break;
            }
            match parts.swap_remove(largest).halves(&self) {
                Ok(halves) => parts.extend(halves),
                // What cannot be cut is not looked at again.
                Err(part) => parts.push(Part { size: 0.0, ..part }),
            }
        }
        parts.iter().map(|part| part.piece(&self)).collect()
    }

    /// Cuts triangles in two across edges that are too long.
    fn shorten(&mut self, longest: f64) {
        let mut open = std::mem::take(&mut self.triangles);
        while let Some(t) = open.pop() {
            let edge = |i: usize| self.vertices[t[i] as usize].distance(self.vertices[t[(i + 1) % 3] as usize]);
            let long = (0..3).max_by(|&a, &b| edge(a).total_cmp(&edge(b))).unwrap_or(0);
            // NaN is not longer than anything.
            if edge(long) > longest && self.triangles.len() + open.len() < MOST_TRIANGLES {
                let [a, b, c] = [t[long], t[(long + 1) % 3], t[(long + 2) % 3]];
                let middle = self.vertices.len() as u32;
                self.vertices.push((self.vertices[a as usize] + self.vertices[b as usize]) * 0.5);
                open.extend([[a, middle, c], [middle, b, c]]);
            } else {
                self.triangles.push(t);
            }
        }
    }

    fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.vertices[v as usize])
    }
}

struct Part {
    triangles: Vec<u32>,
    bounds: Aabb,
    /// Length of the diagonal.
    size: f64,
}

impl Part {
    fn of(soup: &Soup, triangles: Vec<u32>) -> Self {
        let bounds = Aabb::from_points(triangles.iter().flat_map(|&t| soup.corners(t)));
        Self { triangles, size: bounds.extent().length(), bounds }
    }

    /// Cut across its longest side.
    fn halves(self, soup: &Soup) -> Result<[Self; 2], Self> {
        let extent = self.bounds.extent().to_array();
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        let middle = 3.0 * self.bounds.center()[axis];
        let is_low = |t: &u32| soup.corners(*t).iter().map(|p| p[axis]).sum::<f64>() < middle;
        let (low, high): (Vec<u32>, Vec<u32>) = self.triangles.iter().partition(|t| is_low(t));
        if low.is_empty() || high.is_empty() {
            return Err(self);
        }
        Ok([Self::of(soup, low), Self::of(soup, high)])
    }

    fn piece(&self, soup: &Soup) -> Option<Piece> {
        let mut known = std::collections::HashMap::new();
        let mut vertices = Vec::new();
        let mut number = |v: u32| {
            *known.entry(v).or_insert_with(|| {
                vertices.push(soup.vertices[v as usize]);
                vertices.len() as u32 - 1
            })
        };
        let triangles = self.triangles.iter().map(|&t| soup.triangles[t as usize].map(&mut number)).collect();
        let mesh = TriMesh::new(vertices, triangles).ok()?;
        Some(Piece::of(Shape::Mesh(Arc::new(mesh))))
    }
}
