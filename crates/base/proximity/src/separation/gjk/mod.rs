//! The GJK algorithm: distance of any two convex cores. README.md in this folder describes the method and its error.

mod simplex;

use elbowroom_spatial::{Pose, Vec3};

use super::core::Core;
use super::gap::{CONVERGED, Gap, rounding};
use simplex::{Simplex, Vertex};

/// Largest number of iterations, more than any pair needs. If it is reached, the bounds found so far are returned.
const MAX_ITERATIONS: usize = 100;

/// Distance of `a` and `b` in the frame of `b`; `None` as soon as the distance is proven to be above `limit`. The
/// search starts along `start`, a direction from `b` to `a`.
pub(crate) fn distance(a: &Core, b: &Core, a_in_b: &Pose, start: Vec3, limit: f64) -> Option<Gap> {
    let t = a_in_b.translation.abs();
    let scale = t.x + t.y + t.z + a.size() + b.size();
    let rounding = rounding(scale);
    let support = |d: Vec3| {
        let on_a = a_in_b.transform_point(a.support(-a_in_b.inverse_transform_vector(d)));
        let on_b = b.support(d);
        Vertex { w: on_a - on_b, on_a, on_b }
    };
    let first = start.try_normalize().unwrap_or(Vec3::X);
    let mut simplex = Simplex::new(support(first));
    let mut lower = simplex.vertices[0].w.dot(first) - rounding;
    if lower > limit {
        return None;
    }
    let mut v = simplex.vertices[0].w;
    let mut upper = v.length();
    for _ in 0..MAX_ITERATIONS {
        if upper <= rounding {
            if lower > 0.0 {
                break;
            }
            return Some(overlap(&simplex));
        }
        let direction = v / upper;
        let next = support(direction);
        lower = lower.max(next.w.dot(direction) - rounding);
        if lower > limit {
            return None;
        }
        if upper - lower <= CONVERGED * scale || simplex.contains(next.w) {
            break;
        }
        let Some((grown, nearer, length)) = add_vertex(&simplex, next, upper, lower > 0.0, CONVERGED * scale) else {
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

/// The simplex with one more vertex, reduced to the face that contains its nearest point; `None` without progress.
///
/// If the vertices are so close together that rounding decides, the simplex is replaced by its nearest point, which
/// is a point of `A - B` like any other, and the search continues from there.
fn add_vertex(
    simplex: &Simplex,
    next: Vertex,
    upper: f64,
    apart: bool,
    tolerance: f64,
) -> Option<(Simplex, Vec3, f64)> {
    let mut grown = *simplex;
    grown.push(next);
    if !grown.reduce(apart) && shares_a_point(&mut grown, tolerance) {
        return Some((grown, Vec3::ZERO, 0.0));
    }
    let folded = Vertex { w: simplex.blend(|x| x.w), on_a: simplex.blend(|x| x.on_a), on_b: simplex.blend(|x| x.on_b) };
    let mut segment = Simplex::new(folded);
    segment.push(next);
    segment.reduce(true);
    [grown, segment].into_iter().filter(|s| s.len < 4).find_map(|s| {
        let nearer = s.blend(|x| x.w);
        let length = nearer.length();
        // Equality to the last place counts as progress: a gap of g over an edge of length 1 shortens only by g².
        (length <= upper * (1.0 + 2.0 * f64::EPSILON)).then_some((s, nearer, length))
    })
}

/// Whether the tetrahedron contains the origin. If the tetrahedron is flat, signs may be wrong, but a common point
/// is proof. If it does not contain the origin, it is reduced to its nearest face.
#[cold]
#[inline(never)]
fn shares_a_point(tetrahedron: &mut Simplex, tolerance: f64) -> bool {
    let shared = tetrahedron.set_weights_of_origin() && tetrahedron.blend(|x| x.w).length() <= tolerance;
    if !shared {
        tetrahedron.reduce(true);
    }
    shared
}

fn overlap(simplex: &Simplex) -> Gap {
    Gap::touching(simplex.blend(|x| x.on_a), simplex.blend(|x| x.on_b))
}
