//! Data association: assigns detections to tracks.
//!
//! Tracks and detections are assigned one to one: the cheapest pairs first, then improved by swaps. The remaining ones
//! are merged (several tracks in one detection) or fragments (several detections of one track).

use crate::detection::Detection;
use crate::{Point2, polygon};

/// Predicted position of a track in this frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct TrackPrediction {
    pub(crate) outline_m: Vec<Point2>,
    pub(crate) centre_m: Point2,
    pub(crate) area: f64,
    pub(crate) brightness: f64,
    /// Gate: largest distance of a detection from `centre_m`, metres.
    pub(crate) gate_m: f64,
    /// Whether the arm occludes the track: then only detections that overlap the predicted outline are candidates.
    pub(crate) is_occluded: bool,
}

/// The assignment and its workspace.
#[derive(Debug, Clone, Default)]
pub(crate) struct Association {
    /// Detection of each track; several tracks may share one.
    pub(crate) detection_of: Vec<Option<usize>>,
    /// For each detection without its own track, the track of which it is a fragment.
    pub(crate) fragment_of: Vec<Option<usize>>,
    /// For each track, whether its detection belongs to this track alone.
    pub(crate) is_isolated: Vec<bool>,
    /// For each detection, the number of its tracks.
    pub(crate) track_count: Vec<u32>,
    /// Sorted by track, then by detection.
    candidates: Vec<CandidatePair>,
    by_cost: Vec<usize>,
    is_taken: Vec<bool>,
    track_of: Vec<Option<usize>>,
    fragment_overlap: Vec<f64>,
    radii: Vec<f64>,
    gated: Vec<(f64, usize)>,
    intersection: Vec<Point2>,
    workspace: Vec<Point2>,
}

#[derive(Debug, Clone, Copy)]
struct CandidatePair {
    track: usize,
    detection: usize,
    cost: f64,
    /// Area of the intersection as a fraction of the track's area, and (in the next field) of the detection's area.
    overlap_of_track: f64,
    overlap_of_detection: f64,
}

/// Largest number of candidates of one track without overlap: the nearest detections within the gate.
const MAX_GATED: usize = 6;
const MAX_SWAP_ROUNDS: usize = 8;
/// Fraction of a track above which a detection that covers it is merged with it.
const MERGE_OVERLAP: f64 = 0.3;
/// Fraction of a detection above which it is a fragment of the track in whose predicted outline it lies.
const FRAGMENT_OVERLAP: f64 = 0.5;
/// Cost of a logarithm of 1 of the ratio of the areas; then the largest logarithm that counts.
const AREA_COST: f64 = 0.5;
const MAX_AREA_LOGARITHM: f64 = 2.0;
/// Difference in brightness that costs 1, grey levels; then the largest cost of brightness.
const BRIGHTNESS_SCALE_LEVELS: f64 = 40.0;
const MAX_BRIGHTNESS_COST: f64 = 2.0;
/// Smallest decrease of the total cost for a swap: rounding errors do not cause swaps.
const MIN_SWAP_GAIN: f64 = 1e-12;
/// Smallest area (m²) and radius (m) in a ratio, so that it stays finite.
const MIN_AREA_M2: f64 = 1e-9;
const MIN_RADIUS_M: f64 = 1e-6;
/// Smallest area in the fraction of an overlap, m².
const MIN_SHARED_AREA_M2: f64 = 1e-12;

impl Association {
    /// Assigns the detections of a frame to the tracks.
    pub(crate) fn assign(&mut self, tracks: &[TrackPrediction], detections: &[Detection]) {
        self.list_candidates(tracks, detections);
        self.assign_greedily(tracks.len(), detections.len());
        self.improve_by_swaps(detections.len());
        self.assign_merged_and_fragments(detections.len());
    }

    fn list_candidates(&mut self, tracks: &[TrackPrediction], detections: &[Detection]) {
        self.candidates.clear();
        self.radii.clear();
        self.radii.extend(detections.iter().map(|detection| radius(&detection.outline_m, detection.centre_m)));
        for (t, track) in tracks.iter().enumerate() {
            let own_radius = radius(&track.outline_m, track.centre_m);
            let first = self.candidates.len();
            self.gated.clear();
            for (d, detection) in detections.iter().enumerate() {
                let distance = (track.centre_m - detection.centre_m).length();
                let may_overlap = distance <= own_radius + self.radii[d];
                if may_overlap && self.push_overlapping(t, track, d, detection, distance) {
                    continue;
                }
                if distance <= track.gate_m && !track.is_occluded {
                    self.gated.push((distance, d));
                }
            }
            self.gated.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for &(distance, d) in self.gated.iter().take(MAX_GATED) {
                let cost = cost(track, &detections[d], distance);
                let (overlap_of_track, overlap_of_detection) = (0.0, 0.0);
                self.candidates.push(CandidatePair {
                    track: t,
                    detection: d,
                    cost,
                    overlap_of_track,
                    overlap_of_detection,
                });
            }
            self.candidates[first..].sort_unstable_by_key(|pair| pair.detection);
        }
        self.by_cost.clear();
        self.by_cost.extend(0..self.candidates.len());
        let candidates = &self.candidates;
        self.by_cost.sort_unstable_by(|&a, &b| candidates[a].cost.total_cmp(&candidates[b].cost).then(a.cmp(&b)));
    }

