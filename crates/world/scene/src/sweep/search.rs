//! The search over time: tests the middle, drops the times proven free around it, then searches the rest.
//!
//! Earlier times come first.

use elbowroom_kinematics::motion_bound::SpeedBound;
use elbowroom_proximity::Separation;
use elbowroom_robot::{GeometryId, ObjectId};

use super::moves::SweepMove;
use super::options::{SweepHit, SweepOptions};
use super::trajectory::{PairSide, SweepTrajectory};
use crate::checker::core::CheckerCore;
use crate::checker::pair_list::{GeometryPair, PairList};
use crate::narrow_phase::PlacedModel;
use crate::{Level, Reason};

/// Least fraction of the open time that a box must clear to save the measurement of the exact shapes.
///
/// Small, because boxes are some hundred times faster.
const LEAST_SHARE: f64 = 0.01;

/// Workspace of the search.
#[derive(Debug, Default)]
pub(super) struct SweepSearch {
    /// Pairs with an object on its own path that the matrix excludes because no joint moves them.
    extra: Vec<GeometryPair>,
    tracks: Vec<PairTrack>,
    /// Open times; the open times of the topmost time span are at the end.
    open: Vec<OpenTime>,
    /// Earlier parts of the current time span, before they are moved to the end of `open`.
    early: Vec<OpenTime>,
    spans: Vec<TimeSpan>,
    /// The earliest known hit: track and time.
    hit: Option<(usize, f64)>,
    steps: u32,
}

/// A pair in motion.
#[derive(Debug, Clone, Copy)]
struct PairTrack {
    /// Index of the pair: first in the list, then in `extra`.
    pair: usize,
    sides: [PairSide; 2],
    bound: SpeedBound,
    /// Sum of margin, clearance and tolerance, metres.
    near: f64,
    /// Distance below which a tested pair is hit, metres. Slightly less than `near`, for rounding.
    hit_below: f64,
    /// Distance above which a pair is proven free, metres.
    ///
    /// Half a tolerance less than `near`, so that every test makes progress.
    free_above: f64,
}

/// A time interval in which a pair is not proven free.
#[derive(Debug, Clone, Copy)]
struct OpenTime {
    track: usize,
    from: f64,
    to: f64,
}

/// A part of the motion with open times; all earlier times are free.
#[derive(Debug, Clone, Copy)]
struct TimeSpan {
    from: f64,
    to: f64,
    begin: usize,
}

/// Result of the test of a pair at an instant.
enum PairTest {
    /// Free for this time before and after the instant. Infinite: for all of its open time.
    Free(f64),
    TooNear,
    /// Not tested: the steps are used up.
    OutOfSteps,
}

/// Data that a search needs.
struct Context<'r, 'c, 's, 'm> {
    core: &'r mut CheckerCore<'s>,
    list: &'r mut PairList,
    trajectory: &'r mut SweepTrajectory,
    moves: &'c [SweepMove<'m>],
    max_steps: u32,
}

impl SweepSearch {
    /// Finds the first hit along the trajectory; `None` if the whole trajectory is free.
    pub fn run(
        &mut self,
        core: &mut CheckerCore,
        list: &mut PairList,
        trajectory: &mut SweepTrajectory,
        moves: &[SweepMove],
        options: &SweepOptions,
    ) -> Option<SweepHit> {
        (self.hit, self.steps) = (None, 0);
        core.finest = Level::L1;
        self.track_pairs(core, list, trajectory, options);
        let max_steps = options.max_steps;
        let found = self.search(&mut Context { core, list, trajectory, moves, max_steps });
        core.answered();
        found
    }

