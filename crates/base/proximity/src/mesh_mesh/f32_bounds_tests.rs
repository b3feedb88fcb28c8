//! Checks of every f32 decision in f64: boxes contain their triangles, and pairs within the cutoff are kept.

use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::Random;
use fearless_simd::{Level as SimdLevel, dispatch};

use super::cutoff::{Cutoff, WitnessFrame};
use super::leaf_kernel::{LeafIntervals, LeafPair, PairMask, pairs_within, touching_pairs};
use super::mesh_pair::MeshPair;
use super::node_kernel::{DISTANCE, INTERSECTION, expand};
use super::node_pair::NodePair;
use super::relative_placement::RelativePlacement;
use super::triangle_batch::corners_in_a;
use super::workspace::Workspace;
use crate::TriMesh;
use crate::bvh::{ARITY, Bvh16, LEAF_SIZE, Node};
use crate::triangle::triangle_triangle;

/// Random meshes and poses.
trait RandomMeshes {
    fn vector(&mut self) -> Vec3;

    /// A wavy strip: neighbours in space are neighbours in the tree, and some triangles are slivers.
    fn strip(&mut self, count: usize) -> TriMesh;

    /// A second pose at which the surfaces are near each other.
    fn pose(&mut self, a: &TriMesh, here: &Pose, b: &TriMesh) -> Pose;
}

impl RandomMeshes for Random {
    fn vector(&mut self) -> Vec3 {
        Vec3::from(self.within(1.0))
    }

    fn strip(&mut self, count: usize) -> TriMesh {
        let size = 10f64.powf(3.0 * self.unit() - 2.0);
        let off = self.vector() * 10f64.powf(4.0 * self.unit() - 2.0);
        let (twist, thin) = (self.unit(), 10f64.powf(-4.0 * self.unit()));
        let point = |k: usize, n: &mut Self| {
            let (t, side) = (k as f64 / count as f64, (k % 2) as f64 * thin);
            let path = Vec3::new((9.0 * t).sin(), (7.0 * t * (1.0 + twist)).cos(), t);
            off + (path + Vec3::new(side, side * twist, 0.0) + n.vector() * (0.02 * thin)) * size
        };
        let vertices: Vec<Vec3> = (0..count + 2).map(|k| point(k, self)).collect();
        TriMesh::new(vertices, (0..count as u32).map(|k| [k, k + 1, k + 2]).collect()).unwrap()
    }

    fn pose(&mut self, a: &TriMesh, here: &Pose, b: &TriMesh) -> Pose {
        let rotation = Rotation::from_rpy(6.0 * self.unit(), 6.0 * self.unit(), 6.0 * self.unit());
        let (p, q) = (a.vertices()[self.index(a.vertices().len())], b.vertices()[self.index(b.vertices().len())]);
        let size = a.aabb().extent().length().min(b.aabb().extent().length());
        let apart = self.vector() * (size * 10f64.powf(-4.0 * self.unit()));
        Pose { rotation, translation: here.transform_point(p) + apart - rotation * q }
    }
}

/// Number of decisions to check.
fn cases(usual: usize) -> usize {
    elbowroom_testkit::extent::amount(usual, 10_000_000)
}

