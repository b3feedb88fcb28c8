//! Which lines and corners of the outlines matter to sixteen rows.
//!
//! Over sixteen rows the elbow moves on an arc about the shoulder. Most lines have it on one side all the time, most corners
//! are within the forearm's reach all the time or never: only the others are looked at row by row.

use fearless_simd::{Simd, SimdBase, SimdMask};

use super::convex::{Outlines, Shared};
use super::fan::Fan;
use super::lanes::{F, WIDTH, load, splat};

/// One bit per line of a fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Bits {
    pub bits: u64,
    /// Lines of the fan.
    count: u32,
}

impl Bits {
    fn empty(count: usize) -> Self {
        Self { bits: 0, count: count as u32 }
    }

    fn push<S: Simd>(&mut self, at: usize, mask: fearless_simd::mask32x16<S>) {
        self.bits |= mask.to_bitmask() << at;
    }

    fn all(self) -> u64 {
        !0 >> (64 - self.count)
    }

    /// Each line takes its bit from the line before it.
    pub fn before(self) -> u64 {
        (self.bits << 1 | self.bits >> (self.count - 1)) & self.all()
    }

    /// Each line takes its bit from the line after it.
    pub fn after(self) -> u64 {
        (self.bits >> 1 | self.bits << (self.count - 1)) & self.all()
    }

    pub fn has(self, k: usize) -> bool {
        self.bits >> k & 1 == 1
    }
}

/// Numbers of the bits that are set, ascending.
pub(super) fn each(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let k = (bits != 0).then(|| bits.trailing_zeros() as usize)?;
        bits &= bits - 1;
        Some(k)
    })
}

/// The elbow's arc over some rows: its middle, shoulder's frame, and cosine and sine of half the angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    pub middle: [f32; 2],
    pub half: [f32; 2],
}

/// Bounds of `c·x + s·y` while the elbow is on its arc.
#[derive(Clone, Copy)]
struct Range<S: Simd> {
    lo: F<S>,
    hi: F<S>,
}

impl<S: Simd> Range<S> {
    /// Of `along·cos t + across·sin t`, for `t` within half the arc to both sides.
    #[inline(always)]
    fn of(along: F<S>, across: F<S>, [cos, sin]: [F<S>; 2]) -> Self {
        let (turned, swing) = (along * cos, across.abs() * sin);
        Self { lo: along.min(turned) - swing, hi: along.max(turned) + swing }
    }
}

/// Along and across the direction of the elbow.
#[inline(always)]
fn turned<S: Simd>([x, y]: [F<S>; 2], elbow: [F<S>; 2]) -> [F<S>; 2] {
    [x * elbow[0] + y * elbow[1], x * elbow[1] - y * elbow[0]]
}

/// What is certain for all sixteen rows, what is possible for some.
#[derive(Debug)]
pub(super) struct Sieve {
    /// Lines of the forearm's outline with the elbow outside.
    pub front: Bits,
    pub may_front: Bits,
    /// Those that the elbow is farther outside of than this matters: see [`Shared::clear`].
    pub clear: u64,
    /// Lines of the wrist's outline with the elbow outside.
    pub wrist_front: u64,
    /// Corners of the wrist's outline within the forearm's reach.
    pub reached: Bits,
    pub may_reach: Bits,
    /// Lines of the wrist's outline that the wrist's circle may cross twice between their corners: the elbow outside, inside.
    pub poke: u64,
    pub poke_out: u64,
}

