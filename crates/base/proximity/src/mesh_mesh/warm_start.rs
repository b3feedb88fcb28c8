//! Warm start: where a distance query of two meshes begins.

/// The pair of triangles that was nearest in an earlier query of the same two meshes: where the next query begins.
///
/// It changes the time of a query, never its answer. A warm start of two other meshes only makes the query slower. The default
/// is a cold start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WarmStart {
    /// Slots of the two triangles.
    pub(super) a: u32,
    pub(super) b: u32,
    /// Their distance then, units of A.
    pub(super) distance: f32,
}

impl Default for WarmStart {
    fn default() -> Self {
        Self { a: u32::MAX, b: u32::MAX, distance: 0.0 }
    }
}
