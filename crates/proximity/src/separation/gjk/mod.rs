//! Distance between any two convex cores. The method and its error: `README.md` beside this file.

mod simplex;

use elbowroom_spatial::{Pose, Vec3};

use super::core::{Core, Gap, rounding};
use simplex::{Simplex, Vertex};

/// More than any pair needs; reaching it ends with the bounds found so far.
const MAX_ITERATIONS: usize = 100;

/// Wanted difference of the bounds, as a fraction of the coordinates.
const WANTED: f64 = 1e-13;

/// Distance of `a` and `b` in the frame of `b`, starting along `start`, a direction from `b` to `a`.
/// `None` as soon as the distance is proven to be above `limit`.
pub(crate) fn distance(a: &Core, b: &Core, a_in_b: &Pose, start: Vec3, limit: f64) -> Option<Gap> {
    let t = a_in_b.translation.abs();
    let scale = t.x + t.y + t.z + a.size() + b.size();
    let slack = rounding(scale);
    let support = |d: Vec3| {
        let on_a = a_in_b.transform_point(a.support(-a_in_b.inverse_transform_vector(d)));
        let on_b = b.support(d);
        Vertex { w: on_a - on_b, on_a, on_b }
    };
    let first = start.try_normalize().unwrap_or(Vec3::X);
    let mut simplex = Simplex::new(support(first));
    let mut lower = simplex.vertices[0].w.dot(first) - slack;
    if lower > limit {
        return None;
    }
    let mut v = simplex.vertices[0].w;
    let mut upper = v.length();
    for _ in 0..MAX_ITERATIONS {
        if upper <= slack {
            return Some(overlap(&simplex));
        }
        let direction = v / upper;
        let next = support(direction);
        lower = lower.max(next.w.dot(direction) - slack);
        if lower > limit {
            return None;
        }
        if upper - lower <= WANTED * scale || simplex.holds(next.w) {
            break;
        }
        let mut grown = simplex;
        grown.push(next);
        if !grown.reduce() {
            if lower > 0.0 {
                break; // proven apart: rounding made the tetrahedron swallow the origin
            }
            return Some(overlap(&simplex));
        }
        let nearer = grown.blend(|x| x.w);
        let length = nearer.length();
        if !(length < upper) {
            break;
        }
        (simplex, v, upper) = (grown, nearer, length);
    }
    if !(lower > 0.0) {
        return Some(overlap(&simplex)); // not proven apart
    }
    Some(Gap {
        distance: upper,
        lower: lower.min(upper),
        on_a: simplex.blend(|x| x.on_a),
        on_b: simplex.blend(|x| x.on_b),
    })
}

fn overlap(simplex: &Simplex) -> Gap {
    Gap::touching(simplex.blend(|x| x.on_a), simplex.blend(|x| x.on_b))
}