impl Sieve {
    #[inline(always)]
    pub fn new<S: Simd>(simd: S, shared: &Shared, outlines: &Outlines, arc: Arc) -> Self {
        let Outlines { fan, fore, wrist, .. } = outlines;
        let s = |value: f32| splat(simd, value);
        let none = Bits::empty(fan.count);
        let mut sieve = Self {
            front: none,
            may_front: none,
            clear: 0,
            wrist_front: 0,
            reached: none,
            may_reach: none,
            poke: 0,
            poke_out: 0,
        };
        let slack = s(shared.margin);
        let length = s(shared.arm.fore_length_m as f32 + shared.margin);
        let half = [s(arc.half[0]), s(arc.half[1])];
        let elbow = [s(arc.middle[0]), s(arc.middle[1])];
        let (mut poke, mut poke_out, mut clear) = (none, none, none);
        let mut wrist_front = none;
        for at in (0..fan.count).step_by(WIDTH) {
            let [x, y] = [load(simd, &fan.x[at..]), load(simd, &fan.y[at..])];
            let [along, across] = turned([x, y], elbow);
            let reach = Range::of(along, across, half);
            if fore.exists {
                let far = load(simd, &fore.far[at..]);
                sieve.front.push(at, far.simd_lt(reach.lo - slack));
                sieve.may_front.push(at, far.simd_lt(reach.hi + slack));
                clear.push(at, far.simd_lt(reach.lo - s(shared.clear)));
            }
            let [corner_x, corner_y] = [load(simd, &wrist.corner_x[at..]), load(simd, &wrist.corner_y[at..])];
            let limit = load(simd, &outlines.reached_from[at..]);
            let [along_corner, across_corner] = turned([corner_x, corner_y], elbow);
            let toward = Range::of(along_corner, across_corner, half);
            sieve.reached.push(at, limit.simd_le(toward.lo - slack));
            sieve.may_reach.push(at, limit.simd_le(toward.hi + slack));
            let far = load(simd, &wrist.far[at..]);
            let foot = Range::of(across, along, half);
            wrist_front.push(at, far.simd_lt(reach.lo - slack));
            let [from, to] = [load(simd, &wrist.from[at..]), load(simd, &wrist.to[at..])];
            let before = (far - reach.lo).simd_ge(-length);
            let beside = (from - slack).simd_le(foot.hi) & foot.lo.simd_le(to + slack);
            poke.push(at, before & beside & far.simd_lt(reach.hi + slack));
            poke_out.push(at, beside & (far - reach.hi).simd_le(length) & far.simd_ge(reach.lo - slack));
        }
        let all = none.all();
        for bits in [&mut sieve.front, &mut sieve.may_front, &mut sieve.reached, &mut sieve.may_reach] {
            bits.bits &= all;
        }
        // With a corner certainly within reach the circle crosses the line once.
        let open = !(sieve.reached.bits | sieve.reached.after());
        (sieve.poke, sieve.poke_out) = (poke.bits & all & open, poke_out.bits & all & open);
        (sieve.clear, sieve.wrist_front) = (clear.bits & all, wrist_front.bits & all);
        sieve
    }

    /// True where none of the rows can be blocked by forearm or wrist.
    pub fn is_free(&self) -> bool {
        self.may_reach.bits == 0 && self.poke == 0 && self.wrist_front != 0
    }

    /// Lines of the forearm's outline that are looked at row by row, and those whose neighbour before them is.
    pub fn front_edges(&self) -> (Bits, u64) {
        let mixed = Bits { bits: self.may_front.bits & !self.front.bits, ..self.front };
        (mixed, mixed.bits | mixed.before() | (self.front.bits ^ self.front.before()))
    }

    /// Corners of the wrist's outline that are looked at row by row, and the lines between corners that may differ.
    pub fn crossed(&self) -> (Bits, u64) {
        let mixed = Bits { bits: self.may_reach.bits & !self.reached.bits, ..self.reached };
        (mixed, mixed.bits | mixed.after() | (self.reached.bits ^ self.reached.after()))
    }
}

/// By what corner `k` turns up within reach of an elbow on its circle: `corner·elbow ≥ this`.
#[inline(always)]
pub(super) fn reached_from<S: Simd>(
    simd: S,
    shared: &Shared,
    fan: &Fan,
    outline: &super::outline::Outline,
    out: &mut [f32; super::fan::SIZE],
) {
    let (upper, fore) = (shared.arm.upper_length_m, shared.arm.fore_length_m);
    let squares = splat(simd, (upper * upper - fore * fore) as f32);
    for at in (0..fan.count).step_by(WIDTH) {
        let [x, y] = [load(simd, &outline.corner_x[at..]), load(simd, &outline.corner_y[at..])];
        let limit = (x * x + y * y + squares) * splat(simd, 0.5);
        limit.store_slice(&mut out[at..at + WIDTH]);
    }
}
