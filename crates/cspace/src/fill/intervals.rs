//! From outlines to spans: the rows of one plane.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::convex::{Outlines, Shared};
use super::lanes::{F, WIDTH, atan2, load, mad, splat};
use super::links::{Forearm, Seen, Wrist};
use super::{Directions, arcs};
use crate::Layer;

/// The rows of one plane.
pub(super) struct Plane<'a> {
    /// Number of the first row, and how many there are.
    pub row: usize,
    pub rows: usize,
    pub full: &'a [u16],
    pub middles: &'a Directions,
    /// The enclosing ball's middle, shoulder's frame.
    pub middle: [f32; 2],
}

/// Spans of all rows of one plane; false where they do not ascend.
#[inline(always)]
pub(super) fn rows<S: Simd>(
    simd: S,
    shared: &Shared,
    outlines: &Outlines,
    plane: &Plane,
    tell_full: bool,
    layer: &mut Layer,
) -> bool {
    let mut ordered = true;
    for (chunk, start) in (0..plane.rows).step_by(WIDTH).enumerate() {
        let left = plane.rows - start;
        let inside = if left < WIDTH { (1u16 << left) - 1 } else { !0 };
        let known = plane.full[chunk] & inside;
        let full = if tell_full { known } else { 0 };
        let row = (plane.row + start) as u32;
        if known == inside {
            let none = [splat(simd, 0.0); 2];
            shared.rows.emit(simd, row, full, 0, none, layer);
            continue;
        }
        ordered &= sixteen(simd, shared, outlines, plane, (row, start), (full, inside & !known), layer);
    }
    ordered
}

/// Sixteen rows.
#[inline(always)]
fn sixteen<S: Simd>(
    simd: S,
    shared: &Shared,
    outlines: &Outlines,
    plane: &Plane,
    (row, start): (u32, usize),
    (full, open): (u16, u16),
    layer: &mut Layer,
) -> bool {
    let upper = splat(simd, shared.arm.upper_length_m as f32);
    let middles = plane.middles;
    let elbow = [load(simd, &middles.cos[start..]) * upper, load(simd, &middles.sin[start..]) * upper];
    if !in_reach(simd, shared, plane.middle, elbow) {
        shared.rows.emit(simd, row, full, 0, elbow, layer);
        return true;
    }
    let fore = Forearm::of(simd, shared, outlines, elbow);
    let wrist = Wrist::of(simd, shared, outlines, elbow);
    let full = full | (fore.all | wrist.all) & open;
    let open = open & !full;
    let base = load(simd, &middles.zero[start..]);
    let to_cells = |angle: F<S>| mad(angle, splat(simd, shared.rows.scale), base);
    let mut ordered = true;
    let (fore_hit, wrist_hit) = (fore.hit & open, wrist.hit & open);
    if full | fore_hit | wrist_hit != 0 {
        let [fore_lo, fore_hi] = angles(simd, fore.seen).map(to_cells);
        let [wrist_lo, wrist_hi] = angles(simd, wrist.arc).map(to_cells);
        // The wrist's interval in the turn of the forearm's, and both as one where they meet.
        let turn = splat(simd, std::f32::consts::TAU * shared.rows.scale);
        let apart = (fore_lo + fore_hi - wrist_lo - wrist_hi) * splat(simd, 0.5);
        let shift = (apart / turn).round_ties_even() * turn;
        let (wrist_lo, wrist_hi) = (wrist_lo + shift, wrist_hi + shift);
        let meet = (wrist_lo.simd_le(fore_hi) & fore_lo.simd_le(wrist_hi)).to_bitmask() as u16;
        let both = fore_hit & wrist_hit & meet;
        let in_both = |x: F<S>, y: F<S>| simd_mask(simd, both).select(x, y);
        let lo = in_both(fore_lo.min(wrist_lo), simd_mask(simd, fore_hit).select(fore_lo, wrist_lo));
        let hi = in_both(fore_hi.max(wrist_hi), simd_mask(simd, fore_hit).select(fore_hi, wrist_hi));
        shared.rows.emit(simd, row, full, fore_hit | wrist_hit, [lo, hi], layer);
        let twice = fore_hit & wrist_hit & !meet;
        if twice != 0 {
            shared.rows.emit(simd, row, 0, twice, [wrist_lo, wrist_hi], layer);
            ordered = false;
        }
    }
    let several = wrist.several & open;
    if several != 0 {
        one_by_one(simd, shared, outlines, elbow, (row, several), base, layer);
        ordered = false;
    }
    ordered
}

/// False where the forearm is too short for all of the rows.
#[inline(always)]
fn in_reach<S: Simd>(simd: S, shared: &Shared, middle: [f32; 2], elbow: [F<S>; 2]) -> bool {
    let [x, y] = [elbow[0] - splat(simd, middle[0]), elbow[1] - splat(simd, middle[1])];
    let reach = splat(simd, shared.reach);
    mad(x, x, y * y).simd_le(reach * reach).any_true()
}

#[inline(always)]
fn simd_mask<S: Simd>(simd: S, bits: u16) -> fearless_simd::mask32x16<S> {
    fearless_simd::mask32x16::from_bitmask(simd, u64::from(bits))
}

/// Angles of both ends, the second not below the first.
#[inline(always)]
fn angles<S: Simd>(simd: S, seen: Seen<S>) -> [F<S>; 2] {
    let lo = atan2(simd, seen.lo[1], seen.lo[0]);
    let hi = atan2(simd, seen.hi[1], seen.hi[0]);
    let around = splat(simd, std::f32::consts::TAU);
    [lo, hi.simd_lt(lo).select(hi + around, hi)]
}

/// Rows of which the wrist meets the outline in several arcs.
#[cold]
#[inline(never)]
fn one_by_one<S: Simd>(
    _: S,
    shared: &Shared,
    outlines: &Outlines,
    elbow: [F<S>; 2],
    (row, rows): (u32, u16),
    base: F<S>,
    layer: &mut Layer,
) {
    let ([x, y], base) = (elbow.map(SimdBase::to_array), base.to_array());
    for lane in (0..WIDTH).filter(|lane| rows >> lane & 1 == 1) {
        let at = [f64::from(x[lane]), f64::from(y[lane])];
        arcs::each(&outlines.wrist, &outlines.fan, at, shared.arm.fore_length_m, |lo, hi| {
            shared.rows.emit_one(row + lane as u32, base[lane], [lo, hi], layer);
        });
    }
}
