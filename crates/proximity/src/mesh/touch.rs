//! Collision: does any triangle touch any other? Ends at the first; [`contacts`] goes on.

use elbowroom_spatial::Pose;
use fearless_simd::{Simd, dispatch};

use super::leaf::{Facing, Intervals, along_normals, filled};
use super::limit::Limit;
use super::node::{TOUCH, step};
use super::placement::{Pairing, apart};
use super::search::{Entry, Queue, Scratch, Stack, Visits, corners_in_a, filling, settle, side};
use super::swallowed::swallowed;
use super::tree::LEAF;
use crate::TriMesh;
use crate::triangle::triangles_cross;

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
///
/// ```
/// use elbowroom_proximity::{TriMesh, mesh::{Scratch, collide}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let mut scratch = Scratch::new();
/// let (near, far) = (Pose::from_translation(Vec3::X * 0.9), Pose::from_translation(Vec3::X * 1.1));
/// assert!(collide(&mesh, &Pose::IDENTITY, &mesh, &near, &mut scratch).is_some());
/// assert!(collide(&mesh, &Pose::IDENTITY, &mesh, &far, &mut scratch).is_none());
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn collide(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    scratch: &mut Scratch,
) -> Option<Pair> {
    let mut first = None;
    traverse(a, a_in_world, b, b_in_world, scratch, |pair| {
        first = Some(pair);
        true
    });
    first
}

/// Calls `found` with every pair of triangles that touch, or that are closer than f64 can tell, each once and in an
/// order that depends on nothing but the meshes and poses; with [`Pair::Inside`] where none touch and one mesh lies
/// inside the other.
///
/// ```
/// use elbowroom_proximity::{TriMesh, mesh::{Pair, Scratch, contacts}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let mut pairs = Vec::new();
/// let there = Pose::from_translation(Vec3::new(0.3, 0.3, -0.5));
/// contacts(&mesh, &Pose::IDENTITY, &mesh, &there, &mut Scratch::new(), |pair| pairs.push(pair));
/// // The tip of the second one comes out through the floor of the first.
/// assert!(pairs.iter().any(|p| matches!(p, Pair::Triangles(0, _))));
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn contacts(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    scratch: &mut Scratch,
    mut found: impl FnMut(Pair),
) {
    traverse(a, a_in_world, b, b_in_world, scratch, |pair| {
        found(pair);
        false
    });
}

/// `found` returns true to end.
fn traverse(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    scratch: &mut Scratch,
    mut found: impl FnMut(Pair) -> bool,
) {
    scratch.visits = Visits::default();
    if apart(&a.tree, a_in_world, &b.tree, b_in_world, 0.0) {
        return;
    }
    let pairing = Pairing::new(&a.tree, a_in_world, &b.tree, b_in_world);
    if !pairing.is_usable() {
        found(Pair::Unknown);
        return;
    }
    let level = scratch.level();
    let mut touched = false;
    let ended = dispatch!(level, simd => search(simd, a, b, &pairing, scratch, |x, y| {
        touched = true;
        found(Pair::Triangles(x, y))
    }));
    if scratch.stack.overflown() {
        found(Pair::Unknown);
    } else if !ended && !touched && swallowed(a, a_in_world, b, b_in_world).is_some() {
        found(Pair::Inside);
    }
}

#[inline(always)]
fn search<S: Simd>(
    simd: S,
    a: &TriMesh,
    b: &TriMesh,
    pairing: &Pairing,
    scratch: &mut Scratch,
    mut found: impl FnMut(u32, u32) -> bool,
) -> bool {
    let limit = Limit::new(pairing.slack, pairing);
    let Scratch { stack, queue, visits, .. } = scratch;
    queue.clear();
    stack.clear();
    stack.push(Entry::root(&a.tree, &b.tree));
    while let Some(pair) = stack.pop() {
        if pair.is_leaves() {
            visits.leaves += 1;
            let left = leaves(simd, a, b, &pair, pairing, &limit);
            if examine(simd, a, b, &pair, left, pairing, queue, visits, &mut found) {
                return true;
            }
        } else {
            visits.nodes += 1;
            visits.boxes += open(simd, a, b, &pair, pairing, &limit, stack);
        }
    }
    any_close(simd, a, b, pairing, queue, visits, &mut found)
}

