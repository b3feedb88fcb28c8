//! Culling of an outline's lines and corners for sixteen rows.
//!
//! Over sixteen rows the elbow moves on an arc about the shoulder. Most lines have the elbow on the same side for the
//! whole arc, and most corners are within reach of the forearm for the whole arc or never. Only the other lines and
//! corners are evaluated row by row.

use elbowroom_validity::lanes::simd::{Simd, SimdBase, SimdMask};

use super::context::{ConvexContext, Outlines};
use super::simd_math::{Lanes, WIDTH, load, splat};

/// One bit per line of an outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LineBits {
    pub bits: u64,
    /// Number of lines.
    count: u32,
}

impl LineBits {
    fn empty(count: usize) -> Self {
        Self { bits: 0, count: count as u32 }
    }

    fn push<S: Simd>(&mut self, at: usize, mask: elbowroom_validity::lanes::simd::mask32x16<S>) {
        self.bits |= mask.to_bitmask() << at;
    }

    fn all(self) -> u64 {
        !0 >> (64 - self.count)
    }

    /// The mask in which each line has the bit of the line before it.
    fn mask_from_before(self) -> u64 {
        (self.bits << 1 | self.bits >> (self.count - 1)) & self.all()
    }

    /// The mask in which each line has the bit of the line after it.
    fn mask_from_after(self) -> u64 {
        (self.bits >> 1 | self.bits << (self.count - 1)) & self.all()
    }

    pub fn contains(self, k: usize) -> bool {
        self.bits >> k & 1 == 1
    }
}

/// The elbow's arc over some rows: its middle in the shoulder's frame, cosine and sine of half the angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElbowArc {
    pub middle: [f32; 2],
    pub half: [f32; 2],
}

/// Bounds of `c·x + s·y` while the elbow is on its arc.
#[derive(Clone, Copy)]
struct ProductRange<S: Simd> {
    lo: Lanes<S>,
    hi: Lanes<S>,
}

impl<S: Simd> ProductRange<S> {
    /// Bounds of `along·cos t + across·sin t`, for `t` within half the arc to both sides.
    #[inline(always)]
    fn new(along: Lanes<S>, across: Lanes<S>, [cos, sin]: [Lanes<S>; 2]) -> Self {
        let (turned, swing) = (along * cos, across.abs() * sin);
        Self { lo: along.min(turned) - swing, hi: along.max(turned) + swing }
    }
}

/// Components along and across the direction of the elbow.
#[inline(always)]
fn along_and_across<S: Simd>([x, y]: [Lanes<S>; 2], elbow: [Lanes<S>; 2]) -> [Lanes<S>; 2] {
    [x * elbow[0] + y * elbow[1], x * elbow[1] - y * elbow[0]]
}

/// Results that are certain for all sixteen rows, and results that are possible for some rows.
#[derive(Debug)]
pub(super) struct RowCulling {
    /// Lines of the forearm's outline with the elbow outside (certain; in `may_front` possible).
    pub front: LineBits,
    pub may_front: LineBits,
    /// Lines with the elbow farther outside than [`ConvexContext::clear`].
    pub clear: u64,
    /// Lines of the wrist's outline with the elbow outside.
    pub wrist_front: u64,
    /// Corners of the wrist's outline within reach of the forearm (certain; in `may_reach` possible).
    pub reached: LineBits,
    pub may_reach: LineBits,
    /// Lines of the wrist's outline that the wrist's circle may cross twice between their corners, with the elbow
    /// outside.
    pub double_entry: u64,
    /// Lines of the wrist's outline that the wrist's circle may cross twice between their corners, with the elbow
    /// inside.
    pub double_exit: u64,
}

