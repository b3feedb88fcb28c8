//! Closest points and intersection of triangles and segments in a common frame.
//!
//! The normal of a slender triangle (height at most 1/100 of the longest edge) has too few digits after rounding to
//! decide on which side of it a point is. For such triangles the signs are computed by exact predicates (Shewchuk,
//! *Adaptive precision floating-point arithmetic and fast robust geometric predicates*, 1997). For all others the
//! error of f64 is far below the distance at which meshes count as in contact.

use elbowroom_spatial::Vec3;
use robust::{Coord3D, orient3d};

/// The closest points of two shapes and their squared distance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ClosestPoints {
    pub squared: f64,
    pub on_a: Vec3,
    pub on_b: Vec3,
}

impl ClosestPoints {
    pub const FAR: Self = Self { squared: f64::INFINITY, on_a: Vec3::ZERO, on_b: Vec3::ZERO };

    #[inline]
    fn new(on_a: Vec3, on_b: Vec3) -> Self {
        Self { squared: (on_a - on_b).length_squared(), on_a, on_b }
    }

    #[inline]
    fn or_nearer(self, o: Self) -> Self {
        if o.squared < self.squared { o } else { self }
    }

    #[inline]
    fn swapped(self) -> Self {
        Self { squared: self.squared, on_a: self.on_b, on_b: self.on_a }
    }
}

/// The point of the segment nearest to `p`.
#[inline]
pub(crate) fn nearest_on_segment(p: Vec3, a: Vec3, b: Vec3) -> Vec3 {
    let ab = b - a;
    let along = (p - a).dot(ab);
    let squared = ab.length_squared();
    if !(along > 0.0) {
        return a;
    }
    if along >= squared { b } else { a + ab * (along / squared) }
}

/// The point of the triangle nearest to `p`.
///
/// The signs of sub-areas decide whether the projection is inside. They are computed from differences of nearby
/// points, so that slivers and far points keep their digits. Outside, the nearest edge is exact.
#[inline]
pub(crate) fn nearest_on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let n = (b - a).cross(c - a);
    let wa = n.dot((b - p).cross(c - b));
    let wb = n.dot((c - p).cross(a - c));
    let wc = n.dot((a - p).cross(b - a));
    if wa > 0.0 && wb > 0.0 && wc > 0.0 {
        let sum = wa + wb + wc;
        let projected = a + (b - a) * (wb / sum) + (c - a) * (wc / sum);
        if !is_slender(&[a, b, c], n) {
            return projected;
        }
        // The normal may be so inaccurate that an edge is nearer.
        let edge = nearest_on_edges(p, [a, b, c]);
        return if (edge - p).length_squared() < (projected - p).length_squared() { edge } else { projected };
    }
    nearest_on_edges(p, [a, b, c])
}

#[inline]
fn nearest_on_edges(p: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let candidates = [nearest_on_segment(p, a, b), nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)];
    let squared = candidates.map(|q| (q - p).length_squared());
    let first = usize::from(squared[1] < squared[0]);
    candidates[if squared[2] < squared[first] { 2 } else { first }]
}

/// Closest points of two segments.
///
/// The derivative of the squared distance along the first segment is monotone and piecewise linear. Its root is
/// interpolated in the piece that contains it, which avoids cancellation for parallel segments.
pub(crate) fn segment_segment(a0: Vec3, a1: Vec3, b0: Vec3, b1: Vec3) -> ClosestPoints {
    let (u, v) = (a1 - a0, b1 - b0);
    let vv = v.length_squared();
    let slope_at = |s: f64| {
        let p = a0 + u * s;
        (p - nearest_on_segment(p, b0, b1)).dot(u)
    };
    let finish = |s: f64| {
        let p = a0 + u * s;
        ClosestPoints::new(p, nearest_on_segment(p, b0, b1))
    };
    let (mut lo, mut hi) = (0.0, 1.0);
    let (mut g_lo, mut g_hi) = (slope_at(0.0), slope_at(1.0));
    if !(g_lo < 0.0) {
        return finish(0.0);
    }
    if !(g_hi > 0.0) {
        return finish(1.0);
    }
    let uv = u.dot(v);
    if uv != 0.0 {
        for s in [(b0 - a0).dot(v) / uv, ((b0 - a0).dot(v) + vv) / uv] {
            if s > lo && s < hi {
                let g = slope_at(s);
                if g > 0.0 {
                    (hi, g_hi) = (s, g);
                } else {
                    (lo, g_lo) = (s, g);
                }
            }
        }
    }
    finish(lo + (hi - lo) * (g_lo / (g_lo - g_hi)))
}

