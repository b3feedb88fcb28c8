//! Whatever f32 decides is decided again in f64: no box leaves its triangles out, and no pair is left out that is near.

use elbowroom_spatial::{Pose, Rotation, Vec3};
use fearless_simd::Level;

use super::leaf::{Facing, filled, near, touching};
use super::limit::{Limit, Sight};
use super::node::{NEAR, TOUCH, open};
use super::placement::Pairing;
use super::scratch::{Entry, Scratch, corners_in_a, filling};
use super::tree::{FAN, LEAF, Node, Tree};
use crate::TriMesh;
use crate::triangle::triangle_triangle;

struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(2.0 * self.next() - 1.0, 2.0 * self.next() - 1.0, 2.0 * self.next() - 1.0)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }

    /// A wavy strip: neighbours in space are neighbours in the tree, some of them slivers.
    fn strip(&mut self, count: usize) -> TriMesh {
        let size = 10f64.powf(3.0 * self.next() - 2.0);
        let off = self.vector() * 10f64.powf(4.0 * self.next() - 2.0);
        let (twist, thin) = (self.next(), 10f64.powf(-4.0 * self.next()));
        let point = |k: usize, n: &mut Self| {
            let (t, side) = (k as f64 / count as f64, (k % 2) as f64 * thin);
            let path = Vec3::new((9.0 * t).sin(), (7.0 * t * (1.0 + twist)).cos(), t);
            off + (path + Vec3::new(side, side * twist, 0.0) + n.vector() * (0.02 * thin)) * size
        };
        let vertices: Vec<Vec3> = (0..count + 2).map(|k| point(k, self)).collect();
        TriMesh::new(vertices, (0..count as u32).map(|k| [k, k + 1, k + 2]).collect()).unwrap()
    }

    /// A second pose for which surfaces are near each other.
    fn pose(&mut self, a: &TriMesh, here: &Pose, b: &TriMesh) -> Pose {
        let rotation = Rotation::from_rpy(6.0 * self.next(), 6.0 * self.next(), 6.0 * self.next());
        let (p, q) = (a.vertices()[self.below(a.vertices().len())], b.vertices()[self.below(b.vertices().len())]);
        let size = a.aabb().extent().length().min(b.aabb().extent().length());
        let apart = self.vector() * (size * 10f64.powf(-4.0 * self.next()));
        Pose { rotation, translation: here.transform_point(p) + apart - rotation * q }
    }
}

fn wanted(short: usize) -> usize {
    if std::env::var_os("ELBOWROOM_LONG").is_some() { 10_000_000 } else { short }
}

#[test]
fn boxes_and_slabs_hold_their_triangles() {
    let mut n = Numbers(1);
    for count in [1, 7, 8, 9, 100, 130, 2_000, 40_000] {
        let mesh = n.strip(count);
        let tree = &mesh.tree;
        for (above, level) in tree.levels.iter().enumerate() {
            let span = FAN.pow(above as u32) * LEAF;
            for (m, node) in level.iter().enumerate() {
                for lane in 0..FAN {
                    let first = (m * FAN + lane) * span;
                    for slot in first..(first + span).min(tree.order.len()) {
                        for corner in mesh.corners(tree.triangle(slot as u32)) {
                            assert_holds(node, lane, tree.frame.to_units(corner));
                        }
                    }
                }
            }
        }
    }
}

fn assert_holds(node: &Node, lane: usize, p: Vec3) {
    let at = |x: &[[f32; FAN]; 3]| Vec3::new(x[0][lane].into(), x[1][lane].into(), x[2][lane].into());
    let (outside, h) = ((p - at(&node.center)).abs(), at(&node.half));
    assert!(outside.x <= h.x && outside.y <= h.y && outside.z <= h.z, "{p:?} is outside by {:?}", outside - h);
    let along = at(&node.normal).dot(p);
    assert!(f64::from(node.low[lane]) <= along && along <= f64::from(node.high[lane]));
    assert!(at(&node.normal).length() <= 1.0);
}

