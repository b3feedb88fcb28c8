//! Spheres: the outline in the plane is a disk, so all results have a closed form.

use std::ops::Range;

use elbowroom_spatial::Vec3;
use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, dispatch};

use super::arm_grid::{ArmDirections, ArmGrid, half_arc};
use super::precision::MARGIN;
use super::simd_math::{Lanes, WIDTH, acos, atan2, load, mad, splat};
use super::span_writer::{RowBatch, SpanWriter};
use super::upper_arm;
use crate::{Layer, PlanarArm};

/// A sphere in the arm's base frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct SphereObstacle {
    pub center: Vec3,
    pub radius: f64,
}

/// Concentric disks for the three links, in the shoulder's frame: x outward, y down. A radius below 0 means that the
/// link has no disk.
struct GrownDisks {
    center: [f64; 2],
    upper: f64,
    /// Radii such that two disks, rotated about the shoulder by half a step to either side, contain the whole sweep.
    fore: f32,
    wrist: f32,
}

/// Constants of one sphere for all planes.
struct SphereContext {
    tangent: f64,
    /// 1/cos δ1.
    slant: f64,
    /// Radius of the sphere plus the largest radius of the arm, metres.
    grown_radius: f64,
    /// Largest excess, as a fraction, of the distance of a wedge's point from the base axis over its distance along the
    /// middle: 1/cos δ1 − 1.
    stretch: f64,
    /// sin and 1 − cos of half a step of θ2.
    sine: f64,
    sagitta: f64,
    /// Absolute margin for single precision, metres.
    margin: f64,
}

impl SphereContext {
    fn new(arm_grid: &ArmGrid, sphere: &SphereObstacle) -> Self {
        let [half1, half2, _] = arm_grid.grid.half_widths();
        let size = sphere.center.length() + sphere.radius + arm_grid.arm.reach_m();
        Self {
            slant: 1.0 / half1.cos(),
            grown_radius: (sphere.radius + arm_grid.arm.max_radius_m()) * (1.0 + 1e-9) + MARGIN * size,
            tangent: half1.tan(),
            stretch: 1.0 / half1.cos() - 1.0,
            sine: half2.sin(),
            sagitta: 1.0 - half2.cos(),
            margin: MARGIN * size,
        }
    }
}

/// Number of rows of one vector: sixteen borders have this many rows between them.
const ROWS: usize = WIDTH - 1;

/// Adds the spans of some planes; `full_rows` is workspace.
pub(super) fn build(
    arm_grid: &ArmGrid,
    sphere: &SphereObstacle,
    planes: Range<usize>,
    full_rows: &mut [u16],
    layer: &mut Layer,
) {
    let context = SphereContext::new(arm_grid, sphere);
    let ArmGrid { arm, grid, borders, simd_level, .. } = arm_grid;
    let shoulder = &grid.axes()[1];
    let arc = half_arc(shoulder.step() * 0.5 * WIDTH as f64);
    let rows = DiskRows { arm: *arm, arc, spans: SpanWriter::new(&grid.axes()[2]), borders };
    for (i, &[cos, sin]) in arm_grid.planes.iter().enumerate().take(planes.end).skip(planes.start) {
        let first = (i * shoulder.count()) as u32;
        let before = layer.spans.len();
        for side in [1.0, -1.0] {
            let Some(disks) = GrownDisks::in_plane(arm, &context, sphere, [cos, sin], side) else { continue };
            let between = layer.spans.len();
            full_rows.fill(0);
            if disks.upper >= 0.0
                && let Some((middle, half)) = upper_arm::disk_directions(disks.center, disks.upper, arm.upper_length_m)
            {
                upper_arm::mark_rows(shoulder, middle - half, middle + half, full_rows);
            }
            dispatch!(*simd_level, simd => rows.write(simd, &disks, first, shoulder.count(), full_rows, layer));
            if between > before {
                // Rows on both sides of the base axis were written twice.
                layer.spans[before..].sort_unstable();
            }
        }
    }
}