/// Squared ratio of height to longest edge up to which a triangle is slender.
const SLENDER: f64 = 1e-4;

/// True if the plane of the triangle is too inaccurate in f64. `normal` is the cross product of two edges.
#[inline]
fn is_slender([a, b, c]: &[Vec3; 3], normal: Vec3) -> bool {
    let longest = (*b - *a).length_squared().max((*c - *b).length_squared()).max((*a - *c).length_squared());
    !(normal.length_squared() > longest * longest * SLENDER)
}

fn normal([a, b, c]: &[Vec3; 3]) -> Vec3 {
    (*b - *a).cross(*c - *a)
}

/// The point in which the segment intersects the triangle (including its border), if it does: up to rounding for
/// most triangles, exactly for slender ones.
pub(crate) fn segment_crosses(p: Vec3, q: Vec3, t: [Vec3; 3]) -> Option<Vec3> {
    let n = normal(&t);
    if is_slender(&t, n) { crosses_exactly(p, q, &t) } else { crosses_by_signs(p, q, &t, n) }
}

/// Like [`segment_crosses`], by f64 signs alone; `n` is the triangle's normal, of any length.
#[inline]
fn crosses_by_signs(p: Vec3, q: Vec3, t: &[Vec3; 3], n: Vec3) -> Option<Vec3> {
    let [a, b, c] = *t;
    let (hp, hq) = (n.dot(p - a), n.dot(q - a));
    if (hp > 0.0) == (hq > 0.0) || hp == hq {
        return None;
    }
    let x = p + (q - p) * (hp / (hp - hq));
    let inside =
        n.dot((b - a).cross(x - a)) >= 0.0 && n.dot((c - b).cross(x - b)) >= 0.0 && n.dot((a - c).cross(x - c)) >= 0.0;
    inside.then_some(x)
}

/// Like [`segment_crosses`], by exact signs: the ends are on different sides of the plane, and the segment's line
/// passes all edges on the same side. A segment in the triangle's plane, or a triangle that is exactly a line, does
/// not count: then edges and corners give the distance.
#[cold]
fn crosses_exactly(p: Vec3, q: Vec3, t: &[Vec3; 3]) -> Option<Vec3> {
    let at = |v: Vec3| Coord3D { x: v.x, y: v.y, z: v.z };
    let turn = |a: Vec3, b: Vec3, c: Vec3, d: Vec3| orient3d(at(a), at(b), at(c), at(d));
    let [a, b, c] = *t;
    let (hp, hq) = (turn(a, b, c, p), turn(a, b, c, q));
    if !((hp <= 0.0 && hq > 0.0) || (hq <= 0.0 && hp > 0.0)) {
        return None;
    }
    let turns = [turn(p, q, a, b), turn(p, q, b, c), turn(p, q, c, a)];
    let passes = turns.iter().all(|x| *x >= 0.0) || turns.iter().all(|x| *x <= 0.0);
    passes.then(|| intersection_point(p, q, t))
}

