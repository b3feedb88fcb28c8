//! Triangle meshes: checked when created, with a report on their topology, and indexed by a BVH.

use std::sync::OnceLock;

use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::mesh_report::MeshReport;
use super::topology::{self, Topology};
use super::{Capsule, ConvexHull, Cuboid};
use crate::bvh::Bvh16;
use crate::fit::ExtremePoints;

/// A surface of triangles. If it is closed, it bounds a solid.
///
/// ```
/// use elbowroom_proximity::TriMesh;
/// use elbowroom_spatial::Vec3;
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners.clone(), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
/// assert!(mesh.report().closed && !mesh.report().inside_out);
/// let error = TriMesh::new(corners, vec![[0, 1, 7]]).unwrap_err();
/// assert_eq!(error.to_string(), "triangle 0 names vertex 7, but there are only 4 vertices (0 to 3)");
/// ```
#[derive(Debug, Clone)]
pub struct TriMesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    aabb: Aabb,
    report: MeshReport,
    pub(crate) bvh: Bvh16,
    /// The farthest vertices along each axis: if one is outside a box, part of the mesh is outside too.
    pub(crate) extremes: [Vec3; 6],
    /// One vertex of every connected component.
    component_vertices: Vec<Vec3>,
    /// Whether each triangle, by index, belongs to a closed component.
    pub(crate) in_closed_component: Vec<bool>,
    pub(crate) in_oriented_component: Vec<bool>,
    /// The representative of each vertex, if seams had to be closed by a tolerance.
    welded_vertices: Option<Vec<u32>>,
    hull: OnceLock<Option<ConvexHull>>,
    capsule: OnceLock<Option<(Capsule, Pose)>>,
    cuboid: OnceLock<Option<(Cuboid, Pose)>>,
}

/// Why triangles were refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// The mesh has no triangle.
    #[error("a mesh needs at least one triangle")]
    Empty,
    /// A triangle has an index beyond the vertex list.
    #[error("triangle {triangle} names vertex {index}, but there are only {vertices} vertices (0 to {})", vertices.saturating_sub(1))]
    IndexOutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The vertex index in the triangle.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN, infinite or beyond 1e100.
    #[error("vertex {vertex} has a coordinate that is not a finite number below 1e100 m")]
    NotFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// More vertices or triangles than 32-bit indices can number.
    #[error("{0} is more vertices or triangles than 32-bit indices can name (4294967295)")]
    TooLarge(usize),
}

