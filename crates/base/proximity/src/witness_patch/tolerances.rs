//! When gaps are tied, and when a patch is a point.

/// Gaps that differ by less than this share of the sizes (the radii of both shapes, added) are tied.
pub(crate) const TIE_TOLERANCE: f64 = 1e-8;
/// A patch smaller than this share of the sizes is a point.
pub(crate) const MIN_PATCH_SIZE: f64 = 1e-3;

/// The two constants as lengths.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PatchTolerances {
    /// [`TIE_TOLERANCE`] of the sizes.
    pub tie: f64,
    /// [`MIN_PATCH_SIZE`] of the sizes.
    pub min_size: f64,
}

impl PatchTolerances {
    /// `size`: the radii of both shapes, added.
    pub fn of(size: f64) -> Self {
        Self { tie: TIE_TOLERANCE * size, min_size: MIN_PATCH_SIZE * size }
    }
}
