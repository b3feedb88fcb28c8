//! Things with an identity from frame to frame.
//!
//! A thing is expected where its velocity takes it. Two that touch are seen as one: each then gets its part of what is
//! seen, cut by the power diagram of the two (the line where squared distance less squared radius is equal), so that
//! together they cover all of it, and each keeps its size and brightness for the moment they part. What the arm hides
//! stays where it was, however long.

use elbowroom_spatial::Vec3;

use crate::associate::{Association, Detection, Expected};
use crate::template::Footprints;
use crate::track::Track;
use crate::{Change, Obstacle, ObstacleId, Point2, Settings, polygon};

/// All things; memory is reused.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tracker {
    pub(crate) tracks: Vec<Track>,
    pool: Vec<Track>,
    told_before: Vec<Obstacle>,
    next_id: u64,
    expected: Vec<Expected>,
    association: Association,
    footprints: Footprints,
    footprint: Vec<Point2>,
    wanted: Vec<Point2>,
    cut: Vec<Point2>,
    spare: Vec<Point2>,
}

/// Slower things stand: pixels make up as much, metres per second.
const STANDS_MPS: f64 = 0.05;

/// Heights told may be that many times the slack too large before they are told anew.
const HEIGHT_SLACKS: f64 = 2.0;

/// How much of a surprise is believed: of place, and of velocity.
const ALONE: (f64, f64) = (1.0, 0.4);
const TOGETHER: (f64, f64) = (0.35, 0.08);

impl Tracker {
    /// Takes in what is seen `dt_s` seconds after the last call.
    pub(crate) fn update(&mut self, seen: &[Detection], dt_s: f64, settings: &Settings) {
        self.expect(dt_s, settings);
        let known = self.tracks.len();
        let mut association = std::mem::take(&mut self.association);
        association.find(&self.expected[..known], seen);
        for t in 0..self.tracks.len() {
            match association.seen_of[t] {
                Some(s) if association.is_alone[t] => self.follow(t, &seen[s], dt_s, settings),
                Some(s) => self.follow_share(t, s, &seen[s], &association, dt_s, settings),
                None => self.tracks[t].miss(),
            }
        }
        for (s, detection) in seen.iter().enumerate() {
            if let Some(t) = association.piece_of[s] {
                self.add_piece(t, detection, settings);
            } else if association.sharers[s] == 0 {
                self.start(detection);
            }
        }
        self.association = association;
    }

    fn expect(&mut self, dt_s: f64, settings: &Settings) {
        // Never fewer: each keeps a list.
        let most = self.expected.len().max(self.tracks.len());
        self.expected.resize_with(most, Expected::default);
        for (track, expected) in self.tracks.iter().zip(&mut self.expected) {
            let step = if track.frames_missed == 0 { track.velocity_mps * dt_s } else { Point2::default() };
            expected.outline_m.clear();
            expected.outline_m.extend(track.outline_m.iter().map(|&p| p + step));
            expected.centre_m = track.centre_m + step;
            expected.area = track.area;
            expected.brightness = track.brightness;
            expected.reach_m = settings.most_speed_mps * dt_s * f64::from(track.frames_missed + 1);
            expected.is_hidden = track.is_hidden;
        }
    }

    /// A thing that is seen alone.
    fn follow(&mut self, t: usize, detection: &Detection, dt_s: f64, settings: &Settings) {
        self.tracks[t].together_to_m = None;
        if detection.is_cut_by_arm {
            self.add_piece(t, detection, settings);
            self.carry_on(t, dt_s);
            return;
        }
        let track = &mut self.tracks[t];
        track.outline_m.clone_from(&detection.outline_m);
        track.whole_m.clone_from(&detection.outline_m);
        (track.z_from_m, track.z_to_m) = (detection.z_from_m, detection.z_to_m);
        track.is_cut = detection.is_cut_by_border;
        if !track.is_cut {
            track.area = detection.area;
            track.brightness = detection.brightness;
        }
        track.correct(self.expected[t].centre_m, detection.centre_m, dt_s, ALONE, settings.most_speed_mps);
    }

