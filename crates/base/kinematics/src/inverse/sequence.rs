//! Starting points of searches: a deterministic low-discrepancy sequence over the joint ranges.

use std::f64::consts::PI;

/// Component `axis` of point `index` of the sequence in `dimensions` dimensions, in `[0, 1)`.
///
/// Additive recurrence on the generalized golden ratio (Roberts 2018, "The unreasonable effectiveness of quasirandom
/// sequences").
pub fn quasirandom(index: usize, axis: usize, dimensions: usize) -> f64 {
    element(index, axis_step(axis, dimensions))
}

/// Increment of the component per index, for repeated use.
pub fn axis_step(axis: usize, dimensions: usize) -> f64 {
    let mut phi: f64 = 2.0;
    for _ in 0..30 {
        phi = (1.0 + phi).powf(1.0 / (dimensions as f64 + 1.0));
    }
    phi.powf(-(axis as f64 + 1.0))
}

/// Like [`quasirandom`], with the increment of the axis.
pub fn element(index: usize, step: f64) -> f64 {
    (0.5 + step * (index + 1) as f64).fract()
}

/// The part of a joint's range from which starting points are taken: a full turn of an angle; the reach of the rest
/// of the arm for an unlimited slide.
/// for an unlimited slide.
pub fn window(lower: f64, upper: f64, turns: bool, reach: f64) -> (f64, f64) {
    let half = if turns { PI } else { reach.max(1.0) };
    if upper - lower <= 2.0 * half {
        return (lower, upper);
    }
    // Not `clamp`: bounds may be infinite. They are in order because the range is wider than the window.
    let center = 0.0_f64.max(lower + half).min(upper - half);
    (center - half, center + half)
}

/// Fills `q` with configuration `index` of a sequence over the chain's joint ranges (a turn, or ±1 m, if unlimited).
pub fn sample_configuration(chain: &crate::Chain, index: usize, q: &mut [f64]) {
    for (i, id) in chain.active.iter().enumerate() {
        let joint = &chain.joints[id.0];
        let (lo, hi) = window(joint.limits.lower, joint.limits.upper, joint.kind.turns(), 1.0);
        q[i] = lo + (hi - lo) * quasirandom(index, i, q.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_stay_in_the_range() {
        assert_eq!(window(-1.0, 2.0, true, 1.0), (-1.0, 2.0));
        assert_eq!(window(f64::NEG_INFINITY, f64::INFINITY, true, 1.0), (-PI, PI));
        assert_eq!(window(0.0, 4.0 * PI, true, 1.0), (0.0, 2.0 * PI));
        assert_eq!(window(f64::NEG_INFINITY, -5.0, true, 1.0), (-5.0 - 2.0 * PI, -5.0));
        assert_eq!(window(0.5, 0.5, false, 1.0), (0.5, 0.5));
    }

    #[test]
    fn every_eighth_of_the_unit_interval_gets_its_share() {
        for axis in 0..7 {
            let mut hits = [0; 8];
            for index in 0..800 {
                hits[(quasirandom(index, axis, 7) * 8.0) as usize] += 1;
            }
            assert!(hits.iter().all(|&h| (80..=120).contains(&h)), "{axis}: {hits:?}");
        }
    }
}
