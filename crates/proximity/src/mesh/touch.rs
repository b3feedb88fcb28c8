//! Collision: does any triangle touch any other? Ends at the first; [`contacts`] goes on.

use elbowroom_spatial::Pose;
use fearless_simd::Level;

use super::leaf::{filled, touching};
use super::limit::Limit;
use super::node::{TOUCH, open};
use super::placement::{Pairing, apart};
use super::scratch::{Entry, Queue, Scratch, Visits, corners_in_a, filling, settle};
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
/// A mesh wholly inside a closed one is in contact. Which of several pairs is found is unspecified.
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
pub fn collide(a: &TriMesh, a_in_world: &Pose, b: &TriMesh, b_in_world: &Pose, scratch: &mut Scratch) -> Option<Pair> {
    let mut first = None;
    traverse(a, a_in_world, b, b_in_world, scratch, &mut |pair| {
        first = Some(pair);
        true
    });
    first
}

/// Calls `found` with every pair of triangles that touch, or that are closer than f64 can tell, each once and in no
/// particular order; with [`Pair::Inside`] where none touch and one mesh lies
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
    traverse(a, a_in_world, b, b_in_world, scratch, &mut |pair| {
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
    found: &mut dyn FnMut(Pair) -> bool,
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
    let mut touched = false;
    let mut touch = |x, y| {
        touched = true;
        found(Pair::Triangles(x, y))
    };
    let ended = Search { a, b, pairing: &pairing, found: &mut touch }.run(scratch);
    if scratch.stack.overflown() {
        found(Pair::Unknown);
    } else if !ended && !touched && swallowed(a, a_in_world, b, b_in_world).is_some() {
        found(Pair::Inside);
    }
}

struct Search<'a> {
    a: &'a TriMesh,
    b: &'a TriMesh,
    pairing: &'a Pairing,
    /// Told the numbers of two triangles that touch; returns true to end.
    found: &'a mut dyn FnMut(u32, u32) -> bool,
}

impl Search<'_> {
    fn run(&mut self, scratch: &mut Scratch) -> bool {
        let level = scratch.level();
        let limit = Limit::new(self.pairing.slack, self.pairing);
        let Scratch { stack, queue, visits, .. } = scratch;
        let trees = (&self.a.tree, &self.b.tree);
        queue.clear();
        stack.clear();
        stack.push(Entry::root(trees.0, trees.1));
        while let Some(pair) = stack.pop() {
            if pair.is_leaves() {
                visits.leaves += 1;
                let (leaf_a, leaf_b) = (pair.a as usize, pair.b as usize);
                let all = filled(filling(trees.0, leaf_a), filling(trees.1, leaf_b));
                let (of_a, of_b) = (&trees.0.leaves[leaf_a], &trees.1.leaves[leaf_b]);
                let left = touching(level, of_a, of_b, self.pairing, &limit, all);
                if left != 0 && self.examine(level, &pair, left, queue, visits) {
                    return true;
                }
            } else {
                visits.nodes += 1;
                visits.boxes += open::<TOUCH>(level, trees, &pair, self.pairing, &limit, stack);
            }
        }
        self.measure(level, queue, visits)
    }

    /// Pairs that cross are found at once; the others wait to be measured together.
    fn examine(&mut self, level: Level, pair: &Entry, mut left: u64, queue: &mut Queue, visits: &mut Visits) -> bool {
        while left != 0 {
            let bit = left.trailing_zeros();
            left &= left - 1;
            let (slot_a, slot_b) = (pair.a * LEAF as u32 + bit / 8, pair.b * LEAF as u32 + bit % 8);
            let (ta, tb) = (self.a.tree.triangle(slot_a), self.b.tree.triangle(slot_b));
            let (s, t) = corners_in_a(self.a, ta, self.b, tb, self.pairing);
            visits.triangles += 1;
            if triangles_cross(s, t) {
                if (self.found)(ta as u32, tb as u32) {
                    return true;
                }
            } else if queue.push(self.a, slot_a, self.b, slot_b) && self.measure(level, queue, visits) {
                return true;
            }
        }
        false
    }

    /// Measures the queue.
    fn measure(&mut self, level: Level, queue: &mut Queue, visits: &mut Visits) -> bool {
        if queue.is_empty() {
            return false;
        }
        let (measured, len) = queue.measure(level, self.pairing);
        visits.batches += 1;
        let slack = self.pairing.slack;
        for lane in 0..len {
            if measured.at_least[lane] > slack {
                continue;
            }
            let (ta, tb) = queue.triangles[lane];
            let certain = measured.at_least[lane] >= measured.distance[lane];
            let settled = || settle(self.a, ta as usize, self.b, tb as usize, self.pairing).squared <= slack * slack;
            if (certain || settled()) && (self.found)(ta, tb) {
                return true;
            }
        }
        false
    }
}
