//! Distance between any two convex cores. The method and its error: `README.md` beside this file.

mod simplex;

use elbowroom_spatial::{Pose, Vec3};

use super::core::{Core, Gap, rounding};
use super::projections::WANTED;
use simplex::{Simplex, Vertex};

/// More than any pair needs; reaching it ends with the bounds found so far.
const MAX_ITERATIONS: usize = 100;

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
            if lower > 0.0 {
                break;
            }
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
        let Some((grown, nearer, length)) = grow(&simplex, next, upper, lower > 0.0, WANTED * scale) else {
            break;
        };
        if grown.len == 4 {
            return Some(overlap(&grown));
        }
        (simplex, v, upper) = (grown, nearer, length);
    }
    let (on_a, on_b) = (simplex.blend(|x| x.on_a), simplex.blend(|x| x.on_b));
    Some(Gap { distance: upper, apart: upper, lower: 0.0, on_a, on_b }.at_least(lower))
}

/// The simplex with one vertex more, reduced to what holds its nearest point; `None` where that brings nothing nearer.
///
/// Where the vertices have come so close together that rounding decides, the simplex is folded into its nearest point,
/// which is a point of `A - B` like any other, and the search goes on from there.
fn grow(simplex: &Simplex, next: Vertex, upper: f64, apart: bool, wanted: f64) -> Option<(Simplex, Vec3, f64)> {
    let mut grown = *simplex;
    grown.push(next);
    if !grown.reduce(apart) && shares_a_point(&mut grown, wanted) {
        return Some((grown, Vec3::ZERO, 0.0));
    }
    let folded = Vertex { w: simplex.blend(|x| x.w), on_a: simplex.blend(|x| x.on_a), on_b: simplex.blend(|x| x.on_b) };
    let mut segment = Simplex::new(folded);
    segment.push(next);
    segment.reduce(true);
    [grown, segment].into_iter().filter(|s| s.len < 4).find_map(|s| {
        let nearer = s.blend(|x| x.w);
        let length = nearer.length();
        // Equal to the last place is progress too: a gap of g over an edge of length 1 shortens by g² only.
        (length <= upper * (1.0 + 2.0 * f64::EPSILON)).then_some((s, nearer, length))
    })
}

/// Whether the tetrahedron really holds the origin: signs alone may be wrong where it is flat, a point in common is proof.
/// Otherwise it is reduced to its nearest face.
#[cold]
#[inline(never)]
fn shares_a_point(tetrahedron: &mut Simplex, wanted: f64) -> bool {
    let shared = tetrahedron.enclose() && tetrahedron.blend(|x| x.w).length() <= wanted;
    if !shared {
        tetrahedron.reduce(true);
    }
    shared
}

fn overlap(simplex: &Simplex) -> Gap {
    Gap::touching(simplex.blend(|x| x.on_a), simplex.blend(|x| x.on_b))
}
