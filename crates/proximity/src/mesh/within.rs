//! Collision and tolerance: is any pair of triangles this close? Ends at the first.

use elbowroom_spatial::Pose;
use fearless_simd::{Simd, dispatch};

use super::leaf::{along_normals, filled};
use super::limit::Limit;
use super::node::{NEAR, TOUCH, step};
use super::placement::{Pairing, offset};
use super::search::settle;
use super::search::{Entry, Scratch, Visits, filling, side};
use super::swallowed::swallowed;
use super::tree::LEAF;
use crate::TriMesh;

/// Why two meshes are close.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pair {
    /// These triangles (of the first and of the second mesh) are.
    Triangles(u32, u32),
    /// One mesh lies inside the other.
    Inside,
    /// A pose is not finite: unknown is not free.
    Unknown,
}

/// A pair of triangles that touch, or `None` where the meshes are certainly apart.
///
/// Touching is contact, and so is being closer than f64 can tell: 2⁻⁴⁰ of the sizes and distance of the meshes.
/// A mesh wholly inside a closed one is in contact. Which pair is found is unspecified but reproducible.
pub fn collide(a: &TriMesh, a_in_world: &Pose, b: &TriMesh, b_in_world: &Pose, scratch: &mut Scratch) -> Option<Pair> {
    close::<TOUCH>(a, a_in_world, b, b_in_world, 0.0, scratch)
}

/// A pair of triangles no farther apart than `tolerance` metres, or `None` where the meshes certainly are.
///
/// A NaN or negative tolerance counts as 0.
pub fn within(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    tolerance: f64,
    scratch: &mut Scratch,
) -> Option<Pair> {
    if tolerance > 0.0 {
        close::<NEAR>(a, a_in_world, b, b_in_world, tolerance, scratch)
    } else {
        close::<TOUCH>(a, a_in_world, b, b_in_world, 0.0, scratch)
    }
}

fn close<const MODE: u8>(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    tolerance: f64,
    scratch: &mut Scratch,
) -> Option<Pair> {
    scratch.visits = Visits::default();
    let between = offset(&a.tree.frame, a_in_world, &b.tree.frame, b_in_world);
    let far = between.abs().max_element() + a_in_world.translation.abs().max_element();
    let reach = (a.tree.radius + b.tree.radius + tolerance) * (1.0 + 1e-12) + far * 1e-12;
    if between.length_squared() > reach * reach && a_in_world.is_finite() && b_in_world.is_finite() {
        return None;
    }
    let pairing = Pairing::new(&a.tree, a_in_world, &b.tree, b_in_world);
    if !pairing.slack.is_finite() || !(a_in_world.is_finite() && b_in_world.is_finite()) {
        return Some(Pair::Unknown);
    }
    let radius = tolerance / a.tree.frame.unit + pairing.slack;
    let level = scratch.level;
    if let Some(found) = dispatch!(level, simd => search::<_, MODE>(simd, a, b, &pairing, radius, scratch)) {
        return Some(found);
    }
    swallowed(a, a_in_world, b, b_in_world).map(|_| Pair::Inside)
}

#[inline(always)]
fn search<S: Simd, const MODE: u8>(
    simd: S,
    a: &TriMesh,
    b: &TriMesh,
    pairing: &Pairing,
    radius: f64,
    scratch: &mut Scratch,
) -> Option<Pair> {
    let limit = Limit::new(radius, pairing);
    let Scratch { stack, queue, visits, .. } = scratch;
    stack.clear();
    queue.len = 0;
    stack.push(Entry::root(&a.tree, &b.tree));
    while let Some(pair) = stack.pop() {
        if pair.is_leaves() {
            visits.leaves += 1;
            let (la, lb) = (pair.a as usize, pair.b as usize);
            let all = filled(filling(&a.tree, la), filling(&b.tree, lb));
            let mut left = along_normals(simd, &a.tree.leaves[la], &b.tree.leaves[lb], pairing, &limit, all).0;
            while left != 0 {
                let bit = left.trailing_zeros();
                left &= left - 1;
                let full = queue.push(a, pair.a * LEAF as u32 + bit / 8, b, pair.b * LEAF as u32 + bit % 8);
                if full && let Some(found) = any_close(simd, a, b, pairing, radius, queue, visits) {
                    return Some(found);
                }
            }
            // With boxes this deep in each other the answer is near: look at once.
            if queue.len > 0
                && pair.key <= 0.0
                && let Some(found) = any_close(simd, a, b, pairing, radius, queue, visits)
            {
                return Some(found);
            }
            continue;
        }
        visits.nodes += 1;
        let (open_a, open_b) = pair.opens();
        let first = stack.len();
        let (side_a, side_b) =
            (side(&a.tree, pair.a, pair.height_a, open_a), side(&b.tree, pair.b, pair.height_b, open_b));
        let mut deepest = (f32::INFINITY, first);
        visits.boxes += step::<S, MODE>(simd, side_a, side_b, pairing, &limit, |i, j, key| {
            if key < deepest.0 {
                deepest = (key, stack.len());
            }
            stack.push(pair.child(i, j, key));
        });
        if stack.len() > first {
            let last = stack.len() - 1;
            stack.swap(deepest.1, last);
        }
    }
    if queue.len > 0 { any_close(simd, a, b, pairing, radius, queue, visits) } else { None }
}

/// Measures the queue.
#[inline(always)]
fn any_close<S: Simd>(
    simd: S,
    a: &TriMesh,
    b: &TriMesh,
    pairing: &Pairing,
    radius: f64,
    queue: &mut super::search::Queue,
    visits: &mut Visits,
) -> Option<Pair> {
    let (found, len) = queue.measure(simd, pairing);
    visits.triangles += len as u32;
    for lane in 0..len {
        let (ta, tb) = queue.triangles[lane];
        if found.distance[lane] <= radius
            || (found.at_least[lane] <= radius
                && settle(a, ta as usize, b, tb as usize, pairing).squared <= radius * radius)
        {
            return Some(Pair::Triangles(ta, tb));
        }
    }
    None
}
