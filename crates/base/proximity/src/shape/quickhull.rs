//! Quickhull in f64 (Barber, Dobkin, Huhdanpaa, "The Quickhull Algorithm for Convex Hulls", 1996).

use std::collections::HashMap;

use elbowroom_spatial::{Aabb, Vec3};

use super::hull_error::HullError;

type Faces = (Vec<Vec3>, Vec<[u32; 3]>);

struct Face {
    corners: [u32; 3],
    normal: Vec3,
    offset: f64,
    /// Points above this face; each point is stored with one face only.
    outside: Vec<u32>,
    alive: bool,
}

/// Vertices (only vertices of the hull) and outward faces.
pub(super) fn quickhull(points: &[Vec3]) -> Result<Faces, HullError> {
    if points.len() < 4 {
        return Err(HullError::TooFew(points.len()));
    }
    if let Some(i) = points.iter().position(|p| !p.is_finite()) {
        return Err(HullError::NotFinite(i));
    }
    let bounds = Aabb::from_points(points.iter().copied());
    // Points are centred and scaled to unit size, so that tolerances are dimensionless and products do not overflow.
    let extent = bounds.extent().max_element();
    let magnitude = bounds.min.abs().max(bounds.max.abs()).max_element();
    if !(extent > magnitude * 1e-14) || extent < 1e-290 {
        return Err(HullError::Point);
    }
    let middle = bounds.min * 0.5 + bounds.max * 0.5;
    let unit: Vec<Vec3> = points.iter().map(|&p| (p - middle) / extent).collect();
    // The resolution of f64 at this distance from the origin, and at this size.
    let tolerance = (8.0 * f64::EPSILON * magnitude / extent).max(1e-13);
    let mut hull = Builder::start(&unit, tolerance)?;
    hull.grow()?;
    hull.finish(points)
}

/// Faces visible from a point, and the directed edges around them.
type Horizon = (Vec<u32>, Vec<(u32, u32)>);

struct Builder<'a> {
    points: &'a [Vec3],
    tolerance: f64,
    faces: Vec<Face>,
    /// The face of each directed edge.
    edge: HashMap<(u32, u32), u32>,
}

impl<'a> Builder<'a> {
    fn start(points: &'a [Vec3], tolerance: f64) -> Result<Self, HullError> {
        let mut hull = Self { points, tolerance, faces: Vec::new(), edge: HashMap::new() };
        let [a, b, c, d] = simplex(points, tolerance)?;
        for corners in [[a, b, c], [a, c, d], [a, d, b], [b, d, c]] {
            hull.add(corners).ok_or(HullError::Numeric)?;
        }
        let first: Vec<u32> = (0..4).collect();
        hull.distribute(0..points.len() as u32, &first);
        Ok(hull)
    }

    fn add(&mut self, corners: [u32; 3]) -> Option<u32> {
        let [a, b, c] = corners.map(|i| self.points[i as usize]);
        let normal = (b - a).cross(c - a).try_normalize()?;
        let id = self.faces.len() as u32;
        for k in 0..3 {
            // If an edge is used twice in one direction, rounding has folded the surface.
            if self.edge.insert((corners[k], corners[(k + 1) % 3]), id).is_some() {
                return None;
            }
        }
        let offset = normal.dot(a + b + c) / 3.0;
        self.faces.push(Face { corners, normal, offset, outside: Vec::new(), alive: true });
        Some(id)
    }

    fn height(&self, face: u32, point: u32) -> f64 {
        let f = &self.faces[face as usize];
        f.normal.dot(self.points[point as usize]) - f.offset
    }

    fn distribute(&mut self, points: impl IntoIterator<Item = u32>, faces: &[u32]) {
        for p in points {
            let best = faces.iter().map(|&f| (self.height(f, p), f)).max_by(|x, y| x.0.total_cmp(&y.0));
            if let Some((height, f)) = best
                && height > self.tolerance
            {
                self.faces[f as usize].outside.push(p);
            }
        }
    }

    fn grow(&mut self) -> Result<(), HullError> {
        let mut next = 0;
        while next < self.faces.len() {
            let face = next as u32;
            next += 1;
            if !self.faces[face as usize].alive || self.faces[face as usize].outside.is_empty() {
                continue;
            }
            let outside = self.faces[face as usize].outside.iter().copied();
            let apex = outside.max_by(|&p, &q| self.height(face, p).total_cmp(&self.height(face, q)));
            self.add_point(face, apex.unwrap_or_default())?;
        }
        Ok(())
    }

