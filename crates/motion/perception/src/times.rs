//! Wall-clock time per stage.

use std::time::Duration;

/// From the bytes of a frame to the published map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PerceptionTimes {
    /// Decoding of the image.
    pub decode: Duration,
    /// Mask of the arm's silhouette.
    pub mask: Duration,
    /// Light correction, background subtraction, shadows, morphology, adaptation.
    pub background: Duration,
    /// Blobs, floor positions, tracking, prisms.
    pub tracks: Duration,
    /// Prisms to occupied cells.
    pub map: Duration,
    /// Publication of a snapshot for readers.
    pub publish: Duration,
}

/// From the published map to a trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ReplanTimes {
    /// The planner takes over the changed cells.
    pub update: Duration,
    /// Validation of the rest of the path.
    pub path_check: Duration,
    /// Repairing or replanning; 0 where none was needed.
    pub replan: Duration,
    /// Time parametrization of the path.
    pub timing: Duration,
    /// Exact collision check of the path.
    pub exact: Duration,
}

impl PerceptionTimes {
    /// Names and times of the stages, in order.
    pub fn stages(&self) -> [(&'static str, Duration); 6] {
        [
            ("decode", self.decode),
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

impl ReplanTimes {
    /// Names and times of the stages, in order.
    pub fn stages(&self) -> [(&'static str, Duration); 5] {
        [
            ("planner update", self.update),
            ("path check", self.path_check),
            ("replan", self.replan),
            ("timing", self.timing),
            ("exact check", self.exact),
        ]
    }

    /// Sum of all stages.
    pub fn total(&self) -> Duration {
        self.stages().iter().map(|(_, time)| *time).sum()
    }
}
