//! Distance of two convex cores by Newton's method on alternating projections. Why it works: `README.md` beside this
//! file.

mod around;
pub(crate) mod derivative;
mod features;

use elbowroom_spatial::{Pose, Vec3};

use super::core::{Core, Gap, rounding};
use super::gjk;
use derivative::{Projection, newton_step};

/// Wanted difference of the bounds, as a fraction of the coordinates.
pub(super) const WANTED: f64 = 1e-13;

/// Rounds before the question goes to GJK.
const ROUNDS: usize = 12;

/// Bounds closer than this fraction of the distance are likely apart for a wrong direction only.
const NEARLY: f64 = 1e-6;

/// Witnesses closer than this fraction of the coordinates give a direction with too few digits for a proof.
pub(super) const CLOSE: f64 = 1e-6;

/// Rounds after it.
const ROUNDS_AFTER: usize = 40;

/// How much of the derivative is trusted: all but the last digits, and less after a step that led astray.
const TRUST: [f64; 4] = [1.0 - 1e-9, 1.0 - 1e-3, 0.9, 0.0];

/// What a search came to.
enum Outcome {
    /// Proven farther apart than the limit.
    Farther,
    /// The bounds have met.
    Closed(Gap),
    /// They have not; the best so far.
    Open(Gap),
}

/// Two cores, the second in its own frame, and the scale of their rounding.
pub(super) struct Cores<'a> {
    pub a: &'a Core<'a>,
    pub b: &'a Core<'a>,
    pub a_in_b: &'a Pose,
    /// What rounding may take from a bound, metres.
    pub slack: f64,
    /// Bounds this close have met, metres.
    pub wanted: f64,
    /// Witnesses this close give a rough direction, metres.
    pub close: f64,
}

impl<'a> Cores<'a> {
    #[inline]
    pub fn new(a: &'a Core<'a>, b: &'a Core<'a>, a_in_b: &'a Pose) -> Self {
        let t = a_in_b.translation.abs();
        let scale = t.x + t.y + t.z + a.size() + b.size();
        Self { a, b, a_in_b, slack: rounding(scale), wanted: WANTED * scale, close: CLOSE * scale }
    }

    /// The point of `a` farthest along `-direction`, in the frame of `b`.
    #[inline]
    pub fn low_of_a(&self, direction: Vec3) -> Vec3 {
        self.a_in_b.transform_point(self.a.support(-self.a_in_b.inverse_transform_vector(direction)))
    }

    /// Distance of the two support planes perpendicular to the unit vector: never above the exact distance.
    #[inline]
    pub fn plane_gap(&self, direction: Vec3) -> f64 {
        (self.low_of_a(direction) - self.b.support(direction)).dot(direction) - self.slack
    }

    /// The point of `a` nearest to `q`, in the frame of `b`, and the derivative in the frame of `a`.
    #[inline]
    fn onto_a(&self, q: Vec3) -> Projection {
        let local = self.a.project(self.a_in_b.inverse_transform_point(q));
        Projection { point: self.a_in_b.transform_point(local.point), ..local }
    }
}

/// Distance of two cores in the frame of the second; `None` where proven above `limit`.
pub(crate) fn distance(a: &Core, b: &Core, a_in_b: &Pose, limit: f64) -> Option<Gap> {
    let cores = Cores::new(a, b, a_in_b);
    let start = a_in_b.transform_point(a.middle());
    let mut before = None;
    if a.projects_fast() && b.projects_fast() {
        match search(&cores, start, limit, ROUNDS) {
            Outcome::Farther => return None,
            Outcome::Closed(gap) => return Some(gap),
            Outcome::Open(gap) => before = Some(gap),
        }
    }
    finish(&cores, before, start, limit)
}

/// GJK from where the projections have stopped, then projections from where GJK has stopped.
///
/// What is proven apart stays so: a limit ends the search earlier, and changes nothing else.
#[cold]
fn finish(cores: &Cores, before: Option<Gap>, start: Vec3, limit: f64) -> Option<Gap> {
    let mut best = before;
    if let Some(gap) = &mut best
        && (gap.distance - gap.lower <= NEARLY * gap.distance || gap.distance <= cores.close)
    {
        *gap = gap.at_least(features::lower_bound(cores, gap));
        if gap.distance - gap.lower <= cores.wanted {
            return (!(gap.lower > limit)).then_some(*gap);
        }
    }
    let direction = best.map_or(start - cores.b.middle(), |g| g.on_a - g.on_b);
    let found = gjk::distance(cores.a, cores.b, cores.a_in_b, direction, limit)?;
    let mut gap = best.map_or(found, |best| nearer(best, found));
    if decided(cores, &gap) {
        return (!(gap.lower > limit)).then_some(gap);
    }
    match search(cores, gap.on_a, limit, ROUNDS_AFTER) {
        Outcome::Farther => return None,
        Outcome::Closed(closed) | Outcome::Open(closed) => gap = nearer(gap, closed),
    }
    if !decided(cores, &gap) {
        gap = features::improve(cores, gap);
    }
    (!(gap.lower > limit)).then_some(gap)
}

/// In contact, or apart with bounds that have met.
fn decided(cores: &Cores, gap: &Gap) -> bool {
    !(gap.distance > 0.0) || (gap.lower > 0.0 && gap.distance - gap.lower <= cores.wanted)
}

/// The nearer witness points and the higher bound.
fn nearer(a: Gap, b: Gap) -> Gap {
    if b.distance < a.distance { b.at_least(a.lower) } else { a.at_least(b.lower) }
}

/// Projects to and fro, with Newton steps in between.
#[inline]
fn search(cores: &Cores, start: Vec3, limit: f64, rounds: usize) -> Outcome {
    let mut best = Gap { distance: f64::INFINITY, apart: f64::INFINITY, lower: 0.0, on_a: start, on_b: start };
    // The start is anywhere, so its step is not judged, and is a plain one.
    let (mut p, mut doubts, mut judged) = (start, TRUST.len() - 1, false);
    for _ in 0..rounds {
        let onto_b = cores.b.project(p);
        let q = onto_b.point;
        let onto_a = cores.onto_a(q);
        let v = onto_a.point - q;
        let length = v.length();
        if !(length > cores.slack) {
            let touching = Gap::touching(onto_a.point, q);
            return Outcome::Closed(touching.at_least(best.lower));
        }
        let lower = cores.plane_gap(v / length);
        best.lower = best.lower.max(lower);
        if best.lower > limit {
            return Outcome::Farther;
        }
        let better = length < best.distance;
        if better {
            best = Gap { distance: length, apart: length, on_a: onto_a.point, on_b: q, ..best };
        }
        if best.distance - best.lower <= cores.wanted {
            best.lower = best.lower.min(best.distance);
            return Outcome::Closed(best);
        }
        if better {
            doubts = if judged { 0 } else { doubts };
            let moved = onto_a.point - p;
            let step = newton_step(cores.a_in_b.rotation, &onto_a, &onto_b, moved, TRUST[doubts]);
            // Long steps along nearly parallel faces end at the rim.
            p = cores.onto_a(p + step).point;
            (doubts, judged) = (if doubts == TRUST.len() - 1 { 0 } else { doubts }, true);
        } else if judged && doubts + 1 < TRUST.len() {
            (p, doubts, judged) = (best.on_a, doubts + 1, false);
        } else {
            break;
        }
    }
    best.lower = best.lower.min(best.distance);
    Outcome::Open(best)
}
