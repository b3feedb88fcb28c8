//! The smallest enclosing sphere, by exchange of support points until all points are inside.
//!
//! This is a simplex method for this problem of linear-programming type (Sharir and Welzl, 1992). Coplanar points
//! give the smallest enclosing circle.

use elbowroom_spatial::Vec3;

/// Centre and radius of the smallest enclosing sphere, up to rounding.
pub(super) fn smallest(points: &[Vec3]) -> (Vec3, f64) {
    let Some(&first) = points.first() else { return (Vec3::ZERO, 0.0) };
    let mut basis = vec![first];
    let mut sphere = (first, 0.0);
    for _ in 0..1000 {
        let (reach, p) = farthest(points, sphere.0);
        if reach <= sphere.1 * (1.0 + 1e-13) {
            break;
        }
        basis.push(p);
        let Some((next, support)) = of_few(&basis) else { break };
        if next.1 <= sphere.1 {
            break; // no progress beyond rounding
        }
        (sphere, basis) = (next, support);
    }
    (sphere.0, farthest(points, sphere.0).0)
}

/// The largest distance from a centre, and the last point that has it.
///
/// Squares are compared first: roots are computed only for points that can share the largest distance after rounding.
fn farthest(points: &[Vec3], center: Vec3) -> (f64, Vec3) {
    let squared = |p: &Vec3| (*p - center).length_squared();
    let largest = largest(points, squared);
    let (reach, least) = (largest.sqrt(), largest * (1.0 - 4.0 * f64::EPSILON));
    let has_reach = |p: &&Vec3| squared(p) >= least && p.distance(center) >= reach;
    (reach, points.iter().rev().find(has_reach).copied().unwrap_or(center))
}

/// The largest value that is not negative; 0 if there is none. Four independent maxima, which processors compute at the
/// same time.
fn largest(points: &[Vec3], value: impl Fn(&Vec3) -> f64) -> f64 {
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let (quarters, rest) = points.as_chunks::<4>();
    let lanes = quarters.iter().fold([0.0; 4], |m, p| std::array::from_fn(|i| larger(m[i], value(&p[i]))));
    rest.iter().map(&value).chain(lanes).fold(0.0, larger)
}

/// The smallest sphere around at most five points, found by testing all subsets of at most four, and that subset.
fn of_few(points: &[Vec3]) -> Option<((Vec3, f64), Vec<Vec3>)> {
    let mut best: Option<((Vec3, f64), usize)> = None;
    for mask in 1_usize..1 << points.len() {
        if mask.count_ones() > 4 {
            continue;
        }
        let (mut subset, mut count) = ([Vec3::ZERO; 4], 0);
        for p in chosen(points, mask) {
            subset[count] = p;
            count += 1;
        }
        let Some(sphere) = circumscribed(&subset[..count]) else { continue };
        let is_smaller = best.as_ref().is_none_or(|(b, _)| sphere.1 < b.1);
        if is_smaller && points.iter().all(|p| p.distance(sphere.0) <= sphere.1 * (1.0 + 1e-12)) {
            best = Some((sphere, mask));
        }
    }
    best.map(|(sphere, mask)| (sphere, chosen(points, mask).collect()))
}

/// The points whose bits are set.
fn chosen(points: &[Vec3], mask: usize) -> impl Iterator<Item = Vec3> {
    points.iter().enumerate().filter(move |(i, _)| mask >> i & 1 == 1).map(|(_, &p)| p)
}

/// Sphere through one to four points with its centre in their affine hull; `None` if they are dependent.
fn circumscribed(points: &[Vec3]) -> Option<(Vec3, f64)> {
    let (o, offset) = match *points {
        [o] => (o, Vec3::ZERO),
        [o, p] => (o, (p - o) * 0.5),
        [o, p, q] => {
            let (u, v) = (p - o, q - o);
            let n = u.cross(v);
            let nn = n.length_squared();
            if !(nn > 1e-24 * u.length_squared() * v.length_squared()) {
                return None;
            }
            (o, (n.cross(u) * v.length_squared() + v.cross(n) * u.length_squared()) / (2.0 * nn))
        }
        [o, p, q, r] => {
            let (u, v, w) = (p - o, q - o, r - o);
            let det = u.dot(v.cross(w));
            if !(det.abs() > 1e-12 * u.length() * v.length() * w.length()) {
                return None;
            }
            let (uu, vv, ww) = (u.length_squared(), v.length_squared(), w.length_squared());
            (o, (v.cross(w) * uu + w.cross(u) * vv + u.cross(v) * ww) / (2.0 * det))
        }
        _ => return None,
    };
    Some((o + offset, offset.length()))
}
