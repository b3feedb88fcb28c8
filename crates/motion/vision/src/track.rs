//! The state of one tracked obstacle.

use crate::detection::Detection;
use crate::template_match::TemplateMatch;
use crate::track_settings::TrackRules;
use crate::{Obstacle, ObstacleChange, ObstacleId, Point2, polygon};

/// One tracked obstacle.
#[derive(Debug, Clone, Default)]
pub(crate) struct Track {
    /// Convex outline on the floor as observed, metres.
    pub(crate) outline_m: Vec<Point2>,
    pub(crate) complete: CompleteOutline,
    /// Whether the arm occludes a part of the outline in this frame; the caller sets it before
    /// [`ObjectTracker::update`](crate::object_tracker::ObjectTracker::update).
    pub(crate) is_occluded: bool,
    pub(crate) obstacle: Obstacle,
    pub(crate) centre_m: Point2,
    pub(crate) velocity_mps: Point2,
    /// Area in the last frame in which the object was observed completely and apart from others.
    pub(crate) area: f64,
    pub(crate) brightness: f64,
    /// Whether the outline is incomplete, or a part of a merged one.
    pub(crate) is_truncated: bool,
    pub(crate) template: TemplateMatch,
    pub(crate) frames_seen: u32,
    pub(crate) frames_missed: u32,
    /// Area of the footprint when the reported prism last changed; `None` if the obstacle is not reported yet.
    pub(crate) reported_area: Option<f64>,
    pub(crate) heights: HeightRange,
    /// Top of the highest object while several are observed as one, because the line between them is uncertain.
    pub(crate) merged_z_to_m: Option<f64>,
}

/// The outline of an object when it was last completely observed, moved on with the velocity while the arm occludes a part
/// of it.
#[derive(Debug, Clone, Default)]
pub(crate) struct CompleteOutline {
    pub(crate) outline_m: Vec<Point2>,
    /// Time for which the outline was moved on since then, s.
    pub(crate) extrapolated_s: f64,
}

/// Lower and upper end, world z, metres.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct HeightRange {
    pub(crate) from_m: f64,
    pub(crate) to_m: f64,
}

impl HeightRange {
    pub(crate) fn of(detection: &Detection) -> Self {
        Self { from_m: detection.z_from_m, to_m: detection.z_to_m }
    }

    /// Extends the range by a partial detection.
    pub(crate) fn extend(&mut self, detection: &Detection) {
        self.from_m = self.from_m.min(detection.z_from_m);
        self.to_m = self.to_m.max(detection.z_to_m);
    }
}

/// Gains of an alpha-beta filter, each from 0 (keep the prediction) to 1 (P. R. Kalata: *The tracking index*, 1984).
#[derive(Debug, Clone, Copy)]
pub(crate) struct AlphaBetaGains {
    /// Alpha: the position is the predicted one plus this fraction of the residual (measured minus predicted position).
    pub(crate) position: f64,
    /// Beta: the velocity changes by this fraction of the residual per time step.
    pub(crate) velocity: f64,
}

/// Smallest speed by which the speed limit is divided, m/s: a track at rest is not limited.
const MIN_SPEED_MPS: f64 = 1e-12;

/// Fraction of the reported footprint's area below which a smaller footprint is reported again, so that a prism is not
/// much too large.
const SHRUNK_AREA_RATIO: f64 = 0.8;

impl Track {
    pub(crate) fn restart(&mut self, id: ObstacleId, detection: &Detection) {
        self.outline_m.clone_from(&detection.outline_m);
        self.complete.outline_m.clear();
        self.complete.extrapolated_s = 0.0;
        self.is_occluded = false;
        self.obstacle.id = id;
        self.centre_m = detection.centre_m;
        self.velocity_mps = Point2::default();
        self.area = detection.area;
        self.brightness = detection.brightness;
        self.is_truncated = detection.touches_arm || detection.touches_border;
        self.merged_z_to_m = None;
        self.template = TemplateMatch::default();
        (self.frames_seen, self.frames_missed, self.reported_area) = (1, 0, None);
        self.heights = HeightRange::of(detection);
    }

    /// Alpha-beta filter: corrects the predicted centre and the velocity by the measured centre.
    pub(crate) fn correct(
        &mut self,
        predicted_m: Point2,
        measured_m: Point2,
        dt_s: f64,
        gains: AlphaBetaGains,
        max_speed_mps: f64,
    ) {
        let residual = measured_m - predicted_m;
        self.centre_m = predicted_m + residual * gains.position;
        if dt_s > 0.0 {
            let velocity = self.velocity_mps + residual * (gains.velocity / dt_s);
            self.velocity_mps = velocity * (max_speed_mps / velocity.length().max(MIN_SPEED_MPS)).min(1.0);
        }
        self.frames_seen = self.frames_seen.saturating_add(1);
        self.frames_missed = 0;
    }

    /// Records a frame without a detection.
    pub(crate) fn miss(&mut self) {
        self.velocity_mps = Point2::default();
        if !self.is_occluded {
            self.frames_missed = self.frames_missed.saturating_add(1);
            self.frames_seen = if self.is_reported() { self.frames_seen } else { 0 };
        }
    }

    /// Keeps the reported prism.
    pub(crate) fn keep_prism(&mut self) {
        self.obstacle.change = ObstacleChange::Unchanged;
        self.obstacle.velocity_mps = self.velocity_mps;
        self.obstacle.is_unobserved = true;
    }

    /// Whether the obstacle has been reported.
    pub(crate) fn is_reported(&self) -> bool {
        self.reported_area.is_some()
    }

    /// Lower and upper end, including those of objects merged with the track.
    pub(crate) fn z_range_m(&self, settings: TrackRules<'_>) -> (f64, f64) {
        let (from, to) = self.own_z_range_m(settings);
        (from, to.max(self.merged_z_to_m.unwrap_or(to)))
    }

    pub(crate) fn own_z_range_m(&self, settings: TrackRules<'_>) -> (f64, f64) {
        let HeightRange { from_m, to_m } = self.heights;
        let of_template = |template: usize| settings.track.floor_z_m + settings.templates[template].max_height_m();
        (from_m, self.template.accepted.map_or(to_m, of_template))
    }

    /// Whether the reported footprint still contains the present one and is not much too large.
    pub(crate) fn still_contains(&self, footprint_m: &[Point2]) -> bool {
        let has_shrunk =
            self.reported_area.is_some_and(|before| polygon::area(footprint_m) < SHRUNK_AREA_RATIO * before);
        let contains = || footprint_m.iter().all(|&p| polygon::convex_contains(&self.obstacle.footprint_m, p));
        !has_shrunk && contains()
    }
}