/// A child of a node in f64: its box and slab, in its own tree's frame.
struct Child {
    center: Vec3,
    half: Vec3,
    normal: Vec3,
    low: f64,
    high: f64,
}

fn child(tree: &Tree, height: u8, number: u32) -> Child {
    let (node, lane) = (&tree.levels[height as usize][number as usize / FAN], number as usize % FAN);
    let at = |x: &[[f32; FAN]; 3]| Vec3::new(x[0][lane].into(), x[1][lane].into(), x[2][lane].into());
    let (low, high) = (node.low[lane].into(), node.high[lane].into());
    Child { center: at(&node.center), half: at(&node.half), normal: at(&node.normal), low, high }
}

/// The largest lower bound of the distance of two children, in units of A, by the formulas of `node.rs` in f64.
fn bound(a: &Child, b: &Child, pairing: &Pairing, sight: Option<&Sight>) -> f64 {
    let column = |k: usize| Vec3::new(pairing.exact[0][k], pairing.exact[1][k], pairing.exact[2][k]);
    // B's axes in A, each as long as B's unit.
    let axes = [column(0), column(1), column(2)];
    let center_b = pairing.in_a(b.center);
    let half_b = axes[0].abs() * b.half.x + axes[1].abs() * b.half.y + axes[2].abs() * b.half.z;
    let outside = |c: Vec3, h: Vec3| (c.abs() - h).max(Vec3::ZERO);
    let in_a = outside(center_b - a.center, a.half + half_b).length();
    let between = a.center - center_b;
    let unit = 1.0 / scale(pairing);
    let along = |k: usize| {
        let axis = axes[k] * unit;
        let reach = axis.abs().dot(a.half) + [b.half.x, b.half.y, b.half.z][k] * scale(pairing);
        (axis.dot(between).abs() - reach).max(0.0)
    };
    let in_b = Vec3::new(along(0), along(1), along(2)).length();
    let gap = |n: Vec3, (low, high): (f64, f64), c: Vec3, reach: f64| {
        let p = n.dot(c);
        (p - high).max(low - p) - reach
    };
    let reach_b = (0..3).map(|k| a.normal.dot(axes[k]).abs() * [b.half.x, b.half.y, b.half.z][k]).sum();
    let slab_a = gap(a.normal, (a.low, a.high), center_b, reach_b);
    let normal_b = (axes[0] * b.normal.x + axes[1] * b.normal.y + axes[2] * b.normal.z) * unit;
    let offset = normal_b.dot(pairing.in_a(Vec3::ZERO));
    let ends = (b.low * scale(pairing) + offset, b.high * scale(pairing) + offset);
    let slab_b = gap(normal_b, ends, a.center, normal_b.abs().dot(a.half));
    let seen = sight.map_or(0.0, |s| sighted(a, b, s));
    in_a.max(in_b).max(slab_a).max(slab_b).max(seen)
}

/// Units of A per unit of B.
fn scale(pairing: &Pairing) -> f64 {
    pairing.frame_b.unit / pairing.frame_a.unit
}

fn sighted(a: &Child, b: &Child, sight: &Sight) -> f64 {
    let wide = |x: &[f32; 3]| Vec3::new(x[0].into(), x[1].into(), x[2].into());
    let reach = |c: &Child, d: Vec3| {
        let facing = c.normal.dot(d);
        let rest = d - c.normal * facing;
        let by_slab = facing * if facing >= 0.0 { c.high } else { c.low } + rest.dot(c.center) + rest.abs().dot(c.half);
        by_slab.min(d.dot(c.center) + d.abs().dot(c.half))
    };
    let ahead = f64::from(sight.shift[0]) - reach(b, -wide(&sight.of_b[0])) - reach(a, wide(&sight.of_a[0]));
    let aside = |k: usize| {
        let (u, v) = (wide(&sight.of_a[k]), wide(&sight.of_b[k]));
        let apart = (u.dot(a.center) - v.dot(b.center) - f64::from(sight.shift[k])).abs();
        (apart - u.abs().dot(a.half) - v.abs().dot(b.half)).max(0.0)
    };
    // The axes are orthonormal up to f32 rounding.
    Vec3::new(ahead.max(0.0), aside(1), aside(2)).length() * (1.0 - 1e-6)
}