impl GrownDisks {
    /// Disks that contain the sphere grown by each radius, cut by the wedge to one side of the base axis and projected.
    ///
    /// If the centre is in the wedge, this is the whole disk. If the centre is beside the wedge, at distance `d` from
    /// its side, the cut is an ellipse around the centre's foot with half axes √(R² − d²) and slightly less. The part
    /// of the ellipse inside the wedge is at most `w` beyond (`w`: depth of the disk's far end in the wedge).
    fn in_plane(
        arm: &PlanarArm,
        context: &SphereContext,
        sphere: &SphereObstacle,
        [cos, sin]: [f64; 2],
        side: f64,
    ) -> Option<Self> {
        let t = context.tangent;
        let x = (sphere.center.x * cos + sphere.center.y * sin) * side;
        let y = (sphere.center.y * cos - sphere.center.x * sin).abs();
        if y - t * x > context.grown_radius * context.slant || x + context.grown_radius < 0.0 {
            return None;
        }
        let beside = y > t * x;
        let (middle, distance) =
            if beside { ((x + t * y) / (1.0 + t * t), (y - t * x) / (1.0 + t * t).sqrt()) } else { (x, 0.0) };
        let cut = WedgeCut { radius: sphere.radius + context.margin, beside, t, x, y, middle, distance };
        let wrist = cut.disk_radius(arm.wrist_radius_m.max(arm.fore_radius_m));
        let (upper, fore) = (cut.disk_radius(arm.upper_radius_m), cut.disk_radius(arm.fore_radius_m));
        let most = wrist.max(upper);
        if most < 0.0 {
            return None;
        }
        // A point at x along the middle of the wedge may be up to x/cos δ1 from the axis.
        let outward = (middle + most) * context.stretch * 0.5;
        let center = [(middle + outward) * side - arm.offset_m, arm.height_m - sphere.center.z];
        let far = (center[0] * center[0] + center[1] * center[1]).sqrt();
        let (half_chord, sagitta) = (far * context.sine, far * context.sagitta);
        let swept = |radius: f64| {
            let grown = radius + outward + sagitta;
            if radius < 0.0 { -1.0 } else { (grown * grown + half_chord * half_chord).sqrt() as f32 }
        };
        let upper = if upper < 0.0 { upper } else { upper + outward };
        Some(Self { center, upper, fore: swept(fore), wrist: swept(wrist) })
    }
}

/// The sphere relative to the wedge, metres.
struct WedgeCut {
    /// Radius of the sphere, with its margin.
    radius: f64,
    /// Whether the centre is outside the wedge.
    beside: bool,
    /// Tangent of half the wedge's angle; then the sphere's centre along and across the wedge.
    t: f64,
    x: f64,
    y: f64,
    /// Centre of the disks, from the base axis; then the distance of the sphere's centre from the wedge.
    middle: f64,
    distance: f64,
}

impl WedgeCut {
    /// Radius of the disk for a link; below 0 if the link has no disk.
    fn disk_radius(&self, link: f64) -> f64 {
        let whole = self.radius + link;
        if self.distance > whole {
            return -1.0;
        }
        let within = if self.beside { (self.t * (self.x + whole) - self.y).max(0.0) } else { 0.0 };
        let radius = (whole * whole - self.distance * self.distance + within * within).sqrt();
        // No disk if all of it is behind the base axis.
        if self.middle + radius > 0.0 { radius } else { -1.0 }
    }
}

/// Constants of the rows of all planes.
struct DiskRows<'a> {
    arm: PlanarArm,
    /// Cosine and sine of the elbow's arc over half of [`ROWS`] rows and slightly more.
    arc: [f32; 2],
    spans: SpanWriter,
    borders: &'a ArmDirections,
}

