//! The brightness of an image compared with the learnt background.

/// The illumination `observed = gain · learnt + offset`, offset in grey levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Illumination {
    /// Ratio of the brightness to the learnt background.
    pub gain: f64,
    /// Offset of the brightness, grey levels.
    pub offset: f64,
    /// Fraction of the samples that are inliers, 0 to 1.
    pub inlier_ratio: f64,
}

impl Default for Illumination {
    fn default() -> Self {
        Self { gain: 1.0, offset: 0.0, inlier_ratio: 1.0 }
    }
}
