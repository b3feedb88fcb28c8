//! The search over time: look at the middle, drop what is proven free around it, go on with what is left, earlier first.

use elbowroom_proximity::Separation;

use super::speed::Speed;
use super::travel::{Side, Travel};
use super::{Impact, Move, SweepOptions};
use crate::checker::narrow::Placed;
use crate::checker::{Core, Pair, PairList};
use crate::{Level, Member, Reason};

/// Share of the time in question that a box must clear so that the solids need not be measured: little, as boxes are
/// some hundred times faster.
const WORTH: f64 = 0.01;

/// Memory that is used again.
#[derive(Debug, Default)]
pub(super) struct Search {
    /// Pairs with an object on a path that the matrix leaves out because no joint moves them.
    extra: Vec<Pair>,
    tracks: Vec<Track>,
    /// Times in question; those of the frame on top are at the end.
    open: Vec<Open>,
    /// Earlier parts of the frame at hand, on their way to the end of `open`.
    early: Vec<Open>,
    frames: Vec<Frame>,
    /// The earliest known: track and time.
    hit: Option<(usize, f64)>,
    steps: u32,
}

/// A pair in motion.
#[derive(Debug, Clone, Copy)]
struct Track {
    /// Index of the pair: in the list, then in `extra`.
    pair: usize,
    sides: [Side; 2],
    speed: Speed,
    /// Metres: margin, clearance and the tolerance.
    near: f64,
    /// Metres: nearer is a hit, where it is looked at. A little less than `near`, for rounding.
    close: f64,
    /// Metres: farther is proven free. Half a tolerance less, so that every look gets on.
    keep: f64,
}

/// A pair and when it is not proven free.
#[derive(Debug, Clone, Copy)]
struct Open {
    track: usize,
    from: f64,
    to: f64,
}

/// Some time of the motion; everything before is free.
#[derive(Debug, Clone, Copy)]
struct Frame {
    from: f64,
    to: f64,
    begin: usize,
}

/// What a look at a pair says.
enum Look {
    /// Free for so long before and after; infinite: for all the time in question.
    Free(f64),
    /// Too near.
    Near,
    /// Not looked at: the steps are used up.
    Spent,
}

impl Search {
    /// The first impact along the travel, `None` where all of it is free.
    pub fn run(
        &mut self,
        core: &mut Core,
        list: &mut PairList,
        travel: &mut Travel,
        moves: &[Move],
        options: &SweepOptions,
    ) -> Option<Impact> {
        (self.hit, self.steps) = (None, 0);
        core.deepest = Level::L1;
        self.track(core, list, travel, options);
        let found = self.go(&mut Scope { core, list, travel, moves, max_steps: options.max_steps });
        core.narrow.counts.answered.add(core.deepest, 1);
        found
    }

    /// All pairs that count, in question from 0 to 1.
    fn track(&mut self, core: &mut Core, list: &PairList, travel: &Travel, options: &SweepOptions) {
        self.extra.clear();
        self.tracks.clear();
        self.open.clear();
        self.frames.clear();
        self.stand_in_the_way(core, list, travel);
        let clearance = if options.clearance_m.is_nan() { f64::INFINITY } else { options.clearance_m.max(0.0) };
        let level = core.fine();
        for (index, pair) in list.pairs.iter().chain(&self.extra).enumerate() {
            let (a, b) = (pair.a as usize, pair.b as usize);
            let models = [a, b].map(|m| &core.scene.models[m]);
            let finest = travel.finest(a, b);
            let tolerance = if options.tolerance_m > finest { options.tolerance_m } else { finest };
            let limit = pair.margin + clearance + models[0].slack(level) + models[1].slack(level);
            let near = limit + tolerance;
            let proven =
                pair.least > near && core.options.matrix && models.iter().all(|m| travel.proofs_hold(m.member));
            if proven {
                core.narrow.counts.pairs_skipped += 1;
                continue;
            }
            let sides = travel.sides(core.scene, a, b);
            let speed = travel.speed(sides[0]).joined(travel.speed(sides[1]));
            self.open.push(Open { track: self.tracks.len(), from: 0.0, to: 1.0 });
            let (close, keep) = (limit + 0.9 * tolerance, limit + 0.5 * tolerance);
            self.tracks.push(Track { pair: index, sides, speed, near, close, keep });
        }
        if !self.open.is_empty() {
            self.frames.push(Frame { from: 0.0, to: 1.0, begin: 0 });
        }
    }

