//! The nearer of two separations.

use elbowroom_proximity::Separation;

/// The nearer of two separations, with the smaller lower bound.
pub(crate) fn nearer(best: Option<Separation>, s: Separation) -> Separation {
    match best {
        None => s,
        Some(b) if b.distance <= s.distance => Separation { lower_bound: b.lower_bound.min(s.lower_bound), ..b },
        Some(b) => Separation { lower_bound: b.lower_bound.min(s.lower_bound), ..s },
    }
}