#[test]
fn boxes_and_slabs_hold_their_triangles() {
    let mut n = Random(1);
    for count in [1, 7, 8, 9, 100, 130, 2_000, 40_000] {
        let mesh = n.strip(count);
        let tree = &mesh.bvh;
        for (height, level) in tree.levels.iter().enumerate() {
            let span = ARITY.pow(height as u32) * LEAF_SIZE;
            for (m, node) in level.iter().enumerate() {
                for lane in 0..ARITY {
                    let first = (m * ARITY + lane) * span;
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
    let at = |x: &[[f32; ARITY]; 3]| Vec3::new(x[0][lane].into(), x[1][lane].into(), x[2][lane].into());
    let (outside, h) = ((p - at(&node.center)).abs(), at(&node.half));
    assert!(outside.x <= h.x && outside.y <= h.y && outside.z <= h.z, "{p:?} is outside by {:?}", outside - h);
    let along = at(&node.normal).dot(p);
    assert!(f64::from(node.low[lane]) <= along && along <= f64::from(node.high[lane]));
    assert!(at(&node.normal).length() <= 1.0);
}

/// A child of a node in f64: its box and slab, in the frame of its own tree.
struct Child {
    center: Vec3,
    half: Vec3,
    normal: Vec3,
    low: f64,
    high: f64,
}

fn child(tree: &Bvh16, height: u8, number: u32) -> Child {
    let (node, lane) = tree.parent(height as usize, number as usize);
    let at = |x: &[[f32; ARITY]; 3]| Vec3::new(x[0][lane].into(), x[1][lane].into(), x[2][lane].into());
    let (low, high) = (node.low[lane].into(), node.high[lane].into());
    Child { center: at(&node.center), half: at(&node.half), normal: at(&node.normal), low, high }
}

/// The largest lower bound of the distance of two children, in units of A, with the formulas of `node_kernel.rs` in
/// f64.
fn bound(a: &Child, b: &Child, placement: &RelativePlacement, frame: Option<&WitnessFrame>) -> f64 {
    let column = |k: usize| Vec3::new(placement.exact[0][k], placement.exact[1][k], placement.exact[2][k]);
    // B's axes in A, each as long as B's unit.
    let axes = [column(0), column(1), column(2)];
    let center_b = placement.map_to_a(b.center);
    let half_b = axes[0].abs() * b.half.x + axes[1].abs() * b.half.y + axes[2].abs() * b.half.z;
    let outside = |c: Vec3, h: Vec3| (c.abs() - h).max(Vec3::ZERO);
    let in_a = outside(center_b - a.center, a.half + half_b).length();
    let between = a.center - center_b;
    let unit = 1.0 / scale(placement);
    let along = |k: usize| {
        let axis = axes[k] * unit;
        let reach = axis.abs().dot(a.half) + [b.half.x, b.half.y, b.half.z][k] * scale(placement);
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
    let offset = normal_b.dot(placement.map_to_a(Vec3::ZERO));
    let ends = (b.low * scale(placement) + offset, b.high * scale(placement) + offset);
    let slab_b = gap(normal_b, ends, a.center, normal_b.abs().dot(a.half));
    let in_frame = frame.map_or(0.0, |f| bound_in(f, a, b));
    in_a.max(in_b).max(slab_a).max(slab_b).max(in_frame)
}

/// Units of A per unit of B.
fn scale(placement: &RelativePlacement) -> f64 {
    placement.frame_b.unit / placement.frame_a.unit
}

/// The bound by the intervals along the axes of the witness frame.
fn bound_in(frame: &WitnessFrame, a: &Child, b: &Child) -> f64 {
    let wide = |x: &[f32; 3]| Vec3::new(x[0].into(), x[1].into(), x[2].into());
    let reach = |c: &Child, d: Vec3| {
        let along = c.normal.dot(d);
        let rest = d - c.normal * along;
        let by_slab = along * if along >= 0.0 { c.high } else { c.low } + rest.dot(c.center) + rest.abs().dot(c.half);
        by_slab.min(d.dot(c.center) + d.abs().dot(c.half))
    };
    let ahead = f64::from(frame.shift[0]) - reach(b, -wide(&frame.of_b[0])) - reach(a, wide(&frame.of_a[0]));
    let aside = |k: usize| {
        let (u, v) = (wide(&frame.of_a[k]), wide(&frame.of_b[k]));
        let apart = (u.dot(a.center) - v.dot(b.center) - f64::from(frame.shift[k])).abs();
        (apart - u.abs().dot(a.half) - v.abs().dot(b.half)).max(0.0)
    };
    // The axes are orthonormal up to f32 rounding.
    Vec3::new(ahead.max(0.0), aside(1), aside(2)).length() * (1.0 - 1e-6)
}

/// Expands one pair of nodes; returns how many pairs of children f32 excluded.
fn check_boxes<const MODE: u8>(meshes: &MeshPair, pair: &NodePair, cutoff: &Cutoff, radius: f64) -> usize {
    let MeshPair { a, b, placement, .. } = *meshes;
    let (a, b) = (&a.bvh, &b.bvh);
    let mut workspace = Workspace::new();
    expand::<MODE>(meshes, pair, cutoff, &mut workspace.stack);
    let mut kept = [[false; ARITY]; ARITY];
    let expanded = pair.expanded_sides();
    while let Some(entry) = workspace.stack.pop() {
        let lane = |expanded: bool, number: u32| if expanded { number as usize % ARITY } else { 0 };
        kept[lane(expanded.a, entry.a)][lane(expanded.b, entry.b)] = true;
    }
    let all = |tree: &Bvh16, expanded: bool, number: u32, height: u8| -> Vec<(u8, u32)> {
        if !expanded {
            return vec![(height, number)];
        }
        let count = tree.children(height.into(), number as usize).count_ones();
        (0..count).map(|i| (height - 1, number * ARITY as u32 + i)).collect()
    };
    let mut decided = 0;
    for (i, x) in all(a, expanded.a, pair.a, pair.height_a).into_iter().enumerate() {
        for (j, y) in all(b, expanded.b, pair.b, pair.height_b).into_iter().enumerate() {
            if !kept[i][j] {
                decided += 1;
                let frame = cutoff.witness_frame.as_ref().filter(|_| MODE != INTERSECTION);
                let exact = bound(&child(a, x.0, x.1), &child(b, y.0, y.1), placement, frame);
                // The own boxes of the nodes may have decided; the children are inside them.
                let own = bound(&child(a, pair.height_a, pair.a), &child(b, y.0, y.1), placement, None).max(bound(
                    &child(a, x.0, x.1),
                    &child(b, pair.height_b, pair.b),
                    placement,
                    None,
                ));
                assert!(exact.max(own) > radius, "left out at {exact} within {radius}");
            }
        }
    }
    decided
}

/// Checks one pair of leaves; returns how many pairs of triangles f32 excluded.
fn check_leaves(meshes: &MeshPair, pair: &NodePair, cutoff: &Cutoff, radius: f64) -> usize {
    let MeshPair { a, b, placement, .. } = *meshes;
    let leaves = LeafPair { a: pair.a as usize, b: pair.b as usize };
    let mut intervals = LeafIntervals::UNKNOWN;
    let touching = dispatch!(meshes.simd_level, simd => touching_pairs(simd, meshes, leaves, cutoff));
    let within = dispatch!(meshes.simd_level, simd => pairs_within(simd, meshes, leaves, cutoff, &mut intervals));
    let left = within.0 & touching.0;
    let mut decided = 0;
    for (i, j) in PairMask(leaves.all(meshes).0 & !left).lanes() {
        let slot = |leaf: u32, lane: u32| leaf * LEAF_SIZE as u32 + lane;
        let (ta, tb) = (a.bvh.triangle(slot(pair.a, i)), b.bvh.triangle(slot(pair.b, j)));
        let (s, t) = corners_in_a(a, ta, b, tb, placement);
        let exact = triangle_triangle(s, t).squared.sqrt();
        assert!(exact > radius, "left out at {exact} within {radius}");
        decided += 1;
    }
    decided
}

fn random_lanes(n: &mut Random, a: &Bvh16, b: &Bvh16, pair: &NodePair) -> (usize, usize) {
    let mut lane = |tree: &Bvh16, height: u8, number: u32| {
        n.index(tree.children(height.into(), number as usize).count_ones() as usize)
    };
    let expanded = pair.expanded_sides();
    let i = if expanded.a { lane(a, pair.height_a, pair.a) } else { 0 };
    (i, if expanded.b { lane(b, pair.height_b, pair.b) } else { 0 })
}

/// The distance of some pair of triangles, plus a relative 1e-12: a radius at which rounding matters.
fn distance_of_a_pair(n: &mut Random, meshes: &MeshPair, pair: &NodePair) -> Option<f64> {
    let MeshPair { a, b, placement, .. } = *meshes;
    let slot = |n: &mut Random, tree: &Bvh16, leaf: u32| {
        leaf * LEAF_SIZE as u32 + n.index(tree.leaf_len(leaf as usize)) as u32
    };
    let (slot_a, slot_b) = (slot(n, &a.bvh, pair.a), slot(n, &b.bvh, pair.b));
    let (s, t) = corners_in_a(a, a.bvh.triangle(slot_a), b, b.bvh.triangle(slot_b), placement);
    let exact = triangle_triangle(s, t).squared.sqrt();
    (exact > placement.f64_error).then_some(exact * (1.0 + 1e-12))
}

#[test]
fn pairs_left_out_in_f32_are_farther_than_the_cutoff() {
    let mut n = Random(2);
    let (mut boxes, mut triangles) = (0, 0);
    while boxes < cases(400_000) || triangles < cases(100_000) {
        let (size_a, size_b) = (1 + n.index(3_000), 1 + n.index(3_000));
        let (a, b) = (n.strip(size_a), n.strip(size_b));
        for _ in 0..20 {
            let here = Pose { rotation: Rotation::from_rpy(n.unit(), n.unit(), n.unit()), translation: n.vector() };
            let there = n.pose(&a, &here, &b);
            let placement = RelativePlacement::new(&a.bvh, &here, &b.bvh, &there);
            let meshes = MeshPair { a: &a, b: &b, placement: &placement, simd_level: SimdLevel::new() };
            let mut radius = if n.unit() < 0.3 { placement.f64_error } else { 10f64.powf(-5.0 * n.unit()) };
            let mut cutoff = Cutoff::new(radius, &placement);
            if n.unit() < 0.7 {
                cutoff.align(n.vector(), &placement);
            }
            // Down to the leaves by random children.
            let mut pair = NodePair::root(&a.bvh, &b.bvh);
            while !pair.is_leaves() {
                let (i, j) = random_lanes(&mut n, &a.bvh, &b.bvh, &pair);
                let next = pair.child(i, j, 0.0);
                // Half of the radii equal the bound of one pair of boxes, so that rounding decides.
                let ends = (child(&a.bvh, next.height_a, next.a), child(&b.bvh, next.height_b, next.b));
                let exact = bound(&ends.0, &ends.1, &placement, cutoff.witness_frame.as_ref());
                if n.unit() < 0.5 && exact > placement.f64_error {
                    radius = exact * (1.0 + 1e-12);
                    cutoff = cutoff.with_radius(radius, &placement);
                }
                boxes += check_boxes::<INTERSECTION>(&meshes, &pair, &cutoff, radius);
                boxes += check_boxes::<DISTANCE>(&meshes, &pair, &cutoff, radius);
                pair = next;
            }
            for _ in 0..8 {
                let sibling = |n: &mut Random, tree: &Bvh16, leaf: u32| {
                    let first = leaf / ARITY as u32 * ARITY as u32;
                    first + n.index((tree.leaves.len() - first as usize).min(ARITY)) as u32
                };
                let pair = NodePair { a: sibling(&mut n, &a.bvh, pair.a), b: sibling(&mut n, &b.bvh, pair.b), ..pair };
                let radius = distance_of_a_pair(&mut n, &meshes, &pair).unwrap_or(radius);
                cutoff = cutoff.with_radius(radius, &placement);
                triangles += check_leaves(&meshes, &pair, &cutoff, radius);
            }
        }
    }
    println!("{boxes} pairs of boxes and {triangles} pairs of triangles decided in f32, none wrongly");
}
