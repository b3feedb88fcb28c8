//! Wall-clock time per stage.

use std::time::Duration;

/// Times from a frame to the published map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PerceptionTimes {
    /// Mask of the arm's silhouette.
    pub mask: Duration,
    /// Light correction, background subtraction, shadows, morphology, adaptation.
    pub background: Duration,
    /// Blobs, floor positions, tracking, prisms.
    pub tracks: Duration,
    /// Conversion of prisms to occupied cells.
    pub map: Duration,
    /// Publication of a snapshot for readers.
    pub publish: Duration,
}

impl PerceptionTimes {
    /// Names and times of the stages, in order.
    pub fn stages(&self) -> [(&'static str, Duration); 5] {
        [
            ("mask of the arm", self.mask),
            ("background", self.background),
            ("blobs, tracks", self.tracks),
            ("fill cells", self.map),
            ("publish", self.publish),
        ]
    }

    /// Sum of all stages.
    pub fn total(&self) -> Duration {
        self.stages().iter().map(|(_, time)| *time).sum()
    }
}
