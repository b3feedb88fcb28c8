//! A ball: its outline in the plane is a disk, and everything has a closed form.

use std::ops::Range;

use elbowroom_spatial::Vec3;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::lanes::{F, WIDTH, acos, atan2, load, mad, splat};
use super::row::Rows;
use super::slice::Scratch;
use super::{Directions, Filler, upper};
use crate::{Layer, PlanarArm};

/// A ball in the arm's base frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    pub center: Vec3,
    pub radius: f64,
}

/// Disks of one centre for the three parts of the arm; shoulder's frame, x outward, y down. A radius below zero: none.
struct Disks {
    center: [f64; 2],
    upper: f64,
    fore: f64,
    wrist: f64,
}

/// What all planes share.
struct Wedge {
    tangent: f64,
    /// By what a point of the wedge may be farther from the base axis than along the middle: 1/cos δ1 − 1.
    stretch: f64,
    /// sin and 1 − cos of half a step of θ2.
    sine: f64,
    sagitta: f64,
    /// Absolute margin for single precision, metres.
    margin: f64,
}

impl Wedge {
    fn new(filler: &Filler, ball: &Ball) -> Self {
        let [half1, half2, _] = filler.grid.half_widths();
        let size = ball.center.length() + ball.radius + filler.arm.reach_m();
        Self {
            tangent: half1.tan(),
            stretch: 1.0 / half1.cos() - 1.0,
            sine: half2.sin(),
            sagitta: 1.0 - half2.cos(),
            margin: 4e-6 * size,
        }
    }
}

#[inline(always)]
pub(super) fn fill<S: Simd>(simd: S, filler: &mut Filler, ball: &Ball, which: Range<usize>, layer: &mut Layer) {
    let wedge = Wedge::new(filler, ball);
    let rows = Rows::new(&filler.grid.axes()[2]);
    let Filler { arm, grid, planes, borders, scratch, .. } = filler;
    let shoulder = &grid.axes()[1];
    for (i, &[cos, sin]) in planes.iter().enumerate().take(which.end).skip(which.start) {
        let first = i * shoulder.count();
        let before = layer.spans.len();
        for side in [1.0, -1.0] {
            let Some(disks) = Disks::in_plane(arm, &wedge, ball, [cos, sin], side) else { continue };
            let between = layer.spans.len();
            scratch.full.fill(0);
            if let Some((middle, half)) = upper::of_disk(disks.center, disks.upper, arm.upper_length_m)
                && disks.upper >= 0.0
            {
                upper::mark(shoulder, middle - half, middle + half, &mut scratch.full);
            }
            at_borders(simd, arm, &wedge, &rows, &disks, borders, scratch);
            between_borders(simd, shoulder.count(), first as u32, &rows, scratch, layer);
            if between > before {
                // Both sides of the base axis: rows were written twice.
                layer.spans[before..].sort_unstable();
            }
        }
    }
}

impl Disks {
    /// The ball grown by each radius, cut by the wedge to one side of the base axis and projected: at most these disks.
    ///
    /// Where the middle lies in the wedge that is the whole disk. Where it lies beside, at distance `d` from the wedge's
    /// side, the cut is an ellipse about the middle's foot with half axes √(R² − d²) and a little less; what of it lies
    /// inside the wedge again is at most `w` beyond (w: how far the disk's far end lies within the wedge).
    fn in_plane(arm: &PlanarArm, wedge: &Wedge, ball: &Ball, [cos, sin]: [f64; 2], side: f64) -> Option<Self> {
        let t = wedge.tangent;
        let x = (ball.center.x * cos + ball.center.y * sin) * side;
        let y = (ball.center.y * cos - ball.center.x * sin).abs();
        let beside = y > t * x;
        let (middle, distance) =
            if beside { ((x + t * y) / (1.0 + t * t), (y - t * x) / (1.0 + t * t).sqrt()) } else { (x, 0.0) };
        let radius = |link: f64| {
            let whole = ball.radius + link + wedge.margin;
            let within = if beside { (t * (x + whole) - y).max(0.0) } else { 0.0 };
            let square = whole * whole - distance * distance + within * within;
            let radius = if distance <= whole { square.sqrt() } else { -1.0 };
            // All of it on the other side of the base axis: nothing.
            if middle + radius > 0.0 { radius } else { -1.0 }
        };
        let radii = [arm.upper_radius_m, arm.fore_radius_m, arm.wrist_radius_m].map(radius);
        let most = radii.iter().copied().fold(-1.0, f64::max);
        if most < 0.0 {
            return None;
        }
        // What lies at x along the middle of the wedge may be up to x/cos δ1 from the axis.
        let outward = (middle + most) * wedge.stretch * 0.5;
        let center = [(middle + outward) * side - arm.offset_m, arm.height_m - ball.center.z];
        let [upper, fore, wrist] = radii.map(|radius| if radius < 0.0 { radius } else { radius + outward });
        Some(Self { center, upper, fore, wrist })
    }

