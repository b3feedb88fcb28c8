//! Differences between states that do not change their behaviour.

use crate::Occupancy;

/// Maps an occupancy to the case that the arbiter distinguishes: unknown, outside, committed or inside.
pub(crate) fn what_counts(occupancy: Occupancy) -> Occupancy {
    match occupancy {
        Occupancy::Unknown => Occupancy::Unknown,
        Occupancy::Outside | Occupancy::Warning => Occupancy::Outside,
        Occupancy::Committed | Occupancy::Inside => occupancy,
    }
}

/// Moves the element at each index `i` to the index `to[i]`.
pub(crate) fn permute<T>(elements: &mut Vec<T>, to: &[usize]) {
    let mut moved: Vec<(usize, T)> = to.iter().copied().zip(elements.drain(..)).collect();
    moved.sort_by_key(|(to, _)| *to);
    elements.extend(moved.into_iter().map(|(_, element)| element));
}