impl DiskRows<'_> {
    /// Kernel: adds the spans of the rows of one plane; `row` is the first row.
    #[inline(always)]
    fn write<S: Simd>(
        &self,
        simd: S,
        disks: &GrownDisks,
        row: u32,
        count: usize,
        full_rows: &[u16],
        layer: &mut Layer,
    ) {
        let [x, y] = [disks.center[0] as f32, disks.center[1] as f32];
        let (upper, fore) = (self.arm.upper_length_m as f32, self.arm.fore_length_m as f32);
        // The disk is in reach of an elbow if `center·elbow` is above this value.
        let reach = (fore + disks.wrist) * 1.0001;
        let least = (x * x + y * y + upper * upper - reach * reach) * 0.5;
        let least = least - (x * x + y * y + upper * upper + reach * reach) * 1e-6;
        for start in (0..count).step_by(ROWS) {
            let left = (count - start).min(ROWS);
            let next = full_rows.get(start / WIDTH + 1).unwrap_or(&0);
            let bits = u32::from(full_rows[start / WIDTH]) | u32::from(*next) << WIDTH;
            let inside = (1u16 << left) - 1;
            let full = (bits >> (start % WIDTH)) as u16 & inside;
            // In the middle of the arc; missing rows make the arc shorter.
            let middle = (start + ROWS / 2).min(count);
            let [cos, sin] = [self.borders.cos[middle] * upper, self.borders.sin[middle] * upper];
            let (along, across) = (x * cos + y * sin, (x * sin - y * cos).abs());
            let most = along.max(along * self.arc[0]) + across * self.arc[1];
            let row = row + start as u32;
            if full == inside || disks.wrist < 0.0 || most < least {
                self.spans.write_full(row, full, layer);
                continue;
            }
            let (hit, ends) = self.between_borders(simd, disks, start);
            let hit = hit & inside & !full;
            if full | hit != 0 {
                self.spans.write(simd, RowBatch { row, full, hit }, ends, layer);
            }
        }
    }

    /// The blocked intervals of θ3, in cells, of the rows from `start` on. A row lies between two borders; its interval
    /// contains the intervals of both.
    #[inline(always)]
    fn between_borders<S: Simd>(&self, simd: S, disks: &GrownDisks, start: usize) -> (u16, [Lanes<S>; 2]) {
        let (scale, zero) = (splat(simd, self.spans.scale), splat(simd, self.spans.zero));
        let [x, y] = [splat(simd, disks.center[0] as f32), splat(simd, disks.center[1] as f32)];
        let (cos, sin) = (load(simd, &self.borders.cos[start..]), load(simd, &self.borders.sin[start..]));
        // The centre relative to the elbow, along and across the upper arm.
        let along = mad(x, cos, y * sin) - splat(simd, self.arm.upper_length_m as f32);
        let across = y * cos - x * sin;
        let middle = mad(atan2(simd, across, along), scale, zero);
        let square = mad(along, along, across * across);
        let cosine = half_width_cosine(simd, square, self.arm.fore_length_m as f32, disks);
        let half = acos(simd, cosine) * scale;
        let all = cosine.simd_le(splat(simd, -1.0));
        let hit = cosine.simd_le(splat(simd, 1.0));
        let (huge, none) = (splat(simd, 1e6), splat(simd, f32::INFINITY));
        let lo = all.select(-huge, hit.select(middle - half, none));
        let hi = all.select(huge, hit.select(middle + half, -none));
        // The middle may jump by a turn between neighbouring borders.
        let jump = middle.slide::<1>(middle) - middle;
        let turn = splat(simd, std::f32::consts::TAU * self.spans.scale);
        let half_turn = turn * splat(simd, 0.5);
        let shift = jump.simd_gt(half_turn).select(-turn, jump.simd_lt(-half_turn).select(turn, splat(simd, 0.0)));
        let lo = lo.min(lo.slide::<1>(lo) + shift);
        let hi = hi.max(hi.slide::<1>(hi) + shift);
        (lo.simd_le(hi).to_bitmask() as u16, [lo, hi])
    }
}

/// Cosine of half the interval in which forearm or wrist meet their disks: above 1 never, −1 or less always. The
/// wrist's disk is at least as large: where the forearm's end is the first part to meet its disk, the wrist has already
/// met its own.
#[inline(always)]
fn half_width_cosine<S: Simd>(simd: S, square: Lanes<S>, length: f32, disks: &GrownDisks) -> Lanes<S> {
    let &GrownDisks { fore, wrist, .. } = disks;
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
    // Rounding error of the cosine in f32.
    least - s(2e-6)
}
