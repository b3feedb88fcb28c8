//! What two states may differ by and still behave the same.

use crate::Occupancy;

/// What the arbiter makes of an occupancy: unknown, out, or in.
pub(crate) fn what_counts(occupancy: Occupancy) -> Occupancy {
    match occupancy {
        Occupancy::Unknown => Occupancy::Unknown,
        Occupancy::Outside | Occupancy::Warning => Occupancy::Outside,
        Occupancy::Committed | Occupancy::Inside => Occupancy::Committed,
    }
}

/// Moves the element at each index to the index `to` has for it.
pub(crate) fn permute<T>(elements: &mut Vec<T>, to: &[usize]) {
    let mut moved: Vec<(usize, T)> = to.iter().copied().zip(elements.drain(..)).collect();
    moved.sort_by_key(|(to, _)| *to);
    elements.extend(moved.into_iter().map(|(_, element)| element));
}
