//! Forearm and wrist against their outlines, sixteen rows at a time.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::convex::{Outlines, Shared};
use super::lanes::{F, mad, splat};

/// The least and the greatest direction seen so far, as points.
#[derive(Clone, Copy)]
pub(super) struct Seen<S: Simd> {
    pub lo: [F<S>; 2],
    pub hi: [F<S>; 2],
}

/// Where the forearm's axis meets its outline, sixteen rows.
pub(super) struct Forearm<S: Simd> {
    /// All directions: the elbow is inside.
    pub all: u16,
    pub hit: u16,
    pub seen: Seen<S>,
}

impl<S: Simd> Forearm<S> {
    #[inline(always)]
    pub fn of(simd: S, shared: &Shared, outlines: &Outlines, elbow: [F<S>; 2]) -> Self {
        let (fan, outline) = (&outlines.fan, &outlines.fore);
        let s = |value: f32| splat(simd, value);
        let (zero, length) = (s(0.0), shared.arm.fore_length_m as f32);
        let mut seen = Seen { lo: [zero; 2], hi: [zero; 2] };
        if !outline.exists {
            return Self { all: 0, hit: 0, seen };
        }
        let mut least = s(f32::INFINITY);
        let mut any = zero.simd_lt(zero);
        for k in 0..fan.count {
            let (x, y) = (s(fan.x[k]), s(fan.y[k]));
            let gap = s(outline.far[k]) - mad(x, elbow[0], y * elbow[1]);
            let along = x * elbow[1] - y * elbow[0];
            least = least.min(gap);
            let square = s(length * length) - gap * gap;
            let half = square.max(zero).sqrt();
            let from = (s(outline.from[k]) - along).max(-half);
            let to = (s(outline.to[k]) - along).min(half);
            let meets = square.simd_ge(zero) & from.simd_le(to);
            // Seen from the elbow, a line in front runs clockwise, one behind counter-clockwise.
            let front = gap.simd_lt(zero);
            let (first, last) = (front.select(to, from), front.select(from, to));
            let (foot_x, foot_y) = (gap * x, gap * y);
            let lo = [foot_x - first * y, mad(first, x, foot_y)];
            let hi = [foot_x - last * y, mad(last, x, foot_y)];
            let before = meets & (!any | cross(seen.lo, lo).simd_lt(zero));
            let after = meets & (!any | cross(seen.hi, hi).simd_gt(zero));
            seen.lo = [before.select(lo[0], seen.lo[0]), before.select(lo[1], seen.lo[1])];
            seen.hi = [after.select(hi[0], seen.hi[0]), after.select(hi[1], seen.hi[1])];
            any |= meets;
        }
        Self { all: least.simd_ge(zero).to_bitmask() as u16, hit: any.to_bitmask() as u16, seen }
    }
}

#[inline(always)]
fn cross<S: Simd>(a: [F<S>; 2], b: [F<S>; 2]) -> F<S> {
    a[0] * b[1] - a[1] * b[0]
}

/// Where the wrist, on its circle about the elbow, lies in its outline, sixteen rows.
pub(super) struct Wrist<S: Simd> {
    pub all: u16,
    /// Rows with one arc.
    pub hit: u16,
    pub arc: Seen<S>,
    /// Rows with several arcs, or where single precision cannot tell.
    pub several: u16,
}

/// A circle that crosses a line this near to its end crosses it, metres.
const CROSSING: f32 = 1e-5;

impl<S: Simd> Wrist<S> {
    #[inline(always)]
    pub fn of(simd: S, shared: &Shared, outlines: &Outlines, elbow: [F<S>; 2]) -> Self {
        let (fan, outline) = (&outlines.fan, &outlines.wrist);
        let s = |value: f32| splat(simd, value);
        let (zero, one, length) = (s(0.0), s(1.0), shared.arm.fore_length_m as f32);
        let mut arc = Seen { lo: [zero; 2], hi: [zero; 2] };
        if !outline.exists {
            return Self { all: 0, hit: 0, arc, several: 0 };
        }
        let mut least = s(f32::INFINITY);
        let (mut enters, mut leaves) = (zero, zero);
        for k in 0..fan.count {
            let (x, y) = (s(fan.x[k]), s(fan.y[k]));
            let gap = s(outline.far[k]) - mad(x, elbow[0], y * elbow[1]);
            let along = x * elbow[1] - y * elbow[0];
            least = least.min(gap);
            let square = s(length * length) - gap * gap;
            let half = square.max(zero).sqrt();
            let from = s(outline.from[k] - CROSSING) - along;
            let to = s(outline.to[k] + CROSSING) - along;
            let reached = square.simd_ge(zero);
            // Counter-clockwise, the circle enters at the far end of the chord and leaves at its near end.
            let enter = reached & from.simd_le(half) & half.simd_le(to);
            let leave = reached & from.simd_le(-half) & (-half).simd_le(to);
            let (foot_x, foot_y) = (gap * x, gap * y);
            let (side_x, side_y) = (half * y, half * x);
            arc.lo = [enter.select(foot_x - side_x, arc.lo[0]), enter.select(foot_y + side_y, arc.lo[1])];
            arc.hi = [leave.select(foot_x + side_x, arc.hi[0]), leave.select(foot_y - side_y, arc.hi[1])];
            enters += enter.select(one, zero);
            leaves += leave.select(one, zero);
        }
        let single = (enters.simd_eq(one) & leaves.simd_eq(one)).to_bitmask() as u16;
        let none = (enters + leaves).simd_eq(zero).to_bitmask() as u16;
        let all = least.simd_ge(s(length)).to_bitmask() as u16;
        Self { all, hit: single, arc, several: !single & !none & !all }
    }
}
