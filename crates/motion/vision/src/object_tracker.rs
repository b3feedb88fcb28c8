//! Multi-object tracking: obstacles that keep their identity from frame to frame.
//!
//! The position of a track is predicted from its velocity and corrected by its detection (alpha-beta filter). Objects
//! that touch are detected as one. Each of their tracks then gets a part of the outline, divided by the power diagram
//! (the line on which squared distance minus squared radius is equal), so that the parts cover the whole outline. The
//! track keeps its area and brightness for the time after the separation. Tracks that the arm occludes are kept for any
//! length of time.

use elbowroom_spatial::Vec3;

use crate::association::{Association, TrackPrediction};
use crate::detection::Detection;
use crate::template::TemplateMatcher;
use crate::track::{AlphaBetaGains, HeightRange, Track};
use crate::track_settings::TrackRules;
use crate::{Obstacle, ObstacleChange, ObstacleId, Point2, polygon};

/// All tracks; memory is reused.
#[derive(Debug, Clone, Default)]
pub(crate) struct ObjectTracker {
    pub(crate) tracks: Vec<Track>,
    pool: Vec<Track>,
    spare_obstacles: Vec<Obstacle>,
    next_id: u64,
    predictions: Vec<TrackPrediction>,
    association: Association,
    templates: TemplateMatcher,
    footprint_m: Vec<Point2>,
    grown_m: Vec<Point2>,
    share_m: Vec<Point2>,
    workspace: Vec<Point2>,
}

/// Speed below which an object counts as stationary, metres per second: noise of the outline alone causes such speeds.
const STATIONARY_MPS: f64 = 0.05;

/// Time for which a partly occluded object is assumed to move on at its last speed, s. Afterwards it is assumed to stay
/// where it was seen or predicted until the arm no longer occludes it.
const MAX_EXTRAPOLATION_S: f64 = 1.0;

/// Multiple of the hysteresis by which reported heights may exceed the present ones before the prism changes.
const HEIGHT_HYSTERESIS_FACTOR: f64 = 2.0;

/// Gains for a track with its own detection: the measured position is used, which is accurate to a pixel or two.
const ISOLATED_GAINS: AlphaBetaGains = AlphaBetaGains { position: 1.0, velocity: 0.4 };

/// Gains for merged tracks: the line that divides them is uncertain, so the prediction has more weight.
const MERGED_GAINS: AlphaBetaGains = AlphaBetaGains { position: 0.35, velocity: 0.08 };

/// Fraction of its own area below which a track's part of a merged outline means that the track was missed: it is
/// covered.
const MIN_SHARE: f64 = 0.1;

impl ObjectTracker {
    /// Updates the tracks with the detections of a frame, `dt_s` seconds after the last call.
    pub(crate) fn update(&mut self, detections: &[Detection], dt_s: f64, settings: TrackRules<'_>) {
        self.predict(dt_s, settings);
        let track_count = self.tracks.len();
        let mut association = std::mem::take(&mut self.association);
        association.assign(&self.predictions[..track_count], detections);
        for t in 0..track_count {
            match association.detection_of[t] {
                Some(d) if association.is_isolated[t] => self.update_isolated(t, &detections[d], dt_s, settings),
                Some(d) => self.update_merged(t, d, &detections[d], &association, dt_s, settings),
                None => self.tracks[t].miss(),
            }
        }
        for (d, detection) in detections.iter().enumerate() {
            if let Some(t) = association.fragment_of[d] {
                self.extend_outline(t, detection, settings);
            } else if association.track_count[d] == 0 {
                self.start_track(detection);
            }
        }
        self.association = association;
    }

    fn predict(&mut self, dt_s: f64, settings: TrackRules<'_>) {
        // The list never shrinks, so its elements keep their memory.
        let count = self.predictions.len().max(self.tracks.len());
        self.predictions.resize_with(count, TrackPrediction::default);
        for (track, prediction) in self.tracks.iter().zip(&mut self.predictions) {
            let step = if track.frames_missed == 0 { track.velocity_mps * dt_s } else { Point2::default() };
            prediction.outline_m.clear();
            prediction.outline_m.extend(track.outline_m.iter().map(|&p| p + step));
            prediction.centre_m = track.centre_m + step;
            prediction.area = track.area;
            prediction.brightness = track.brightness;
            prediction.gate_m = settings.track.max_speed_mps * dt_s * f64::from(track.frames_missed + 1);
            prediction.is_occluded = track.is_occluded;
        }
    }

