//! Point of a simplex nearest to the origin, by trying every face of it: slow, but short and easy to verify.

use elbowroom_spatial::Vec3;

/// Returns the nearest point, and the corners of the face that it lies in, of up to four corners.
pub fn nearest(corners: &[Vec3]) -> (Vec3, Vec<Vec3>) {
    // Without lists and iterators: this is the innermost loop of the oracle, which is compiled without optimization.
    let (mut best, mut least) = ((corners[0], 1), f64::INFINITY);
    for mask in 1_u32..1 << corners.len() {
        let (face, count) = face(corners, mask);
        let Some(point) = nearest_of_face(&face[..count]) else { continue };
        let length = point.length_squared();
        if mask == 1 || length < least {
            (best, least) = ((point, mask), length);
        }
    }
    let (face, count) = face(corners, best.1);
    (best.0, face[..count].to_vec())
}

/// The corners whose bits are set, and their number.
fn face(corners: &[Vec3], mask: u32) -> ([Vec3; 4], usize) {
    let (mut face, mut count, mut i) = ([Vec3::ZERO; 4], 0, 0);
    while i < corners.len() {
        if mask & (1 << i) != 0 {
            face[count] = corners[i];
            count += 1;
        }
        i += 1;
    }
    (face, count)
}

/// Projects the origin onto the plane of a face; `None` if the projection is not in the face.
fn nearest_of_face(face: &[Vec3]) -> Option<Vec3> {
    let first = face[0];
    let edge = |i: usize| face[i] - first;
    let inside = |w: &f64| w.is_finite() && *w >= 0.0;
    match face.len() {
        1 => Some(first),
        2 => {
            let a = edge(1);
            let w = -first.dot(a) / a.dot(a);
            (inside(&w) && w <= 1.0).then(|| first + a * w)
        }
        3 => {
            let (a, b) = (edge(1), edge(2));
            let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
            let (pa, pb) = (-first.dot(a), -first.dot(b));
            let det = aa * bb - ab * ab;
            let [v, w] = [(pa * bb - pb * ab) / det, (pb * aa - pa * ab) / det];
            (inside(&v) && inside(&w) && v + w <= 1.0).then(|| first + a * v + b * w)
        }
        _ => {
            let (a, b, c, p) = (edge(1), edge(2), edge(3), -first);
            let det = a.dot(b.cross(c));
            let [u, v, w] = [p.dot(b.cross(c)) / det, a.dot(p.cross(c)) / det, a.dot(b.cross(p)) / det];
            ([u, v, w].iter().all(inside) && u + v + w <= 1.0).then(|| first + a * u + b * v + c * w)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_origin_in_a_tetrahedron_is_its_own_nearest_point() {
        let corners = [Vec3::new(-1.0, -1.0, -1.0), Vec3::X * 3.0, Vec3::Y * 3.0, Vec3::Z * 3.0];
        assert!(nearest(&corners).0.length() < 1e-12);
        let shifted = corners.map(|c| c + Vec3::Z * 5.0);
        let (point, face) = nearest(&shifted);
        assert!((point - Vec3::new(0.0, 0.0, 4.0)).length() < 2.0 && face.len() <= 3 && point.length() > 3.0);
    }
}