    /// Links that stand still are no pair with objects that do, but with one that comes along.
    fn stand_in_the_way(&mut self, core: &Core, list: &PairList, travel: &Travel) {
        let scene = core.scene;
        for object in (0..scene.objects.len()).filter(|o| travel.is_free(*o)) {
            for m in &scene.models {
                let Member::Link { .. } = m.member else { continue };
                let (a, b) = (m.member, Member::Object(object));
                let entry = scene.pairs.get(a, b).filter(|e| e.reason == Reason::NoJointBetween);
                if let Some(e) = entry.filter(|_| list.selects(&travel.state, a, b)) {
                    self.extra.extend(Pair::of(scene, (a, b), e.margin_m));
                }
            }
        }
    }

    fn go(&mut self, s: &mut Scope) -> Option<Impact> {
        while let Some(frame) = self.frames.pop() {
            let until = self.hit.map_or(1.0, |h| h.1);
            if self.hit.is_some() && frame.from >= until {
                self.open.truncate(frame.begin);
                continue;
            }
            let to = frame.to.min(until);
            let middle = 0.5 * (frame.from + to);
            let length = to - frame.from;
            let speeds = || self.open[frame.begin..].iter().map(|o| &self.tracks[o.track]);
            let short = |t: &Track| t.speed.cap * length <= 0.5 * (t.near - t.keep);
            // Where the whole frame is within the tolerance, its start tells all; without a bound of speed, there is no
            // more to tell.
            let last = !(middle > frame.from && middle < to)
                || speeds().all(short)
                || speeds().any(|t| t.speed.cap == f64::INFINITY);
            let at = if last { frame.from } else { middle };
            s.travel.go(s.core.scene, s.moves, at);
            if let Some(stuck) = self.look_at_all(s, &frame, at, last) {
                let impact = self.tell(s, stuck, frame.from);
                return Some(Impact { certain: false, ..impact });
            }
        }
        self.hit.map(|(track, time)| self.tell(s, track, time))
    }

