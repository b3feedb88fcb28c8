//! Straight segments in joint space.

/// The configuration at a fraction of the segment from `a` to `b`.
pub(crate) fn lerp(a: &[f64], b: &[f64], share: f64, out: &mut [f64]) {
    for ((o, x), y) in out.iter_mut().zip(a).zip(b) {
        *o = x + (y - x) * share;
    }
}

/// Euclidean length of a segment, rad (and m).
pub(crate) fn length(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

/// Euclidean length of a path, rad (and m).
pub(crate) fn path_length(path: &[Vec<f64>]) -> f64 {
    path.windows(2).map(|w| length(&w[0], &w[1])).sum()
}
