//! Downsampling of curves with their extremes.

/// Largest number of points per trace of a plot.
pub const MAX_POINTS: usize = 2000;

/// Indices of at most `budget` of `len` points that preserve the shape of the curve.
///
/// The points are cut into runs of equal length; each run keeps its first and last point and the extremes of every key,
/// so that short peaks are preserved. `budget` is at least 4 per key.
pub fn pick(len: usize, budget: usize, keys: &[&dyn Fn(usize) -> f64]) -> Vec<usize> {
    if len <= budget {
        return (0..len).collect();
    }
    let per_bucket = 2 + 2 * keys.len();
    let buckets = (budget / per_bucket).max(1);
    let mut kept = Vec::with_capacity(budget);
    for bucket in 0..buckets {
        let (from, to) = (bucket * len / buckets, (bucket + 1) * len / buckets);
        kept.extend([from, to - 1]);
        for key in keys {
            kept.extend(extremes(from, to, key));
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Indices of the smallest and largest value of the key; NaN is ignored.
fn extremes(from: usize, to: usize, key: &dyn Fn(usize) -> f64) -> impl Iterator<Item = usize> + use<> {
    let finite = (from..to).filter(|&i| key(i).is_finite());
    let smallest = finite.clone().min_by(|&a, &b| key(a).total_cmp(&key(b)));
    let largest = finite.max_by(|&a, &b| key(a).total_cmp(&key(b)));
    smallest.into_iter().chain(largest)
}

/// Indices of at most `budget` (at least 2) points, evenly spaced, including the first and the last.
pub fn every(len: usize, budget: usize) -> Vec<usize> {
    if len <= budget {
        return (0..len).collect();
    }
    (0..budget).map(|i| i * (len - 1) / (budget - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_of_one_sample_survives() {
        let values: Vec<f64> =
            (0..100_000).map(|i| if i == 77_777 { 5.0 } else { (f64::from(i) * 1e-3).sin() }).collect();
        let kept = pick(values.len(), MAX_POINTS, &[&|i| values[i]]);
        assert!(kept.len() <= MAX_POINTS && kept.contains(&77_777) && kept.contains(&0) && kept.contains(&99_999));
        assert!(kept.is_sorted());
    }

    #[test]
    fn nan_gaps_do_not_break_downsampling_or_hide_extremes() {
        let value = |i: usize| if i.is_multiple_of(3) { f64::NAN } else { i as f64 };
        let kept = pick(9000, 100, &[&value, &|_| f64::NAN]);
        assert!(kept.len() <= 100 && kept.contains(&8999));
    }

    #[test]
    fn frames_keep_both_ends() {
        for (len, budget) in [(0, 5), (5, 5), (6, 5), (100_001, 1500)] {
            let frames = every(len, budget);
            assert!(frames.len() <= budget && frames.first().is_none_or(|&f| f == 0));
            assert_eq!(frames.last().copied(), len.checked_sub(1));
        }
    }
}