    /// Looks at the pairs of a frame, and leaves frames for what is in question still. A pair that gets nowhere is
    /// returned.
    fn look_at_all(&mut self, s: &mut Scope, frame: &Frame, at: f64, last: bool) -> Option<usize> {
        self.early.clear();
        let mut late = frame.begin;
        for i in frame.begin..self.open.len() {
            let open = self.open[i];
            // After a hit, only what is earlier matters.
            let to = self.hit.map_or(open.to, |h| h.1.min(open.to));
            if to < open.from {
                continue;
            }
            let track = self.tracks[open.track];
            let (before, after) = match self.look(s, &track, (at - open.from).max(to - at).max(0.0)) {
                Look::Spent => return Some(open.track),
                Look::Free(time) => (at - time, at + time),
                Look::Near => {
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
                self.early.push(Open { to: before.min(to), ..open });
            }
            if after < to {
                self.open[late] = Open { track: open.track, from: after.max(open.from), to };
                late += 1;
            }
        }
        self.open.truncate(late);
        self.push_frame(frame.begin);
        let begin = self.open.len();
        self.open.append(&mut self.early);
        self.push_frame(begin);
        None
    }

    fn push_frame(&mut self, begin: usize) {
        let open = &self.open[begin..];
        if !open.is_empty() {
            let from = open.iter().map(|o| o.from).fold(f64::INFINITY, f64::min);
            let to = open.iter().map(|o| o.to).fold(0.0, f64::max);
            self.frames.push(Frame { from, to, begin });
        }
    }

    /// Looks at one pair where it is now, from coarse to fine; `time` before and after is in question.
    fn look(&mut self, s: &mut Scope, track: &Track, time: f64) -> Look {
        let (core, travel) = (&mut *s.core, &mut *s.travel);
        let [a, b] = track.sides.map(|side| Placed::new(core.scene, &travel.state, side.model));
        let (near, keep, speed) = (track.near, track.keep, track.speed);
        let mut gap = f64::NEG_INFINITY;
        if core.boxes_decide() {
            let [x, y] = track.sides.map(|side| &travel.state.boxes[side.model]);
            gap = f64::from(x.gap(y));
            if gap > near && gap - keep >= speed.over(speed.cap, time) {
                core.narrow.counts.pairs_cleared.l2 += 1;
                core.deepen(Level::L2);
                return Look::Free(f64::INFINITY);
            }
            if core.options.level == Level::Auto {
                gap = gap.max(core.narrow.gap(&a, &b));
            }
        }
        let now = track.sides.iter().map(|side| travel.speed_now(core.scene, *side)).sum();
        let reach = speed.over(now, time);
        if gap > near {
            let all = gap - keep >= reach;
            let free = if all { f64::INFINITY } else { speed.time_for(now, gap - keep) };
            if free >= WORTH * time {
                core.narrow.counts.pairs_cleared.l2 += 1;
                core.deepen(Level::L2);
                return Look::Free(free);
            }
        }
        if self.steps >= s.max_steps {
            return Look::Spent;
        }
        self.steps += 1;
        let level = core.fine();
        core.deepen(level);
        let limit = near.max(keep + reach);
        let hint = &mut pair_mut(s.list, &mut self.extra, track.pair).hint;
        let Some(found) = core.narrow.measure(&a, &b, level, limit, hint) else {
            core.narrow.counts.pairs_cleared.add(level, 1);
            return Look::Free(f64::INFINITY);
        };
        if found.distance > track.close {
            Look::Free(speed.time_for(now, found.lower_bound - keep))
        } else {
            Look::Near
        }
    }

    /// The answer: what a pair is like at some time.
    fn tell(&mut self, s: &mut Scope, track: usize, time: f64) -> Impact {
        s.travel.go(s.core.scene, s.moves, time);
        let track = self.tracks[track];
        let [a, b] = track.sides.map(|side| Placed::new(s.core.scene, &s.travel.state, side.model));
        let pair = pair_mut(s.list, &mut self.extra, track.pair);
        let level = s.core.fine();
        let slack = a.model.slack(level) + b.model.slack(level);
        let found = s.core.narrow.measure(&a, &b, level, f64::INFINITY, &mut pair.hint);
        let nowhere = Separation {
            distance: f64::INFINITY,
            lower_bound: 0.0,
            on_a: a.in_world.translation,
            on_b: b.in_world.translation,
        };
        let found = found.unwrap_or(nowhere);
        Impact {
            time,
            a: a.model.member,
            b: b.model.member,
            on_a: found.on_a,
            on_b: found.on_b,
            metres: (found.distance - pair.margin - slack).max(0.0),
            level,
            steps: self.steps,
            certain: a.in_world.is_finite() && b.in_world.is_finite() && found.distance <= track.near,
        }
    }
}

/// All that a search works on.
struct Scope<'r, 'c, 's, 'm> {
    core: &'r mut Core<'s>,
    list: &'r mut PairList,
    travel: &'r mut Travel,
    moves: &'c [Move<'m>],
    max_steps: u32,
}

fn pair_mut<'p>(list: &'p mut PairList, extra: &'p mut [Pair], index: usize) -> &'p mut Pair {
    let listed = list.pairs.len();
    if index < listed { &mut list.pairs[index] } else { &mut extra[index - listed] }
}