/// The point of the segment nearest to a slender triangle that it intersects. The point from heights over the plane
/// loses its digits as the triangle gets thinner, while the closest points of the edges become more accurate; the
/// best of them is returned.
fn intersection_point(p: Vec3, q: Vec3, t: &[Vec3; 3]) -> Vec3 {
    let n = normal(t);
    let (hp, hq) = (n.dot(p - t[0]), n.dot(q - t[0]));
    let share = hp / (hp - hq);
    let by_heights = if (0.0..=1.0).contains(&share) { p + (q - p) * share } else { p };
    let error = |x: &Vec3| (nearest_on_triangle(*x, *t) - *x).length_squared();
    let by_edge = |k: usize| segment_segment(p, q, t[k], t[(k + 1) % 3]).on_a;
    let candidates = [by_heights, by_edge(0), by_edge(1), by_edge(2)];
    candidates.into_iter().min_by(|x, y| error(x).total_cmp(&error(y))).unwrap_or(p)
}

/// True if an edge of one triangle intersects the other, up to rounding. If one is slender, true is exact and false
/// may be wrong.
pub(crate) fn triangles_cross(s: [Vec3; 3], t: [Vec3; 3]) -> bool {
    // Each triangle must have corners on both sides of the other's plane.
    let (Some(of_s), Some(of_t)) = (sides(&s, &t), sides(&t, &s)) else { return false };
    (edges_cross(&s, of_s, &t) || edges_cross(&t, of_t, &s)) && confirmed(&s, &t)
}

/// False if inaccurate signs made slender triangles cross that do not.
fn confirmed(s: &[Vec3; 3], t: &[Vec3; 3]) -> bool {
    let slender = is_slender(s, normal(s)) || is_slender(t, normal(t));
    let passes = |s: &[Vec3; 3], t: &[Vec3; 3]| (0..3).any(|k| crosses_exactly(s[k], s[(k + 1) % 3], t).is_some());
    !slender || passes(s, t) || passes(t, s)
}

/// Which corners of `s` are above `t`'s plane; `None` if all are on one side.
#[inline]
fn sides(s: &[Vec3; 3], t: &[Vec3; 3]) -> Option<[bool; 3]> {
    let n = (t[1] - t[0]).cross(t[2] - t[0]);
    let above = [n.dot(s[0] - t[0]) > 0.0, n.dot(s[1] - t[0]) > 0.0, n.dot(s[2] - t[0]) > 0.0];
    (above[0] != above[1] || above[1] != above[2]).then_some(above)
}

#[inline]
fn edges_cross(s: &[Vec3; 3], above: [bool; 3], t: &[Vec3; 3]) -> bool {
    let n = normal(t);
    (0..3).any(|k| above[k] != above[(k + 1) % 3] && crosses_by_signs(s[k], s[(k + 1) % 3], t, n).is_some())
}

/// Closest points of a segment (first) and a triangle.
pub(crate) fn segment_triangle(p: Vec3, q: Vec3, t: [Vec3; 3]) -> ClosestPoints {
    if let Some(x) = segment_crosses(p, q, t) {
        return ClosestPoints { squared: 0.0, on_a: x, on_b: x };
    }
    let mut best =
        ClosestPoints::new(p, nearest_on_triangle(p, t)).or_nearer(ClosestPoints::new(q, nearest_on_triangle(q, t)));
    for k in 0..3 {
        best = best.or_nearer(segment_segment(p, q, t[k], t[(k + 1) % 3]));
    }
    best
}

/// Closest points of two triangles.
pub(crate) fn triangle_triangle(s: [Vec3; 3], t: [Vec3; 3]) -> ClosestPoints {
    let mut best = ClosestPoints::FAR;
    for k in 0..3 {
        let crossing = segment_crosses(s[k], s[(k + 1) % 3], t).or_else(|| segment_crosses(t[k], t[(k + 1) % 3], s));
        if let Some(x) = crossing {
            return ClosestPoints { squared: 0.0, on_a: x, on_b: x };
        }
    }
    for k in 0..3 {
        best = best.or_nearer(ClosestPoints::new(s[k], nearest_on_triangle(s[k], t)));
        best = best.or_nearer(ClosestPoints::new(t[k], nearest_on_triangle(t[k], s)).swapped());
        for l in 0..3 {
            best = best.or_nearer(segment_segment(s[k], s[(k + 1) % 3], t[l], t[(l + 1) % 3]));
        }
    }
    best
}
