//! How far a mesh with fewer triangles is from the original: a bound that is proven, not sampled.
//!
//! The distance to one triangle is a convex function, so over another triangle it is largest in a corner. For a face
//! `T` of the original and any faces `D` of the result, no point of `T` is farther from the result than
//! `min over D of max over corners of T of distance(corner, D)`. Cutting `T` in four makes the bound tighter.

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::Vec3;

use super::simplify::Simplified;

/// Cuts of a face, at most.
const DEPTH: u32 = 5;

/// No point of the surface of `mesh` is farther (m) than this from the surface of `simple`.
pub(super) fn bound(mesh: &TriMesh, simple: &Simplified) -> f64 {
    let mut faces_of: Vec<Vec<u32>> = vec![Vec::new(); simple.vertices.len()];
    for (i, t) in simple.triangles.iter().enumerate() {
        for v in t {
            faces_of[*v as usize].push(i as u32);
        }
    }
    let size = mesh.aabb().extent().length();
    let mut worst: f64 = 0.0;
    let mut near: Vec<u32> = Vec::new();
    let mut solids: Vec<[Vec3; 3]> = Vec::new();
    for t in mesh.triangles() {
        // Where its corners went, and the faces around those: the nearest is among them, but any would do for a bound.
        near.clear();
        for v in t.map(|v| simple.became[v as usize]) {
            for f in faces_of.get(v as usize).into_iter().flatten() {
                near.extend(simple.triangles[*f as usize].iter().flat_map(|w| &faces_of[*w as usize]));
            }
        }
        near.sort_unstable();
        near.dedup();
        solids.clear();
        solids.extend(near.iter().map(|f| simple.triangles[*f as usize].map(|v| simple.vertices[v as usize])));
        let face = t.map(|v| mesh.vertices()[v as usize]);
        worst = worst.max(of_face(face, &solids, worst.max(1e-6 * size), DEPTH));
    }
    // What rounding may have taken off.
    worst + 1e-12 * size
}

/// Bound for one face; below `enough` nobody cares.
fn of_face(face: [Vec3; 3], solids: &[[Vec3; 3]], enough: f64, depth: u32) -> f64 {
    let mut nearest = [f64::INFINITY; 3];
    let mut together = f64::INFINITY;
    for solid in solids {
        let d = face.map(|p| p.distance(nearest_on(*solid, p)));
        nearest.iter_mut().zip(d).for_each(|(n, d)| *n = n.min(d));
        together = together.min(d[0].max(d[1]).max(d[2]));
    }
    let least = nearest.into_iter().fold(0.0, f64::max);
    if depth == 0 || together <= enough || together <= 1.05 * least || !together.is_finite() {
        return together;
    }
    let [a, b, c] = face;
    let (ab, bc, ca) = (a.lerp(b, 0.5), b.lerp(c, 0.5), c.lerp(a, 0.5));
    let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    let cut = quarters.into_iter().map(|q| of_face(q, solids, enough.max(least), depth - 1)).fold(0.0, f64::max);
    cut.min(together)
}

/// The point of a triangle nearest to `p`, by the region of the triangle's plane that `p` is over (Ericson, "Real-Time
/// Collision Detection", 2005, section 5.1.5). A triangle without area gives one of its points, which is a bound, too.
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
