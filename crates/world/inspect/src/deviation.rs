//! Deviation of a simplified mesh from the original: a proven bound, without sampling.
//!
//! The distance to one triangle is a convex function, so over another triangle it is largest at a corner. For a face
//! `T` of the original and any faces `D` of the result, no point of `T` is farther from the result than
//! `min over D of max over corners of T of distance(corner, D)`. Subdivision of `T` tightens the bound.

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::Vec3;

use crate::simplify::Simplified;

/// Largest depth of subdivision.
const DEPTH: u32 = 12;

/// Largest number of distance computations for subdivided faces. When it is used up, the bound stays less tight.
const BUDGET: usize = 60_000_000;

/// Upper bound (m) on the distance of any point of the surface of `mesh` from the surface of `simple`.
pub(super) fn bound(mesh: &TriMesh, simple: &Simplified) -> f64 {
    let mut faces_of: Vec<Vec<u32>> = vec![Vec::new(); simple.vertices.len()];
    for (i, t) in simple.triangles.iter().enumerate() {
        for v in t {
            faces_of[*v as usize].push(i as u32);
        }
    }
    let size = mesh.aabb().extent().length();
    let face = |t: &[u32; 3]| t.map(|v| mesh.vertices()[v as usize]);
    let mut near = Vec::new();
    // Corners first: faces within the largest corner distance need no subdivision.
    let mut enough: f64 = 1e-6 * size;
    let mut whole = Vec::with_capacity(mesh.triangles().len());
    for t in mesh.triangles() {
        around(t, simple, &faces_of, &mut near);
        let (least, together) = measure(face(t), &near);
        enough = enough.max(if least.is_finite() { least } else { 0.0 });
        whole.push(together);
    }
    let mut worst: f64 = 0.0;
    let mut budget = BUDGET;
    let solids: Vec<[Vec3; 3]> = simple.triangles.iter().map(|t| t.map(|v| simple.vertices[v as usize])).collect();
    for (t, together) in mesh.triangles().iter().zip(whole) {
        let mut bound = together;
        if together > enough && budget > 0 {
            budget = budget.saturating_sub(solids.len());
            bound = of_face(face(t), &relevant(face(t), &solids), enough.max(worst), DEPTH, &mut budget);
        }
        worst = worst.max(bound);
    }
    // Allowance for rounding.
    worst + 1e-12 * size
}

/// The faces at the vertices to which the corners of a face collapsed.
///
/// They usually include the nearest face; any face gives a valid bound.
fn around(t: &[u32; 3], simple: &Simplified, faces_of: &[Vec<u32>], near: &mut Vec<[Vec3; 3]>) {
    let once = |mut list: Vec<u32>| {
        list.sort_unstable();
        list.dedup();
        list
    };
    let faces = |vertices: &[u32]| -> Vec<u32> {
        once(vertices.iter().filter_map(|v| faces_of.get(*v as usize)).flatten().copied().collect())
    };
    let there = faces(&t.map(|v| simple.collapsed_to[v as usize]));
    let list = faces(&once(there.iter().flat_map(|f| simple.triangles[*f as usize]).collect()));
    near.clear();
    near.extend(list.iter().map(|f| simple.triangles[*f as usize].map(|v| simple.vertices[v as usize])));
}

/// The largest distance (m) of a corner from its nearest face, and the minimum over the faces of the largest one.
fn measure(face: [Vec3; 3], solids: &[[Vec3; 3]]) -> (f64, f64) {
    let mut nearest = [f64::INFINITY; 3];
    let mut together = f64::INFINITY;
    for solid in solids {
        let d = face.map(|p| p.distance(nearest_on(*solid, p)));
        nearest.iter_mut().zip(d).for_each(|(n, d)| *n = n.min(d));
        together = together.min(d[0].max(d[1]).max(d[2]));
    }
    (nearest.into_iter().fold(0.0, f64::max), together)
}

/// Bound (m) for one face. A bound below `enough` is not refined.
fn of_face(face: [Vec3; 3], solids: &[[Vec3; 3]], enough: f64, depth: u32, budget: &mut usize) -> f64 {
    *budget = budget.saturating_sub(4 * solids.len());
    let (least, together) = measure(face, solids);
    if depth == 0 || *budget == 0 || together <= enough || together <= 1.05 * least || !together.is_finite() {
        return together;
    }
    let [a, b, c] = face;
    let (ab, bc, ca) = (a.lerp(b, 0.5), b.lerp(c, 0.5), c.lerp(a, 0.5));
    let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    let enough = enough.max(least);
    let part = |q: [Vec3; 3]| of_face(q, &relevant(q, solids), enough, depth - 1, budget);
    quarters.into_iter().map(part).fold(0.0, f64::max).min(together)
}

/// All faces that can be nearest to a point of `face`.
///
/// Their distance from its centroid exceeds the smallest distance by at most twice the radius of `face`.
fn relevant(face: [Vec3; 3], solids: &[[Vec3; 3]]) -> Vec<[Vec3; 3]> {
    let middle = (face[0] + face[1] + face[2]) / 3.0;
    let radius = face.into_iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let distances: Vec<f64> = solids.iter().map(|s| middle.distance(nearest_on(*s, middle))).collect();
    let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let near = |(d, _): &(&f64, _)| **d <= least + 2.0 * radius;
    distances.iter().zip(solids).filter(near).map(|(_, s)| *s).collect()
}