/// The pairs of triangles that neither boxes nor planes keep apart.
#[inline(always)]
fn leaves<S: Simd>(simd: S, a: &TriMesh, b: &TriMesh, pair: &Entry, pairing: &Pairing, limit: &Limit) -> u64 {
    let (leaf_a, leaf_b) = (&a.tree.leaves[pair.a as usize], &b.tree.leaves[pair.b as usize]);
    let all = filled(filling(&a.tree, pair.a as usize), filling(&b.tree, pair.b as usize));
    let of_a = Intervals::own(simd, leaf_a);
    let left = Facing::new(simd, leaf_b, &pairing.axes).touching(simd, &of_a, limit, all);
    if left.0 == 0 { 0 } else { along_normals(simd, leaf_a, leaf_b, pairing, limit, left).0 }
}

/// Pairs that cross are found at once; the others wait to be measured together.
#[inline(always)]
fn examine<S: Simd>(
    simd: S,
    a: &TriMesh,
    b: &TriMesh,
    pair: &Entry,
    mut left: u64,
    pairing: &Pairing,
    queue: &mut Queue,
    visits: &mut Visits,
    found: &mut impl FnMut(u32, u32) -> bool,
) -> bool {
    while left != 0 {
        let bit = left.trailing_zeros();
        left &= left - 1;
        let (slot_a, slot_b) = (pair.a * LEAF as u32 + bit / 8, pair.b * LEAF as u32 + bit % 8);
        let (ta, tb) = (a.tree.triangle(slot_a), b.tree.triangle(slot_b));
        let (s, t) = corners_in_a(a, ta, b, tb, pairing);
        visits.triangles += 1;
        if triangles_cross(s, t) {
            if found(ta as u32, tb as u32) {
                return true;
            }
        } else if queue.push(a, slot_a, b, slot_b) && any_close(simd, a, b, pairing, queue, visits, found) {
            return true;
        }
    }
    false
}

#[inline(always)]
fn open<S: Simd>(
    simd: S,
    a: &TriMesh,
    b: &TriMesh,
    pair: &Entry,
    pairing: &Pairing,
    limit: &Limit,
    stack: &mut Stack,
) -> u32 {
    let (open_a, open_b) = pair.opens();
    let first = stack.len();
    let side_a = side(&a.tree, pair.a, pair.height_a, open_a);
    let side_b = side(&b.tree, pair.b, pair.height_b, open_b);
    let mut deepest = (f32::INFINITY, first);
    let tests = step::<S, TOUCH>(simd, side_a, side_b, pairing, limit, |i, j, key| {
        if key < deepest.0 {
            deepest = (key, stack.len());
        }
        stack.push(pair.child(i, j, key));
    });
    stack.bring_to_top(deepest.1);
    tests
}

/// Measures the queue.
#[inline(always)]
fn any_close<S: Simd>(
    simd: S,
    a: &TriMesh,
    b: &TriMesh,
    pairing: &Pairing,
    queue: &mut Queue,
    visits: &mut Visits,
    found: &mut impl FnMut(u32, u32) -> bool,
) -> bool {
    if queue.is_empty() {
        return false;
    }
    let (measured, len) = queue.measure(simd, pairing);
    visits.batches += 1;
    for lane in 0..len {
        if measured.at_least[lane] > pairing.slack {
            continue;
        }
        let (ta, tb) = queue.triangles[lane];
        let certain = measured.at_least[lane] >= measured.distance[lane];
        let settled = || settle(a, ta as usize, b, tb as usize, pairing).squared <= pairing.slack * pairing.slack;
        if (certain || settled()) && found(ta, tb) {
            return true;
        }
    }
    false
}
