//! What one frame told.

use std::time::Duration;

use crate::{Light, Obstacle};

/// Why a frame is not believed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Blindness {
    /// Much lighter or darker than it was learnt, black or white: 0.4 to 2.5 times, 60 grey levels up or down.
    Light(Light),
    /// Less than half of the floor that is in sight looks like itself: a lamp went on, the camera was pushed, something
    /// is before the lens.
    Unrecognized {
        /// Share of samples that agree with the background, 0 to 1.
        agreeing: f64,
    },
    /// More of the picture than [`Settings::most_foreground`](crate::Settings::most_foreground) is covered by things.
    Covered {
        /// Share of the picture, 0 to 1.
        share: f64,
    },
}

/// Whether a frame can be believed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sight {
    /// The background is being learnt; nothing is known yet.
    Learning {
        /// Frames of the empty cell still to come.
        frames_left: u32,
    },
    /// All is well: where no obstacle is told, none is seen.
    Clear,
    /// Nothing is known of this frame: the obstacles are those of the last one that was clear. Not free: the caller
    /// should stop what relies on it.
    Blind(Blindness),
}

/// Time per stage of one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Timings {
    /// Colours to planes.
    pub convert: Duration,
    /// Gain and offset of the light.
    pub light: Duration,
    /// Each pixel against the background.
    pub classify: Duration,
    /// Shadow or thing.
    pub shadows: Duration,
    /// Opening, closing.
    pub clean: Duration,
    /// Blobs.
    pub label: Duration,
    /// Outlines to the floor.
    pub place: Duration,
    /// Identities.
    pub track: Duration,
    /// Templates and prisms.
    pub tell: Duration,
    /// The background's adaptation (and learning).
    pub adapt: Duration,
}

impl Timings {
    /// Names and times of the stages, in their order.
    pub fn stages(&self) -> [(&'static str, Duration); 10] {
        [
            ("convert", self.convert),
            ("light", self.light),
            ("classify", self.classify),
            ("shadows", self.shadows),
            ("clean", self.clean),
            ("label", self.label),
            ("place", self.place),
            ("track", self.track),
            ("tell", self.tell),
            ("adapt", self.adapt),
        ]
    }

    /// Frame to obstacles.
    pub fn total(&self) -> Duration {
        self.stages().iter().map(|(_, time)| *time).sum()
    }
}

/// What one frame told. Borrowed from the [`Vision`](crate::Vision), which reuses it.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// When the frame was taken, seconds.
    pub stamp_s: f64,
    /// Whether it can be believed.
    pub sight: Sight,
    /// All obstacles, in the order of their identities; those that left are told once.
    pub obstacles: Vec<Obstacle>,
    /// Share of the picture that is foreground, 0 to 1.
    pub foreground: f64,
    /// The light of each plane (grey; or red, green, blue).
    pub lights: Vec<Light>,
    /// Time per stage.
    pub timings: Timings,
}
