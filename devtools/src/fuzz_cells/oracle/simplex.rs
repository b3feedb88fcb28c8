//! Point of a simplex nearest to the origin, by trying every face of it: slow, but short and easy to verify.

use elbowroom_spatial::Vec3;

/// Returns the nearest point, and the corners of the face that it lies in.
pub fn nearest(corners: &[Vec3]) -> (Vec3, Vec<Vec3>) {
    let mut best: Option<(Vec3, Vec<Vec3>)> = None;
    for mask in 1_u32..1 << corners.len() {
        let face: Vec<Vec3> = (0..corners.len()).filter(|i| mask & (1 << i) != 0).map(|i| corners[i]).collect();
        let Some(point) = nearest_of_face(&face) else { continue };
        if best.as_ref().is_none_or(|(b, _)| point.length_squared() < b.length_squared()) {
            best = Some((point, face));
        }
    }
    best.unwrap_or((corners[0], vec![corners[0]]))
}

/// Projects the origin onto the plane of a face; `None` if the projection is not in the face.
fn nearest_of_face(face: &[Vec3]) -> Option<Vec3> {
    let first = face[0];
    let edges: Vec<Vec3> = face[1..].iter().map(|p| *p - first).collect();
    let weights = match edges.as_slice() {
        [] => return Some(first),
        [a] => vec![-first.dot(*a) / a.dot(*a)],
        [a, b] => {
            let (aa, ab, bb) = (a.dot(*a), a.dot(*b), b.dot(*b));
            let (pa, pb) = (-first.dot(*a), -first.dot(*b));
            let det = aa * bb - ab * ab;
            vec![(pa * bb - pb * ab) / det, (pb * aa - pa * ab) / det]
        }
        [a, b, c] => {
            let det = a.dot(b.cross(*c));
            let p = -first;
            vec![p.dot(b.cross(*c)) / det, a.dot(p.cross(*c)) / det, a.dot(b.cross(p)) / det]
        }
        _ => return None,
    };
    let inside = weights.iter().all(|w| w.is_finite() && *w >= 0.0) && weights.iter().sum::<f64>() <= 1.0;
    inside.then(|| edges.iter().zip(&weights).fold(first, |p, (e, w)| p + *e * *w))
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
