//! The f32 kernel of nodes: tests children of one node against children of another, sixteen at a time.

use fearless_simd::{Simd, dispatch, prelude::*};

use super::cutoff::{Cutoff, WitnessFrame};
use super::mesh_pair::MeshPair;
use super::node_pair::{NodePair, NodePairStack, Sides};
use super::relative_placement::{AffineF32, RelativePlacement};
use crate::bvh::{ARITY, Bvh16, Node};
use crate::lanes::{V3, W16, abs16, array16, load16, rows16, splat16, store16};

/// Mode of an intersection test: gaps along single axes decide.
pub(super) const INTERSECTION: u8 = 0;
/// Mode of a distance or tolerance query: squared distances decide.
pub(super) const DISTANCE: u8 = 1;

/// Pushes the pairs of children of `pair` that may be within the cutoff, the pair with the smallest key last, and
/// returns the number of 16-lane tests.
pub(super) fn expand<const MODE: u8>(
    meshes: &MeshPair,
    pair: &NodePair,
    cutoff: &Cutoff,
    stack: &mut NodePairStack,
) -> u32 {
    expand_sides::<MODE>(meshes, pair, pair.expanded_sides(), cutoff, stack)
}

/// Like [`expand`], for one side, both sides or none: a node that is not expanded is tested itself.
pub(super) fn expand_sides<const MODE: u8>(
    meshes: &MeshPair,
    pair: &NodePair,
    expanded: Sides,
    cutoff: &Cutoff,
    stack: &mut NodePairStack,
) -> u32 {
    dispatch!(meshes.simd_level, simd => expand_in::<_, MODE>(simd, meshes, pair, expanded, cutoff, stack))
}

/// [`expand_sides`] for an instruction set that the caller has selected.
#[inline(always)]
pub(super) fn expand_in<S: Simd, const MODE: u8>(
    simd: S,
    meshes: &MeshPair,
    pair: &NodePair,
    expanded: Sides,
    cutoff: &Cutoff,
    stack: &mut NodePairStack,
) -> u32 {
    let first = stack.len();
    let side_a = side(&meshes.a.bvh, pair.a, pair.height_a, expanded.a);
    let side_b = side(&meshes.b.bvh, pair.b, pair.height_b, expanded.b);
    let mut best = (f32::INFINITY, first);
    let tests = test_children::<_, MODE>(simd, side_a, side_b, meshes.placement, cutoff, |i, j, key| {
        if key < best.0 {
            best = (key, stack.len());
        }
        stack.push(pair.child_of(expanded, i, j, key));
    });
    stack.bring_to_top(best.1);
    tests
}

/// The box of a node in the frame and units of its own tree.
#[derive(Clone, Copy)]
struct NodeBox {
    center: [f32; 3],
    half: [f32; 3],
}

/// A node with a mask of the lanes to test.
#[derive(Clone, Copy)]
struct Side<'a> {
    node: &'a Node,
    mask: u32,
    /// The box of the node itself.
    own: NodeBox,
}

/// The lanes to test: all children if the node is expanded; otherwise the node's own lane in its parent.
#[inline(always)]
fn side(tree: &Bvh16, number: u32, height: u8, expanded: bool) -> Side<'_> {
    let (number, height) = (number as usize, height as usize);
    let (parent, lane) = tree.parent(height, number);
    let at = |p: &[[f32; ARITY]; 3]| [p[0][lane], p[1][lane], p[2][lane]];
    let own = NodeBox { center: at(&parent.center), half: at(&parent.half) };
    if expanded {
        Side { node: tree.node(height, number), mask: tree.children(height, number), own }
    } else {
        Side { node: parent, mask: 1 << lane, own }
    }
}

