//! From outlines to spans: the rows of one plane.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, mask32x16};

use super::convex::{Outlines, Shared};
use super::lanes::{F, WIDTH, atan2, load, mad, splat};
use super::links::{Forearm, Points, Wrist};
use super::sift::{Arc, Sieve};
use super::{Directions, arcs};
use crate::Layer;

/// The rows of one plane.
pub(super) struct Plane<'a> {
    /// Number of the first row, and how many there are.
    pub row: usize,
    pub rows: usize,
    pub full: &'a [u16],
    pub middles: &'a Directions,
    pub borders: &'a Directions,
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
    #[cfg(test)]
    let before = layer.spans.len();
    for (chunk, start) in (0..plane.rows).step_by(WIDTH).enumerate() {
        let left = plane.rows - start;
        let inside = if left < WIDTH { (1u16 << left) - 1 } else { !0 };
        let known = plane.full[chunk] & inside;
        let full = if tell_full { known } else { 0 };
        let row = (plane.row + start) as u32;
        // Where the forearm reaches, its end does.
        if known == inside || !outlines.wrist.exists {
            let none = [splat(simd, 0.0); 2];
            shared.rows.emit(simd, row, full, 0, none, layer);
            continue;
        }
        ordered &= sixteen(simd, shared, outlines, plane, (row, start), (full, inside & !known), layer);
    }
    #[cfg(test)]
    super::audit::compare(shared, outlines, plane, &layer.spans[before..]);
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
    let upper = shared.arm.upper_length_m as f32;
    let Plane { middles, borders, rows, .. } = plane;
    // Between the eighth row and the ninth, or at the end of the last.
    let middle = (start + WIDTH / 2).min(*rows);
    let arc = Arc { middle: [borders.cos[middle] * upper, borders.sin[middle] * upper], half: shared.arc };
    let sieve = Sieve::new(simd, shared, outlines, arc);
    let none = [splat(simd, 0.0); 2];
    if sieve.is_free() {
        shared.rows.emit(simd, row, full, 0, none, layer);
        return true;
    }
    let upper = splat(simd, upper);
    let elbow = [load(simd, &middles.cos[start..]) * upper, load(simd, &middles.sin[start..]) * upper];
    let fore = Forearm::of(simd, shared, outlines, &sieve, elbow);
    let wrist = Wrist::of(simd, shared, outlines, &sieve, elbow);
    let full = full | (fore.inside | wrist.all).to_bitmask() as u16 & open;
    let several = wrist.several.to_bitmask() as u16 & open & !full;
    let touched = wrist.hit | fore.lo_reached | fore.hi_reached;
    let hit = touched.to_bitmask() as u16 & open & !full & !several;
    if hit == 0 {
        shared.rows.emit(simd, row, full, 0, none, layer);
    } else {
        let around = wrist.around.to_bitmask() as u16 & hit != 0;
        let [lo, hi] = if around { widest(simd, &fore, &wrist) } else { joined(simd, &fore, &wrist) };
        let (base, scale) = (load(simd, &middles.zero[start..]), splat(simd, shared.rows.scale));
        let ends = [mad(lo - fore.widen, scale, base), mad(hi + fore.widen, scale, base)];
        shared.rows.emit(simd, row, full, hit, ends, layer);
    }
    if several != 0 {
        one_by_one(simd, shared, outlines, elbow, (row, several), load(simd, &middles.zero[start..]), layer);
    }
    several == 0
}

/// The interval of forearm and wrist, radians, where the elbow is outside both outlines: all directions are within less
/// than half a turn.
#[inline(always)]
fn joined<S: Simd>(simd: S, fore: &Forearm<S>, wrist: &Wrist<S>) -> [F<S>; 2] {
    let zero = splat(simd, 0.0);
    let wrist_lo = wrist.hit & !(fore.lo_reached & cross(wrist.lo, fore.lo).simd_lt(zero));
    let wrist_hi = wrist.hit & !(fore.hi_reached & cross(wrist.hi, fore.hi).simd_gt(zero));
    let lo = pick(wrist_lo, wrist.lo, fore.lo);
    let hi = pick(wrist_hi, wrist.hi, fore.hi);
    angles(simd, lo, hi)
}

/// The same where the elbow may be inside the wrist's outline.
#[inline(always)]
fn widest<S: Simd>(simd: S, fore: &Forearm<S>, wrist: &Wrist<S>) -> [F<S>; 2] {
    // A tangent out of reach says nothing beside the wrist's arc.
    let alone = !wrist.hit | (fore.lo_reached & fore.hi_reached);
    let fore_lo = pick(alone | fore.lo_reached, fore.lo, fore.hi);
    let fore_hi = pick(alone | fore.hi_reached, fore.hi, fore.lo);
    let [fore_lo, fore_hi] = angles(simd, fore_lo, fore_hi);
    let [wrist_lo, wrist_hi] = angles(simd, wrist.lo, wrist.hi);
    // The wrist's interval in the turn of the forearm's.
    let turn = splat(simd, std::f32::consts::TAU);
    let apart = (fore_lo + fore_hi - wrist_lo - wrist_hi) * splat(simd, 0.5);
    let shift = (apart / turn).round_ties_even() * turn;
    let (wrist_lo, wrist_hi) = (wrist_lo + shift, wrist_hi + shift);
    let reached = fore.lo_reached | fore.hi_reached;
    let lo = wrist.hit.select(reached.select(wrist_lo.min(fore_lo), wrist_lo), fore_lo);
    let hi = wrist.hit.select(reached.select(wrist_hi.max(fore_hi), wrist_hi), fore_hi);
    [lo, hi]
}

#[inline(always)]
fn cross<S: Simd>(a: Points<S>, b: Points<S>) -> F<S> {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn pick<S: Simd>(which: mask32x16<S>, yes: Points<S>, no: Points<S>) -> Points<S> {
    [which.select(yes[0], no[0]), which.select(yes[1], no[1])]
}

/// Angles of both ends, the second not below the first.
#[inline(always)]
fn angles<S: Simd>(simd: S, lo: Points<S>, hi: Points<S>) -> [F<S>; 2] {
    let lo = atan2(simd, lo[1], lo[0]);
    let hi = atan2(simd, hi[1], hi[0]);
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
        let length = shared.arm.fore_length_m;
        let mut found = |lo, hi| shared.rows.emit_one(row + lane as u32, base[lane], [lo, hi], layer);
        arcs::each(&outlines.wrist, &outlines.fan, at, length, &mut found);
        if outlines.fore.exists
            && let Some((lo, hi)) = arcs::seen(&outlines.fore, &outlines.fan, at, length)
        {
            found(lo, hi);
        }
    }
}
