//! Numbers of zones in millimetres, rounded so that a zone encloses its region.

use elbowroom_spatial::Vec3;

use super::zone::Side;

/// By how much a border moves outwards before it is rounded, mm: controllers keep numbers in single precision, which at
/// 16 m is 0.001 mm, and angles to 0.00001 degrees.
const MARGIN_MM: f64 = 0.004;
/// Largest distance of a point from the nearest point with three digits per coordinate, mm.
const GRID_MM: f64 = 0.000_87;

/// The smallest number (mm, three digits) beyond a length (m) by the margin.
fn up_mm(metres: f64) -> f64 {
    // Without the errors of the last digits, which would add a micrometre to a whole number of them.
    ((metres * 1e3 + MARGIN_MM) * 1e3 - 1e-6).ceil() / 1e3
}

fn down_mm(metres: f64) -> f64 {
    -up_mm(-metres)
}

/// A coordinate (m) in mm with three digits.
pub(super) fn nearest_mm(metres: f64) -> f64 {
    (metres * 1e6).round() / 1e3
}

/// The borders (m) of a solid along an axis as those of a zone, mm: outwards from the solid if the zone is its inside, else
/// inwards. `None` if nothing is left of the solid.
pub(super) fn interval_mm(side: Side, low_m: f64, high_m: f64) -> Option<[f64; 2]> {
    let [low, high] = match side {
        Side::Inside => [down_mm(low_m), up_mm(high_m)],
        Side::Outside => [up_mm(low_m), down_mm(high_m)],
    };
    (low < high).then_some([low, high])
}

/// A radius (m) as that of a zone about the same centre in three digits, mm.
pub(super) fn radius_mm(side: Side, radius_m: f64) -> Option<f64> {
    let radius = match side {
        Side::Inside => up_mm(radius_m + GRID_MM / 1e3),
        Side::Outside => down_mm(radius_m - GRID_MM / 1e3),
    };
    (radius > 0.0).then_some(radius)
}

/// How far a point of a box (half extents in m) moves at most if its axes are replaced, m.
pub(super) fn turn_m(half_extents: Vec3, axes: [Vec3; 3], replaced: [Vec3; 3]) -> f64 {
    half_extents.to_array().iter().zip(axes.iter().zip(replaced)).map(|(h, (a, b))| h * (*a - b).length()).sum()
}

/// Three digits, and no minus before zero.
pub(super) fn text(mm: f64) -> String {
    let text = format!("{mm:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}
