//! Warm start: the starting point of a distance query of two meshes.

/// The nearest pair of triangles of an earlier query of the same two meshes, at which the next query starts.
///
/// It changes the time of a query, never its answer. A warm start of two other meshes only makes the query slower.
/// The default is a cold start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WarmStart {
    /// Slots of the two triangles.
    pub(super) a: u32,
    pub(super) b: u32,
    /// Distance of the two triangles in that query, units of A.
    pub(super) distance: f32,
}

impl Default for WarmStart {
    fn default() -> Self {
        Self { a: u32::MAX, b: u32::MAX, distance: 0.0 }
    }
}