    /// One of several that are seen as one: takes its part of the outline.
    fn follow_share(
        &mut self,
        t: usize,
        s: usize,
        detection: &Detection,
        association: &Association,
        dt_s: f64,
        settings: &Settings,
    ) {
        self.tracks[t].together_to_m = self.highest_of(s, association, settings);
        self.cut.clone_from(&detection.outline_m);
        let own = &self.expected[t];
        for (other, expected) in self.expected.iter().enumerate().take(association.seen_of.len()) {
            if other != t && association.seen_of[other] == Some(s) {
                let (normal, offset) = power_line(own, expected);
                if normal != Point2::default() {
                    std::mem::swap(&mut self.cut, &mut self.spare);
                    polygon::clip(&self.spare, normal, offset, &mut self.cut);
                }
            }
        }
        let track = &mut self.tracks[t];
        if polygon::area(&self.cut) < 0.1 * track.area {
            track.miss();
            return;
        }
        if track.is_hidden || detection.is_cut_by_arm {
            self.cut.extend_from_slice(&track.outline_m);
        }
        polygon::convex_hull(&mut self.cut, &mut track.outline_m);
        track.z_from_m = track.z_from_m.min(detection.z_from_m);
        track.z_to_m = track.z_to_m.max(detection.z_to_m);
        track.is_cut = true;
        let at = polygon::centroid(&track.outline_m);
        track.correct(own.centre_m, at, dt_s, TOGETHER, f64::INFINITY);
    }

    /// The upper end of the highest of the things in detection `s`.
    fn highest_of(&self, s: usize, association: &Association, settings: &Settings) -> Option<f64> {
        let together = self.tracks.iter().zip(&association.seen_of).filter(|(_, seen)| **seen == Some(s));
        together.map(|(track, _)| track.own_heights(settings).1).max_by(f64::total_cmp)
    }

    /// Adds what is seen of a thing to what was known of it; nothing changes where it is within that.
    fn add_piece(&mut self, t: usize, detection: &Detection, settings: &Settings) {
        let track = &mut self.tracks[t];
        track.frames_missed = 0;
        let (outline_m, tolerance_m) = (&track.outline_m, settings.uncertainty_m.min(settings.slack_m));
        polygon::grown(outline_m, tolerance_m, &mut self.wanted, &mut self.spare);
        if detection.outline_m.iter().all(|&p| polygon::convex_contains(&self.wanted, p)) {
            return;
        }
        self.cut.clone_from(&detection.outline_m);
        self.cut.extend_from_slice(&track.outline_m);
        polygon::convex_hull(&mut self.cut, &mut track.outline_m);
        track.z_from_m = track.z_from_m.min(detection.z_from_m);
        track.z_to_m = track.z_to_m.max(detection.z_to_m);
        track.is_cut = true;
        track.centre_m = polygon::centroid(&track.outline_m);
    }

    /// A moving thing that is hidden in part: adds what its velocity adds to it behind the arm.
    fn carry_on(&mut self, t: usize, dt_s: f64) {
        let track = &mut self.tracks[t];
        track.frames_seen = track.frames_seen.saturating_add(1);
        if track.velocity_mps.length() < STANDS_MPS || track.whole_m.is_empty() {
            return;
        }
        let step = track.velocity_mps * dt_s;
        track.whole_m.iter_mut().for_each(|p| *p = *p + step);
        self.cut.clone_from(&track.whole_m);
        self.cut.extend_from_slice(&track.outline_m);
        polygon::convex_hull(&mut self.cut, &mut track.outline_m);
        track.is_cut = true;
        track.centre_m = polygon::centroid(&track.whole_m);
    }

    fn start(&mut self, detection: &Detection) {
        let mut track = self.pool.pop().unwrap_or_default();
        self.next_id += 1;
        track.restart(ObstacleId(self.next_id), detection);
        self.tracks.push(track);
    }

