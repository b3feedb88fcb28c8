//! Triangle meshes: checked at the door, reported on, and indexed by a tree of boxes.

use std::sync::OnceLock;

use elbowroom_spatial::{Aabb, Vec3};

use crate::mesh::Tree;

use super::ConvexHull;
use super::topology::{self, Topology};

/// A surface of triangles. Where it is closed it bounds a solid.
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
    pub(crate) tree: Tree,
    /// Vertices that reach farthest along each axis: if one is outside a box, so is part of the mesh.
    pub(crate) extremes: [Vec3; 6],
    /// One vertex of every connected part.
    pub(crate) parts: Vec<Vec3>,
    /// Triangles that belong to a closed part, by index.
    pub(crate) in_closed_part: Vec<bool>,
    /// The vertex that stands for each, where seams had to be closed by a tolerance.
    joined: Option<Vec<u32>>,
    hull: OnceLock<Option<ConvexHull>>,
}

/// What is to be known about a mesh before it is trusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshReport {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices as given.
    pub vertices: usize,
    /// Every edge is shared by two triangles (vertices of equal coordinates count as one, and so do those that were
    /// [`welded`](Self::welded)): the mesh has an inside.
    pub closed: bool,
    /// Vertices on open rims that were taken for another one within [`weld_tolerance`](Self::weld_tolerance), so that
    /// hairline seams are closed. What is inside is judged with them; distances are to the triangles as given.
    pub welded: usize,
    /// Metres: a millionth of the largest extent where seams were closed; 0 where none were.
    pub weld_tolerance: f64,
    /// Triangles without area.
    pub degenerate: usize,
    /// Triangles whose three corners another triangle has already.
    pub duplicate: usize,
    /// Closed, and its triangles face inwards.
    pub inside_out: bool,
    /// Volume enclosed, m³, where closed; 0 where open.
    pub volume: f64,
}

/// Why triangles were refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// Nothing to be near to.
    #[error("a mesh needs at least one triangle")]
    Empty,
    /// A triangle points outside the vertex list.
    #[error("triangle {triangle} names vertex {index}, but there are only {vertices} vertices (0 to {})", vertices.saturating_sub(1))]
    IndexOutOfRange {
        /// Which triangle, from 0.
        triangle: usize,
        /// The index it names.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN, infinite or beyond 1e100.
    #[error("vertex {vertex} has a coordinate that is not a finite number below 1e100 m")]
    NotFinite {
        /// Which vertex, from 0.
        vertex: usize,
    },
    /// Indices are 32 bits wide.
    #[error("{0} is more vertices or triangles than 32-bit indices can name (4294967295)")]
    TooLarge(usize),
}

impl TriMesh {
    /// Checks and indexes a mesh; vertices in metres, local frame. Open, inside-out, degenerate and duplicate
    /// triangles are accepted and reported in [`TriMesh::report`].
    ///
    /// # Errors
    /// No triangle, an index out of range, a coordinate that is not finite, more than 2³²-1 vertices or triangles.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check(&vertices, &triangles)?;
        let (topology, tree) = prepare(&vertices, &triangles);
        let aabb = Aabb::from_points(triangles.iter().flatten().map(|&i| vertices[i as usize]));
        let extremes = extremes(&vertices, &triangles);
        Ok(Self {
            aabb,
            tree,
            extremes,
            report: topology.report,
            parts: topology.parts,
            in_closed_part: topology.in_closed_part,
            joined: topology.joined,
            hull: OnceLock::new(),
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

    /// What was found on the way in.
    pub fn report(&self) -> &MeshReport {
        &self.report
    }

    /// The convex hull, computed once when first asked for; `None` where the mesh is flat.
    pub fn hull(&self) -> Option<&ConvexHull> {
        self.hull.get_or_init(|| ConvexHull::from_points(&self.vertices).ok()).as_ref()
    }

    /// Bytes of the tree that answers queries, beside vertices and triangles.
    pub fn tree_bytes(&self) -> usize {
        self.tree.bytes()
    }

    pub(crate) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.vertices[i as usize])
    }

    /// Corners of a triangle after hairline seams were closed.
    pub(crate) fn closed_corners(&self, triangle: usize) -> [Vec3; 3] {
        match &self.joined {
            Some(joined) => self.triangles[triangle].map(|i| self.vertices[joined[i as usize] as usize]),
            None => self.corners(triangle),
        }
    }

    /// For each vertex the one that stands for it when the surface is judged: the first of equal coordinates, and across
    /// hairline seams the first of those within [`MeshReport::weld_tolerance`].
    ///
    /// ```
    /// use elbowroom_proximity::TriMesh;
    /// use elbowroom_spatial::Vec3;
    /// // A tetrahedron whose last face has corners of its own, a little off.
    /// let [o, x, y, z] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let off = Vec3::new(1e-9, 0.0, -1e-9);
    /// let corners = vec![o, x, y, z, x + off, y - off, z + off];
    /// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [4, 5, 6]])?;
    /// assert_eq!(mesh.joined(), [0, 1, 2, 3, 1, 2, 3]);
    /// assert!(mesh.report().closed && mesh.report().welded == 3 && mesh.contains(Vec3::splat(0.2)));
    /// # Ok::<(), elbowroom_proximity::MeshError>(())
    /// ```
    pub fn joined(&self) -> Vec<u32> {
        self.joined.clone().unwrap_or_else(|| topology::first_of_equal(&self.vertices))
    }

    /// A vertex of each connected part.
    pub fn parts(&self) -> &[Vec3] {
        &self.parts
    }

    /// True where some part of the surface is closed, so that points can be inside.
    pub fn has_inside(&self) -> bool {
        self.in_closed_part.iter().any(|&c| c)
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

/// From so many triangles on, the tree and the examination are worth a thread each.
const LARGE: usize = 20_000;

/// The two long parts of making a mesh, at the same time where it is large.
fn prepare(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (Topology, Tree) {
    if triangles.len() < LARGE {
        return (topology::examine(vertices, triangles), Tree::build(vertices, triangles, 1));
    }
    std::thread::scope(|scope| {
        let examination = scope.spawn(|| topology::examine(vertices, triangles));
        let tree = Tree::build(vertices, triangles, 2);
        (examination.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), tree)
    })
}
