//! One thing with an identity: what is known of it.

use crate::associate::Detection;
use crate::{Change, Obstacle, ObstacleId, Point2, Settings, polygon};

/// One thing.
#[derive(Debug, Clone, Default)]
pub(crate) struct Track {
    /// What it covers on the floor as seen, convex, metres.
    pub(crate) outline_m: Vec<Point2>,
    /// What it covered when it was last seen whole, carried on with its velocity while the arm hides a part of it.
    pub(crate) whole_m: Vec<Point2>,
    /// Some of that is behind the arm in this frame: set by the caller before [`Tracker::update`].
    pub(crate) is_hidden: bool,
    pub(crate) obstacle: Obstacle,
    pub(crate) centre_m: Point2,
    pub(crate) velocity_mps: Point2,
    /// Of the time when it was last seen alone and whole.
    pub(crate) area: f64,
    pub(crate) brightness: f64,
    pub(crate) is_cut: bool,
    /// The template that it has been fitting, and for how many frames in a row.
    pub(crate) fits: Option<usize>,
    pub(crate) frames_fit: u32,
    pub(crate) frames_whole: u32,
    pub(crate) frames_misfit: u32,
    pub(crate) template: Option<usize>,
    pub(crate) frames_seen: u32,
    pub(crate) frames_missed: u32,
    pub(crate) is_told: bool,
    /// Area of the footprint when the obstacle was last told.
    pub(crate) told_area: f64,
    pub(crate) z_from_m: f64,
    pub(crate) z_to_m: f64,
    /// While several are seen as one, the highest of them: the line between them is a guess.
    pub(crate) together_to_m: Option<f64>,
}

/// One frame in so many may fit no template.
const MOST_MISFITS: u32 = 10;

impl Track {
    pub(crate) fn restart(&mut self, id: ObstacleId, detection: &Detection) {
        self.outline_m.clone_from(&detection.outline_m);
        self.whole_m.clear();
        self.is_hidden = false;
        self.obstacle.id = id;
        self.centre_m = detection.centre_m;
        self.velocity_mps = Point2::default();
        self.area = detection.area;
        self.brightness = detection.brightness;
        self.is_cut = detection.is_cut_by_arm || detection.is_cut_by_border;
        self.together_to_m = None;
        (self.template, self.fits, self.frames_fit) = (None, None, 0);
        (self.frames_whole, self.frames_misfit) = (0, 0);
        (self.frames_seen, self.frames_missed, self.is_told) = (1, 0, false);
        (self.z_from_m, self.z_to_m) = (detection.z_from_m, detection.z_to_m);
    }

    pub(crate) fn correct(
        &mut self,
        expected_m: Point2,
        seen_m: Point2,
        dt_s: f64,
        (place, speed): (f64, f64),
        most: f64,
    ) {
        let surprise = seen_m - expected_m;
        self.centre_m = expected_m + surprise * place;
        if dt_s > 0.0 {
            let velocity = self.velocity_mps + surprise * (speed / dt_s);
            self.velocity_mps = velocity * (most / velocity.length().max(1e-12)).min(1.0);
        }
        self.frames_seen = self.frames_seen.saturating_add(1);
        self.frames_missed = 0;
    }

    pub(crate) fn miss(&mut self) {
        self.velocity_mps = Point2::default();
        if !self.is_hidden {
            self.frames_missed = self.frames_missed.saturating_add(1);
            self.frames_seen = if self.is_told { self.frames_seen } else { 0 };
        }
    }

    /// The prism told last is told again.
    pub(crate) fn stay(&mut self) {
        self.obstacle.change = Change::Still;
        self.obstacle.velocity_mps = self.velocity_mps;
        self.obstacle.is_remembered = true;
    }

    /// A template must fit for some frames in a row, and must have been fitting nearly whenever the thing was in full
    /// sight: on its way a high, slim thing covers for a while what a lower, longer one would.
    pub(crate) fn decide_on(&mut self, fits: Option<usize>, frames_to_fit: u32) {
        self.frames_fit = if fits == self.fits { self.frames_fit.saturating_add(1) } else { 1 };
        self.fits = fits;
        self.frames_whole = self.frames_whole.saturating_add(1);
        self.frames_misfit += u32::from(fits.is_none());
        let is_believed = self.frames_fit >= frames_to_fit && self.frames_misfit <= self.frames_whole / MOST_MISFITS;
        self.template = fits.filter(|_| is_believed);
    }

    pub(crate) fn heights(&self, settings: &Settings) -> (f64, f64) {
        let (from, to) = self.own_heights(settings);
        (from, to.max(self.together_to_m.unwrap_or(to)))
    }

    pub(crate) fn own_heights(&self, settings: &Settings) -> (f64, f64) {
        match self.template {
            Some(kind) => (self.z_from_m, settings.floor_z_m + settings.templates[kind].top_m()),
            None => (self.z_from_m, self.z_to_m),
        }
    }

    /// Whether the prism told last contains what is wanted now, and is not needlessly large.
    pub(crate) fn still_covers(&self, wanted: &[Point2]) -> bool {
        let has_shrunk = polygon::area(wanted) < 0.8 * self.told_area;
        let covers = || wanted.iter().all(|&p| polygon::convex_contains(&self.obstacle.footprint_m, p));
        !has_shrunk && covers()
    }
}
