//! Forearm and wrist against their outlines, sixteen rows at a time.
//!
//! Seen from the elbow, what the forearm can touch begins and ends at a tangent to its outline, if the touched corner is
//! within reach, or where the end of the forearm crosses the outline. The end carries the wrist's sphere, whose outline holds
//! the forearm's: there the wrist is blocked too. So the forearm needs its tangents only, and the wrist the two points where
//! its circle enters and leaves its outline.
//!
//! Forearm and wrist together are blocked in one interval: the forearm's outline is convex, and every arc of the wrist meets
//! an angle at which the forearm touches, or there is but one (the part of the disk near a convex outline is convex).

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, mask32x16};

use super::convex::{Outlines, Shared};
use super::fan::Fan;
use super::lanes::{F, mad, splat};
use super::outline::Outline;
use super::sift::{Bits, Sieve, each};

type Mask<S> = mask32x16<S>;

/// Sixteen points, x and y.
pub(super) type Points<S> = [F<S>; 2];

/// Tangents from sixteen elbows to the forearm's outline.
pub(super) struct Forearm<S: Simd> {
    /// The elbow is inside, or so close that single precision cannot tell.
    pub inside: Mask<S>,
    /// Corners at which the outline begins and ends, counter-clockwise, seen from the elbow.
    pub lo: Points<S>,
    pub hi: Points<S>,
    /// Whether they are within reach.
    pub lo_reached: Mask<S>,
    pub hi_reached: Mask<S>,
    /// What single precision may have turned the tangents by, radians.
    pub widen: F<S>,
}

/// A yes or no for every line or corner and sixteen rows: certain for most.
#[derive(Clone, Copy)]
struct Known<'a, S: Simd> {
    outlines: &'a Outlines,
    mixed: Bits,
    certain: Bits,
    elbow: Points<S>,
}

impl<S: Simd> Known<'_, S> {
    /// Line `k` of the forearm's outline has the elbow outside.
    #[inline(always)]
    fn front(&self, simd: S, k: usize) -> Mask<S> {
        let Outlines { fan, fore, .. } = self.outlines;
        if self.mixed.has(k) {
            let [x, y, far] = [splat(simd, fan.x[k]), splat(simd, fan.y[k]), splat(simd, fore.far[k])];
            return far.simd_lt(mad(x, self.elbow[0], y * self.elbow[1]));
        }
        Mask::splat(simd, self.certain.has(k))
    }

    /// Corner `k` of the wrist's outline is within the forearm's reach.
    #[inline(always)]
    fn reached(&self, simd: S, k: usize) -> Mask<S> {
        let Outlines { wrist, reached_from, .. } = self.outlines;
        if self.mixed.has(k) {
            let [x, y, from] =
                [splat(simd, wrist.corner_x[k]), splat(simd, wrist.corner_y[k]), splat(simd, reached_from[k])];
            return from.simd_le(mad(x, self.elbow[0], y * self.elbow[1]));
        }
        Mask::splat(simd, self.certain.has(k))
    }

    fn next(&self, k: usize) -> usize {
        if k + 1 == self.outlines.fan.count { 0 } else { k + 1 }
    }
}

