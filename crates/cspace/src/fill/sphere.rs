//! A ball: its outline in the plane is a disk, and everything has a closed form.

use std::ops::Range;

use elbowroom_spatial::Vec3;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::lanes::{F, WIDTH, acos, atan2, load, mad, splat};
use super::row::Rows;
use super::{Directions, Filler, MARGIN, arc, upper};
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
    /// Turned about the shoulder by half a step to both sides, two of these at the ends hold the whole sweep.
    fore: f32,
    wrist: f32,
}

/// What all planes share.
struct Wedge {
    tangent: f64,
    /// 1/cos δ1.
    slant: f64,
    /// Ball and thickest part together, metres.
    around: f64,
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
        let arm = &filler.arm;
        let thickest = arm.upper_radius_m.max(arm.fore_radius_m).max(arm.wrist_radius_m);
        Self {
            slant: 1.0 / half1.cos(),
            around: (ball.radius + thickest) * (1.0 + 1e-9) + MARGIN * size,
            tangent: half1.tan(),
            stretch: 1.0 / half1.cos() - 1.0,
            sine: half2.sin(),
            sagitta: 1.0 - half2.cos(),
            margin: MARGIN * size,
        }
    }
}

/// Rows that are filled at once: sixteen borders have as many rows between them.
const ROWS: usize = WIDTH - 1;

