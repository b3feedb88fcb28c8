//! Rows that the upper arm blocks.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::GridAxis;

/// Marks the rows (cells of θ2) in which the direction of the upper arm is within `lo..=hi` for some θ2; directions are
/// angles in the shoulder's frame (x outward, y down), radians.
pub(super) fn mark_rows(shoulder: &GridAxis, lo: f64, hi: f64, full_rows: &mut [u16]) {
    if hi - lo >= TAU {
        return mark_cells(0, shoulder.count() - 1, full_rows);
    }
    // θ2 = 0 is upward, which is the direction −π/2.
    let (lo, hi) = (lo + FRAC_PI_2, hi + FRAC_PI_2);
    let turn = TAU * (lo / TAU).round();
    let (lo, hi) = (lo - turn, hi - turn);
    for turns in shoulder.full_turns() {
        let shift = TAU * f64::from(turns);
        if let Some((first, last)) = shoulder.cells_touching(lo + shift, hi + shift) {
            mark_cells(first, last, full_rows);
        }
    }
}

fn mark_cells(first: usize, last: usize, full_rows: &mut [u16]) {
    for word in first / 16..=last / 16 {
        let from = first.saturating_sub(word * 16);
        let to = (last - word * 16).min(15);
        full_rows[word] |= (!0 << from) & (!0 >> (15 - to));
    }
}

/// Directions from the shoulder in which a link of length `reach` meets a disk: centre and half width, radians.
pub(super) fn disk_directions([x, y]: [f64; 2], radius: f64, reach: f64) -> Option<(f64, f64)> {
    let square = x * x + y * y - radius * radius;
    if !(square > 0.0) {
        return Some((0.0, PI));
    }
    let distance = (x * x + y * y).sqrt();
    let tangent = square.sqrt().min(reach);
    let cosine = (square + tangent * tangent) / (2.0 * distance * tangent);
    (cosine <= 1.0).then(|| (y.atan2(x), cosine.acos()))
}
