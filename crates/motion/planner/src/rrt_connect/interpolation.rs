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

/// The configuration after a length along a path, and its segment.
pub(crate) fn point_at(path: &[Vec<f64>], far: f64) -> (usize, Vec<f64>) {
    let mut left = far;
    for (segment, w) in path.windows(2).enumerate() {
        let length = length(&w[0], &w[1]);
        if left <= length && length > 0.0 {
            let mut q = w[0].clone();
            lerp(&w[0], &w[1], left / length, &mut q);
            return (segment, q);
        }
        left -= length;
    }
    (path.len() - 2, path[path.len() - 1].clone())
}