/// Calls `emit(i, j, key)` for every pair of children that may be within the cutoff, and returns the number of
/// 16-lane tests.
///
/// A negative key is the smallest depth of overlap along any tested axis. Other keys are the gap ([`INTERSECTION`])
/// or a lower bound of the squared distance, in units of A.
#[inline(always)]
fn test_children<S: Simd, const MODE: u8>(
    simd: S,
    a: Side,
    b: Side,
    placement: &RelativePlacement,
    cutoff: &Cutoff,
    emit: impl FnMut(usize, usize, f32),
) -> u32 {
    let (b_in_a, a_in_b) = (&placement.b_in_a, &placement.a_in_b);
    let (ca, ha) = (load16(simd, &a.node.center), load16(simd, &a.node.half));
    let (cb, hb) = (load16(simd, &b.node.center), load16(simd, &b.node.half));
    let (mut rows, mut columns) = (b.mask, a.mask);
    let (cb_in_a, hb_in_a) = placed_boxes(simd, cb, hb, b_in_a);
    rows &= !beyond::<S, MODE>(simd, cb_in_a, hb_in_a, a.own, cutoff.gap, cutoff.squared);
    if MODE == INTERSECTION && rows == 0 {
        return 1;
    }
    let (ca_in_b, ha_in_b) = placed_boxes(simd, ca, ha, a_in_b);
    // In units of B, rounded up once more.
    let (gap, squared) =
        (cutoff.gap * a_in_b.scale * 1.000_001, cutoff.squared * (a_in_b.scale * a_in_b.scale) * 1.000_001);
    columns &= !beyond::<S, MODE>(simd, ca_in_b, ha_in_b, b.own, gap, squared);
    if MODE == INTERSECTION && columns == 0 {
        return 2;
    }
    if rows == 0 || columns == 0 {
        return 2;
    }
    let intervals = match &cutoff.witness_frame {
        Some(frame) if MODE != INTERSECTION => {
            let intervals = WitnessIntervals::new(simd, a.node, b.node, frame);
            let (row, column) = intervals.beyond(simd, &a, &b, frame, cutoff.squared);
            (rows, columns) = (rows & !row, columns & !column);
            if rows == 0 || columns == 0 {
                return 3;
            }
            Some(intervals)
        }
        _ => None,
    };
    let slab_a = SlabsOfA::new(simd, a.node, b_in_a);
    let slabs_b = SlabsOfB::new(simd, b.node, b_in_a);
    let lanes_a = LanesOfA { ca, ha, ca_in_b, ha_in_b, slab: slab_a };
    let (cb_in_a, hb_in_a) = (store16(cb_in_a), store16(hb_in_a));
    let rows_b = RowsOfB { node: b.node, center_in_a: &cb_in_a, half_in_a: &hb_in_a, slabs: &slabs_b, b_in_a };
    test_rows::<S, MODE>(simd, (rows, columns), &lanes_a, &rows_b, intervals.as_ref(), cutoff, emit)
}

/// Tests children of B (the bits of `rows`), one at a time, against all children of A (the bits of `columns`).
///
/// Calls `emit` as [`test_children`] does; returns the number of 16-lane tests, with the two of whole nodes before.
#[inline(always)]
fn test_rows<S: Simd, const MODE: u8>(
    simd: S,
    (mut rows, columns): (u32, u32),
    lanes_a: &LanesOfA<S>,
    b: &RowsOfB,
    intervals: Option<&WitnessIntervals<S>>,
    cutoff: &Cutoff,
    mut emit: impl FnMut(usize, usize, f32),
) -> u32 {
    let mut keys = [0.0f32; 16];
    let zero = W16::splat(simd, 0.0);
    let square_scale = b.b_in_a.scale * b.b_in_a.scale;
    let mut tests = 2;
    while rows != 0 {
        let j = rows.trailing_zeros() as usize;
        rows &= rows - 1;
        tests += 1;
        let mut square = W16::splat(simd, 0.0);
        if MODE != INTERSECTION
            && let Some(intervals) = intervals
        {
            square = intervals.square(simd, j);
            if columns & !(square.simd_gt(cutoff.squared).to_bitmask() as u32) == 0 {
                continue;
            }
        }
        let (gap_a, square_a) =
            gaps::<S, MODE>(simd, lanes_a.ca, lanes_a.ha, lane(b.center_in_a, j), lane(b.half_in_a, j));
        let (gap_b, square_b) =
            gaps::<S, MODE>(simd, lanes_a.ca_in_b, lanes_a.ha_in_b, lane(&b.node.center, j), lane(&b.node.half, j));
        let slab = lanes_a
            .slab
            .gap(simd, lane(b.center_in_a, j), lane(&b.node.half, j))
            .max(b.slabs.gap(simd, j, lanes_a.ca, lanes_a.ha));
        let gap = gap_a.max(gap_b * b.b_in_a.scale).max(slab);
        let (key, out) = if MODE == INTERSECTION {
            (gap, gap.simd_gt(cutoff.gap))
        } else {
            let apart = gap.max(zero);
            let square = square.max(square_a).max(square_b * square_scale).max(apart * apart);
            (square.simd_gt(zero).select(square, gap), square.simd_gt(cutoff.squared))
        };
        let left = columns & !(out.to_bitmask() as u32);
        if left != 0 {
            key.store_slice(&mut keys);
            let mut left = left;
            while left != 0 {
                let i = left.trailing_zeros() as usize;
                left &= left - 1;
                emit(i, j, keys[i]);
            }
        }
    }
    tests
}