/// The point of a triangle nearest to `p`, by the region of the triangle's plane above which `p` lies.
///
/// For a degenerate triangle, one of its points, which is also a valid bound. Source: Ericson, "Real-Time Collision
/// Detection", 2005, section 5.1.5.
fn nearest_on([a, b, c]: [Vec3; 3], p: Vec3) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return on_edge(a, b, d1, d1 - d3);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return on_edge(a, c, d2, d2 - d6);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return on_edge(b, c, d4 - d3, (d4 - d3) + (d5 - d6));
    }
    let sum = va + vb + vc;
    if sum > 0.0 { a + ab * (vb / sum) + ac * (vc / sum) } else { a }
}

fn on_edge(from: Vec3, to: Vec3, along: f64, whole: f64) -> Vec3 {
    if whole > 0.0 { from.lerp(to, (along / whole).clamp(0.0, 1.0)) } else { from }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::simplify;

    /// A bumpy sphere of `n` by `2 n` quads, triangulated.
    fn ball(n: u32, bump: f64) -> TriMesh {
        let point = |i: u32, j: u32| {
            let (u, v) = (f64::from(i) / f64::from(n), f64::from(j % (2 * n)) / f64::from(2 * n));
            let ((su, cu), (sv, cv)) = ((u * std::f64::consts::PI).sin_cos(), (v * std::f64::consts::TAU).sin_cos());
            Vec3::new(su * cv, su * sv, cu) * (1.0 + bump * (5.0 * u * v + 3.0 * v).sin())
        };
        let vertices = (0..=n).flat_map(|i| (0..2 * n).map(move |j| point(i, j))).collect();
        let at = |i: u32, j: u32| i * 2 * n + j % (2 * n);
        let quads = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
        let triangles = quads.flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        });
        TriMesh::new(vertices, triangles.collect()).unwrap()
    }

    /// Largest distance of sampled points of the original from the simplified mesh.
    fn sampled(mesh: &TriMesh, simple: &Simplified) -> f64 {
        let solids: Vec<[Vec3; 3]> = simple.triangles.iter().map(|t| t.map(|v| simple.vertices[v as usize])).collect();
        let nearest = |p: Vec3| solids.iter().map(|s| p.distance(nearest_on(*s, p))).fold(f64::INFINITY, f64::min);
        let mut worst: f64 = 0.0;
        for t in mesh.triangles() {
            let [a, b, c] = t.map(|v| mesh.vertices()[v as usize]);
            let grid = (0..=10).flat_map(|i| (0..=10 - i).map(move |j| (f64::from(i) / 10.0, f64::from(j) / 10.0)));
            for (u, v) in grid {
                worst = worst.max(nearest(a + (b - a) * u + (c - a) * v));
            }
        }
        worst
    }

    #[test]
    fn the_bound_holds_every_point_and_is_tight() {
        let mesh = ball(12, 0.05);
        let (middle, coarse) = simplify::middle_and_coarse(&mesh, 150, 50);
        for (simple, most, off) in [(&middle, 150, 0.1), (&coarse, 50, 0.3)] {
            assert!(simple.triangles.len() <= most, "{}", simple.triangles.len());
            let (seen, proven) = (sampled(&mesh, simple), bound(&mesh, simple));
            assert!(seen <= proven && proven <= 1.2 * seen && proven < off, "{seen} {proven}");
        }
    }

    #[test]
    fn a_mesh_that_cannot_be_simplified_has_no_deviation() {
        let mesh = ball(3, 0.0);
        let (same, _) = simplify::middle_and_coarse(&mesh, 1000, 1000);
        assert!(bound(&mesh, &same) < 1e-9);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

        /// Arbitrary triangles: intersecting, degenerate, with coincident corners.
        #[test]
        fn the_deviation_of_any_triangle_soup_is_bounded(
            corners in prop::collection::vec((0..4_u8, 0..4_u8, 0..4_u8), 3..20),
            faces in prop::collection::vec((0..20_usize, 0..20_usize, 0..20_usize), 1..40),
        ) {
            let vertices: Vec<Vec3> =
                corners.iter().map(|c| Vec3::new(f64::from(c.0), f64::from(c.1), f64::from(c.2))).collect();
            let n = vertices.len();
            let triangles = faces.iter().map(|f| [f.0 % n, f.1 % n, f.2 % n].map(|i| i as u32)).collect();
            let mesh = TriMesh::new(vertices, triangles).unwrap();
            let (middle, coarse) = simplify::middle_and_coarse(&mesh, 12, 4);
            for simple in [middle, coarse] {
                prop_assert!(simple.vertices.iter().all(|v| v.is_finite()));
                prop_assert!(sampled(&mesh, &simple) <= bound(&mesh, &simple));
            }
        }
    }
}
