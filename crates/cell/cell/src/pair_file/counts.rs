//! Counts of a survey of pairs.

/// Number of pairs of each kind that a survey found.
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
    /// Decided by rows of the previous file.
    pub by_hand: usize,
    /// All other pairs.
    pub others: usize,
}