    /// Updates a track that has its own detection.
    fn update_isolated(&mut self, t: usize, detection: &Detection, dt_s: f64, settings: TrackRules<'_>) {
        self.tracks[t].merged_z_to_m = None;
        if detection.touches_arm {
            self.extend_outline(t, detection, settings);
            self.extrapolate(t, dt_s);
            return;
        }
        let track = &mut self.tracks[t];
        track.outline_m.clone_from(&detection.outline_m);
        track.complete.outline_m.clone_from(&detection.outline_m);
        track.complete.extrapolated_s = 0.0;
        track.heights = HeightRange::of(detection);
        track.is_truncated = detection.touches_border;
        if !track.is_truncated {
            track.area = detection.area;
            track.brightness = detection.brightness;
        }
        let predicted_m = self.predictions[t].centre_m;
        track.correct(predicted_m, detection.centre_m, dt_s, ISOLATED_GAINS, settings.track.max_speed_mps);
    }

    /// Updates one of several tracks that share a detection: the track gets its part of the outline.
    fn update_merged(
        &mut self,
        t: usize,
        d: usize,
        detection: &Detection,
        association: &Association,
        dt_s: f64,
        settings: TrackRules<'_>,
    ) {
        self.tracks[t].merged_z_to_m = self.max_z_of_merged(d, association, settings);
        self.share_m.clone_from(&detection.outline_m);
        let own = &self.predictions[t];
        for (other, prediction) in self.predictions.iter().enumerate().take(association.detection_of.len()) {
            if other != t && association.detection_of[other] == Some(d) {
                let (normal, offset) = power_bisector(own, prediction);
                if normal != Point2::default() {
                    std::mem::swap(&mut self.share_m, &mut self.workspace);
                    polygon::clip(&self.workspace, normal, offset, &mut self.share_m);
                }
            }
        }
        let track = &mut self.tracks[t];
        if polygon::area(&self.share_m) < MIN_SHARE * track.area {
            track.miss();
            return;
        }
        if track.is_occluded || detection.touches_arm {
            self.share_m.extend_from_slice(&track.outline_m);
        }
        polygon::convex_hull(&mut self.share_m, &mut track.outline_m);
        track.heights.extend(detection);
        track.is_truncated = true;
        let measured_m = polygon::centroid(&track.outline_m);
        track.correct(own.centre_m, measured_m, dt_s, MERGED_GAINS, f64::INFINITY);
    }

    /// Largest height of the objects in detection `d`.
    fn max_z_of_merged(&self, d: usize, association: &Association, settings: TrackRules<'_>) -> Option<f64> {
        let merged = self.tracks.iter().zip(&association.detection_of).filter(|(_, of)| **of == Some(d));
        merged.map(|(track, _)| track.own_z_range_m(settings).1).max_by(f64::total_cmp)
    }

    /// Extends a track's outline by a partial detection; does not change it if the detection is within the outline.
    fn extend_outline(&mut self, t: usize, detection: &Detection, settings: TrackRules<'_>) {
        let track = &mut self.tracks[t];
        track.frames_missed = 0;
        let (outline_m, tolerance_m) =
            (&track.outline_m, settings.track.uncertainty_m.min(settings.track.hysteresis_m));
        polygon::inflate(outline_m, tolerance_m, &mut self.grown_m, &mut self.workspace);
        if detection.outline_m.iter().all(|&p| polygon::convex_contains(&self.grown_m, p)) {
            return;
        }
        self.share_m.clone_from(&detection.outline_m);
        self.share_m.extend_from_slice(&track.outline_m);
        polygon::convex_hull(&mut self.share_m, &mut track.outline_m);
        track.heights.extend(detection);
        track.is_truncated = true;
        track.centre_m = polygon::centroid(&track.outline_m);
    }

