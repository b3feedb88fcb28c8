//! Dimensions of a shield.

use super::error::ShieldError;
use super::opening::Cut;
use crate::NavigatorError;

/// Dimensions of a shield, metres and radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShieldSettings {
    /// Distance of the shield from the protected surface.
    pub offset_m: f64,
    /// Width of the opening at its ground.
    pub width_m: f64,
    /// Depth of the ground below the surface.
    pub depth_m: f64,
    /// Angle between the wall of the opening and its axis: 0 for parallel walls.
    pub flare_rad: f64,
    /// Largest error of the shield. Nothing farther than this outside the opening is bare, and nothing farther than this
    /// inside is blocked. The edge of the grid is a part of it, so time and triangles grow with its inverse square.
    pub tolerance_m: f64,
}

impl ShieldSettings {
    /// Settings with a width and the defaults of a cell file: an offset of 2 mm, no depth, parallel walls, a tolerance of
    /// 2 mm.
    pub fn with_width(width_m: f64) -> Self {
        Self { offset_m: 0.002, width_m, depth_m: 0.0, flare_rad: 0.0, tolerance_m: 0.002 }
    }

    /// Largest distance of two neighbouring points of the target, metres: openings this far apart leave ridges of a quarter
    /// of the tolerance between them.
    pub(super) fn spacing_m(&self) -> f64 {
        (self.width_m * self.tolerance_m).sqrt()
    }

    pub(super) fn check(&self) -> Result<(), ShieldError> {
        let positive = [("width_m", self.width_m), ("tolerance_m", self.tolerance_m)];
        let not_negative = [("offset_m", self.offset_m), ("depth_m", self.depth_m), ("flare_rad", self.flare_rad)];
        if let Some(&(name, value)) = positive.iter().find(|(_, x)| !(x.is_finite() && *x > 0.0)) {
            return Err(NavigatorError::Setting { name, value, wanted: "a positive number" }.into());
        }
        if let Some(&(name, value)) = not_negative.iter().find(|(_, x)| !(x.is_finite() && *x >= 0.0)) {
            return Err(NavigatorError::Setting { name, value, wanted: "0 or more" }.into());
        }
        if self.flare_rad > 80.0_f64.to_radians() + 1e-9 {
            let (name, value) = ("flare_rad", self.flare_rad);
            return Err(NavigatorError::Setting { name, value, wanted: "at most 1.396 (80°)" }.into());
        }
        Ok(())
    }

    /// The opening, wider by `margin_m` on all sides. `cosine` is the smallest one between its axes and the normals of the
    /// surface.
    pub(super) fn cut(&self, margin_m: f64, cosine: f64) -> Cut {
        let radius_m = 0.5 * self.width_m + margin_m;
        let tangent = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine;
        Cut {
            radius_m,
            depth_m: self.depth_m + margin_m,
            // Through the shield, and no farther: a flare without an end would open what overhangs.
            height_m: (self.offset_m + 2.0 * self.tolerance_m) / cosine + radius_m * tangent,
            flare: self.flare_rad.sin_cos(),
        }
    }
}
