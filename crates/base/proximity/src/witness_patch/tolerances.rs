//! Tolerances for tied gaps and for patches that count as points.

/// Difference below which gaps are tied, as a fraction of the sizes (the radii of both shapes, added).
pub(crate) const TIE_TOLERANCE: f64 = 1e-8;
/// Size below which a patch counts as a point, as a fraction of the sizes.
pub(crate) const MIN_PATCH_SIZE: f64 = 1e-3;

/// The two tolerances as lengths.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PatchTolerances {
    /// [`TIE_TOLERANCE`] times the sizes.
    pub tie: f64,
    /// [`MIN_PATCH_SIZE`] times the sizes.
    pub min_size: f64,
}

impl PatchTolerances {
    /// The tolerances for `size`, the sum of the radii of both shapes.
    pub fn of(size: f64) -> Self {
        Self { tie: TIE_TOLERANCE * size, min_size: MIN_PATCH_SIZE * size }
    }
}