    /// Collects all pairs that count, open from time 0 to 1.
    fn track_pairs(
        &mut self,
        core: &mut CheckerCore,
        list: &PairList,
        trajectory: &SweepTrajectory,
        options: &SweepOptions,
    ) {
        self.extra.clear();
        self.tracks.clear();
        self.open.clear();
        self.spans.clear();
        self.add_fixed_links(core, list, trajectory);
        let clearance = if options.clearance_m.is_nan() { f64::INFINITY } else { options.clearance_m.max(0.0) };
        let level = core.options.pair_level();
        for (index, pair) in list.pairs.iter().chain(&self.extra).enumerate() {
            let (a, b) = (pair.a as usize, pair.b as usize);
            let models = [a, b].map(|m| &core.scene.models[m]);
            let resolution = trajectory.resolution(a, b);
            let tolerance = if options.tolerance_m > resolution { options.tolerance_m } else { resolution };
            let limit = pair.margin + clearance + models[0].slack_m(level) + models[1].slack_m(level);
            let near = limit + tolerance;
            let proven = pair.proven_least_m > near
                && core.options.matrix
                && models.iter().all(|m| trajectory.proofs_hold(m.id));
            if proven {
                core.narrow.stats.pairs_skipped += 1;
                continue;
            }
            let sides = trajectory.sides(core.scene, a, b);
            let bound = trajectory.bound(sides[0]).relative_to(trajectory.bound(sides[1]));
            if options.moving_only && bound.speed == 0.0 {
                continue;
            }
            self.open.push(OpenTime { track: self.tracks.len(), from: 0.0, to: 1.0 });
            let (hit_below, free_above) = (limit + 0.9 * tolerance, limit + 0.5 * tolerance);
            self.tracks.push(PairTrack { pair: index, sides, bound, near, hit_below, free_above });
        }
        if !self.open.is_empty() {
            self.spans.push(TimeSpan { from: 0.0, to: 1.0, begin: 0 });
        }
    }

    /// Adds the pairs of links that no joint moves with objects on their own paths.
    ///
    /// With stationary objects these links form no pair.
    fn add_fixed_links(&mut self, core: &CheckerCore, list: &PairList, trajectory: &SweepTrajectory) {
        let scene = core.scene;
        for object in (0..scene.objects.len()).map(ObjectId).filter(|o| trajectory.is_free(*o)) {
            for m in &scene.models {
                let GeometryId::Link { .. } = m.id else { continue };
                let (a, b) = (m.id, GeometryId::Object(object));
                let entry = scene.matrix.get(a, b).filter(|e| e.reason == Reason::NoJointBetween);
                if let Some(e) = entry.filter(|_| list.selects(&trajectory.state, a, b)) {
                    self.extra.extend(GeometryPair::of(scene, a, b, e.margin_m));
                }
            }
        }
    }

    fn search(&mut self, c: &mut Context) -> Option<SweepHit> {
        while let Some(span) = self.spans.pop() {
            let until = self.hit.map_or(1.0, |h| h.1);
            if self.hit.is_some() && span.from >= until {
                self.open.truncate(span.begin);
                continue;
            }
            let to = span.to.min(until);
            let middle = 0.5 * (span.from + to);
            let length = to - span.from;
            let tracks = || self.open[span.begin..].iter().map(|o| &self.tracks[o.track]);
            let short = |t: &PairTrack| t.bound.speed * length <= 0.5 * (t.near - t.free_above);
            // If no pair moves by more than a quarter of the tolerance in the whole span, the start of the span decides
            // all of it. Without a speed bound nothing more can be decided.
            let last = !(middle > span.from && middle < to)
                || tracks().all(short)
                || tracks().any(|t| t.bound.speed == f64::INFINITY);
            let at = if last { span.from } else { middle };
            c.trajectory.set_time(c.core.scene, c.moves, at);
            if let Some(stuck) = self.test_span(c, &span, at, last) {
                let hit = self.hit_of(c, stuck, span.from);
                return Some(SweepHit { certain: false, ..hit });
            }
        }
        self.hit.map(|(track, time)| self.hit_of(c, track, time))
    }

    /// Tests the pairs of a time span at an instant, and pushes spans for the times that remain open.
    ///
    /// Returns a pair for which the search cannot make progress.
    fn test_span(&mut self, c: &mut Context, span: &TimeSpan, at: f64, last: bool) -> Option<usize> {
        self.early.clear();
        let mut late = span.begin;
        for i in span.begin..self.open.len() {
            let open = self.open[i];
            // After a hit, only earlier times count.
            let to = self.hit.map_or(open.to, |h| h.1.min(open.to));
            if to < open.from {
                continue;
            }
            let track = self.tracks[open.track];
            let (before, after) = match self.test_pair(c, &track, (at - open.from).max(to - at).max(0.0)) {
                PairTest::OutOfSteps => return Some(open.track),
                PairTest::Free(time) => (at - time, at + time),
                PairTest::TooNear => {
                    if self.hit.is_none_or(|h| at < h.1) {
                        self.hit = Some((open.track, at));
                    }
                    (at, f64::INFINITY)
                }
            };
            if last && after < to {
                return Some(open.track);
            }
            if before > open.from {
                self.early.push(OpenTime { to: before.min(to), ..open });
            }
            if after < to {
                self.open[late] = OpenTime { track: open.track, from: after.max(open.from), to };
                late += 1;
            }
        }
        self.open.truncate(late);
        self.push_span(span.begin);
        let begin = self.open.len();
        self.open.append(&mut self.early);
        self.push_span(begin);
        None
    }