    /// Turned about the shoulder by half a step to both sides, the two disks at the ends hold the whole sweep if their
    /// radius is this.
    fn swept(&self, wedge: &Wedge, radius: f64) -> f32 {
        let far = self.center[0].hypot(self.center[1]);
        let (half_chord, sagitta) = (far * wedge.sine, far * wedge.sagitta);
        if radius < 0.0 { -1.0 } else { (radius + sagitta).hypot(half_chord) as f32 }
    }
}

/// The blocked interval of θ3 at every border between rows, in cells.
#[inline(always)]
fn at_borders<S: Simd>(
    simd: S,
    arm: &PlanarArm,
    wedge: &Wedge,
    rows: &Rows,
    disks: &Disks,
    borders: &Directions,
    scratch: &mut Scratch,
) {
    let [x, y] = disks.center.map(|c| splat(simd, c as f32));
    let upper = splat(simd, arm.upper_length_m as f32);
    let fore = arm.fore_length_m as f32;
    let radii = [disks.swept(wedge, disks.fore), disks.swept(wedge, disks.wrist)];
    let (scale, zero) = (splat(simd, rows.scale), splat(simd, rows.zero));
    let (huge, none) = (splat(simd, 1e6), splat(simd, f32::INFINITY));
    for start in (0..scratch.lo.len() - WIDTH).step_by(WIDTH) {
        let (cos, sin) = (load(simd, &borders.cos[start..]), load(simd, &borders.sin[start..]));
        // The centre from the elbow, along and across the upper arm.
        let along = mad(x, cos, y * sin) - upper;
        let across = y * cos - x * sin;
        let middle = mad(atan2(simd, across, along), scale, zero);
        let cosine = half_width(simd, mad(along, along, across * across), fore, radii);
        let half = acos(simd, cosine) * scale;
        let all = cosine.simd_le(splat(simd, -1.0));
        let hit = cosine.simd_le(splat(simd, 1.0));
        let lo = all.select(-huge, hit.select(middle - half, none));
        let hi = all.select(huge, hit.select(middle + half, -none));
        lo.store_slice(&mut scratch.lo[start..start + WIDTH]);
        hi.store_slice(&mut scratch.hi[start..start + WIDTH]);
        middle.store_slice(&mut scratch.middle[start..start + WIDTH]);
    }
}

/// Cosine of half the interval in which forearm or wrist meet their disks: above 1 never, −1 or less always.
#[inline(always)]
fn half_width<S: Simd>(simd: S, square: F<S>, length: f32, [fore, wrist]: [f32; 2]) -> F<S> {
    let distance = square.sqrt().max(splat(simd, 1e-12));
    let reach = splat(simd, length);
    let over = splat(simd, 1.0) / (distance + distance);
    let (always, never) = (splat(simd, -2.0), splat(simd, 2.0));
    let mut least = never;
    if fore >= 0.0 {
        let tangent = square - splat(simd, fore * fore);
        let end = tangent.max(splat(simd, 1e-12)).sqrt().min(reach);
        let cosine = mad(end, end, tangent) / end * over;
        least = tangent.simd_gt(splat(simd, 0.0)).select(cosine, always);
    }
    if wrist >= 0.0 {
        let tangent = square - splat(simd, wrist * wrist);
        least = least.min((tangent + splat(simd, length * length)) * splat(simd, 1.0 / length) * over);
    }
    // What f32 may have lost of the cosine.
    least - splat(simd, 2e-6)
}

/// A row lies between two borders: its interval holds those of both.
#[inline(always)]
fn between_borders<S: Simd>(simd: S, count: usize, first: u32, rows: &Rows, scratch: &Scratch, layer: &mut Layer) {
    let turn = splat(simd, std::f32::consts::TAU * rows.scale);
    let half = splat(simd, std::f32::consts::PI * rows.scale);
    for (chunk, start) in (0..count).step_by(WIDTH).enumerate() {
        let full = scratch.full[chunk];
        let at = |from: &[f32], shift: usize| load(simd, &from[start + shift..]);
        // The middle may jump by a turn from one border to the next.
        let jump = at(&scratch.middle, 1) - at(&scratch.middle, 0);
        let zero = splat(simd, 0.0);
        let shift = jump.simd_gt(half).select(-turn, jump.simd_lt(-half).select(turn, zero));
        let lo = at(&scratch.lo, 0).min(at(&scratch.lo, 1) + shift);
        let hi = at(&scratch.hi, 0).max(at(&scratch.hi, 1) + shift);
        let inside = if count - start < WIDTH { (1u16 << (count - start)) - 1 } else { !0 };
        let hit = lo.simd_le(hi).to_bitmask() as u16 & inside & !full;
        if full | hit != 0 {
            rows.emit(simd, first + start as u32, full, hit, [lo, hi], layer);
        }
    }
}
