//! Intervals of time with a constant value.

/// Maximal runs of equal `Some` values: the value, its first index, and the index after its last.
pub fn runs<T: PartialEq>(values: impl IntoIterator<Item = Option<T>>) -> Vec<(T, usize, usize)> {
    let mut out: Vec<(T, usize, usize)> = Vec::new();
    for (i, value) in values.into_iter().enumerate() {
        let Some(value) = value else { continue };
        match out.last_mut() {
            Some((last, _, end)) if *end == i && *last == value => *end = i + 1,
            _ => out.push((value, i, i + 1)),
        }
    }
    out
}

/// Pairs each `on` time with the next `off` time; an open interval ends at `end_s`.
pub fn pair(times: impl IntoIterator<Item = (f64, bool)>, end_s: f64) -> Vec<(f64, f64)> {
    let mut spans = Vec::new();
    let mut since = None;
    for (t, on) in times {
        match (since, on) {
            (None, true) => since = Some(t),
            (Some(from), false) => {
                spans.push((from, t));
                since = None;
            }
            _ => {}
        }
    }
    spans.extend(since.map(|from| (from, end_s)));
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_split_at_changes_and_gaps() {
        let found = runs([Some(1), Some(1), None, Some(1), Some(2)]);
        assert_eq!(found, [(1, 0, 2), (1, 3, 4), (2, 4, 5)]);
    }

    #[test]
    fn open_spans_last_to_the_end_of_the_run() {
        assert_eq!(
            pair([(0.0, false), (1.0, true), (1.5, true), (2.0, false), (3.0, true)], 9.0),
            [(1.0, 2.0), (3.0, 9.0)]
        );
    }
}