    /// Extends the outline of a moving, partly occluded object to its predicted position behind the arm.
    fn extrapolate(&mut self, t: usize, dt_s: f64) {
        let track = &mut self.tracks[t];
        track.frames_seen = track.frames_seen.saturating_add(1);
        if track.velocity_mps.length() < STATIONARY_MPS || track.complete.outline_m.is_empty() {
            return;
        }
        track.complete.extrapolated_s += dt_s;
        if track.complete.extrapolated_s > MAX_EXTRAPOLATION_S {
            track.velocity_mps = Point2::default();
            return;
        }
        let step = track.velocity_mps * dt_s;
        track.complete.outline_m.iter_mut().for_each(|p| *p = *p + step);
        self.share_m.clone_from(&track.complete.outline_m);
        self.share_m.extend_from_slice(&track.outline_m);
        polygon::convex_hull(&mut self.share_m, &mut track.outline_m);
        track.is_truncated = true;
        track.centre_m = polygon::centroid(&track.complete.outline_m);
    }

    fn start_track(&mut self, detection: &Detection) {
        let mut track = self.pool.pop().unwrap_or_default();
        self.next_id += 1;
        track.restart(ObstacleId(self.next_id), detection);
        self.tracks.push(track);
    }

    /// Writes the obstacles of this frame, including obstacles that have left, whose tracks are dropped.
    pub(crate) fn write_obstacles(
        &mut self,
        settings: TrackRules<'_>,
        eye_above_floor: Option<Vec3>,
        out: &mut Vec<Obstacle>,
    ) {
        let mut count = 0;
        for t in (0..self.tracks.len()).rev() {
            if self.tracks[t].frames_missed >= settings.track.leave_frames.max(1) && !self.tracks[t].is_occluded {
                let mut track = self.tracks.remove(t);
                track.obstacle.change = ObstacleChange::Left;
                if track.is_reported() {
                    write(&track.obstacle, &mut count, out, &mut self.spare_obstacles);
                }
                self.pool.push(track);
            }
        }
        for t in 0..self.tracks.len() {
            if self.tracks[t].is_reported() || self.tracks[t].frames_seen >= settings.track.enter_frames.max(1) {
                self.update_prism(t, settings, eye_above_floor);
                write(&self.tracks[t].obstacle, &mut count, out, &mut self.spare_obstacles);
            }
        }
        self.spare_obstacles.extend(out.drain(count..));
        out.sort_unstable_by_key(|obstacle| obstacle.id);
    }

    /// Writes the obstacles unchanged, for rejected frames.
    pub(crate) fn write_unobserved(&mut self, out: &mut Vec<Obstacle>) {
        let mut count = 0;
        for track in &mut self.tracks {
            if track.is_reported() {
                track.obstacle.change = ObstacleChange::Unchanged;
                track.obstacle.is_unobserved = true;
                write(&track.obstacle, &mut count, out, &mut self.spare_obstacles);
            }
        }
        self.spare_obstacles.extend(out.drain(count..));
    }

