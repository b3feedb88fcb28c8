//! Agreement of the distances of two libraries.

/// Relative tolerance of distances; a thousandth of it, relative to the size, is the absolute tolerance.
const RELATIVE: f64 = 1e-9;

/// Whether two distances agree. A negative distance, by which some libraries report a penetration, counts as 0.
pub fn same_distance(x: f64, y: f64, size: f64) -> bool {
    !x.is_nan() && !y.is_nan() && (x.max(0.0) - y.max(0.0)).abs() <= RELATIVE * (y.max(0.0) + 1e-3 * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_the_same_within_what_was_agreed() {
        assert!(same_distance(0.1, 0.1 + 1e-11, 1.0) && same_distance(-0.2, 0.0, 1.0));
        assert!(!same_distance(0.1, 0.1 + 1e-9, 1.0) && !same_distance(0.0, 1e-9, 1.0));
        assert!(!same_distance(f64::NAN, f64::NAN, 1.0) && !same_distance(f64::NAN, 0.0, 1.0));
    }
}