    /// Adds a candidate if track and detection overlap; returns whether they do.
    fn push_overlapping(
        &mut self,
        t: usize,
        track: &TrackPrediction,
        d: usize,
        detection: &Detection,
        distance: f64,
    ) -> bool {
        polygon::intersection(&track.outline_m, &detection.outline_m, &mut self.intersection, &mut self.workspace);
        let area = polygon::area(&self.intersection);
        if area > 0.0 {
            self.candidates.push(CandidatePair {
                track: t,
                detection: d,
                cost: cost(track, detection, distance),
                overlap_of_track: area / track.area.max(MIN_SHARED_AREA_M2),
                overlap_of_detection: area / detection.area.max(MIN_SHARED_AREA_M2),
            });
        }
        area > 0.0
    }

    /// Assigns pairs in the order of their cost, as long as track and detection are unassigned.
    fn assign_greedily(&mut self, tracks: usize, detections: usize) {
        reset(&mut self.detection_of, tracks, None);
        reset(&mut self.is_taken, detections, false);
        for pair in self.by_cost.iter().map(|&i| self.candidates[i]) {
            if self.detection_of[pair.track].is_none() && !self.is_taken[pair.detection] {
                self.detection_of[pair.track] = Some(pair.detection);
                self.is_taken[pair.detection] = true;
            }
        }
    }

    /// Swaps the detections of two tracks if that lowers their total cost, because greedy assignment is not optimal.
    fn improve_by_swaps(&mut self, detections: usize) {
        reset(&mut self.track_of, detections, None);
        for (track, &detection) in self.detection_of.iter().enumerate() {
            if let Some(detection) = detection {
                self.track_of[detection] = Some(track);
            }
        }
        for _round in 0..MAX_SWAP_ROUNDS {
            let mut swapped = false;
            for i in 0..self.candidates.len() {
                swapped |= self.swap_if_cheaper(self.candidates[i]);
            }
            if !swapped {
                return;
            }
        }
    }

    /// Assigns the pair, and the track's previous detection to the detection's previous track, if this is cheaper.
    fn swap_if_cheaper(&mut self, pair: CandidatePair) -> bool {
        let (a, j) = (pair.track, pair.detection);
        let (Some(i), Some(b)) = (self.detection_of[a], self.track_of[j]) else { return false };
        let (Some(ai), Some(bj), Some(bi)) = (self.cost_of(a, i), self.cost_of(b, j), self.cost_of(b, i)) else {
            return false;
        };
        if a == b || pair.cost + bi + MIN_SWAP_GAIN >= ai + bj {
            return false;
        }
        (self.detection_of[a], self.detection_of[b]) = (Some(j), Some(i));
        (self.track_of[j], self.track_of[i]) = (Some(a), Some(b));
        true
    }

    fn cost_of(&self, track: usize, detection: usize) -> Option<f64> {
        let found = self.candidates.binary_search_by(|p| p.track.cmp(&track).then(p.detection.cmp(&detection)));
        found.ok().map(|i| self.candidates[i].cost)
    }

    fn candidates_of(&self, track: usize) -> &[CandidatePair] {
        let from = self.candidates.partition_point(|p| p.track < track);
        let to = self.candidates.partition_point(|p| p.track <= track);
        &self.candidates[from..to]
    }

    /// Assigns the remaining tracks to detections that cover them, and the remaining detections to tracks that cover
    /// them.
    fn assign_merged_and_fragments(&mut self, detections: usize) {
        reset(&mut self.fragment_of, detections, None);
        for t in 0..self.detection_of.len() {
            if self.detection_of[t].is_none() {
                let covering = self.candidates_of(t).iter().filter(|p| p.overlap_of_track > MERGE_OVERLAP);
                let best = covering.max_by(|a, b| a.overlap_of_track.total_cmp(&b.overlap_of_track));
                self.detection_of[t] = best.map(|p| p.detection);
            }
        }
        reset(&mut self.track_count, detections, 0);
        self.detection_of.iter().flatten().for_each(|&d| self.track_count[d] += 1);
        reset(&mut self.fragment_overlap, detections, 0.0);
        for pair in &self.candidates {
            let (d, overlap) = (pair.detection, pair.overlap_of_detection);
            if self.track_count[d] == 0 && overlap > FRAGMENT_OVERLAP && overlap > self.fragment_overlap[d] {
                self.fragment_overlap[d] = overlap;
                self.fragment_of[d] = Some(pair.track);
            }
        }
        self.is_isolated.clear();
        let is_isolated = |detection: &Option<usize>| detection.is_some_and(|d| self.track_count[d] == 1);
        self.is_isolated.extend(self.detection_of.iter().map(is_isolated));
    }
}

/// Sum of the differences in position, area and brightness, each scaled to about 1 if the match is doubtful.
fn cost(track: &TrackPrediction, detection: &Detection, distance: f64) -> f64 {
    let area = (track.area.max(MIN_AREA_M2) / detection.area.max(MIN_AREA_M2)).ln().abs();
    let brightness = (track.brightness - detection.brightness).abs();
    let radius = (track.area / std::f64::consts::PI).sqrt();
    distance / (radius + MIN_RADIUS_M)
        + AREA_COST * area.min(MAX_AREA_LOGARITHM)
        + (brightness / BRIGHTNESS_SCALE_LEVELS).min(MAX_BRIGHTNESS_COST)
}

fn radius(outline_m: &[Point2], centre_m: Point2) -> f64 {
    outline_m.iter().map(|&p| (p - centre_m).length()).fold(0.0, f64::max)
}

fn reset<T: Clone>(list: &mut Vec<T>, n: usize, value: T) {
    list.clear();
    list.resize(n, value);
}
