//! How long each stage took, on the clock of the wall.

use std::time::{Duration, Instant};

/// From the bytes of a frame to blocked cells that readers see.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SeeTimes {
    /// Bytes to pixels.
    pub decode: Duration,
    /// The arm's silhouette.
    pub mask: Duration,
    /// Light, background, shadows, cleaning, adaptation.
    pub background: Duration,
    /// Blobs, places, identities, prisms.
    pub tracks: Duration,
    /// Prisms to blocked cells.
    pub fill: Duration,
    /// A snapshot for readers.
    pub publish: Duration,
}

/// From blocked cells to a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LookTimes {
    /// The planner takes over the cells that changed.
    pub update: Duration,
    /// What is left of the path is looked along.
    pub standing: Duration,
    /// A path, mended or new; 0 where none was needed.
    pub replan: Duration,
    /// The path in time.
    pub timing: Duration,
    /// The path in the exact scene.
    pub exact: Duration,
}

impl SeeTimes {
    /// Names and times, in order.
    pub fn stages(&self) -> [(&'static str, Duration); 6] {
        [
            ("decode", self.decode),
            ("mask of the arm", self.mask),
            ("background", self.background),
            ("blobs, tracks", self.tracks),
            ("fill cells", self.fill),
            ("publish", self.publish),
        ]
    }

    /// All together.
    pub fn total(&self) -> Duration {
        self.stages().iter().map(|(_, time)| *time).sum()
    }
}

impl LookTimes {
    /// Names and times, in order.
    pub fn stages(&self) -> [(&'static str, Duration); 5] {
        [
            ("planner update", self.update),
            ("look along the path", self.standing),
            ("replan", self.replan),
            ("timing", self.timing),
            ("exact check", self.exact),
        ]
    }

    /// All together.
    pub fn total(&self) -> Duration {
        self.stages().iter().map(|(_, time)| *time).sum()
    }
}

/// Laps.
pub(super) struct Clock(Instant);

impl Clock {
    pub fn start() -> Self {
        Self(Instant::now())
    }

    pub fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.0, now)
    }
}