/// One pair of nodes opened; returns how many pairs of children f32 left out.
fn audit_boxes<const MODE: u8>(
    a: &Tree,
    b: &Tree,
    pair: &Entry,
    pairing: &Pairing,
    limit: &Limit,
    radius: f64,
) -> usize {
    let mut scratch = Scratch::new();
    open::<MODE>(Level::new(), (a, b), pair, pairing, limit, &mut scratch.stack);
    let mut kept = [[false; FAN]; FAN];
    let (open_a, open_b) = pair.opens();
    while let Some(entry) = scratch.stack.pop() {
        let lane = |opened: bool, number: u32| if opened { number as usize % FAN } else { 0 };
        kept[lane(open_a, entry.a)][lane(open_b, entry.b)] = true;
    }
    let all = |tree: &Tree, opened: bool, number: u32, height: u8| -> Vec<(u8, u32)> {
        if !opened {
            return vec![(height, number)];
        }
        let count = tree.children(height.into(), number as usize).count_ones();
        (0..count).map(|i| (height - 1, number * FAN as u32 + i)).collect()
    };
    let mut decided = 0;
    for (i, x) in all(a, open_a, pair.a, pair.height_a).into_iter().enumerate() {
        for (j, y) in all(b, open_b, pair.b, pair.height_b).into_iter().enumerate() {
            if !kept[i][j] {
                decided += 1;
                let sight = limit.sight.as_ref().filter(|_| MODE != TOUCH);
                let exact = bound(&child(a, x.0, x.1), &child(b, y.0, y.1), pairing, sight);
                // The own boxes of the nodes may have decided; children are inside them.
                let own = bound(&child(a, pair.height_a, pair.a), &child(b, y.0, y.1), pairing, None).max(bound(
                    &child(a, x.0, x.1),
                    &child(b, pair.height_b, pair.b),
                    pairing,
                    None,
                ));
                assert!(exact.max(own) > radius, "left out at {exact} within {radius}");
            }
        }
    }
    decided
}

/// One pair of leaves; returns how many pairs of triangles f32 left out.
fn audit_leaves(a: &TriMesh, b: &TriMesh, pair: &Entry, pairing: &Pairing, limit: &Limit, radius: f64) -> usize {
    let (leaf_a, leaf_b) = (pair.a as usize, pair.b as usize);
    let all = filled(filling(&a.tree, leaf_a), filling(&b.tree, leaf_b));
    let leaves = (&a.tree.leaves[leaf_a], &b.tree.leaves[leaf_b]);
    let mut facing = Facing::NOTHING;
    let left = near(Level::new(), leaves.0, leaves.1, pairing, limit, &mut facing, all)
        & touching(Level::new(), leaves.0, leaves.1, pairing, limit, all);
    let mut decided = 0;
    for bit in 0..64 {
        if (all.0 & !left) >> bit & 1 == 1 {
            let slot = |leaf: usize, lane: usize| (leaf * LEAF + lane) as u32;
            let (ta, tb) = (a.tree.triangle(slot(leaf_a, bit / 8)), b.tree.triangle(slot(leaf_b, bit % 8)));
            let (s, t) = corners_in_a(a, ta, b, tb, pairing);
            let exact = triangle_triangle(s, t).squared.sqrt();
            assert!(exact > radius, "left out at {exact} within {radius}");
            decided += 1;
        }
    }
    decided
}