    /// Writes the obstacles of this frame, those that have left included, and forgets the latter.
    pub(crate) fn tell(&mut self, settings: &Settings, eye_above_floor: Option<Vec3>, out: &mut Vec<Obstacle>) {
        let mut told = 0;
        for t in (0..self.tracks.len()).rev() {
            if self.tracks[t].frames_missed >= settings.frames_to_leave.max(1) && !self.tracks[t].is_hidden {
                let mut track = self.tracks.remove(t);
                track.obstacle.change = Change::Left;
                if track.is_told {
                    write(&track.obstacle, &mut told, out, &mut self.told_before);
                }
                self.pool.push(track);
            }
        }
        for t in 0..self.tracks.len() {
            if self.tracks[t].is_told || self.tracks[t].frames_seen >= settings.frames_to_enter.max(1) {
                self.shape(t, settings, eye_above_floor);
                write(&self.tracks[t].obstacle, &mut told, out, &mut self.told_before);
            }
        }
        self.told_before.extend(out.drain(told..));
        out.sort_unstable_by_key(|obstacle| obstacle.id);
    }

    /// Repeats the obstacles as they are: for frames that tell nothing.
    pub(crate) fn repeat(&mut self, out: &mut Vec<Obstacle>) {
        let mut told = 0;
        for track in &mut self.tracks {
            if track.is_told {
                track.obstacle.change = Change::Still;
                track.obstacle.is_remembered = true;
                write(&track.obstacle, &mut told, out, &mut self.told_before);
            }
        }
        self.told_before.extend(out.drain(told..));
    }

    /// Decides on template and prism of a thing.
    fn shape(&mut self, t: usize, settings: &Settings, eye_above_floor: Option<Vec3>) {
        let track = &mut self.tracks[t];
        let footprint = &mut self.footprint;
        let is_whole = !track.is_cut && track.frames_missed == 0 && !track.is_hidden;
        if !is_whole && !track.is_cut && track.is_told {
            track.stay();
            return;
        }
        // The outline of a part says nothing about the size, and what it stands on does not follow from it.
        footprint.clone_from(&track.outline_m);
        if is_whole {
            let fits = self.footprints.find(&settings.templates, &track.outline_m, eye_above_floor, footprint);
            track.decide_on(fits, settings.frames_to_fit);
            if track.template.is_none() {
                footprint.clone_from(&track.outline_m);
            }
        }
        polygon::grown(footprint, settings.uncertainty_m, &mut self.wanted, &mut self.spare);
        let (z_from_m, z_to_m) = track.heights(settings);
        let obstacle = &mut track.obstacle;
        obstacle.centre_m = polygon::centroid(footprint);
        obstacle.velocity_mps = track.velocity_mps;
        obstacle.is_remembered = track.frames_missed > 0 || track.is_hidden;
        let is_same = |told: f64, wanted: f64| (0.0..=HEIGHT_SLACKS * settings.slack_m).contains(&(told - wanted));
        let is_as_high = is_same(obstacle.z_to_m, z_to_m) && is_same(z_from_m, obstacle.z_from_m);
        if track.is_told && is_as_high && track.still_covers(&self.wanted) {
            track.obstacle.change = Change::Still;
            return;
        }
        let obstacle = &mut track.obstacle;
        obstacle.change = if track.is_told { Change::Moved } else { Change::Entered };
        (obstacle.z_from_m, obstacle.z_to_m) = (z_from_m, z_to_m);
        obstacle.kind = track.template.map(|kind| settings.templates[kind].name.clone());
        polygon::grown(&self.wanted, settings.slack_m, &mut obstacle.footprint_m, &mut self.spare);
        polygon::simplify_outward(&mut obstacle.footprint_m, settings.most_corners);
        track.is_told = true;
        track.told_area = polygon::area(&self.wanted);
    }
}

/// The line between two things that are seen as one: `normal · p <= offset` is the first one's side.
fn power_line(own: &Expected, other: &Expected) -> (Point2, f64) {
    let power = |e: &Expected| e.centre_m.dot(e.centre_m) - e.area / std::f64::consts::PI;
    ((other.centre_m - own.centre_m) * 2.0, power(other) - power(own))
}

/// Writes the next obstacle of a list; `spare` are obstacles whose memory can be had.
fn write(obstacle: &Obstacle, told: &mut usize, out: &mut Vec<Obstacle>, spare: &mut Vec<Obstacle>) {
    if *told == out.len() {
        out.push(spare.pop().unwrap_or_default());
    }
    out[*told].copy_from(obstacle);
    *told += 1;
}
