//! The state of one tracked obstacle.

use crate::detection::Detection;
use crate::{CameraTrackerSettings, Obstacle, ObstacleChange, ObstacleId, Point2, polygon};

/// One tracked obstacle.
#[derive(Debug, Clone, Default)]
pub(crate) struct Track {
    /// Convex outline on the floor as observed, metres.
    pub(crate) outline_m: Vec<Point2>,
    /// Outline when it was last completely observed, moved on with the velocity while the arm occludes a part of it.
    pub(crate) full_outline_m: Vec<Point2>,
    /// Time for which this outline was moved on since then, s.
    pub(crate) extrapolated_s: f64,
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
    /// The template that currently matches, and (in `candidate_frames`) the number of frames in a row in which it has
    /// matched.
    pub(crate) template_candidate: Option<usize>,
    pub(crate) candidate_frames: u32,
    pub(crate) frames_fully_visible: u32,
    pub(crate) frames_unmatched: u32,
    pub(crate) template: Option<usize>,
    pub(crate) frames_seen: u32,
    pub(crate) frames_missed: u32,
    pub(crate) is_reported: bool,
    /// Area of the footprint when the prism last changed.
    pub(crate) reported_area: f64,
    pub(crate) z_from_m: f64,
    pub(crate) z_to_m: f64,
    /// Top of the highest object while several are observed as one, because the line between them is uncertain.
    pub(crate) merged_z_to_m: Option<f64>,
}

/// Gains of an alpha-beta filter, each from 0 (keep the prediction) to 1 (P. R. Kalata: *The tracking index*, 1984).
#[derive(Debug, Clone, Copy)]
pub(crate) struct AlphaBetaGains {
    /// Alpha: the position is the predicted one plus this fraction of the residual (measured minus predicted position).
    pub(crate) position: f64,
    /// Beta: the velocity changes by this fraction of the residual per time step.
    pub(crate) velocity: f64,
}

/// At most one fully visible frame in this number may be without a matching template.
const FRAMES_PER_MISMATCH: u32 = 10;

/// Smallest speed by which the speed limit is divided, m/s: a track at rest is not limited.
const MIN_SPEED_MPS: f64 = 1e-12;

/// Fraction of the reported footprint's area below which a smaller footprint is reported again, so that a prism is not
/// much too large.
const SHRUNK_AREA_RATIO: f64 = 0.8;

impl Track {
    pub(crate) fn restart(&mut self, id: ObstacleId, detection: &Detection) {
        self.outline_m.clone_from(&detection.outline_m);
        self.full_outline_m.clear();
        self.extrapolated_s = 0.0;
        self.is_occluded = false;
        self.obstacle.id = id;
        self.centre_m = detection.centre_m;
        self.velocity_mps = Point2::default();
        self.area = detection.area;
        self.brightness = detection.brightness;
        self.is_truncated = detection.touches_arm || detection.touches_border;
        self.merged_z_to_m = None;
        (self.template, self.template_candidate, self.candidate_frames) = (None, None, 0);
        (self.frames_fully_visible, self.frames_unmatched) = (0, 0);
        (self.frames_seen, self.frames_missed, self.is_reported) = (1, 0, false);
        (self.z_from_m, self.z_to_m) = (detection.z_from_m, detection.z_to_m);
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
            self.frames_seen = if self.is_reported { self.frames_seen } else { 0 };
        }
    }

    /// Keeps the reported prism.
    pub(crate) fn keep_prism(&mut self) {
        self.obstacle.change = ObstacleChange::Unchanged;
        self.obstacle.velocity_mps = self.velocity_mps;
        self.obstacle.is_unobserved = true;
    }

    /// Accepts a template that matches in some frames in a row, if nearly all fully visible frames have matched a
    /// template: a moving high, narrow object covers for a while the same floor as a lower, longer one.
    pub(crate) fn update_template(&mut self, matched: Option<usize>, template_frames: u32) {
        let is_same = matched == self.template_candidate;
        self.candidate_frames = if is_same { self.candidate_frames.saturating_add(1) } else { 1 };
        self.template_candidate = matched;
        self.frames_fully_visible = self.frames_fully_visible.saturating_add(1);
        self.frames_unmatched += u32::from(matched.is_none());
        let is_accepted = self.candidate_frames >= template_frames
            && self.frames_unmatched <= self.frames_fully_visible / FRAMES_PER_MISMATCH;
        self.template = matched.filter(|_| is_accepted);
    }

    /// Lower and upper end, including those of objects merged with the track.
    pub(crate) fn z_range_m(&self, settings: &CameraTrackerSettings) -> (f64, f64) {
        let (from, to) = self.own_z_range_m(settings);
        (from, to.max(self.merged_z_to_m.unwrap_or(to)))
    }

    pub(crate) fn own_z_range_m(&self, settings: &CameraTrackerSettings) -> (f64, f64) {
        match self.template {
            Some(template) => (self.z_from_m, settings.floor_z_m + settings.templates[template].max_height_m()),
            None => (self.z_from_m, self.z_to_m),
        }
    }

    /// Whether the reported footprint still contains the present one and is not much too large.
    pub(crate) fn still_contains(&self, footprint_m: &[Point2]) -> bool {
        let has_shrunk = polygon::area(footprint_m) < SHRUNK_AREA_RATIO * self.reported_area;
        let contains = || footprint_m.iter().all(|&p| polygon::convex_contains(&self.obstacle.footprint_m, p));
        !has_shrunk && contains()
    }
}