impl<S: Simd> Forearm<S> {
    #[inline(always)]
    pub fn of(simd: S, shared: &Shared, outlines: &Outlines, sieve: &Sieve, elbow: Points<S>) -> Self {
        let (fan, outline) = (&outlines.fan, &outlines.fore);
        let s = |value: f32| splat(simd, value);
        let (none, all, zero) = (Mask::splat(simd, false), Mask::splat(simd, true), s(0.0));
        let never =
            Self { inside: none, lo: [zero; 2], hi: [zero; 2], lo_reached: none, hi_reached: none, widen: zero };
        if !outline.exists {
            return never;
        }
        let (mixed, edges) = sieve.front_edges();
        let known = Known { outlines, mixed, certain: sieve.front, elbow };
        let (mut lo, mut hi) = ([zero; 2], [zero; 2]);
        let mut outside = if sieve.front.bits == 0 { none } else { all };
        let mut last = (usize::MAX, none);
        for k in each(edges) {
            let before = if k == last.0 { last.1 } else { known.front(simd, if k == 0 { fan.count } else { k } - 1) };
            let here = known.front(simd, k);
            last = (k + 1, here);
            outside |= here;
            // Lines with the elbow outside run clockwise: the first of them begins at the far end.
            let (begins, ends) = (here & !before, before & !here);
            let [x, y] = [s(outline.corner_x[k]), s(outline.corner_y[k])];
            hi = [begins.select(x, hi[0]), begins.select(y, hi[1])];
            lo = [ends.select(x, lo[0]), ends.select(y, lo[1])];
        }
        let (lo, hi) = ([lo[0] - elbow[0], lo[1] - elbow[1]], [hi[0] - elbow[0], hi[1] - elbow[1]]);
        let reach = shared.arm.fore_length_m as f32 + shared.margin;
        let square = s(reach * reach);
        let lo_reached = mad(lo[0], lo[0], lo[1] * lo[1]).simd_le(square);
        let hi_reached = mad(hi[0], hi[0], hi[1] * hi[1]).simd_le(square);
        let (mut inside, mut widen) = (!outside, zero);
        if sieve.clear == 0 {
            let depth = Self::depth(simd, outlines, sieve, elbow);
            inside |= depth.simd_lt(s(2.0 * shared.margin));
            let close = depth.simd_lt(s(shared.clear));
            widen = close.select(s(shared.rounding) / depth.max(s(shared.margin)), zero);
        }
        Self { inside, lo, hi, lo_reached, hi_reached, widen }
    }

    /// How far the elbow is outside, metres; below 0 inside.
    #[inline(always)]
    fn depth(simd: S, outlines: &Outlines, sieve: &Sieve, elbow: Points<S>) -> F<S> {
        let (fan, outline) = (&outlines.fan, &outlines.fore);
        let mut most = splat(simd, f32::NEG_INFINITY);
        for k in each(sieve.may_front.bits) {
            let s = |list: &[f32]| splat(simd, list[k]);
            most = most.max(mad(s(&fan.x), elbow[0], s(&fan.y) * elbow[1]) - s(&outline.far));
        }
        most
    }
}

/// Where the wrist, on its circle about the elbow, enters and leaves its outline, sixteen rows.
pub(super) struct Wrist<S: Simd> {
    /// Never outside.
    pub all: Mask<S>,
    /// The elbow is inside: the arc may be longer than half a turn.
    pub around: Mask<S>,
    /// Rows with one arc, or whose arcs are all between these points.
    pub hit: Mask<S>,
    pub lo: Points<S>,
    pub hi: Points<S>,
    /// Rows that have to be looked at one by one.
    pub several: Mask<S>,
}

/// A line that the wrist crosses, sixteen rows.
#[derive(Clone, Copy)]
struct Crossed<S: Simd> {
    normal: Points<S>,
    far: F<S>,
}

impl<S: Simd> Crossed<S> {
    #[inline(always)]
    fn take(&mut self, where_: Mask<S>, [x, y, far]: [F<S>; 3]) {
        self.normal = [where_.select(x, self.normal[0]), where_.select(y, self.normal[1])];
        self.far = where_.select(far, self.far);
    }

    /// The point on the circle and the line, from the elbow; `side` 1 at the line's far end, −1 at its near end.
    #[inline(always)]
    fn point(&self, simd: S, elbow: Points<S>, length: f32, side: f32) -> Points<S> {
        let [x, y] = self.normal;
        let gap = self.far - mad(x, elbow[0], y * elbow[1]);
        let square = splat(simd, length * length) - gap * gap;
        let half = square.max(splat(simd, 0.0)).sqrt() * splat(simd, side);
        [gap * x - half * y, mad(gap, y, half * x)]
    }
}

#[inline(always)]
fn line<S: Simd>(simd: S, fan: &Fan, outline: &Outline, k: usize) -> [F<S>; 3] {
    [splat(simd, fan.x[k]), splat(simd, fan.y[k]), splat(simd, outline.far[k])]
}

/// A foot this near to a corner is taken for one on the line, metres.
const BESIDE: f32 = 1e-5;