#[inline(always)]
fn lane(p: &[[f32; 16]; 3], j: usize) -> [f32; 3] {
    [p[0][j], p[1][j], p[2][j]]
}

#[inline(always)]
fn absolute(v: [f32; 3]) -> [f32; 3] {
    [v[0].abs(), v[1].abs(), v[2].abs()]
}

/// Children of B, taken one at a time.
struct RowsOfB<'a> {
    node: &'a Node,
    center_in_a: &'a [[f32; 16]; 3],
    half_in_a: &'a [[f32; 16]; 3],
    slabs: &'a SlabsOfB,
    b_in_a: &'a AffineF32,
}

/// Children of A, in sixteen lanes.
struct LanesOfA<S: Simd> {
    ca: V3<W16<S>>,
    ha: V3<W16<S>>,
    ca_in_b: V3<W16<S>>,
    ha_in_b: V3<W16<S>>,
    slab: SlabsOfA<S>,
}

/// Boxes of one frame, enclosed in boxes of the other frame.
#[inline(always)]
fn placed_boxes<S: Simd>(simd: S, c: V3<W16<S>>, h: V3<W16<S>>, p: &AffineF32) -> (V3<W16<S>>, V3<W16<S>>) {
    (c.placed(&rows16(simd, &p.m), splat16(simd, p.t)), h.mapped(&rows16(simd, &p.abs)))
}

/// Largest gap along the three axes, and the sum of squares of the positive ones.
#[inline(always)]
fn gaps<S: Simd, const MODE: u8>(
    simd: S,
    c: V3<W16<S>>,
    h: V3<W16<S>>,
    center: [f32; 3],
    half: [f32; 3],
) -> (W16<S>, W16<S>) {
    let x = (c.0 - center[0]).abs() - (h.0 + half[0]);
    let y = (c.1 - center[1]).abs() - (h.1 + half[1]);
    let z = (c.2 - center[2]).abs() - (h.2 + half[2]);
    let zero = W16::splat(simd, 0.0);
    let mut square = zero;
    if MODE != INTERSECTION {
        let (x, y, z) = (x.max(zero), y.max(zero), z.max(zero));
        square = x * x + y * y + z * z;
    }
    (x.max(y).max(z), square)
}

/// Lanes that are farther than the limit from the box `own`.
#[inline(always)]
fn beyond<S: Simd, const MODE: u8>(
    simd: S,
    c: V3<W16<S>>,
    h: V3<W16<S>>,
    own: NodeBox,
    limit: f32,
    squared: f32,
) -> u32 {
    let (gap, square) = gaps::<S, MODE>(simd, c, h, own.center, own.half);
    if MODE == INTERSECTION {
        gap.simd_gt(limit).to_bitmask() as u32
    } else {
        square.simd_gt(squared).to_bitmask() as u32
    }
}