    /// Updates template and prism of a track.
    fn update_prism(&mut self, t: usize, settings: TrackRules<'_>, eye_above_floor: Option<Vec3>) {
        let track = &mut self.tracks[t];
        let footprint_m = &mut self.footprint_m;
        let is_whole = !track.is_truncated && track.frames_missed == 0 && !track.is_occluded;
        if !is_whole && !track.is_truncated && track.is_reported() {
            track.keep_prism();
            return;
        }
        // An incomplete outline determines neither the size nor the footprint.
        footprint_m.clone_from(&track.outline_m);
        if is_whole {
            let matched = self.templates.best_match(settings.templates, &track.outline_m, eye_above_floor, footprint_m);
            track.template.update(matched, settings.template_frames);
            if track.template.accepted.is_none() {
                footprint_m.clone_from(&track.outline_m);
            }
        }
        polygon::inflate(footprint_m, settings.track.uncertainty_m, &mut self.grown_m, &mut self.workspace);
        let (z_from_m, z_to_m) = track.z_range_m(settings);
        let obstacle = &mut track.obstacle;
        obstacle.centre_m = polygon::centroid(footprint_m);
        obstacle.velocity_mps = track.velocity_mps;
        obstacle.is_unobserved = track.frames_missed > 0 || track.is_occluded;
        let tolerance_m = HEIGHT_HYSTERESIS_FACTOR * settings.track.hysteresis_m;
        let is_within = |excess_m: f64| (0.0..=tolerance_m).contains(&excess_m);
        let is_as_high = is_within(obstacle.z_to_m - z_to_m) && is_within(z_from_m - obstacle.z_from_m);
        if track.is_reported() && is_as_high && track.still_contains(&self.grown_m) {
            track.obstacle.change = ObstacleChange::Unchanged;
            return;
        }
        let is_reported = track.is_reported();
        let obstacle = &mut track.obstacle;
        obstacle.change = if is_reported { ObstacleChange::Moved } else { ObstacleChange::Entered };
        (obstacle.z_from_m, obstacle.z_to_m) = (z_from_m, z_to_m);
        obstacle.kind = track.template.accepted.map(|template| settings.templates[template].name.clone());
        polygon::inflate(&self.grown_m, settings.track.hysteresis_m, &mut obstacle.footprint_m, &mut self.workspace);
        polygon::simplify_outward(&mut obstacle.footprint_m, settings.track.max_corners);
        track.reported_area = Some(polygon::area(&self.grown_m));
    }
}

/// The line that divides two merged objects: `normal · p <= offset` is the side of the first object.
fn power_bisector(own: &TrackPrediction, other: &TrackPrediction) -> (Point2, f64) {
    let power = |p: &TrackPrediction| p.centre_m.dot(p.centre_m) - p.area / std::f64::consts::PI;
    ((other.centre_m - own.centre_m) * 2.0, power(other) - power(own))
}

/// Writes the next obstacle of a list, using the memory of a spare one if available.
fn write(obstacle: &Obstacle, count: &mut usize, out: &mut Vec<Obstacle>, spare: &mut Vec<Obstacle>) {
    if *count == out.len() {
        out.push(spare.pop().unwrap_or_default());
    }
    out[*count].copy_from(obstacle);
    *count += 1;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x_m: f64, touches_arm: bool) -> Detection {
        let outline_m = [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)].map(|(x, y)| Point2::new(x + x_m, y));
        Detection {
            outline_m: outline_m.to_vec(),
            centre_m: Point2::new(x_m, 0.0),
            area: 0.04,
            z_to_m: 0.5,
            touches_arm,
            ..Detection::default()
        }
    }

    /// An object that moves at 1 m/s stops behind the arm: it is assumed to move on for a second, and then stops
    /// growing.
    #[test]
    fn an_object_that_the_arm_occludes_does_not_grow_forever() {
        let (settings, mut tracker) = (crate::CameraTrackerSettings::default(), ObjectTracker::default());
        for i in 0..=20 {
            tracker.update(&[square(0.05 * f64::from(i), false)], 0.05, settings.track_rules());
        }
        let mut far_m = Vec::new();
        for _ in 0..60 {
            tracker.update(&[square(1.0, true)], 0.05, settings.track_rules());
            assert_eq!(tracker.tracks.len(), 1);
            far_m.push(tracker.tracks[0].outline_m.iter().map(|p| p.x).fold(f64::NEG_INFINITY, f64::max));
        }
        assert!(far_m[9] > 1.5, "{far_m:?}");
        assert!((2.0..2.2).contains(&far_m[20]) && far_m[20..].iter().all(|x| *x == far_m[20]), "{far_m:?}");
        assert_eq!(tracker.tracks[0].velocity_mps, Point2::default());
        // Seen completely, the object has its true size.
        tracker.update(&[square(1.0, false)], 0.05, settings.track_rules());
        assert!(tracker.tracks[0].outline_m.iter().all(|p| p.x < 1.2));
    }
}