#[inline(always)]
pub(super) fn fill<S: Simd>(simd: S, filler: &mut Filler, ball: &Ball, which: Range<usize>, layer: &mut Layer) {
    let wedge = Wedge::new(filler, ball);
    let rows = Rows::new(&filler.grid.axes()[2]);
    let Filler { arm, grid, planes, borders, scratch, .. } = filler;
    let shoulder = &grid.axes()[1];
    let part = Part { arm: *arm, arc: arc(shoulder.step() * 0.5 * WIDTH as f64), rows, borders };
    for (i, &[cos, sin]) in planes.iter().enumerate().take(which.end).skip(which.start) {
        let first = i * shoulder.count();
        let before = layer.spans.len();
        for side in [1.0, -1.0] {
            let Some(disks) = Disks::in_plane(arm, &wedge, ball, [cos, sin], side) else { continue };
            let between = layer.spans.len();
            scratch.full.fill(0);
            if disks.upper >= 0.0
                && let Some((middle, half)) = upper::of_disk(disks.center, disks.upper, arm.upper_length_m)
            {
                upper::mark(shoulder, middle - half, middle + half, &mut scratch.full);
            }
            part.fill(simd, &disks, first as u32, shoulder.count(), &scratch.full, layer);
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
    #[inline(always)]
    fn in_plane(arm: &PlanarArm, wedge: &Wedge, ball: &Ball, [cos, sin]: [f64; 2], side: f64) -> Option<Self> {
        let t = wedge.tangent;
        let x = (ball.center.x * cos + ball.center.y * sin) * side;
        let y = (ball.center.y * cos - ball.center.x * sin).abs();
        if y - t * x > wedge.around * wedge.slant || x + wedge.around < 0.0 {
            return None;
        }
        let beside = y > t * x;
        let (middle, distance) =
            if beside { ((x + t * y) / (1.0 + t * t), (y - t * x) / (1.0 + t * t).sqrt()) } else { (x, 0.0) };
        let reaching = Reaching { radius: ball.radius + wedge.margin, beside, t, x, y, middle, distance };
        let wrist = reaching.radius(arm.wrist_radius_m.max(arm.fore_radius_m));
        let (upper, fore) = (reaching.radius(arm.upper_radius_m), reaching.radius(arm.fore_radius_m));
        let most = wrist.max(upper);
        if most < 0.0 {
            return None;
        }
        // What lies at x along the middle of the wedge may be up to x/cos δ1 from the axis.
        let outward = (middle + most) * wedge.stretch * 0.5;
        let center = [(middle + outward) * side - arm.offset_m, arm.height_m - ball.center.z];
        let far = (center[0] * center[0] + center[1] * center[1]).sqrt();
        let (half_chord, sagitta) = (far * wedge.sine, far * wedge.sagitta);
        let swept = |radius: f64| {
            let grown = radius + outward + sagitta;
            if radius < 0.0 { -1.0 } else { (grown * grown + half_chord * half_chord).sqrt() as f32 }
        };
        let upper = if upper < 0.0 { upper } else { upper + outward };
        Some(Self { center, upper, fore: swept(fore), wrist: swept(wrist) })
    }
}

/// How the ball lies in the wedge, metres.
struct Reaching {
    /// Of the ball, with its margin.
    radius: f64,
    beside: bool,
    /// Tangent of half the wedge, and the ball's middle along and across it.
    t: f64,
    x: f64,
    y: f64,
    /// Middle of the disks, from the base axis, and the ball's distance from the wedge.
    middle: f64,
    distance: f64,
}

impl Reaching {
    /// Radius of the disk for a link; below 0 where there is none.
    #[inline(always)]
    fn radius(&self, link: f64) -> f64 {
        let whole = self.radius + link;
        if self.distance > whole {
            return -1.0;
        }
        let within = if self.beside { (self.t * (self.x + whole) - self.y).max(0.0) } else { 0.0 };
        let radius = (whole * whole - self.distance * self.distance + within * within).sqrt();
        // All of it on the other side of the base axis: nothing.
        if self.middle + radius > 0.0 { radius } else { -1.0 }
    }
}

/// What the rows of all planes share.
struct Part<'a> {
    arm: PlanarArm,
    /// Cosine and sine of the arc of the elbow over half of [`ROWS`] rows and a little more.
    arc: [f32; 2],
    rows: Rows,
    borders: &'a Directions,
}

impl Part<'_> {
    /// Spans of the rows of one plane.
    #[inline(always)]
    fn fill<S: Simd>(&self, simd: S, disks: &Disks, row: u32, count: usize, full: &[u16], layer: &mut Layer) {
        let [x, y] = [disks.center[0] as f32, disks.center[1] as f32];
        let (upper, fore) = (self.arm.upper_length_m as f32, self.arm.fore_length_m as f32);
        // The disk is in reach of an elbow with `center·elbow` above this.
        let reach = (fore + disks.wrist) * 1.0001;
        let least = (x * x + y * y + upper * upper - reach * reach) * 0.5;
        let least = least - (x * x + y * y + upper * upper + reach * reach) * 1e-6;
        for start in (0..count).step_by(ROWS) {
            let left = (count - start).min(ROWS);
            let bits = u32::from(full[start / WIDTH]) | u32::from(*full.get(start / WIDTH + 1).unwrap_or(&0)) << WIDTH;
            let inside = (1u16 << left) - 1;
            let full = (bits >> (start % WIDTH)) as u16 & inside;
            // In the middle of the arc; rows that are missing make it shorter.
            let middle = (start + ROWS / 2).min(count);
            let [cos, sin] = [self.borders.cos[middle] * upper, self.borders.sin[middle] * upper];
            let (along, across) = (x * cos + y * sin, (x * sin - y * cos).abs());
            let most = along.max(along * self.arc[0]) + across * self.arc[1];
            let none = [splat(simd, 0.0); 2];
            if full == inside || disks.wrist < 0.0 || most < least {
                if full != 0 {
                    self.rows.emit(simd, row + start as u32, full, 0, none, layer);
                }
                continue;
            }
            let (hit, ends) = self.between_borders(simd, disks, start);
            let hit = hit & inside & !full;
            if full | hit != 0 {
                self.rows.emit(simd, row + start as u32, full, hit, ends, layer);
            }
        }
    }

    /// The blocked intervals of θ3, in cells, of the rows from `start` on. A row lies between two borders: its interval
    /// holds those of both.
    #[inline(always)]
    fn between_borders<S: Simd>(&self, simd: S, disks: &Disks, start: usize) -> (u16, [F<S>; 2]) {
        let (scale, zero) = (splat(simd, self.rows.scale), splat(simd, self.rows.zero));
        let [x, y] = [splat(simd, disks.center[0] as f32), splat(simd, disks.center[1] as f32)];
        let (cos, sin) = (load(simd, &self.borders.cos[start..]), load(simd, &self.borders.sin[start..]));
        // The centre from the elbow, along and across the upper arm.
        let along = mad(x, cos, y * sin) - splat(simd, self.arm.upper_length_m as f32);
        let across = y * cos - x * sin;
        let middle = mad(atan2(simd, across, along), scale, zero);
        let square = mad(along, along, across * across);
        let cosine = half_width(simd, square, self.arm.fore_length_m as f32, [disks.fore, disks.wrist]);
        let half = acos(simd, cosine) * scale;
        let all = cosine.simd_le(splat(simd, -1.0));
        let hit = cosine.simd_le(splat(simd, 1.0));
        let (huge, none) = (splat(simd, 1e6), splat(simd, f32::INFINITY));
        let lo = all.select(-huge, hit.select(middle - half, none));
        let hi = all.select(huge, hit.select(middle + half, -none));
        // The middle may jump by a turn from one border to the next.
        let jump = middle.slide::<1>(middle) - middle;
        let turn = splat(simd, std::f32::consts::TAU * self.rows.scale);
        let half_turn = turn * splat(simd, 0.5);
        let shift = jump.simd_gt(half_turn).select(-turn, jump.simd_lt(-half_turn).select(turn, splat(simd, 0.0)));
        let lo = lo.min(lo.slide::<1>(lo) + shift);
        let hi = hi.max(hi.slide::<1>(hi) + shift);
        (lo.simd_le(hi).to_bitmask() as u16, [lo, hi])
    }
}

/// Cosine of half the interval in which forearm or wrist meet their disks: above 1 never, −1 or less always. The wrist's
/// disk is no smaller: where the forearm's end is what meets its disk first, the wrist meets its own before.
#[inline(always)]
fn half_width<S: Simd>(simd: S, square: F<S>, length: f32, [fore, wrist]: [f32; 2]) -> F<S> {
    let s = |value: f32| splat(simd, value);
    let distance = square.sqrt().max(s(1e-12));
    let over = s(1.0) / distance;
    let tangent = square - s(wrist * wrist);
    let mut least = (tangent + s(length * length)) * s(0.5 / length) * over;
    if fore >= 0.0 {
        let tangent = square - s(fore * fore);
        let inside = tangent.simd_le(s(0.0));
        let along = tangent.max(s(0.0)).sqrt();
        let reached = along.simd_le(s(length * 1.00001));
        least = least.min(inside.select(s(-2.0), reached.select(along * over, s(2.0))));
    }
    // What f32 may have lost of the cosine.
    least - s(2e-6)
}
