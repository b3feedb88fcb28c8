//! The result of one frame.

use std::time::Duration;

use crate::{Illumination, Obstacle};

/// Why a frame is rejected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RejectReason {
    /// The image is much lighter or darker than while the background was learnt, black or white: a gain outside 0.4 to
    /// 2.5, or an offset of more than 60 grey levels.
    Illumination(Illumination),
    /// Less than half of the visible floor agrees with the background model: for example because a lamp was switched
    /// on, the camera was moved, or something covers the lens.
    Unrecognized {
        /// Fraction of the samples that agree with the background model, 0 to 1.
        inlier_ratio: f64,
    },
    /// The foreground covers more of the image than
    /// [`CameraTrackerSettings::max_foreground`](crate::CameraTrackerSettings::max_foreground).
    TooMuchForeground {
        /// Fraction of the image, 0 to 1.
        foreground_ratio: f64,
    },
    /// A point cloud has too few valid points.
    FewPoints {
        /// Number of valid points.
        points: usize,
        /// Number of invalid points.
        dropped: usize,
    },
}

/// Whether the obstacles of a frame can be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrameStatus {
    /// The background is being learnt; nothing is known yet.
    Learning {
        /// Number of missing frames of the empty cell.
        frames_left: u32,
    },
    /// The frame was accepted and evaluated: where no obstacle is reported, none was detected.
    Accepted,
    /// The frame was not evaluated: the obstacles are those of the last accepted frame. Unknown is not free: the caller
    /// should stop everything that relies on the obstacles.
    Rejected(RejectReason),
}

/// Times per stage of one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StageTimings {
    /// Separation of colours into planes.
    pub convert: Duration,
    /// Gain and offset of the illumination.
    pub illumination: Duration,
    /// Comparison of each pixel with the background model.
    pub classify: Duration,
    /// Shadow detection.
    pub shadows: Duration,
    /// Opening and closing.
    pub morphology: Duration,
    /// Connected components.
    pub label: Duration,
    /// Projection of outlines to the floor.
    pub project: Duration,
    /// Association and update of tracks.
    pub track: Duration,
    /// Templates and prisms.
    pub prisms: Duration,
    /// Adaptation (and learning) of the background model.
    pub adapt: Duration,
}

impl StageTimings {
    /// Names and times of the stages, in their order.
    pub fn stages(&self) -> [(&'static str, Duration); 10] {
        [
            ("convert", self.convert),
            ("illumination", self.illumination),
            ("classify", self.classify),
            ("shadows", self.shadows),
            ("morphology", self.morphology),
            ("label", self.label),
            ("project", self.project),
            ("track", self.track),
            ("prisms", self.prisms),
            ("adapt", self.adapt),
        ]
    }

    /// Total time from frame to obstacles.
    pub fn total(&self) -> Duration {
        self.stages().iter().map(|(_, time)| *time).sum()
    }
}

/// The result of one frame. Borrowed from the [`CameraTracker`](crate::CameraTracker), which reuses it.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameReport {
    /// Time at which the frame was taken, seconds.
    pub stamp_s: f64,
    /// Whether the obstacles can be used.
    pub status: FrameStatus,
    /// All obstacles in the order of their identities; an obstacle that left is reported once more.
    pub obstacles: Vec<Obstacle>,
    /// Fraction of the image that is foreground, 0 to 1.
    pub foreground_ratio: f64,
    /// The illumination of each plane (grey; or red, green, blue).
    pub illumination: Vec<Illumination>,
    /// Time per stage.
    pub timings: StageTimings,
}
