//! Kernel that converts the outlines of one plane to spans of its rows.

use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, dispatch};

use super::arc_intervals;
use super::context::{ConvexContext, Outlines, PlaneRows};
use super::corner_tests::{Mask, Points};
use super::forearm::ForearmTangents;
use super::row_culling::{ElbowArc, RowCulling};
use super::simd_math::{Lanes, WIDTH, atan2, load, mad, splat};
use super::span_writer::RowBatch;
use super::wrist::WristCrossings;
use crate::Layer;

/// Adds the spans of all rows of one plane, of full rows only if `write_full` is set; false if rows do not ascend.
pub(super) fn write_plane(
    context: &ConvexContext,
    outlines: &Outlines,
    plane: &PlaneRows,
    write_full: bool,
    layer: &mut Layer,
) -> bool {
    #[cfg(test)]
    let before = layer.spans.len();
    let ordered = dispatch!(context.simd_level, simd => write_lanes(simd, context, outlines, plane, write_full, layer));
    #[cfg(test)]
    super::precision_audit::compare(context, outlines, plane, &layer.spans[before..]);
    ordered
}

#[inline(always)]
fn write_lanes<S: Simd>(
    simd: S,
    context: &ConvexContext,
    outlines: &Outlines,
    plane: &PlaneRows,
    write_full: bool,
    layer: &mut Layer,
) -> bool {
    let mut ordered = true;
    for (chunk, start) in (0..plane.count).step_by(WIDTH).enumerate() {
        let left = plane.count - start;
        let inside = if left < WIDTH { (1u16 << left) - 1 } else { !0 };
        let known = plane.full[chunk] & inside;
        let full = if write_full { known } else { 0 };
        let row = (plane.first + start) as u32;
        // Where the forearm reaches, the end of the forearm also reaches.
        if known == inside || !outlines.wrist.exists {
            context.spans.write_full(row, full, layer);
            continue;
        }
        let rows = RowBatch { row, full, hit: inside & !known };
        ordered &= write_sixteen_rows(simd, context, outlines, plane, start, rows, layer);
    }
    ordered
}

/// Adds the spans of the full rows, and of the rows in `hit` that forearm or wrist block.
#[inline(always)]
fn write_sixteen_rows<S: Simd>(
    simd: S,
    context: &ConvexContext,
    outlines: &Outlines,
    plane: &PlaneRows,
    start: usize,
    rows: RowBatch,
    layer: &mut Layer,
) -> bool {
    let RowBatch { row, full, hit: open } = rows;
    let upper = context.arm.upper_length_m as f32;
    let PlaneRows { middles, borders, count, .. } = plane;
    // Between the eighth and the ninth row, or at the end of the last row.
    let middle = (start + WIDTH / 2).min(*count);
    let arc = ElbowArc { middle: [borders.cos[middle] * upper, borders.sin[middle] * upper], half: context.arc };
    let culling = RowCulling::new(simd, context, outlines, arc);
    if culling.is_free() {
        context.spans.write_full(row, full, layer);
        return true;
    }
    let upper = splat(simd, upper);
    let elbow = [load(simd, &middles.cos[start..]) * upper, load(simd, &middles.sin[start..]) * upper];
    let fore = ForearmTangents::new(simd, context, outlines, &culling, elbow);
    let wrist = WristCrossings::new(simd, context, outlines, &culling, elbow);
    let full = full | (fore.inside | wrist.all).to_bitmask() as u16 & open;
    let several = wrist.several.to_bitmask() as u16 & open & !full;
    let touched = wrist.hit | fore.lo_reached | fore.hi_reached;
    let hit = touched.to_bitmask() as u16 & open & !full & !several;
    if hit == 0 {
        context.spans.write_full(row, full, layer);
    } else {
        let around = wrist.around.to_bitmask() as u16 & hit != 0;
        let [lo, hi] =
            if around { interval_from_inside(simd, &fore, &wrist) } else { interval_from_outside(simd, &fore, &wrist) };
        let (base, scale) = (load(simd, &middles.zero[start..]), splat(simd, context.spans.scale));
        let ends = [mad(lo - fore.widen, scale, base), mad(hi + fore.widen, scale, base)];
        context.spans.write(simd, RowBatch { row, full, hit }, ends, layer);
    }
    if several != 0 {
        let rows = RowBatch { row, full: 0, hit: several };
        write_rows_singly(context, outlines, elbow.map(SimdBase::to_array), rows, &middles.zero[start..], layer);
    }
    several == 0
}

