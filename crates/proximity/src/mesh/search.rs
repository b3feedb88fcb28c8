//! What every traversal shares: the stack, the queue of triangle pairs, the counts.

use fearless_simd::{Level, Simd};

use super::exact::{BATCH, Corners, Distances, distances};
use super::node::Side;
use super::placement::Pairing;
use super::tree::{FAN, LEAF, Tree};
use crate::TriMesh;
use crate::triangle::{Near, triangle_triangle};
use elbowroom_spatial::Vec3;

/// Work done by one query.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Visits {
    /// Pairs of nodes opened.
    pub nodes: u32,
    /// Tests of one box against sixteen.
    pub boxes: u32,
    /// Pairs of leaves opened.
    pub leaves: u32,
    /// Pairs of triangles measured in f64.
    pub triangles: u32,
}

/// Memory that queries use again: one per thread. Nothing of an answer depends on what was asked before.
#[derive(Debug)]
pub struct Scratch {
    pub(super) stack: Vec<Entry>,
    pub(super) queue: Queue,
    pub(super) level: Level,
    pub(super) visits: Visits,
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}

impl Scratch {
    /// For the best instruction set of this processor.
    pub fn new() -> Self {
        Self::with_level(Level::new())
    }

    /// For a given instruction set.
    #[doc(hidden)]
    pub fn with_level(level: Level) -> Self {
        Self { stack: Vec::with_capacity(1024), queue: Queue::new(), level, visits: Visits::default() }
    }

    /// Work done by the last query.
    pub fn visits(&self) -> Visits {
        self.visits
    }
}

/// A pair of nodes still to be opened.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub a: u32,
    pub b: u32,
    /// What is known of the distance (see [`super::node::step`]).
    pub key: f32,
    pub height_a: u8,
    pub height_b: u8,
}

impl Entry {
    #[inline(always)]
    pub fn root(a: &Tree, b: &Tree) -> Self {
        Self { a: 0, b: 0, key: f32::MIN, height_a: a.height() as u8, height_b: b.height() as u8 }
    }

    #[inline(always)]
    pub fn is_leaves(&self) -> bool {
        self.height_a == 0 && self.height_b == 0
    }

    /// The higher of the two is opened; both, where they are equally high.
    #[inline(always)]
    pub fn opens(&self) -> (bool, bool) {
        (self.height_a >= self.height_b, self.height_b >= self.height_a)
    }

    /// The pair of children `i` and `j` as numbered by [`side`].
    #[inline(always)]
    pub fn child(&self, i: usize, j: usize, key: f32) -> Self {
        let (open_a, open_b) = self.opens();
        let (a, height_a) =
            if open_a { (self.a * FAN as u32 + i as u32, self.height_a - 1) } else { (self.a, self.height_a) };
        let (b, height_b) =
            if open_b { (self.b * FAN as u32 + j as u32, self.height_b - 1) } else { (self.b, self.height_b) };
        Self { a, b, key, height_a, height_b }
    }
}

/// A node to be opened, or the lane of its parent that is itself.
#[inline(always)]
pub(super) fn side(tree: &Tree, number: u32, height: u8, open: bool) -> Side<'_> {
    let (number, height) = (number as usize, height as usize);
    let (parent, lane) = (&tree.levels[height][number / FAN], number % FAN);
    let at = |p: &[[f32; FAN]; 3]| [p[0][lane], p[1][lane], p[2][lane]];
    let own = (at(&parent.center), at(&parent.half));
    if open {
        Side { node: &tree.levels[height - 1][number], mask: tree.children(height, number), own }
    } else {
        Side { node: parent, mask: 1 << lane, own }
    }
}

/// Triangles in a leaf.
#[inline(always)]
pub(super) fn filling(tree: &Tree, leaf: usize) -> usize {
    (tree.order.len() - leaf * LEAF).min(LEAF)
}

/// Pairs of triangles waiting to be measured together.
#[derive(Debug)]
pub(super) struct Queue {
    pub triangles: [(u32, u32); BATCH],
    pub len: usize,
    corners: Corners,
}

impl Queue {
    fn new() -> Self {
        Self { triangles: [(0, 0); BATCH], len: 0, corners: Corners::ZERO }
    }

    /// Adds a pair of slots; true where the batch is full.
    #[inline(always)]
    pub fn push(&mut self, a: &TriMesh, slot_a: u32, b: &TriMesh, slot_b: u32) -> bool {
        let (ta, tb) = (a.tree.triangle(slot_a), b.tree.triangle(slot_b));
        let lane = self.len;
        self.triangles[lane] = (ta as u32, tb as u32);
        let (pa, pb) = (a.triangles()[ta], b.triangles()[tb]);
        for k in 0..3 {
            let (p, q) = (a.vertices()[pa[k] as usize], b.vertices()[pb[k] as usize]);
            let (to_a, to_b) = (&mut self.corners.a[k], &mut self.corners.b[k]);
            (to_a[0][lane], to_a[1][lane], to_a[2][lane]) = (p.x, p.y, p.z);
            (to_b[0][lane], to_b[1][lane], to_b[2][lane]) = (q.x, q.y, q.z);
        }
        self.len += 1;
        self.len == BATCH
    }

    /// Measures all and empties the queue; lanes from `len` on mean nothing. The second value is `len`.
    #[inline(always)]
    pub fn measure<S: Simd>(&mut self, simd: S, pairing: &Pairing) -> (Distances, usize) {
        let len = std::mem::take(&mut self.len);
        (distances(simd, &self.corners, pairing), len)
    }
}

/// Corners of a triangle in its tree's frame.
#[inline]
fn units(mesh: &TriMesh, triangle: usize) -> [Vec3; 3] {
    mesh.corners(triangle).map(|p| mesh.tree.frame.to_units(p))
}

/// Nearest points of two triangles, robustly, in units and axes of A's tree.
pub(super) fn settle(a: &TriMesh, ta: usize, b: &TriMesh, tb: usize, pairing: &Pairing) -> Near {
    triangle_triangle(units(a, ta), units(b, tb).map(|p| pairing.to_a(p)))
}
