//! Settings of continuous collision detection.

/// Settings of continuous collision detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CcdOptions {
    /// Largest distance of the shapes at a reported contact, metres. Not finer than the resolution of poses of that size
    /// (about 1e-14 of the largest coordinate); 0, a negative number or NaN selects that resolution.
    pub tolerance: f64,
    /// Largest number of distance queries; beyond it the result is a contact that is not
    /// [`certain`](super::TimeOfImpact::certain). A mesh that slides along another just outside the tolerance advances
    /// by about the distance per step.
    pub max_steps: u32,
    /// If true, a start nearer than the tolerance without touching is not a contact, but coming nearer than half the
    /// initial distance is. Shapes that touch at the start are still reported at time 0.
    pub allow_initial_proximity: bool,
}

impl Default for CcdOptions {
    /// A tolerance of 0.1 mm and 10,000 steps; a start within the tolerance is a contact.
    fn default() -> Self {
        Self { tolerance: 1e-4, max_steps: 10_000, allow_initial_proximity: false }
    }
}
