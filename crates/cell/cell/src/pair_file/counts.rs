//! The result of a survey of pairs in numbers.

/// How many pairs of each kind a survey found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PairCounts {
    /// Adjacent, without a joint between, or disabled in the SRDF: never tested.
    pub excluded: usize,
    /// Proven to be out of reach of each other.
    pub out_of_reach: usize,
    /// In contact in all samples.
    pub always: usize,
    /// In contact in no sample.
    pub never: usize,
    /// In contact at rest, and apart in some samples.
    pub at_rest: usize,
    /// Decided by rows of the file before.
    pub by_hand: usize,
    /// All others.
    pub others: usize,
}