fn random_lanes(n: &mut Numbers, a: &Tree, b: &Tree, pair: &Entry) -> (usize, usize) {
    let mut lane = |tree: &Tree, height: u8, number: u32| {
        n.below(tree.children(height.into(), number as usize).count_ones() as usize)
    };
    let (open_a, open_b) = pair.opens();
    let i = if open_a { lane(a, pair.height_a, pair.a) } else { 0 };
    (i, if open_b { lane(b, pair.height_b, pair.b) } else { 0 })
}

/// The distance of some pair of triangles, or a hair less than one: a limit at which rounding decides.
fn at_a_pair(n: &mut Numbers, a: &TriMesh, b: &TriMesh, pair: &Entry, pairing: &Pairing) -> Option<f64> {
    let slot =
        |n: &mut Numbers, tree: &Tree, leaf: u32| leaf * LEAF as u32 + n.below(filling(tree, leaf as usize)) as u32;
    let (slot_a, slot_b) = (slot(n, &a.tree, pair.a), slot(n, &b.tree, pair.b));
    let (s, t) = corners_in_a(a, a.tree.triangle(slot_a), b, b.tree.triangle(slot_b), pairing);
    let exact = triangle_triangle(s, t).squared.sqrt();
    (exact > pairing.slack).then_some(exact * (1.0 + 1e-12))
}

#[test]
fn what_f32_leaves_out_is_farther_than_the_limit() {
    let mut n = Numbers(2);
    let (mut boxes, mut triangles) = (0, 0);
    while boxes < wanted(400_000) || triangles < wanted(100_000) {
        let (size_a, size_b) = (1 + n.below(3_000), 1 + n.below(3_000));
        let (a, b) = (n.strip(size_a), n.strip(size_b));
        for _ in 0..20 {
            let here = Pose { rotation: Rotation::from_rpy(n.next(), n.next(), n.next()), translation: n.vector() };
            let there = n.pose(&a, &here, &b);
            let pairing = Pairing::new(&a.tree, &here, &b.tree, &there);
            let mut radius = if n.next() < 0.3 { pairing.slack } else { 10f64.powf(-5.0 * n.next()) };
            let mut limit = Limit::new(radius, &pairing);
            if n.next() < 0.7 {
                limit.look_along(n.vector(), &pairing);
            }
            // Down to the leaves on a random way.
            let mut pair = Entry::root(&a.tree, &b.tree);
            while !pair.is_leaves() {
                let (i, j) = random_lanes(&mut n, &a.tree, &b.tree, &pair);
                let next = pair.child(i, j, 0.0);
                // Half of the limits lie just where one pair of boxes is: there rounding decides.
                let ends = (child(&a.tree, next.height_a, next.a), child(&b.tree, next.height_b, next.b));
                let exact = bound(&ends.0, &ends.1, &pairing, limit.sight.as_ref());
                if n.next() < 0.5 && exact > pairing.slack {
                    radius = exact * (1.0 + 1e-12);
                    limit = limit.with_radius(radius, &pairing);
                }
                boxes += audit_boxes::<TOUCH>(&a.tree, &b.tree, &pair, &pairing, &limit, radius);
                boxes += audit_boxes::<NEAR>(&a.tree, &b.tree, &pair, &pairing, &limit, radius);
                pair = next;
            }
            for _ in 0..8 {
                let sibling = |n: &mut Numbers, tree: &Tree, leaf: u32| {
                    let first = leaf / FAN as u32 * FAN as u32;
                    first + n.below((tree.leaves.len() - first as usize).min(FAN)) as u32
                };
                let pair = Entry { a: sibling(&mut n, &a.tree, pair.a), b: sibling(&mut n, &b.tree, pair.b), ..pair };
                let radius = at_a_pair(&mut n, &a, &b, &pair, &pairing).unwrap_or(radius);
                limit = limit.with_radius(radius, &pairing);
                triangles += audit_leaves(&a, &b, &pair, &pairing, &limit, radius);
            }
        }
    }
    println!("{boxes} pairs of boxes and {triangles} pairs of triangles decided in f32, none wrongly");
}
