//! Distance of two convex cores by Newton's method on alternating projections. README.md in this folder describes
//! the method.

mod core_pair;
pub(crate) mod derivative;
mod feature_search;
mod local_features;

use elbowroom_spatial::{Pose, Vec3};

use super::core::Core;
use super::gap::Gap;
use super::gjk;
use core_pair::CorePair;
use derivative::newton_step;

/// Largest number of iterations before GJK is used.
const ITERATIONS: usize = 12;

/// Difference of bounds, as a fraction of the distance, below which only an inaccurate direction prevents
/// convergence.
const NEARLY_CONVERGED: f64 = 1e-6;

/// Largest number of iterations after GJK.
const ITERATIONS_AFTER_GJK: usize = 40;

/// Factors for the derivative: nearly 1, and less after a step that increased the distance.
const DAMPING: [f64; 4] = [1.0 - 1e-9, 1.0 - 1e-3, 0.9, 0.0];

/// The result of a search.
enum Outcome {
    /// The cores are proven to be farther apart than the limit.
    Farther,
    /// The bounds have converged.
    Converged(Gap),
    /// The bounds have not converged; the best gap so far.
    Open(Gap),
}

/// Distance of two cores in the frame of the second; `None` if it is proven to be above `limit`.
pub(crate) fn distance(a: &Core, b: &Core, a_in_b: &Pose, limit: f64) -> Option<Gap> {
    distance_from(a, b, a_in_b, a_in_b.transform_point(a.middle()), limit)
}

/// Like [`distance`]; the search begins at `start`, a point of the first core.
pub(crate) fn distance_from(a: &Core, b: &Core, a_in_b: &Pose, start: Vec3, limit: f64) -> Option<Gap> {
    let cores = CorePair::new(a, b, a_in_b);
    let mut before = None;
    if a.has_closed_projection() && b.has_closed_projection() {
        match search(&cores, start, limit, ITERATIONS) {
            Outcome::Farther => return None,
            Outcome::Converged(gap) => return Some(gap),
            Outcome::Open(gap) => before = Some(gap),
        }
    }
    finish(&cores, before, start, limit)
}

/// Runs GJK from the best points of the projections, then projections from the points of GJK.
///
/// Cores that are proven to be apart stay apart: a limit may end the search earlier, and never changes anything
/// else.
#[cold]
fn finish(cores: &CorePair, before: Option<Gap>, start: Vec3, limit: f64) -> Option<Gap> {
    let mut best = before;
    if let Some(gap) = &mut best
        && (gap.distance - gap.lower <= NEARLY_CONVERGED * gap.distance || gap.distance <= cores.close)
    {
        *gap = gap.at_least(feature_search::lower_bound(cores, gap));
        if gap.distance - gap.lower <= cores.converged {
            return (!(gap.lower > limit)).then_some(*gap);
        }
    }
    let direction = best.map_or(start - cores.b.middle(), |g| g.on_a - g.on_b);
    let found = gjk::distance(cores.a, cores.b, cores.a_in_b, direction, limit)?;
    let mut gap = best.map_or(found, |best| nearer(best, found));
    if is_decided(cores, &gap) {
        return (!(gap.lower > limit)).then_some(gap);
    }
    match search(cores, gap.on_a, limit, ITERATIONS_AFTER_GJK) {
        Outcome::Farther => return None,
        Outcome::Converged(found) | Outcome::Open(found) => gap = nearer(gap, found),
    }
    if !is_decided(cores, &gap) {
        gap = feature_search::improve(cores, gap);
    }
    (!(gap.lower > limit)).then_some(gap)
}

/// True if the cores are in contact, or apart with bounds that have converged.
fn is_decided(cores: &CorePair, gap: &Gap) -> bool {
    !(gap.distance > 0.0) || (gap.lower > 0.0 && gap.distance - gap.lower <= cores.converged)
}

/// The nearer witness points and the higher bound.
fn nearer(a: Gap, b: Gap) -> Gap {
    if b.distance < a.distance { b.at_least(a.lower) } else { a.at_least(b.lower) }
}

/// Alternates projections with Newton steps.
#[inline]
fn search(cores: &CorePair, start: Vec3, limit: f64, iterations: usize) -> Outcome {
    let mut best = Gap { distance: f64::INFINITY, apart: f64::INFINITY, lower: 0.0, on_a: start, on_b: start };
    // The start is arbitrary, so its step is a plain projection and is not compared with the one before.
    let (mut p, mut damping, mut compared) = (start, DAMPING.len() - 1, false);
    for _ in 0..iterations {
        let onto_b = cores.b.project(p);
        let q = onto_b.point;
        let onto_a = cores.onto_a(q);
        let v = onto_a.point - q;
        let length = v.length();
        if !(length > cores.rounding) {
            let touching = Gap::touching(onto_a.point, q);
            return Outcome::Converged(touching.at_least(best.lower));
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
        if best.distance - best.lower <= cores.converged {
            best.lower = best.lower.min(best.distance);
            return Outcome::Converged(best);
        }
        if better {
            damping = if compared { 0 } else { damping };
            let moved = onto_a.point - p;
            let step = newton_step(cores.a_in_b.rotation, &onto_a, &onto_b, moved, DAMPING[damping]);
            // Long steps along nearly parallel faces end at the border of the face.
            p = cores.onto_a(p + step).point;
            (damping, compared) = (if damping == DAMPING.len() - 1 { 0 } else { damping }, true);
        } else if compared && damping + 1 < DAMPING.len() {
            (p, damping, compared) = (best.on_a, damping + 1, false);
        } else {
            break;
        }
    }
    best.lower = best.lower.min(best.distance);
    Outcome::Open(best)
}
