//! Children of one node against children of another, sixteen at a time.

use fearless_simd::{Simd, prelude::*};

use super::lanes::{V3, W16, abs16, bits, load16, rows16, splat16, store16};
use super::limit::Limit;
use super::placement::{Pairing, Placement};
use super::tree::Node;

/// Which tests decide.
pub(super) const TOUCH: u8 = 0;
pub(super) const NEAR: u8 = 1;
pub(super) const NEAREST: u8 = 2;

/// A node of which the children in `mask` are asked about.
#[derive(Clone, Copy)]
pub(super) struct Side<'a> {
    pub node: &'a Node,
    pub mask: u32,
    /// The box of the node itself, a lane of its parent.
    pub own: ([f32; 3], [f32; 3]),
}

/// Calls `emit(i, j, gap)` for every pair of children that may be within the limit; `gap` (units of A) is the largest
/// separation found along any axis, negative where the boxes overlap. Returns the number of 16-lane tests.
#[inline(always)]
pub(super) fn step<S: Simd, const MODE: u8>(
    simd: S,
    a: Side,
    b: Side,
    pairing: &Pairing,
    limit: &Limit,
    mut emit: impl FnMut(usize, usize, f32),
) -> u32 {
    let (ab, ba) = (&pairing.ab, &pairing.ba);
    let (ca, ha) = (load16(simd, &a.node.center), load16(simd, &a.node.half));
    let (cb, hb) = (load16(simd, &b.node.center), load16(simd, &b.node.half));
    let (mut rows, mut columns) = (b.mask, a.mask);
    let mut reach_a = W16::splat(simd, 0.0);
    let mut reach_b = [0.0f32; 16];
    if MODE == NEAREST {
        reach_a = support(simd, ca, ha, limit.direction_a);
        let far = reach_a.reduce_max();
        let reach = support(simd, V3(-cb.0, -cb.1, -cb.2), hb, limit.direction_b);
        rows &= !((reach + far).simd_lt(limit.reach).to_bitmask() as u32);
        reach.store_slice(&mut reach_b);
        if rows == 0 {
            return 1;
        }
    }
    let (cb_in_a, hb_in_a) = seen(simd, cb, hb, ab);
    if rows & (rows - 1) != 0 {
        rows &= !beyond::<S, MODE>(simd, cb_in_a, hb_in_a, a.own, limit.gap, limit.squared_a);
    }
    if rows == 0 {
        return 1;
    }
    let (ca_in_b, ha_in_b) = seen(simd, ca, ha, ba);
    if columns & (columns - 1) != 0 {
        // In units of B, rounded up once more.
        let gap = limit.gap * ba.scale * 1.000_001;
        columns &= !beyond::<S, MODE>(simd, ca_in_b, ha_in_b, b.own, gap, limit.squared_b);
    }
    if columns == 0 {
        return 2;
    }
    let lanes_a = LanesOfA { ca, ha, ca_in_b, ha_in_b, slab: SlabsOfA::new(simd, a.node, ab) };
    let (cb_in_a, hb_in_a) = (store16(cb_in_a), store16(hb_in_a));
    let slabs_b = SlabsOfB::new(simd, b.node, ab);
    let mut keys = [0.0f32; 16];
    let mut tests = 2;
    for j in bits(rows) {
        let mut out = W16::splat(simd, 0.0).simd_lt(0.0);
        if MODE == NEAREST {
            let left = columns & !((reach_a + reach_b[j]).simd_lt(limit.reach).to_bitmask() as u32);
            if left == 0 {
                continue;
            }
        }
        tests += 1;
        let at = |p: &[[f32; 16]; 3]| [p[0][j], p[1][j], p[2][j]];
        let (gap_a, square_a) = gaps::<S, MODE>(simd, lanes_a.ca, lanes_a.ha, at(&cb_in_a), at(&hb_in_a));
        let (gap_b, square_b) =
            gaps::<S, MODE>(simd, lanes_a.ca_in_b, lanes_a.ha_in_b, at(&b.node.center), at(&b.node.half));
        let slab = lanes_a.slab.gap(simd, at(&cb_in_a), at(&b.node.half)).max(slabs_b.gap(simd, j, ca, ha));
        let gap = gap_a.max(gap_b * ab.scale).max(slab);
        out = out | gap.simd_gt(limit.gap);
        if MODE != TOUCH {
            out = out | square_a.simd_gt(limit.squared_a) | square_b.simd_gt(limit.squared_b);
        }
        if MODE == NEAREST {
            out = out | (reach_a + reach_b[j]).simd_lt(limit.reach);
        }
        let left = columns & !(out.to_bitmask() as u32);
        if left != 0 {
            gap.store_slice(&mut keys);
            for i in bits(left) {
                emit(i, j, keys[i]);
            }
        }
    }
    tests
}