impl<S: Simd> Wrist<S> {
    #[inline(always)]
    pub fn of(simd: S, shared: &Shared, outlines: &Outlines, sieve: &Sieve, elbow: Points<S>) -> Self {
        let (fan, outline) = (&outlines.fan, &outlines.wrist);
        let s = |value: f32| splat(simd, value);
        let (none, zero) = (Mask::splat(simd, false), s(0.0));
        let length = shared.arm.fore_length_m as f32;
        let (mixed, edges) = sieve.crossed();
        let known = Known { outlines, mixed, certain: sieve.reached, elbow };
        let empty = Crossed { normal: [zero; 2], far: zero };
        let (mut entered, mut left) = (empty, empty);
        let (mut hit, mut several) = (none, none);
        let mut last = (usize::MAX, none);
        for k in each(edges) {
            let before = if k == last.0 { last.1 } else { known.reached(simd, k) };
            let after = known.reached(simd, known.next(k));
            last = (k + 1, after);
            // Where the outline leaves the disk, the circle enters the outline.
            let enters = before & !after;
            several |= hit & enters;
            hit |= enters;
            let line = line(simd, fan, outline, k);
            entered.take(enters, line);
            left.take(after & !before, line);
        }
        let mut poked = none;
        for k in each(sieve.poke) {
            let [gap, along] = Self::foot(simd, outlines, k, elbow);
            let beside = s(outline.from[k] - BESIDE).simd_le(along) & along.simd_le(s(outline.to[k] + BESIDE));
            let near = gap.simd_lt(zero) & gap.simd_ge(s(-length));
            let poke = near & beside & !known.reached(simd, k) & !known.reached(simd, known.next(k));
            let line = line(simd, fan, outline, k);
            entered.take(poke, line);
            left.take(poke, line);
            poked |= poke;
        }
        (hit, several) = (hit | poked, several & !poked);
        let lo = entered.point(simd, elbow, length, 1.0);
        let hi = left.point(simd, elbow, length, -1.0);
        let mut wrist = Self { all: none, around: none, hit, lo, hi, several };
        if sieve.wrist_front == 0 {
            let least = Self::least(simd, outlines, elbow);
            wrist.all = least.simd_ge(s(length));
            wrist.around = least.simd_ge(zero);
            // From inside, the circle may leave the outline and enter it again through one line.
            for k in each(sieve.poke_out) {
                let [gap, along] = Self::foot(simd, outlines, k, elbow);
                let beside = s(outline.from[k] - BESIDE).simd_le(along) & along.simd_le(s(outline.to[k] + BESIDE));
                let out =
                    beside & gap.simd_lt(s(length)) & !known.reached(simd, k) & !known.reached(simd, known.next(k));
                wrist.several |= out & wrist.around & !wrist.all;
            }
        }
        // From outside, an arc goes less than half around.
        let backwards = (lo[0] * hi[1] - lo[1] * hi[0]).simd_le(zero);
        wrist.several |= hit & !wrist.around & !poked & backwards;
        wrist.hit = hit & !wrist.several;
        wrist
    }

    /// The elbow before line `k`: how far, and where along it.
    #[inline(always)]
    fn foot(simd: S, outlines: &Outlines, k: usize, elbow: Points<S>) -> [F<S>; 2] {
        let (fan, outline) = (&outlines.fan, &outlines.wrist);
        let [x, y, far] = [splat(simd, fan.x[k]), splat(simd, fan.y[k]), splat(simd, outline.far[k])];
        [far - mad(x, elbow[0], y * elbow[1]), x * elbow[1] - y * elbow[0]]
    }

    /// Least distance of the elbow from a line, metres; below 0 outside.
    #[inline(always)]
    fn least(simd: S, outlines: &Outlines, elbow: Points<S>) -> F<S> {
        let (fan, outline) = (&outlines.fan, &outlines.wrist);
        let mut least = splat(simd, f32::INFINITY);
        for k in 0..fan.count {
            let s = |list: &[f32]| splat(simd, list[k]);
            least = least.min(s(&outline.far) - mad(s(&fan.x), elbow[0], s(&fan.y) * elbow[1]));
        }
        least
    }
}
