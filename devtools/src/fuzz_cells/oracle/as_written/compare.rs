//! Comparison of frames.

use crate::fuzz_cells::oracle::frame::Frame;

/// Difference of numbers that are equal but for rounding, m and rad.
pub const ROUNDING: f64 = 1e-9;

/// What was read otherwise, and by how much.
pub type Off = Vec<(String, f64)>;

/// Compares a frame with that of the text; without a stated turn only the places.
pub fn compare(what: String, expected: &Frame, is_turned: bool, read: &Frame, off: &mut Off) {
    let turn = if is_turned { expected.turn_to(read).length() } else { 0.0 };
    let by = expected.at.distance(read.at).max(turn);
    if !(by <= ROUNDING) {
        off.push((what, by));
    }
}
