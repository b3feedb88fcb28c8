//! Distance: first a good upper bound, then the proof that nothing is nearer.

use elbowroom_spatial::{Pose, Vec3};
use fearless_simd::{Simd, dispatch};

use super::leaf::{along_direction, along_normals, filled};
use super::limit::Limit;
use super::node::{NEAREST, step};
use super::placement::{Pairing, offset};
use super::search::settle;
use super::search::{Entry, Queue, Scratch, Visits, filling, side};
use super::swallowed::swallowed;
use super::toward::{Spot, nearest_child, nearest_leaf, spot_of};
use super::tree::LEAF;
use super::within::Pair;
use crate::TriMesh;
use crate::triangle::Near;

/// How far apart two meshes are, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Metres; 0 on contact, and where one mesh lies inside the other.
    pub distance: f64,
    /// Proven: the exact distance is not below this, metres.
    pub lower_bound: f64,
    /// Nearest point of the first mesh, in the world. Inside: a point of the inner mesh, twice.
    pub on_a: Vec3,
    /// Nearest point of the second mesh, in the world.
    pub on_b: Vec3,
    /// The nearest triangles.
    pub pair: Pair,
    /// Where to begin when the same two meshes have moved a little.
    pub hint: Hint,
}

/// A pair of triangles that was nearest once. With other meshes than those it came from it is only a bad beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Hint {
    a: u32,
    b: u32,
}

/// Distance of two meshes.
///
/// ```
/// use elbowroom_proximity::{TriMesh, wide::{Scratch, TriMesh, distance}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
/// let wide = TriMesh::new(mesh.into());
/// let there = Pose::from_translation(Vec3::X * 1.5);
/// let near = distance(&wide, &Pose::IDENTITY, &wide, &there, &mut Scratch::new());
/// assert!((near.distance - 0.5).abs() < 1e-12 && near.lower_bound <= near.distance);
/// assert!((near.on_a - Vec3::X).length() < 1e-12);
/// ```
pub fn distance(a: &TriMesh, a_in_world: &Pose, b: &TriMesh, b_in_world: &Pose, scratch: &mut Scratch) -> Nearest {
    let found = distance_at(a, a_in_world, b, b_in_world, f64::INFINITY, None, scratch);
    found.unwrap_or_else(|| unknown(a_in_world, b_in_world))
}

/// Like [`distance`], or `None` where the meshes are certainly farther apart than `limit` metres; `hint` is the
/// [`Nearest::hint`] of an earlier answer for the same meshes and changes the time only, never the answer.
pub fn distance_at(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    limit: f64,
    hint: Option<Hint>,
    scratch: &mut Scratch,
) -> Option<Nearest> {
    scratch.visits = Visits::default();
    if !(a_in_world.is_finite() && b_in_world.is_finite()) {
        return Some(unknown(a_in_world, b_in_world));
    }
    let between = offset(&a.tree.frame, a_in_world, &b.tree.frame, b_in_world);
    let far = between.abs().max_element() + a_in_world.translation.abs().max_element();
    let reach = (a.tree.radius + b.tree.radius + limit) * (1.0 + 1e-12) + far * 1e-12;
    if between.length_squared() > reach * reach {
        return None;
    }
    let pairing = Pairing::new(&a.tree, a_in_world, &b.tree, b_in_world);
    if !pairing.slack.is_finite() {
        return Some(unknown(a_in_world, b_in_world));
    }
    let unit = a.tree.frame.unit;
    let radius = limit.max(0.0) / unit + pairing.slack;
    let level = scratch.level;
    let found = dispatch!(level, simd => search(simd, a, b, &pairing, radius, hint, scratch));
    let touching = found.is_some_and(|f| f.distance <= pairing.slack);
    if !touching && let Some(p) = swallowed(a, a_in_world, b, b_in_world) {
        let hint = found.map_or(Hint::default(), |f| f.hint);
        return Some(Nearest { distance: 0.0, lower_bound: 0.0, on_a: p, on_b: p, pair: Pair::Inside, hint });
    }
    let found = found?;
    let to_world = |p: Vec3| a_in_world.transform_point(p * unit + a.tree.frame.center);
    let exact = found.near.squared.sqrt();
    let measured = if touching || exact <= pairing.slack { 0.0 } else { exact * unit };
    Some(Nearest {
        distance: measured,
        lower_bound: (measured - 2.0 * pairing.slack * unit).max(0.0),
        on_a: to_world(found.near.on_a),
        on_b: to_world(found.near.on_b),
        pair: Pair::Triangles(found.triangles.0, found.triangles.1),
        hint: found.hint,
    })
}