impl TriMesh {
    /// Checks and indexes a mesh; vertices in metres, local frame. Open, inside-out, degenerate and duplicate triangles
    /// are accepted and reported in [`TriMesh::report`].
    ///
    /// # Errors
    /// [`MeshError`] if the mesh has no triangle, an index out of range, a coordinate that is not finite, or more than
    /// 2³²-1 vertices or triangles.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check(&vertices, &triangles)?;
        let (topology, bvh) = prepare(&vertices, &triangles);
        let aabb = Aabb::from_points(triangles.iter().flatten().map(|&i| vertices[i as usize]));
        let extremes = extremes(&vertices, &triangles);
        Ok(Self {
            aabb,
            bvh,
            extremes,
            report: topology.report,
            component_vertices: topology.component_vertices,
            in_closed_component: topology.in_closed_component,
            in_oriented_component: topology.in_oriented_component,
            welded_vertices: topology.welded_vertices,
            hull: OnceLock::new(),
            capsule: OnceLock::new(),
            cuboid: OnceLock::new(),
            vertices,
            triangles,
        })
    }

    /// Vertices as given, metres, local frame.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Triangles as given, indices into the vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Bounds of the triangles in the local frame.
    pub fn aabb(&self) -> &Aabb {
        &self.aabb
    }

    /// The report of the checks at creation.
    pub fn report(&self) -> &MeshReport {
        &self.report
    }

    /// True if every part of the surface is closed and its triangles face the same side.
    pub fn is_oriented(&self) -> bool {
        self.in_closed_component.iter().zip(&self.in_oriented_component).all(|(closed, oriented)| *closed && *oriented)
    }

    /// The convex hull, computed on the first call; `None` if the mesh is flat.
    pub fn hull(&self) -> Option<&ConvexHull> {
        self.hull.get_or_init(|| ConvexHull::from_points(&self.vertices).ok()).as_ref()
    }

    /// A small capsule around all vertices and its frame in the mesh's frame, computed on the first call.
    pub(crate) fn enclosing_capsule(&self) -> Option<(Capsule, Pose)> {
        *self.capsule.get_or_init(|| self.extreme_points().enclosing_capsule())
    }

    /// A small box around all vertices and its frame in the mesh's frame, computed on the first call.
    pub(crate) fn enclosing_cuboid(&self) -> Option<(Cuboid, Pose)> {
        *self.cuboid.get_or_init(|| self.extreme_points().enclosing_cuboid())
    }

    fn extreme_points(&self) -> ExtremePoints {
        ExtremePoints::with_hull(&self.vertices, self.hull().cloned())
    }

    /// Size of the BVH in bytes, in addition to vertices and triangles.
    pub fn bvh_bytes(&self) -> usize {
        self.bvh.bytes()
    }

    /// Number of levels of the BVH below the box around the whole mesh. Every level divides a box into up to sixteen
    /// boxes; each box of the last level has up to eight triangles.
    ///
    /// ```
    /// use elbowroom_proximity::{Shape, Sphere, TriMesh, tessellate::tessellate};
    /// let (corners, faces) = tessellate(&Shape::Sphere(Sphere { radius: 1.0 }), 0.001);
    /// let ball = TriMesh::new(corners, faces)?;
    /// let (triangles, depth) = (ball.triangles().len(), ball.bvh_depth().into());
    /// assert!(triangles <= 8 * 16_usize.pow(depth) && triangles > 8 * 16_usize.pow(depth - 1));
    /// # Ok::<(), elbowroom_proximity::MeshError>(())
    /// ```
    pub fn bvh_depth(&self) -> u8 {
        self.bvh.height() as u8
    }

    pub(crate) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.vertices[i as usize])
    }

    /// Corners of a triangle after hairline seams were closed.
    pub(crate) fn closed_corners(&self, triangle: usize) -> [Vec3; 3] {
        match &self.welded_vertices {
            Some(welded) => self.triangles[triangle].map(|i| self.vertices[welded[i as usize] as usize]),
            None => self.corners(triangle),
        }
    }

    /// For each vertex, the vertex that represents it in the topology: the first with equal coordinates and, across
    /// hairline seams, the first of those within [`MeshReport::weld_tolerance`].
    ///
    /// ```
    /// use elbowroom_proximity::TriMesh;
    /// use elbowroom_spatial::Vec3;
    /// // A tetrahedron whose last face has its own corners, with a small offset.
    /// let [o, x, y, z] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let off = Vec3::new(1e-9, 0.0, -1e-9);
    /// let corners = vec![o, x, y, z, x + off, y - off, z + off];
    /// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [4, 5, 6]])?;
    /// assert_eq!(mesh.welded_vertices(), [0, 1, 2, 3, 1, 2, 3]);
    /// assert!(mesh.report().closed && mesh.report().welded == 3 && mesh.contains(Vec3::splat(0.2)));
    /// # Ok::<(), elbowroom_proximity::MeshError>(())
    /// ```
    pub fn welded_vertices(&self) -> Vec<u32> {
        self.welded_vertices.clone().unwrap_or_else(|| topology::first_of_equal(&self.vertices))
    }

    /// A vertex of each connected component.
    pub fn component_vertices(&self) -> &[Vec3] {
        &self.component_vertices
    }

    /// True if a component of the surface is closed, so that points can be inside.
    pub fn has_interior(&self) -> bool {
        self.in_closed_component.iter().any(|&c| c)
    }
}

fn check(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    let largest = vertices.len().max(triangles.len());
    if u32::try_from(largest).is_err() {
        return Err(MeshError::TooLarge(largest));
    }
    if let Some(vertex) = vertices.iter().position(|v| v.abs().max_element() > 1e100 || !v.is_finite()) {
        return Err(MeshError::NotFinite { vertex });
    }
    for (triangle, t) in triangles.iter().enumerate() {
        if let Some(&index) = t.iter().find(|&&i| i as usize >= vertices.len()) {
            return Err(MeshError::IndexOutOfRange { triangle, index, vertices: vertices.len() });
        }
    }
    Ok(())
}

fn extremes(vertices: &[Vec3], triangles: &[[u32; 3]]) -> [Vec3; 6] {
    let first = triangles.first().map_or(Vec3::ZERO, |t| vertices[t[0] as usize]);
    let mut found = [first; 6];
    for &i in triangles.iter().flatten() {
        let v = vertices[i as usize];
        for k in 0..3 {
            if v[k] < found[k][k] {
                found[k] = v;
            }
            if v[k] > found[k + 3][k] {
                found[k + 3] = v;
            }
        }
    }
    found
}

/// Number of triangles from which tree and topology are computed in parallel.
const LARGE: usize = 20_000;

/// Performs the two long steps of creating a mesh, in parallel if the mesh is large.
fn prepare(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (Topology, Bvh16) {
    if triangles.len() < LARGE {
        return (topology::examine(vertices, triangles), Bvh16::build(vertices, triangles));
    }
    rayon::join(|| topology::examine(vertices, triangles), || Bvh16::build(vertices, triangles))
}