struct LanesOfA<S: Simd> {
    ca: V3<W16<S>>,
    ha: V3<W16<S>>,
    ca_in_b: V3<W16<S>>,
    ha_in_b: V3<W16<S>>,
    slab: SlabsOfA<S>,
}

/// Farthest reach of each box along a direction.
#[inline(always)]
fn support<S: Simd>(simd: S, center: V3<W16<S>>, half: V3<W16<S>>, direction: [f32; 3]) -> W16<S> {
    center.dot(splat16(simd, direction)) + half.dot(splat16(simd, direction.map(f32::abs)))
}

/// Boxes of one frame as boxes of the other.
#[inline(always)]
fn seen<S: Simd>(simd: S, c: V3<W16<S>>, h: V3<W16<S>>, p: &Placement) -> (V3<W16<S>>, V3<W16<S>>) {
    (c.mapped(&rows16(simd, &p.m)).plus(splat16(simd, p.t)), h.mapped(&rows16(simd, &p.abs)))
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
    let one = |c: W16<S>, h: W16<S>, k: usize| (c - center[k]).abs() - (h + half[k]);
    let (x, y, z) = (one(c.0, h.0, 0), one(c.1, h.1, 1), one(c.2, h.2, 2));
    let zero = W16::splat(simd, 0.0);
    let mut square = zero;
    if MODE != TOUCH {
        let (x, y, z) = (x.max(zero), y.max(zero), z.max(zero));
        square = x * x + y * y + z * z;
    }
    (x.max(y).max(z), square)
}

#[inline(always)]
fn beyond<S: Simd, const MODE: u8>(
    simd: S,
    c: V3<W16<S>>,
    h: V3<W16<S>>,
    own: ([f32; 3], [f32; 3]),
    limit: f32,
    squared: f32,
) -> u32 {
    let (gap, square) = gaps::<S, MODE>(simd, c, h, own.0, own.1);
    if MODE == TOUCH { gap.simd_gt(limit).to_bitmask() as u32 } else { square.simd_gt(squared).to_bitmask() as u32 }
}

/// Slabs of A's children (lanes) against one box of B.
struct SlabsOfA<S: Simd> {
    normal: V3<W16<S>>,
    /// Absolute normals in B's axes, times the ratio of units.
    spread: V3<W16<S>>,
    low: W16<S>,
    high: W16<S>,
}

impl<S: Simd> SlabsOfA<S> {
    #[inline(always)]
    fn new(simd: S, node: &Node, ab: &Placement) -> Self {
        let normal = load16(simd, &node.normal);
        let m = &ab.m;
        let transposed = std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]));
        let spread = abs16(normal.mapped(&rows16(simd, &transposed)));
        let at = |x: &[f32; 16]| W16::load_array_ref(simd, x);
        Self { normal, spread, low: at(&node.low), high: at(&node.high) }
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
    fn new<S: Simd>(simd: S, node: &Node, ab: &Placement) -> Self {
        let normal = load16(simd, &node.normal).mapped(&rows16(simd, &ab.r));
        let offset = normal.dot(splat16(simd, ab.t));
        let (mut low, mut high) = ([0.0; 16], [0.0; 16]);
        (W16::load_array_ref(simd, &node.low) * ab.scale + offset).store_slice(&mut low);
        (W16::load_array_ref(simd, &node.high) * ab.scale + offset).store_slice(&mut high);
        Self { normal: store16(normal), low, high }
    }

    #[inline(always)]
    fn gap<S: Simd>(&self, simd: S, j: usize, center: V3<W16<S>>, half: V3<W16<S>>) -> W16<S> {
        let n = [self.normal[0][j], self.normal[1][j], self.normal[2][j]];
        let p = center.dot(splat16(simd, n));
        let reach = half.dot(splat16(simd, n.map(f32::abs)));
        (p - self.high[j]).max(W16::splat(simd, self.low[j]) - p) - reach
    }
}
