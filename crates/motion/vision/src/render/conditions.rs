//! Illumination and noise of synthetic images.

use elbowroom_spatial::Vec3;

/// Illumination and sensor noise of one image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderConditions {
    /// Brightness relative to the first image.
    pub gain: f64,
    /// Offset added by the sensor, grey levels.
    pub offset: f64,
    /// Difference of the gain between the right and the left edge.
    pub slope: f64,
    /// Standard deviation of the noise, grey levels.
    pub noise: f64,
    /// Direction in which the light travels, world frame, for shadows on the floor; `None` for light without shadows.
    pub light: Option<Vec3>,
    /// Brightness of the floor in shadow, relative to the lit floor.
    pub shadow: f64,
    /// Seed of the noise; use a different seed for each image.
    pub seed: u64,
}

impl Default for RenderConditions {
    fn default() -> Self {
        Self { gain: 1.0, offset: 0.0, slope: 0.0, noise: 2.0, light: None, shadow: 0.65, seed: 1 }
    }
}