/// Slabs of A's children (lanes) against one box of B.
struct SlabsOfA<S: Simd> {
    normal: V3<W16<S>>,
    /// Absolute values of the normals in B's axes, times the ratio of units.
    spread: V3<W16<S>>,
    low: W16<S>,
    high: W16<S>,
}

impl<S: Simd> SlabsOfA<S> {
    #[inline(always)]
    fn new(simd: S, node: &Node, b_in_a: &AffineF32) -> Self {
        let normal = load16(simd, &node.normal);
        let m = &b_in_a.m;
        let transposed = [[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]];
        let spread = abs16(normal.mapped(&rows16(simd, &transposed)));
        let (low, high) = (W16::load_array_ref(simd, &node.low), W16::load_array_ref(simd, &node.high));
        Self { normal, spread, low, high }
    }

    #[inline(always)]
    fn gap(&self, simd: S, center_in_a: [f32; 3], half: [f32; 3]) -> W16<S> {
        let p = self.normal.dot(splat16(simd, center_in_a));
        let reach = self.spread.dot(splat16(simd, half));
        (p - self.high).max(self.low - p) - reach
    }
}

/// Slabs of B's children, one at a time, against the boxes of A (lanes), in units of A.
struct SlabsOfB {
    normal: [[f32; 16]; 3],
    low: [f32; 16],
    high: [f32; 16],
}

impl SlabsOfB {
    #[inline(always)]
    fn new<S: Simd>(simd: S, node: &Node, b_in_a: &AffineF32) -> Self {
        let normal = load16(simd, &node.normal).mapped(&rows16(simd, &b_in_a.r));
        let offset = normal.dot(splat16(simd, b_in_a.t));
        let (mut low, mut high) = ([0.0; 16], [0.0; 16]);
        (W16::load_array_ref(simd, &node.low) * b_in_a.scale + offset).store_slice(&mut low);
        (W16::load_array_ref(simd, &node.high) * b_in_a.scale + offset).store_slice(&mut high);
        Self { normal: store16(normal), low, high }
    }

    #[inline(always)]
    fn gap<S: Simd>(&self, simd: S, j: usize, center: V3<W16<S>>, half: V3<W16<S>>) -> W16<S> {
        let n = [self.normal[0][j], self.normal[1][j], self.normal[2][j]];
        let p = center.dot(splat16(simd, n));
        let reach = half.dot(splat16(simd, absolute(n)));
        (p - self.high[j]).max(W16::splat(simd, self.low[j]) - p) - reach
    }
}

/// Both nodes' children as intervals along the axes of a [`WitnessFrame`].
struct WitnessIntervals<S: Simd> {
    /// A: upper end along the line; middle and half width along the other two axes.
    far: W16<S>,
    middle: (W16<S>, W16<S>),
    half: (W16<S>, W16<S>),
    /// B: lower end along the line; middle and half width along the other two axes.
    near_b: [f32; 16],
    middle_b: ([f32; 16], [f32; 16]),
    half_b: ([f32; 16], [f32; 16]),
    /// Intervals of all children of B at once.
    near: W16<S>,
    across_b: [(W16<S>, W16<S>); 2],
}

impl<S: Simd> WitnessIntervals<S> {
    #[inline(always)]
    fn new(simd: S, a: &Node, b: &Node, frame: &WitnessFrame) -> Self {
        let (ca, ha) = (load16(simd, &a.center), load16(simd, &a.half));
        let (cb, hb) = (load16(simd, &b.center), load16(simd, &b.half));
        let far = reach(simd, a, ca, ha, frame.of_a[0]);
        let [x, y, z] = frame.of_b[0];
        let near = W16::splat(simd, frame.shift[0]) - reach(simd, b, cb, hb, [-x, -y, -z]);
        let (mu, hu) = across(simd, ca, ha, frame.of_a[1]);
        let (mv, hv) = across(simd, ca, ha, frame.of_a[2]);
        let (bu, ku) = across(simd, cb, hb, frame.of_b[1]);
        let (bv, kv) = across(simd, cb, hb, frame.of_b[2]);
        let (bu, bv) = (bu + frame.shift[1], bv + frame.shift[2]);
        Self {
            near,
            across_b: [(bu, ku), (bv, kv)],
            far,
            middle: (mu, mv),
            half: (hu, hv),
            near_b: array16(near),
            middle_b: (array16(bu), array16(bv)),
            half_b: (array16(ku), array16(kv)),
        }
    }

