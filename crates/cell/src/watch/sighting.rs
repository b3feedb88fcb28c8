//! What one frame told, for whoever moves the arm.

use elbowroom_vision::{ObstacleId, Point2, Sight, polygon};

use super::SeeTimes;

/// One obstacle as it was seen, and as it is in the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Prism {
    /// Who it is.
    pub id: ObstacleId,
    /// The template that it fits.
    pub kind: Option<String>,
    /// Corners of its footprint at the time of the frame, grown by the uncertainty, world x and y, metres.
    pub footprint_m: Vec<Point2>,
    /// The same together with where it will be [`WatchSettings::ahead_s`](super::WatchSettings::ahead_s) later.
    pub swept_m: Vec<Point2>,
    /// Lower end, world z, metres.
    pub z_from_m: f64,
    /// Upper end, world z, metres.
    pub z_to_m: f64,
    /// Its middle, as a best guess, world x and y, metres.
    pub centre_m: Point2,
    /// How that moves, metres per second.
    pub velocity_mps: Point2,
    /// It was not seen in this frame and is kept where it was.
    pub is_remembered: bool,
}

impl Prism {
    /// Whether a convex footprint (world x and y, metres) lies within the one that was seen.
    pub fn contains(&self, footprint_m: &[Point2]) -> bool {
        footprint_m.iter().all(|&p| polygon::convex_contains(&self.footprint_m, p))
    }
}

/// What one frame told.
#[derive(Debug, Clone, PartialEq)]
pub struct Sighting {
    /// When the frame was taken, seconds.
    pub stamp_s: f64,
    /// Whether it can be believed.
    pub sight: Sight,
    /// All obstacles in the map.
    pub prisms: Vec<Prism>,
    /// Who entered.
    pub entered: Vec<ObstacleId>,
    /// Who left.
    pub left: Vec<ObstacleId>,
    /// Cells that became blocked, all obstacles' changes added up.
    pub blocked: usize,
    /// Cells that became free.
    pub freed: usize,
    /// Time per stage.
    pub times: SeeTimes,
}

impl Sighting {
    /// Whether the picture can be believed, and the map with it.
    pub fn is_clear(&self) -> bool {
        self.sight == Sight::Clear
    }
}
