//! Margins for single precision, as fractions of the largest occurring length (distance and size of the obstacle, reach
//! of the arm).
//!
//! Single precision rounds to 2⁻²⁴ = 6e-8 of a number. A row is decided by the distance of the elbow from a line or a
//! corner: `far − (x·ex + y·ey)`. The direction is rounded once, the elbow twice, and the products, their sum, the
//! difference and `far` once each: 8 roundings of numbers not larger than `size`, [`ROUNDING`]. `far` comes from a
//! support distance (three half edges and a centre, each rotated into the plane and multiplied by a direction: at most
//! 24 roundings) and is rotated by half a step of θ2 (6 more). The sum is 38 · 6e-8 = 2.3e-6, less than [`MARGIN`].
//! `precision_audit` compares a million rows with double precision, with half of this margin removed.

/// Fraction by which outlines are enlarged.
pub(super) const MARGIN: f64 = 4e-6;

/// Fraction that the decision of a row may lose: 8 roundings.
pub(super) const ROUNDING: f64 = 0.5e-6;
