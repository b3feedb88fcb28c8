//! What every traversal shares: the stack, the queue of triangle pairs, the counts.

use std::cell::RefCell;
use std::sync::OnceLock;

use fearless_simd::{Level, dispatch};

use super::exact::{BATCH, Corners, Distances, distances};
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
    /// Pairs of leaves opened, each of up to eight triangles.
    pub leaves: u32,
    /// Pairs of triangles that f32 could not decide.
    pub triangles: u32,
    /// Batches of up to eight such pairs measured in f64.
    pub batches: u32,
}

/// Memory that queries use again: one per thread. It never allocates, and nothing of an answer depends on what was
/// asked before.
#[derive(Debug)]
pub struct Scratch {
    pub(super) stack: Stack,
    pub(super) queue: Queue,
    level: Option<Level>,
    pub(super) visits: Visits,
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}

impl Scratch {
    /// For the best instruction set of this processor.
    pub const fn new() -> Self {
        Self { stack: Stack::new(), queue: Queue::new(), level: None, visits: Visits::ZERO }
    }

    /// For a given instruction set.
    #[doc(hidden)]
    pub const fn with_level(level: Level) -> Self {
        Self { level: Some(level), ..Self::new() }
    }

    /// Work done by the last query on two meshes.
    pub fn visits(&self) -> Visits {
        self.visits
    }

    #[inline]
    pub(super) fn level(&self) -> Level {
        self.level.unwrap_or_else(detected_level)
    }
}

/// The best instruction set of this processor, asked for once.
#[inline]
pub(super) fn detected_level() -> Level {
    static DETECTED: OnceLock<Level> = OnceLock::new();
    *DETECTED.get_or_init(Level::new)
}

/// Runs a query with this thread's own memory, which is static: the first use does not allocate either.
pub(crate) fn with_scratch<T>(query: impl FnOnce(&mut Scratch) -> T) -> T {
    thread_local! { static SCRATCH: RefCell<Scratch> = const { RefCell::new(Scratch::new()) } }
    SCRATCH.with_borrow_mut(query)
}

impl Visits {
    const ZERO: Self = Self { nodes: 0, boxes: 0, leaves: 0, triangles: 0, batches: 0 };
}

/// Each step down pushes at most 256 pairs and takes one away; trees over 2³² triangles in leaves of 8 are 8 high, and
/// pairs of unequal height push 16 a step until they are equal.
const DEPTH: usize = 8 * 256 + 8 * 16;

/// Pairs of nodes still to be opened, last in first out.
#[derive(Debug)]
pub(super) struct Stack {
    entries: [Entry; DEPTH],
    len: usize,
    overflown: bool,
}

impl Stack {
    #[allow(
        clippy::large_stack_arrays,
        reason = "it lives in static or boxed memory; making it is not part of a query"
    )]
    const fn new() -> Self {
        let blank = Entry { a: 0, b: 0, key: 0.0, height_a: 0, height_b: 0 };
        Self { entries: [blank; DEPTH], len: 0, overflown: false }
    }

    pub fn clear(&mut self) {
        (self.len, self.overflown) = (0, false);
    }

    pub fn len(&self) -> usize {
        self.len
    }

    /// True where a pair was lost: an answer of "apart" would prove nothing.
    pub fn overflown(&self) -> bool {
        self.overflown
    }

    #[inline(always)]
    pub fn push(&mut self, entry: Entry) {
        match self.entries.get_mut(self.len) {
            Some(slot) => (*slot, self.len) = (entry, self.len + 1),
            None => self.overflown = true,
        }
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<Entry> {
        self.len = self.len.checked_sub(1)?;
        self.entries.get(self.len).copied()
    }

    /// Makes this entry the next.
    #[inline(always)]
    pub fn bring_to_top(&mut self, number: usize) {
        if number < self.len && self.len <= DEPTH {
            self.entries.swap(number, self.len - 1);
        }
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
        self.child_as(self.opens(), i, j, key)
    }

    /// The same where these are opened.
    #[inline(always)]
    pub fn child_as(&self, (open_a, open_b): (bool, bool), i: usize, j: usize, key: f32) -> Self {
        let (a, height_a) =
            if open_a { (self.a * FAN as u32 + i as u32, self.height_a - 1) } else { (self.a, self.height_a) };
        let (b, height_b) =
            if open_b { (self.b * FAN as u32 + j as u32, self.height_b - 1) } else { (self.b, self.height_b) };
        Self { a, b, key, height_a, height_b }
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
    len: usize,
    corners: Corners,
}

impl Queue {
    const fn new() -> Self {
        Self { triangles: [(0, 0); BATCH], len: 0, corners: Corners::ZERO }
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
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
    pub fn measure(&mut self, level: Level, pairing: &Pairing) -> (Distances, usize) {
        let len = std::mem::take(&mut self.len);
        (dispatch!(level, simd => distances(simd, &self.corners, pairing)), len)
    }
}

/// Corners of a triangle in its tree's frame.
#[inline(always)]
fn units(mesh: &TriMesh, triangle: usize) -> [Vec3; 3] {
    let [p, q, r] = mesh.triangles()[triangle];
    let at = |i: u32| mesh.tree.frame.to_units(mesh.vertices()[i as usize]);
    [at(p), at(q), at(r)]
}

/// Corners of a triangle of each, in units and axes of A's tree.
#[inline(always)]
pub(super) fn corners_in_a(
    a: &TriMesh,
    ta: usize,
    b: &TriMesh,
    tb: usize,
    pairing: &Pairing,
) -> ([Vec3; 3], [Vec3; 3]) {
    let [p, q, r] = units(b, tb);
    (units(a, ta), [pairing.in_a(p), pairing.in_a(q), pairing.in_a(r)])
}

/// Nearest points of two triangles, robustly, in units and axes of A's tree.
pub(super) fn settle(a: &TriMesh, ta: usize, b: &TriMesh, tb: usize, pairing: &Pairing) -> Near {
    let (s, t) = corners_in_a(a, ta, b, tb, pairing);
    triangle_triangle(s, t)
}
