//! Request and result of the test of a block of configurations.

/// Request for the test of a block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BlockRequest {
    /// True if neighbouring lanes are configurations on one straight segment, and the motion between them also counts.
    pub chords: bool,
    /// One bit per lane; lanes without a bit do not count.
    pub active: u32,
}

/// Result of the test of a block, one bit per lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct BlockResult {
    /// Configurations at which a sphere touches an obstacle or another link.
    pub touching: u32,
    /// Configurations from which the motion to the next one is not proven free, although nothing touches at either end.
    pub unproven: u32,
}

impl BlockResult {
    /// True if all active lanes, and the motion between them if it counts, are proven free.
    pub fn is_free(self) -> bool {
        self.touching == 0 && self.unproven == 0
    }
}

/// A pair that is not proven to be apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum NearPair {
    /// Indices of two links.
    Links(u32, u32),
    /// Index of a body and number of an obstacle.
    Obstacle(u32, u32),
}
