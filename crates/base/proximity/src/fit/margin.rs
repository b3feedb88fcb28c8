//! The margin by which a fit is enlarged.

use elbowroom_spatial::Vec3;

/// Margin for rounding when a pose is composed with others later, as a fraction of the coordinates.
pub(super) const MARGIN: f64 = 4.0 * f64::EPSILON;

/// Largest coordinate of the points.
pub(super) fn scale(points: &[Vec3]) -> f64 {
    points.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()))
}
