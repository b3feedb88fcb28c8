//! When two libraries give the same distance.

/// Distances agree to this share of themselves, and to a thousandth of it of the size.
const RELATIVE: f64 = 1e-9;

/// Some libraries report a penetration as a negative distance; here it is 0.
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