impl RowCulling {
    #[inline(always)]
    pub fn new<S: Simd>(simd: S, context: &ConvexContext, outlines: &Outlines, arc: ElbowArc) -> Self {
        let Outlines { normals, fore, wrist, .. } = outlines;
        let s = |value: f32| splat(simd, value);
        let none = LineBits::empty(normals.count);
        let mut culling = Self {
            front: none,
            may_front: none,
            clear: 0,
            wrist_front: 0,
            reached: none,
            may_reach: none,
            double_entry: 0,
            double_exit: 0,
        };
        let slack = s(context.margin);
        let length = s(context.arm.fore_length_m as f32 + context.margin);
        let half = [s(arc.half[0]), s(arc.half[1])];
        let elbow = [s(arc.middle[0]), s(arc.middle[1])];
        let (mut double_entry, mut double_exit, mut clear) = (none, none, none);
        let mut wrist_front = none;
        for at in (0..normals.count).step_by(WIDTH) {
            let [x, y] = [load(simd, &normals.x[at..]), load(simd, &normals.y[at..])];
            let [along, across] = along_and_across([x, y], elbow);
            let reach = ProductRange::new(along, across, half);
            if fore.exists {
                let far = load(simd, &fore.far[at..]);
                culling.front.push(at, far.simd_lt(reach.lo - slack));
                culling.may_front.push(at, far.simd_lt(reach.hi + slack));
                clear.push(at, far.simd_lt(reach.lo - s(context.clear)));
            }
            let [corner_x, corner_y] = [load(simd, &wrist.corner_x[at..]), load(simd, &wrist.corner_y[at..])];
            let limit = load(simd, &outlines.reach_limits[at..]);
            let [along_corner, across_corner] = along_and_across([corner_x, corner_y], elbow);
            let toward = ProductRange::new(along_corner, across_corner, half);
            culling.reached.push(at, limit.simd_le(toward.lo - slack));
            culling.may_reach.push(at, limit.simd_le(toward.hi + slack));
            let far = load(simd, &wrist.far[at..]);
            let foot = ProductRange::new(across, along, half);
            wrist_front.push(at, far.simd_lt(reach.lo - slack));
            let [from, to] = [load(simd, &wrist.from[at..]), load(simd, &wrist.to[at..])];
            let before = (far - reach.lo).simd_ge(-length);
            let beside = (from - slack).simd_le(foot.hi) & foot.lo.simd_le(to + slack);
            double_entry.push(at, before & beside & far.simd_lt(reach.hi + slack));
            double_exit.push(at, beside & (far - reach.hi).simd_le(length) & far.simd_ge(reach.lo - slack));
        }
        let all = none.all();
        for bits in [&mut culling.front, &mut culling.may_front, &mut culling.reached, &mut culling.may_reach] {
            bits.bits &= all;
        }
        // If a corner is certainly within reach, the circle crosses the line once.
        let open = !(culling.reached.bits | culling.reached.mask_from_after());
        (culling.double_entry, culling.double_exit) = (double_entry.bits & all & open, double_exit.bits & all & open);
        (culling.clear, culling.wrist_front) = (clear.bits & all, wrist_front.bits & all);
        culling
    }

    /// Whether neither forearm nor wrist can block any of the rows.
    pub fn is_free(&self) -> bool {
        self.may_reach.bits == 0 && self.double_entry == 0 && self.wrist_front != 0
    }

    /// Lines of the forearm's outline that are evaluated row by row, and lines at which the side may change.
    pub fn front_edges(&self) -> (LineBits, u64) {
        let mixed = LineBits { bits: self.may_front.bits & !self.front.bits, ..self.front };
        (mixed, mixed.bits | mixed.mask_from_before() | (self.front.bits ^ self.front.mask_from_before()))
    }

    /// Corners of the wrist's outline that are evaluated row by row, and the lines between corners that may differ.
    pub fn crossing_edges(&self) -> (LineBits, u64) {
        let mixed = LineBits { bits: self.may_reach.bits & !self.reached.bits, ..self.reached };
        (mixed, mixed.bits | mixed.mask_from_after() | (self.reached.bits ^ self.reached.mask_from_after()))
    }
}
