//! Parts that figures share.

use super::svg::{Axis, Curve, Dash};

/// A curve through points.
pub fn curve(label: &str, colour: usize, dash: Dash, points: Vec<(f64, f64)>) -> Curve {
    Curve { label: label.into(), colour, dash, points }
}

/// The axis of a distance, mm.
pub fn distance(from: f64, to: f64, step: f64) -> Axis {
    Axis { title: "distance d (mm)", from, to, step }
}

/// Samples a function of x at 201 points.
pub fn over(from: f64, to: f64, y: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    (0..=200).map(|i| from + (to - from) * f64::from(i) / 200.0).map(|x| (x, y(x))).collect()
}