/// The interval of forearm and wrist, radians, if the elbow is outside both outlines: all directions are within less
/// than half a turn.
#[inline(always)]
fn interval_from_outside<S: Simd>(simd: S, fore: &ForearmTangents<S>, wrist: &WristCrossings<S>) -> [Lanes<S>; 2] {
    let zero = splat(simd, 0.0);
    let wrist_lo = wrist.hit & !(fore.lo_reached & cross(wrist.lo, fore.lo).simd_lt(zero));
    let wrist_hi = wrist.hit & !(fore.hi_reached & cross(wrist.hi, fore.hi).simd_gt(zero));
    let lo = pick(wrist_lo, wrist.lo, fore.lo);
    let hi = pick(wrist_hi, wrist.hi, fore.hi);
    angles(simd, lo, hi)
}

/// The interval of forearm and wrist, radians, if the elbow may be inside the wrist's outline.
#[inline(always)]
fn interval_from_inside<S: Simd>(simd: S, fore: &ForearmTangents<S>, wrist: &WristCrossings<S>) -> [Lanes<S>; 2] {
    // A tangent out of reach adds nothing to the wrist's arc.
    let alone = !wrist.hit | (fore.lo_reached & fore.hi_reached);
    let fore_lo = pick(alone | fore.lo_reached, fore.lo, fore.hi);
    let fore_hi = pick(alone | fore.hi_reached, fore.hi, fore.lo);
    let [fore_lo, fore_hi] = angles(simd, fore_lo, fore_hi);
    let [wrist_lo, wrist_hi] = angles(simd, wrist.lo, wrist.hi);
    // Shifts the wrist's interval to the turn of the forearm's interval.
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
fn cross<S: Simd>(a: Points<S>, b: Points<S>) -> Lanes<S> {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn pick<S: Simd>(which: Mask<S>, yes: Points<S>, no: Points<S>) -> Points<S> {
    [which.select(yes[0], no[0]), which.select(yes[1], no[1])]
}

/// Angles of both ends; the second is not below the first.
#[inline(always)]
fn angles<S: Simd>(simd: S, lo: Points<S>, hi: Points<S>) -> [Lanes<S>; 2] {
    let lo = atan2(simd, lo[1], lo[0]);
    let hi = atan2(simd, hi[1], hi[0]);
    let turn = splat(simd, std::f32::consts::TAU);
    [lo, hi.simd_lt(lo).select(hi + turn, hi)]
}

/// Writes rows in which the wrist meets the outline in several arcs; `zero` is the cell coordinate of angle 0 per row.
#[cold]
#[inline(never)]
fn write_rows_singly(
    context: &ConvexContext,
    outlines: &Outlines,
    [x, y]: [[f32; WIDTH]; 2],
    rows: RowBatch,
    zero: &[f32],
    layer: &mut Layer,
) {
    for lane in (0..WIDTH).filter(|lane| rows.hit >> lane & 1 == 1) {
        let at = [f64::from(x[lane]), f64::from(y[lane])];
        let length = context.arm.fore_length_m;
        let row = rows.row + lane as u32;
        let mut found = |lo, hi| context.spans.write_interval(row, zero[lane], [lo, hi], layer);
        arc_intervals::for_each_inside(&outlines.wrist, &outlines.normals, at, length, &mut found);
        if outlines.fore.exists {
            let visible = arc_intervals::visible_interval(&outlines.fore, &outlines.normals, at, length);
            if let Some((lo, hi)) = visible {
                found(lo, hi);
            }
        }
    }
}
