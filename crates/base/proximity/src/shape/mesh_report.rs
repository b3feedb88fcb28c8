//! Report of the checks of a mesh.

/// Counts and properties of a triangle mesh, found when it was created.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshReport {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of given vertices.
    pub vertices: usize,
    /// True if every edge is shared by two triangles, so that the mesh has an interior. Vertices with equal coordinates
    /// count as one, and so do [`welded`](Self::welded) vertices.
    pub closed: bool,
    /// Number of vertices on open boundaries that were identified with another vertex within
    /// [`weld_tolerance`](Self::weld_tolerance), which closes hairline seams. Point containment uses the closed surface;
    /// distances are to the triangles as given.
    pub welded: usize,
    /// Tolerance of this identification, metres: a millionth of the largest extent if seams were closed; 0 otherwise.
    pub weld_tolerance: f64,
    /// Number of triangles without area.
    pub degenerate: usize,
    /// Number of triangles with the same three corners as an earlier one.
    pub duplicate: usize,
    /// True if the mesh is closed and its triangles face inwards.
    pub inside_out: bool,
    /// Enclosed volume, m³, if the mesh is closed; 0 if it is open.
    pub volume: f64,
}
