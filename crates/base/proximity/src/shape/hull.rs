//! Convex hulls; `quickhull` constructs them.

use elbowroom_spatial::{Aabb, Vec3};

use super::hull_error::HullError;
use super::quickhull::quickhull;
use crate::triangle::nearest_on_triangle;

/// A convex polyhedron with triangular faces.
///
/// ```
/// use elbowroom_proximity::ConvexHull;
/// use elbowroom_spatial::Vec3;
/// let corner = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(0.1)];
/// let hull = ConvexHull::from_points(&corner).unwrap();
/// assert_eq!((hull.vertices().len(), hull.triangles().len()), (4, 4)); // the fifth point is inside
/// assert!((hull.volume() - 1.0 / 6.0).abs() < 1e-15);
/// assert!(ConvexHull::from_points(&corner[..3]).is_err()); // flat
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexHull {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Unit outward normal and offset of each triangle's plane.
    planes: Vec<(Vec3, f64)>,
    volume: f64,
    aabb: Aabb,
}

/// Distance, as a fraction of the extent, by which a corner may be outside a face.
const OUTSIDE: f64 = 1e-9;
/// Largest number of pairs of corner and face that are tested.
const MAX_SIDES: usize = 1 << 32;

impl ConvexHull {
    /// Computes the convex hull of a set of points (quickhull; Barber, Dobkin, Huhdanpaa, 1996).
    ///
    /// Points within about 1e-13 of the extent of a face count as on it, so every input point is inside the result up to
    /// that tolerance.
    ///
    /// # Errors
    /// [`HullError`] for fewer than four points, a coordinate that is not finite, or points that all lie on one point,
    /// line or plane.
    pub fn from_points(points: &[Vec3]) -> Result<Self, HullError> {
        let (vertices, triangles) = quickhull(points)?;
        Self::assemble(vertices, triangles).ok_or(HullError::Numeric)
    }

    /// Builds a hull with exactly these corners and faces, for example the corners and faces of a hull that was written
    /// to a file. The order of both is kept, so that every query gives the same bits.
    ///
    /// # Errors
    /// [`HullError::Faces`] if a face has an index beyond the corners or no area, or if a corner is outside a face.
    ///
    /// ```
    /// use elbowroom_proximity::ConvexHull;
    /// use elbowroom_spatial::Vec3;
    /// let hull = ConvexHull::from_points(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z])?;
    /// assert_eq!(ConvexHull::from_faces(hull.vertices().to_vec(), hull.triangles().to_vec())?, hull);
    /// # Ok::<(), elbowroom_proximity::HullError>(())
    /// ```
    pub fn from_faces(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, HullError> {
        if vertices.len() < 4 {
            return Err(HullError::TooFew(vertices.len()));
        }
        if let Some(bad) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(HullError::NotFinite(bad));
        }
        let names_corners = triangles.iter().flatten().all(|i| (*i as usize) < vertices.len());
        if triangles.len() < 4 || !names_corners || vertices.len().saturating_mul(triangles.len()) > MAX_SIDES {
            return Err(HullError::Faces);
        }
        let hull = Self::assemble(vertices, triangles).ok_or(HullError::Faces)?;
        let tolerance = OUTSIDE * hull.aabb.min.abs().max(hull.aabb.max.abs()).max_element();
        let is_inside = |v: &Vec3| hull.planes.iter().all(|(normal, offset)| normal.dot(*v) - offset <= tolerance);
        if hull.volume > 0.0 && hull.vertices.iter().all(is_inside) { Ok(hull) } else { Err(HullError::Faces) }
    }

    fn assemble(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Option<Self> {
        let planes = triangles.iter().map(|t| plane(&vertices, *t)).collect::<Option<Vec<_>>>()?;
        let volume = enclosed_volume(&vertices, &triangles);
        let aabb = Aabb::from_points(vertices.iter().copied());
        Some(Self { vertices, triangles, planes, volume, aabb })
    }

    /// Corners, metres, local frame.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Faces as indices into the vertices, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Volume in cubic metres.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Bounds in the local frame.
    pub fn aabb(&self) -> &Aabb {
        &self.aabb
    }

    /// The vertex farthest along `dir`, local frame.
    pub fn support(&self, dir: Vec3) -> Vec3 {
        farthest(&self.vertices, dir)
    }

    /// The point of the solid nearest to `p` (`p` itself if it is inside), local frame.
    pub fn nearest(&self, p: Vec3) -> Vec3 {
        self.nearest_with_face(p).0
    }

    /// The nearest point, and a face that contains it if `p` is outside.
    pub(crate) fn nearest_with_face(&self, p: Vec3) -> (Vec3, Option<usize>) {
        let heights = || self.planes.iter().map(|(normal, offset)| normal.dot(p) - offset);
        if !heights().any(|height| height > 0.0) {
            return (p, None);
        }
        // All faces are tested, including those that `p` is just below because of rounding: at a corner, `p` may be above
        // only a distant face.
        let mut best = (f64::INFINITY, p, None);
        for (i, height) in heights().enumerate() {
            if height * height < best.0 {
                let q = nearest_on_triangle(p, self.corners(i));
                let squared = (q - p).length_squared();
                if squared < best.0 {
                    best = (squared, q, Some(i));
                }
            }
        }
        (best.1, best.2)
    }

    pub(crate) fn planes(&self) -> &[(Vec3, f64)] {
        &self.planes
    }

    /// Outward unit normals of the triangles.
    pub(crate) fn normals(&self) -> impl Iterator<Item = Vec3> {
        self.planes.iter().map(|(normal, _)| *normal)
    }

    /// The outward normal with the largest component along `dir`.
    pub(crate) fn most_aligned_normal(&self, dir: Vec3) -> Vec3 {
        self.normals().max_by(|m, n| m.dot(dir).total_cmp(&n.dot(dir))).unwrap_or(dir)
    }

    pub(crate) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.vertices[i as usize])
    }
}

/// The point of the list farthest along `dir`; the origin for an empty list.
pub(crate) fn farthest(points: &[Vec3], dir: Vec3) -> Vec3 {
    let mut best = (f64::NEG_INFINITY, Vec3::ZERO);
    for &p in points {
        let along = p.dot(dir);
        if along > best.0 {
            best = (along, p);
        }
    }
    best.1
}

/// Signed volume enclosed by outward triangles (divergence theorem), relative to the first vertex for accuracy.
pub(crate) fn enclosed_volume(vertices: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let Some(&o) = vertices.first() else { return 0.0 };
    let six_fold: f64 =
        triangles.iter().map(|t| t.map(|i| vertices[i as usize] - o)).map(|[a, b, c]| a.dot(b.cross(c))).sum();
    six_fold / 6.0
}

fn plane(vertices: &[Vec3], t: [u32; 3]) -> Option<(Vec3, f64)> {
    let [a, b, c] = t.map(|i| vertices[i as usize]);
    let normal = (b - a).cross(c - a).try_normalize()?;
    // The largest of the three offsets, so that rounding never leaves a vertex outside.
    let offset = normal.dot(a).max(normal.dot(b)).max(normal.dot(c));
    Some((normal, offset))
}
