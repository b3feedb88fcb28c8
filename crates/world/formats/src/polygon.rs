//! Triangulation of polygons, fans and strips.
//!
//! Convex polygons become a fan; concave ones are triangulated by ear clipping (Meisters, "Polygons have ears", American
//! Mathematical Monthly 82, 1975) in the plane of their Newell normal.

use elbowroom_spatial::Vec3;

/// Largest number of point-in-ear tests per corner, as a limit for hostile polygons.
const MAX_TESTS_PER_CORNER: usize = 1000;

/// Appends the triangles of a polygon, with its winding. Fewer than three corners give no triangles.
///
/// A polygon without ears (crossing edges, collinear corners) becomes a fan, so that no corner is lost. Every index must
/// be below `vertices.len()`.
pub(crate) fn triangulate(vertices: &[Vec3], polygon: &[u32], out: &mut Vec<[u32; 3]>) {
    match *polygon {
        [] | [_] | [_, _] => {}
        [a, b, c] => out.push([a, b, c]),
        _ => match flatten(vertices, polygon) {
            Some(flat) if !is_convex(&flat) => clip_ears(&flat, polygon, out),
            _ => fan(polygon, out),
        },
    }
}

/// Appends the triangles of a fan around its first vertex.
pub(crate) fn fan(polygon: &[u32], out: &mut Vec<[u32; 3]>) {
    out.extend(polygon.get(1..).unwrap_or_default().windows(2).map(|w| [polygon[0], w[0], w[1]]));
}

/// Appends the triangles of a strip: each vertex from the third on with the two before it.
///
/// Every second triangle is reversed.
pub(crate) fn strip(vertices: &[u32], out: &mut Vec<[u32; 3]>) {
    out.extend(
        vertices.windows(3).enumerate().map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }),
    );
}

/// The corners projected along the coordinate axis nearest to their normal, counter-clockwise.
fn flatten(vertices: &[Vec3], polygon: &[u32]) -> Option<Vec<[f64; 2]>> {
    let corner = |i: usize| vertices[polygon[i % polygon.len()] as usize];
    let normal =
        (0..polygon.len()).fold(Vec3::ZERO, |n, i| n + (corner(i) - corner(0)).cross(corner(i + 1) - corner(0)));
    let size = normal.abs();
    let largest = size.max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let axis = (0..3).find(|&i| size[i] == largest)?;
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        std::mem::swap(&mut u, &mut v);
    }
    Some((0..polygon.len()).map(|i| [corner(i)[u], corner(i)[v]]).collect())
}

/// Twice the signed area of the triangle abc.
fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn is_convex(flat: &[[f64; 2]]) -> bool {
    let n = flat.len();
    (0..n).all(|i| area(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= 0.0)
}

fn clip_ears(flat: &[[f64; 2]], polygon: &[u32], out: &mut Vec<[u32; 3]>) {
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut budget = MAX_TESTS_PER_CORNER * flat.len();
    let (mut at, mut misses) = (0, 0);
    while left.len() > 3 && misses < left.len() && budget > 0 {
        let n = left.len();
        let [before, tip, after] = [left[(at + n - 1) % n], left[at % n], left[(at + 1) % n]];
        if is_ear(flat, &left, [before, tip, after], &mut budget) {
            out.push([polygon[before], polygon[tip], polygon[after]]);
            left.remove(at % n);
            at = if at % n == 0 { 0 } else { at % n - 1 };
            misses = 0;
        } else {
            at = (at + 1) % n;
            misses += 1;
        }
    }
    let rest: Vec<u32> = left.iter().map(|&i| polygon[i]).collect();
    fan(&rest, out);
}

/// Whether a corner turns left and no other corner lies in its triangle.
fn is_ear(flat: &[[f64; 2]], left: &[usize], [i, j, k]: [usize; 3], budget: &mut usize) -> bool {
    let (a, b, c) = (flat[i], flat[j], flat[k]);
    if area(a, b, c) <= 0.0 {
        return false;
    }
    *budget = budget.saturating_sub(left.len());
    !left.iter().any(|&o| {
        let p = flat[o];
        p != a && p != b && p != c && area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area_of(vertices: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
        let corner = |i: u32| vertices[i as usize];
        triangles.iter().map(|t| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).length() / 2.0).sum()
    }

    #[test]
    fn a_concave_polygon_is_triangulated() {
        let vertices: Vec<Vec3> =
            [[0.0, 0.0], [2.0, -2.0], [0.0, 2.0], [-2.0, -2.0]].map(|[x, z]| Vec3::new(x, 1.0, z)).to_vec();
        for turn in 0..4 {
            let polygon: Vec<u32> = (0..4).map(|i| (i + turn) % 4).collect();
            let mut out = Vec::new();
            triangulate(&vertices, &polygon, &mut out);
            assert_eq!(out.len(), 2);
            assert!((area_of(&vertices, &out) - 4.0).abs() < 1e-12, "start {turn}");
        }
    }

    #[test]
    fn fewer_than_three_corners_give_no_triangle() {
        let mut out = Vec::new();
        triangulate(&[Vec3::ZERO, Vec3::X], &[0, 1], &mut out);
        assert!(out.is_empty());
    }

    proptest! {
        /// A star around the origin: its area is the sum over its spokes, whatever the triangulation.
        #[test]
        fn stars_keep_their_area(radii in prop::collection::vec(0.05..2.0f64, 4..60), tilt in 0.0..6.0f64, flip: bool) {
            let n = radii.len();
            let spoke = |i: usize| {
                let angle = std::f64::consts::TAU * i as f64 / n as f64;
                let (x, y) = (radii[i] * angle.cos(), radii[i] * angle.sin());
                Vec3::new(x, y * tilt.cos(), y * tilt.sin())
            };
            let vertices: Vec<Vec3> = (0..n).map(spoke).collect();
            let mut polygon: Vec<u32> = (0..n as u32).collect();
            if flip {
                polygon.reverse();
            }
            let expected: f64 = (0..n).map(|i| vertices[i].cross(vertices[(i + 1) % n]).length() / 2.0).sum();
            let mut out = Vec::new();
            triangulate(&vertices, &polygon, &mut out);
            prop_assert_eq!(out.len(), n - 2);
            prop_assert!((area_of(&vertices, &out) - expected).abs() < 1e-9 * expected);
        }

        /// Arbitrary corners, repeated and crossing: n - 2 triangles, all with given corners.
        #[test]
        fn any_polygon_gives_n_minus_two_triangles(xs in prop::collection::vec((-2..3i8, -2..3i8, -1..2i8), 1..12),
                                         polygon in prop::collection::vec(any::<prop::sample::Index>(), 3..30)) {
            let vertices: Vec<Vec3> = xs.iter().map(|&(x, y, z)| Vec3::new(f64::from(x), f64::from(y), f64::from(z))).collect();
            let polygon: Vec<u32> = polygon.iter().map(|i| i.index(vertices.len()) as u32).collect();
            let mut out = Vec::new();
            triangulate(&vertices, &polygon, &mut out);
            prop_assert_eq!(out.len(), polygon.len() - 2);
            prop_assert!(out.iter().flatten().all(|i| polygon.contains(i)));
        }
    }
}
