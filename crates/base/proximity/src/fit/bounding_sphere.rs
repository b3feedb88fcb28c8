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
        let outermost = points.iter().map(|&p| (p.distance(sphere.0), p)).max_by(|x, y| x.0.total_cmp(&y.0));
        let Some((reach, p)) = outermost else { break };
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
    let reach = points.iter().fold(0.0, |r: f64, p| r.max(p.distance(sphere.0)));
    (sphere.0, reach)
}

/// The smallest sphere around at most five points, found by testing all subsets of at most four, and that subset.
fn of_few(points: &[Vec3]) -> Option<((Vec3, f64), Vec<Vec3>)> {
    let mut best: Option<((Vec3, f64), Vec<Vec3>)> = None;
    for mask in 1_usize..1 << points.len() {
        if mask.count_ones() > 4 {
            continue;
        }
        let subset: Vec<Vec3> = (0..points.len()).filter(|i| mask >> i & 1 == 1).map(|i| points[i]).collect();
        let Some(sphere) = circumscribed(&subset) else { continue };
        let holds = points.iter().all(|p| p.distance(sphere.0) <= sphere.1 * (1.0 + 1e-12));
        if holds && best.as_ref().is_none_or(|(b, _)| sphere.1 < b.1) {
            best = Some((sphere, subset));
        }
    }
    best
}

/// Sphere through one to four points with its centre in their affine hull; `None` if they are dependent.
fn circumscribed(points: &[Vec3]) -> Option<(Vec3, f64)> {
    let o = points[0];
    let e: Vec<Vec3> = points[1..].iter().map(|&p| p - o).collect();
    let offset = match e[..] {
        [] => Vec3::ZERO,
        [u] => u * 0.5,
        [u, v] => {
            let n = u.cross(v);
            let nn = n.length_squared();
            if !(nn > 1e-24 * u.length_squared() * v.length_squared()) {
                return None;
            }
            (n.cross(u) * v.length_squared() + v.cross(n) * u.length_squared()) / (2.0 * nn)
        }
        [u, v, w] => {
            let det = u.dot(v.cross(w));
            if !(det.abs() > 1e-12 * u.length() * v.length() * w.length()) {
                return None;
            }
            let (uu, vv, ww) = (u.length_squared(), v.length_squared(), w.length_squared());
            (v.cross(w) * uu + w.cross(u) * vv + u.cross(v) * ww) / (2.0 * det)
        }
        _ => return None,
    };
    Some((o + offset, offset.length()))
}