    fn push_span(&mut self, begin: usize) {
        let open = &self.open[begin..];
        if !open.is_empty() {
            let from = open.iter().map(|o| o.from).fold(f64::INFINITY, f64::min);
            let to = open.iter().map(|o| o.to).fold(0.0, f64::max);
            self.spans.push(TimeSpan { from, to, begin });
        }
    }

    /// Tests one pair at the current time, from coarse to fine. It is open for `time` before and after.
    fn test_pair(&mut self, c: &mut Context, track: &PairTrack, time: f64) -> PairTest {
        let (core, trajectory) = (&mut *c.core, &mut *c.trajectory);
        let [a, b] = track.sides.map(|side| PlacedModel::new(core.scene, &trajectory.state, side.model));
        let (near, free_above, bound) = (track.near, track.free_above, track.bound);
        let mut gap = f64::NEG_INFINITY;
        if core.options.uses_boxes() {
            let [x, y] = track.sides.map(|side| &trajectory.state.boxes[side.model]);
            gap = f64::from(x.gap(y));
            if gap > near && gap - free_above >= bound.distance(bound.speed, time) {
                core.cleared(Level::L2);
                return PairTest::Free(f64::INFINITY);
            }
            if core.options.level == Level::Auto {
                gap = gap.max(core.narrow.obb_distance(&a, &b));
            }
        }
        let now = track.sides.iter().map(|side| trajectory.speed_now(core.scene, *side)).sum();
        let travel = bound.distance(now, time);
        if gap > near {
            let all = gap - free_above >= travel;
            let free = if all { f64::INFINITY } else { bound.time_for(now, gap - free_above) };
            if free >= LEAST_SHARE * time {
                core.cleared(Level::L2);
                return PairTest::Free(free);
            }
        }
        if self.steps >= c.max_steps {
            return PairTest::OutOfSteps;
        }
        self.steps += 1;
        let level = core.options.pair_level();
        core.used(level);
        let limit = near.max(free_above + travel);
        let warm_start = &mut pair_mut(c.list, &mut self.extra, track.pair).warm_start;
        let Some(found) = core.narrow.separation(&a, &b, level, limit, warm_start) else {
            core.narrow.stats.pairs_cleared.add(level, 1);
            return PairTest::Free(f64::INFINITY);
        };
        if found.distance > track.hit_below {
            PairTest::Free(bound.time_for(now, found.lower_bound - free_above))
        } else {
            PairTest::TooNear
        }
    }

    /// The hit of a pair at a time, with its distance.
    fn hit_of(&mut self, c: &mut Context, track: usize, time: f64) -> SweepHit {
        c.trajectory.set_time(c.core.scene, c.moves, time);
        let track = self.tracks[track];
        let [a, b] = track.sides.map(|side| PlacedModel::new(c.core.scene, &c.trajectory.state, side.model));
        let pair = pair_mut(c.list, &mut self.extra, track.pair);
        let level = c.core.options.pair_level();
        let slack = a.model.slack_m(level) + b.model.slack_m(level);
        let found = c.core.narrow.separation(&a, &b, level, f64::INFINITY, &mut pair.warm_start);
        let unknown = Separation {
            distance: f64::INFINITY,
            lower_bound: 0.0,
            on_a: a.in_world.translation,
            on_b: b.in_world.translation,
        };
        let found = found.unwrap_or(unknown);
        SweepHit {
            time,
            a: a.model.id,
            b: b.model.id,
            on_a: found.on_a,
            on_b: found.on_b,
            metres: (found.distance - pair.margin - slack).max(0.0),
            level,
            steps: self.steps,
            certain: a.in_world.is_finite() && b.in_world.is_finite() && found.distance <= track.near,
        }
    }
}

fn pair_mut<'p>(list: &'p mut PairList, extra: &'p mut [GeometryPair], index: usize) -> &'p mut GeometryPair {
    let listed = list.pairs.len();
    if index < listed { &mut list.pairs[index] } else { &mut extra[index - listed] }
}