    /// Replaces the faces visible from `apex` by a cone from their border to `apex`.
    fn add_point(&mut self, face: u32, apex: u32) -> Result<(), HullError> {
        let (visible, horizon) = self.horizon(face, apex)?;
        let mut orphans = Vec::new();
        for f in visible {
            self.faces[f as usize].alive = false;
            orphans.append(&mut self.faces[f as usize].outside);
            let corners = self.faces[f as usize].corners;
            for k in 0..3 {
                self.edge.remove(&(corners[k], corners[(k + 1) % 3]));
            }
        }
        let mut cone = Vec::with_capacity(horizon.len());
        for (a, b) in horizon {
            cone.push(self.add([a, b, apex]).ok_or(HullError::Numeric)?);
        }
        orphans.retain(|&p| p != apex);
        self.distribute(orphans, &cone);
        Ok(())
    }

    /// The connected faces visible from `apex`, and the directed edges around them.
    fn horizon(&self, face: u32, apex: u32) -> Result<Horizon, HullError> {
        let mut visible = vec![face];
        let mut seen = std::collections::HashSet::from([face]);
        let mut border = Vec::new();
        let mut next = 0;
        while next < visible.len() {
            let corners = self.faces[visible[next] as usize].corners;
            next += 1;
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                let &beyond = self.edge.get(&(b, a)).ok_or(HullError::Numeric)?;
                if seen.contains(&beyond) {
                    continue;
                }
                if self.is_visible(apex, beyond, a, b) {
                    seen.insert(beyond);
                    visible.push(beyond);
                } else {
                    border.push((a, b, beyond));
                }
            }
        }
        border.retain(|(_, _, beyond)| !seen.contains(beyond));
        Ok((visible, border.into_iter().map(|(a, b, _)| (a, b)).collect()))
    }

    /// True if the face is replaced: the point is above it, or the point is collinear with the shared edge, where the
    /// face would otherwise become a sliver.
    fn is_visible(&self, apex: u32, face: u32, a: u32, b: u32) -> bool {
        if self.height(face, apex) > self.tolerance {
            return true;
        }
        let [a, b, e] = [a, b, apex].map(|i| self.points[i as usize]);
        let along = b - a;
        (e - a).cross(along).length() <= self.tolerance * along.length()
    }

    fn finish(self, original: &[Vec3]) -> Result<Faces, HullError> {
        let mut index: HashMap<u32, u32> = HashMap::new();
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        for f in self.faces.iter().filter(|f| f.alive) {
            triangles.push(f.corners.map(|i| {
                *index.entry(i).or_insert_with(|| {
                    vertices.push(original[i as usize]);
                    vertices.len() as u32 - 1
                })
            }));
        }
        // Euler's formula for a closed surface without holes.
        if vertices.len() + triangles.len() != triangles.len() * 3 / 2 + 2 {
            return Err(HullError::Numeric);
        }
        Ok((vertices, triangles))
    }
}

/// Four points that span a volume; `a b c` are counter-clockwise seen from the side away from `d`.
fn simplex(points: &[Vec3], tolerance: f64) -> Result<[u32; 4], HullError> {
    let farthest = |measure: &dyn Fn(Vec3) -> f64| {
        (0..points.len()).map(|i| (measure(points[i]), i)).max_by(|x, y| x.0.total_cmp(&y.0)).unwrap_or((0.0, 0))
    };
    let (_, a) = farthest(&|p| p.length_squared());
    let (length, b) = farthest(&|p| (p - points[a]).length());
    if length <= tolerance {
        return Err(HullError::Point);
    }
    let along = (points[b] - points[a]) / length;
    let (width, c) = farthest(&|p| (p - points[a]).cross(along).length());
    if width <= 10.0 * tolerance {
        return Err(HullError::Line);
    }
    let normal = (points[b] - points[a]).cross(points[c] - points[a]).try_normalize().ok_or(HullError::Line)?;
    let (height, d) = farthest(&|p| (p - points[a]).dot(normal).abs());
    if height <= 10.0 * tolerance {
        return Err(HullError::Flat);
    }
    let (b, c) = if (points[d] - points[a]).dot(normal) > 0.0 { (c, b) } else { (b, c) };
    Ok([a, b, c, d].map(|i| i as u32))
}