fn unknown(a_in_world: &Pose, b_in_world: &Pose) -> Nearest {
    Nearest {
        distance: 0.0,
        lower_bound: 0.0,
        on_a: a_in_world.translation,
        on_b: b_in_world.translation,
        pair: Pair::Unknown,
        hint: Hint::default(),
    }
}

/// The best so far, units of A.
#[derive(Clone, Copy)]
struct Best {
    distance: f64,
    near: Near,
    triangles: (u32, u32),
    hint: Hint,
}

struct Search<'a> {
    a: &'a TriMesh,
    b: &'a TriMesh,
    pairing: &'a Pairing,
    limit: Limit,
    radius: f64,
    best: Option<Best>,
    queue: &'a mut Queue,
    slots: [(u32, u32); LEAF],
    visits: Visits,
}

#[inline(always)]
fn search<S: Simd>(
    simd: S,
    a: &TriMesh,
    b: &TriMesh,
    pairing: &Pairing,
    radius: f64,
    hint: Option<Hint>,
    scratch: &mut Scratch,
) -> Option<Best> {
    let Scratch { stack, queue, visits, .. } = scratch;
    queue.len = 0;
    stack.clear();
    let mut limit = Limit::new(radius, pairing);
    if radius.is_finite() {
        limit.tighten(radius, Vec3::ZERO, pairing.to_a(Vec3::ZERO), pairing);
    }
    let slots = [(0, 0); LEAF];
    let mut s = Search { a, b, pairing, limit, radius, best: None, queue, slots, visits: Visits::default() };
    s.open(simd, Entry::root(&a.tree, &b.tree), stack);
    if !stack.is_empty() {
        s.begin(simd, hint);
        s.prove(simd, stack);
    }
    *visits = s.visits;
    s.best
}