    /// Children of B and of A that are farther than `limit` (squared) from the whole of the other node.
    #[inline(always)]
    fn beyond(&self, simd: S, a: &Side, b: &Side, frame: &WitnessFrame, limit: f32) -> (u32, u32) {
        let zero = W16::splat(simd, 0.0);
        let (near, [(bu, ku), (bv, kv)]) = (self.near, self.across_b);
        let (u, hu) = own_across(a, frame.of_a[1]);
        let (v, hv) = own_across(a, frame.of_a[2]);
        let n = (near - self.far.reduce_max()).max(zero);
        let (du, dv) = (((bu - u).abs() - (ku + hu)).max(zero), ((bv - v).abs() - (kv + hv)).max(zero));
        let rows = (n * n + du * du + dv * dv).simd_gt(limit).to_bitmask() as u32;
        let (u, hu) = own_across(b, frame.of_b[1]);
        let (v, hv) = own_across(b, frame.of_b[2]);
        let (u, v) = (u + frame.shift[1], v + frame.shift[2]);
        let n = (W16::splat(simd, near.reduce_min()) - self.far).max(zero);
        let du = ((self.middle.0 - u).abs() - (self.half.0 + hu)).max(zero);
        let dv = ((self.middle.1 - v).abs() - (self.half.1 + hv)).max(zero);
        (rows, (n * n + du * du + dv * dv).simd_gt(limit).to_bitmask() as u32)
    }

    /// Lower bound of the squared distance of A's children from child `j` of B.
    #[inline(always)]
    fn square(&self, simd: S, j: usize) -> W16<S> {
        let zero = W16::splat(simd, 0.0);
        let n = (W16::splat(simd, self.near_b[j]) - self.far).max(zero);
        let u = ((self.middle.0 - self.middle_b.0[j]).abs() - (self.half.0 + self.half_b.0[j])).max(zero);
        let v = ((self.middle.1 - self.middle_b.1[j]).abs() - (self.half.1 + self.half_b.1[j])).max(zero);
        n * n + u * u + v * v
    }
}

/// Middle and half width of a node's own box along an axis.
#[inline(always)]
fn own_across(side: &Side, d: [f32; 3]) -> (f32, f32) {
    let NodeBox { center: c, half: h } = &side.own;
    let e = absolute(d);
    (c[0] * d[0] + c[1] * d[1] + c[2] * d[2], h[0] * e[0] + h[1] * e[1] + h[2] * e[2])
}

/// Middle and half width of boxes along an axis.
#[inline(always)]
fn across<S: Simd>(simd: S, c: V3<W16<S>>, h: V3<W16<S>>, axis: [f32; 3]) -> (W16<S>, W16<S>) {
    (c.dot(splat16(simd, axis)), h.dot(splat16(simd, absolute(axis))))
}

/// Upper bound of the height of each child along `d`: from its box, or from its slab for the component of `d` along
/// the slab's normal and from its box for the rest.
#[inline(always)]
fn reach<S: Simd>(simd: S, node: &Node, c: V3<W16<S>>, h: V3<W16<S>>, d: [f32; 3]) -> W16<S> {
    let d = splat16(simd, d);
    let normal = load16(simd, &node.normal);
    let zero = W16::splat(simd, 0.0);
    let along = normal.dot(d);
    let end = along.simd_ge(zero).select(W16::load_array_ref(simd, &node.high), W16::load_array_ref(simd, &node.low));
    let rest = d.minus(normal.times(along));
    let by_slab = along * end + c.dot(rest) + h.dot(abs16(rest));
    let by_box = c.dot(d) + h.dot(abs16(d));
    by_box.min(by_slab)
}
