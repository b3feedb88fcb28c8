//! What the checks of a mesh found.

/// Counts and properties of a triangle mesh, as found when it was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshReport {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices as given.
    pub vertices: usize,
    /// Every edge is shared by two triangles (vertices of equal coordinates count as one, and so do those that were
    /// [`welded`](Self::welded)): the mesh has an interior.
    pub closed: bool,
    /// Vertices on open boundaries that were identified with another one within [`weld_tolerance`](Self::weld_tolerance), which
    /// closes hairline seams. Point containment uses the closed surface; distances are to the triangles as given.
    pub welded: usize,
    /// Metres: a millionth of the largest extent where seams were closed; 0 if none were.
    pub weld_tolerance: f64,
    /// Triangles without area.
    pub degenerate: usize,
    /// Triangles with the same three corners as an earlier one.
    pub duplicate: usize,
    /// Closed, and its triangles face inwards.
    pub inside_out: bool,
    /// Volume enclosed, m³, where closed; 0 where open.
    pub volume: f64,
}