impl Search<'_> {
    /// Looks for a good upper bound: the hint, else a greedy descent; then from side to side as long as it helps.
    #[inline(always)]
    fn begin<S: Simd>(&mut self, simd: S, hint: Option<Hint>) {
        let (ab, ba) = (self.pairing.ab, self.pairing.ba);
        let start = hint.filter(|h| h.a < self.a.tree.order.len() as u32 && h.b < self.b.tree.order.len() as u32);
        let start = start.unwrap_or_else(|| {
            let (la, lb) = self.descend(simd);
            Hint { a: (la * LEAF) as u32, b: (lb * LEAF) as u32 }
        });
        let (mut leaf_a, mut leaf_b) = (start.a as usize / LEAF, start.b as usize / LEAF);
        self.settle_slots(start.a, start.b);
        self.leaves(simd, leaf_a, leaf_b);
        self.flush(simd);
        for round in 0..8 {
            let Some(best) = self.best else { return };
            if best.distance <= self.pairing.slack {
                return;
            }
            let next = if round % 2 == 0 {
                let spot = Spot { center: best.near.on_a.to_array().map(|x| x as f32), half: [0.0; 3] };
                (best.hint.a as usize / LEAF, nearest_leaf(simd, &self.b.tree, &ab, &spot))
            } else {
                let p = self.to_b(best.near.on_b);
                let spot = Spot { center: p.to_array().map(|x| x as f32), half: [0.0; 3] };
                (nearest_leaf(simd, &self.a.tree, &ba, &spot), best.hint.b as usize / LEAF)
            };
            if next == (leaf_a, leaf_b) {
                if round > 0 {
                    return;
                }
                continue;
            }
            (leaf_a, leaf_b) = next;
            self.leaves(simd, leaf_a, leaf_b);
            self.flush(simd);
        }
    }

    fn to_b(&self, p: Vec3) -> Vec3 {
        let (m, s) = (&self.pairing.exact, 1.0 / (self.pairing.scale * self.pairing.scale));
        let q = [p.x - m[0][3], p.y - m[1][3], p.z - m[2][3]];
        Vec3::from(std::array::from_fn::<f64, 3, _>(|k| (m[0][k] * q[0] + m[1][k] * q[1] + m[2][k] * q[2]) * s))
    }

    /// A leaf of each tree, reached by turns.
    #[inline(always)]
    fn descend<S: Simd>(&self, simd: S) -> (usize, usize) {
        let (a, b) = (&self.a.tree, &self.b.tree);
        let (ab, ba) = (&self.pairing.ab, &self.pairing.ba);
        let (mut ha, mut na, mut hb, mut nb) = (a.height(), 0, b.height(), 0);
        while ha > 0 || hb > 0 {
            if hb > 0 && hb >= ha {
                nb = nearest_child(simd, b, hb, nb, ab, &spot_of(a, ha, na));
                hb -= 1;
            }
            if ha > 0 && ha > hb {
                na = nearest_child(simd, a, ha, na, ba, &spot_of(b, hb, nb));
                ha -= 1;
            }
        }
        (na, nb)
    }

    /// Measures one pair at once.
    fn settle_slots(&mut self, slot_a: u32, slot_b: u32) {
        let (ta, tb) = (self.a.tree.triangle(slot_a), self.b.tree.triangle(slot_b));
        let near = settle(self.a, ta, self.b, tb, self.pairing);
        self.offer(near.squared.sqrt(), Some(near), (ta as u32, tb as u32), Hint { a: slot_a, b: slot_b });
    }

    /// Keeps the nearer; of equals the one with the smaller numbers, so that no order of tests shows.
    #[inline(always)]
    fn offer(&mut self, distance: f64, near: Option<Near>, triangles: (u32, u32), hint: Hint) {
        if !(distance <= self.radius) {
            return;
        }
        if let Some(best) = &self.best
            && (best.distance, best.triangles) <= (distance, triangles)
        {
            return;
        }
        let near =
            near.unwrap_or_else(|| settle(self.a, triangles.0 as usize, self.b, triangles.1 as usize, self.pairing));
        let nearer = self.best.is_none_or(|b| distance < b.distance);
        self.best = Some(Best { distance, near, triangles, hint });
        if nearer {
            self.radius = distance;
            self.limit.tighten(distance, near.on_a, near.on_b, self.pairing);
        }
    }

    /// Measures the queue.
    #[inline(always)]
    fn flush<S: Simd>(&mut self, simd: S) {
        if self.queue.len == 0 {
            return;
        }
        let (found, len) = self.queue.measure(simd, self.pairing);
        self.visits.triangles += len as u32;
        // Doubtless lanes first: they may spare the doubtful ones.
        for doubtful in [false, true] {
            for lane in 0..len {
                if (found.at_least[lane] < found.distance[lane]) != doubtful || found.at_least[lane] > self.radius {
                    continue;
                }
                let triangles = self.queue.triangles[lane];
                let hint = Hint { a: self.slots[lane].0, b: self.slots[lane].1 };
                if doubtful {
                    let near = settle(self.a, triangles.0 as usize, self.b, triangles.1 as usize, self.pairing);
                    self.offer(near.squared.sqrt(), Some(near), triangles, hint);
                } else {
                    self.offer(found.distance[lane], None, triangles, hint);
                }
            }
        }
    }

    #[inline(always)]
    fn leaves<S: Simd>(&mut self, simd: S, leaf_a: usize, leaf_b: usize) {
        self.visits.leaves += 1;
        let (a, b) = (&self.a.tree, &self.b.tree);
        let all = filled(filling(a, leaf_a), filling(b, leaf_b));
        let mut left = along_direction(simd, &a.leaves[leaf_a], &b.leaves[leaf_b], &self.limit, all);
        if left.0 != 0 {
            left = along_normals(simd, &a.leaves[leaf_a], &b.leaves[leaf_b], self.pairing, &self.limit, left);
        }
        let mut left = left.0;
        while left != 0 {
            let bit = left.trailing_zeros();
            left &= left - 1;
            let (slot_a, slot_b) = (leaf_a as u32 * LEAF as u32 + bit / 8, leaf_b as u32 * LEAF as u32 + bit % 8);
            self.slots[self.queue.len] = (slot_a, slot_b);
            if self.queue.push(self.a, slot_a, self.b, slot_b) {
                self.flush(simd);
            }
        }
    }

    #[inline(always)]
    fn open<S: Simd>(&mut self, simd: S, pair: Entry, stack: &mut Vec<Entry>) {
        if pair.is_leaves() {
            stack.push(pair);
            return;
        }
        self.visits.nodes += 1;
        let (open_a, open_b) = pair.opens();
        let side_a = side(&self.a.tree, pair.a, pair.height_a, open_a);
        let side_b = side(&self.b.tree, pair.b, pair.height_b, open_b);
        self.visits.boxes += step::<S, NEAREST>(simd, side_a, side_b, self.pairing, &self.limit, |i, j, gap| {
            stack.push(pair.child(i, j, gap));
        });
    }

    /// Opens every pair of nodes that may be nearer than the best.
    #[inline(always)]
    fn prove<S: Simd>(&mut self, simd: S, stack: &mut Vec<Entry>) {
        // What the first step left was found without an upper bound: begin again.
        stack.clear();
        stack.push(Entry::root(&self.a.tree, &self.b.tree));
        while let Some(pair) = stack.pop() {
            if self.best.is_some_and(|b| b.distance <= self.pairing.slack) {
                return;
            }
            if pair.gap > self.limit.gap {
                continue;
            }
            if pair.is_leaves() {
                self.leaves(simd, pair.a as usize, pair.b as usize);
            } else {
                self.open(simd, pair, stack);
            }
        }
        self.flush(simd);
    }
}
