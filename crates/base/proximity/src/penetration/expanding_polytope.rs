//! Penetration depth of two convex cores by the expanding polytope algorithm (EPA; van den Bergen, 2001).
//!
//! The difference `A - B` contains the origin; its boundary point nearest to the origin gives the penetration. A
//! polytope inside the difference is expanded at the face nearest to the origin until the support point there is no
//! farther than the face. The returned depth belongs to a support plane, so the translation always separates the
//! cores; the face is a lower bound.

use elbowroom_spatial::{Pose, Vec3};

use crate::ConvexHull;
use crate::separation::core::Core;

const MAX_ITERATIONS: usize = 64;

/// Depth, and unit direction (frame of b) in which to move a. The depth is negative if the cores are apart.
pub(super) fn expanding_polytope(a: &Core, b: &Core, a_in_b: &Pose) -> (f64, Vec3) {
    let difference = |d: Vec3| a_in_b.transform_point(a.support(a_in_b.inverse_transform_vector(d))) - b.support(-d);
    let mut best = (f64::INFINITY, Vec3::Z);
    let mut points = Vec::with_capacity(MAX_ITERATIONS + 26);
    let mut add_support = |d: Vec3, points: &mut Vec<Vec3>| {
        let w = difference(d);
        points.push(w);
        if w.dot(d) < best.0 {
            best = (w.dot(d), -d);
        }
        best
    };
    for d in initial_directions(a_in_b) {
        add_support(d, &mut points);
    }
    let scale = points.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    for _ in 0..MAX_ITERATIONS {
        let Ok(hull) = ConvexHull::from_points(&points) else { break };
        let nearest = hull.planes().iter().copied().min_by(|x, y| x.1.total_cmp(&y.1));
        let Some((normal, offset)) = nearest else { break };
        let (depth, _) = add_support(normal, &mut points);
        if depth - offset <= 1e-10 * scale {
            break;
        }
    }
    best
}

/// The axes of both frames and their cross products, each with both signs.
fn initial_directions(a_in_b: &Pose) -> Vec<Vec3> {
    let b = [Vec3::X, Vec3::Y, Vec3::Z];
    let a = b.map(|e| a_in_b.transform_vector(e));
    let products = a.iter().flat_map(|&u| b.iter().filter_map(move |&v| u.cross(v).try_normalize()));
    let toward = a_in_b.translation.try_normalize();
    let all: Vec<Vec3> = b.into_iter().chain(a).chain(products).chain(toward).collect();
    all.iter().flat_map(|&d| [d, -d]).collect()
}
