//! Boxes and convex polyhedra: outlines plane by plane, intervals row by row.

use std::ops::Range;

use elbowroom_spatial::Vec3;
use fearless_simd::{Select, Simd, SimdBase};

use super::body::{Body, Tilt};
use super::fan::{Fan, SIZE};
use super::intervals::{Plane, rows};
use super::lanes::{ANGLE_ERROR, WIDTH, load, mad, splat};
use super::outline::Outline;
use super::row::Rows;
use super::sift::reached_from;
use super::support::reach;
use super::{Filler, MARGIN, ROUNDING, arc, upper};
use crate::{Layer, PlanarArm};

/// What all planes share.
pub(super) struct Shared {
    pub arm: PlanarArm,
    pub rows: Rows,
    /// The obstacle's enclosing ball, and the largest radius of the arm.
    pub center: Vec3,
    pub around: f64,
    /// Tangent of half a step of θ1, and 1/cos − 1.
    pub tangent: f64,
    pub stretch: f64,
    /// Sine and cosine of half a step of θ2.
    pub turn: [f32; 2],
    /// Margin for single precision, metres.
    pub margin: f32,
    pub sectors: [f64; 2],
    pub apart: f32,
    /// Cosine and sine of half the arc of the elbow over sixteen rows.
    pub arc: [f32; 2],
    /// Length of the upper arm and what single precision may lose of it, metres.
    pub upper_reach: f32,
    /// What single precision may lose of a distance from a line, metres.
    pub rounding: f32,
    /// From an elbow farther outside than this, tangents are good to the margins, metres: what rounding turns a tangent by at
    /// a corner this near moves it by no more than the margin (eight times the rounding) at the end of the forearm.
    pub clear: f32,
}

/// Outlines for the radii of the three parts: the upper arm's as it is, the others turned by half a step of θ2.
pub(super) struct Outlines {
    pub fan: Fan,
    pub raw: Outline,
    pub upper: Outline,
    pub fore: Outline,
    pub wrist: Outline,
    /// See [`reached_from`].
    pub reached_from: [f32; SIZE],
}

#[inline(always)]
pub(super) fn fill<S: Simd, B: Body>(
    simd: S,
    filler: &mut Filler,
    body: &mut B,
    (center, radius): (Vec3, f64),
    which: Range<usize>,
    layer: &mut Layer,
) {
    let [half1, half2, _] = filler.grid.half_widths();
    // The forearm ends in half a ball: the wrist's is no smaller.
    let wrist_radius_m = filler.arm.wrist_radius_m.max(filler.arm.fore_radius_m);
    let arm = PlanarArm { wrist_radius_m, ..filler.arm };
    let thickest = arm.upper_radius_m.max(arm.fore_radius_m).max(arm.wrist_radius_m);
    let size = center.length() + radius + arm.reach_m();
    let shared = Shared {
        arm,
        rows: Rows::new(&filler.grid.axes()[2]),
        center,
        around: radius + thickest,
        tangent: half1.tan(),
        stretch: 1.0 / half1.cos() - 1.0,
        turn: [half2.sin() as f32, half2.cos() as f32],
        margin: (MARGIN * size) as f32,
        sectors: sectors(half2 * 2.0, radius > arm.fore_length_m),
        apart: apart(half2 * 2.0),
        arc: arc(half2 * (WIDTH - 1) as f64),
        upper_reach: (arm.upper_length_m + 1e-6 * size) as f32,
        rounding: (ROUNDING * size) as f32,
        clear: (arm.fore_length_m / 8.0) as f32,
    };
    let mut outlines = Outlines {
        fan: Fan::new([[1.0, 0.0]].into_iter(), shared.apart),
        raw: Outline::EMPTY,
        upper: Outline::EMPTY,
        fore: Outline::EMPTY,
        wrist: Outline::EMPTY,
        reached_from: [0.0; SIZE],
    };
    let Filler { grid, planes, middles, borders, scratch, .. } = filler;
    let shoulder = &grid.axes()[1];
    for (i, &plane) in planes.iter().enumerate().take(which.end).skip(which.start) {
        let before = layer.spans.len();
        let mut ordered = true;
        for side in [1.0, -1.0] {
            if !shared.may_reach(plane, side) {
                continue;
            }
            body.turn(plane);
            if !outlines.of(simd, &shared, body, side) {
                continue;
            }
            scratch.full.fill(0);
            if outlines.upper.exists
                && let Some((lo, hi)) = outlines.upper.seen_from_shoulder(simd, &outlines.fan, shared.upper_reach)
            {
                upper::mark(shoulder, lo - UPPER_MARGIN, hi + UPPER_MARGIN, &mut scratch.full);
            }
            let plane =
                Plane { row: i * shoulder.count(), rows: shoulder.count(), full: &scratch.full, middles, borders };
            ordered &= before == layer.spans.len();
            ordered &= outlines.parts(simd, &shared, body, side, &plane, layer);
        }
        if !ordered {
            layer.spans[before..].sort_unstable();
        }
    }
}

/// What angles seen from the shoulder may be wrong by in single precision, radians.
const UPPER_MARGIN: f64 = 2.0 * ANGLE_ERROR as f64;

impl Shared {
    /// False where not even the enclosing ball, grown by the thickest part, reaches into the wedge.
    fn may_reach(&self, [cos, sin]: [f64; 2], side: f64) -> bool {
        let x = (self.center.x * cos + self.center.y * sin) * side;
        let y = (self.center.y * cos - self.center.x * sin).abs();
        let around = self.around + f64::from(self.margin);
        x + around > 0.0 && y - self.tangent * x <= around * (1.0 + self.stretch)
    }
}

impl Outlines {
    /// The whole outlines of one plane; false where nothing of the arm reaches.
    #[inline(always)]
    fn of<S: Simd, B: Body>(&mut self, simd: S, shared: &Shared, body: &B, side: f64) -> bool {
        let lean = (shared.tangent * side) as f32;
        let gap = gap(simd, body, lean, side as f32, shared) - shared.margin;
        let arm = &shared.arm;
        let [upper, fore, wrist] = [arm.upper_radius_m, arm.fore_radius_m, arm.wrist_radius_m].map(|r| r as f32);
        (self.upper.exists, self.fore.exists, self.wrist.exists) = (upper >= gap, fore >= gap, wrist >= gap);
        if !(self.upper.exists || self.fore.exists || self.wrist.exists) {
            return false;
        }
        // y is down in the shoulder's frame, z up in the body's.
        self.fan = Fan::new(body.own_directions(lean).map(|[x, z]| [x, -z]), shared.apart);
        if self.upper.exists {
            far(simd, shared, body, &self.fan, (lean, upper), &mut self.upper.far);
            self.upper.exists = self.upper.close(simd, &self.fan);
        }
        true
    }

    /// Spans of one plane; false where they do not ascend.
    ///
    /// Turning a solid about the shoulder and taking what is convex around it adds little to a solid that is seen within a
    /// narrow angle, and much to one around the shoulder: such a one is cut into sectors.
    #[inline(always)]
    fn parts<S: Simd, B: Body>(
        &mut self,
        simd: S,
        shared: &Shared,
        body: &B,
        side: f64,
        plane: &Plane,
        layer: &mut Layer,
    ) -> bool {
        let lean = (shared.tangent * side) as f32;
        if !(self.fore.exists || self.wrist.exists) {
            return rows(simd, shared, self, plane, true, layer);
        }
        let spread = self.grown(simd, shared, body, lean, None);
        let (lo, hi) = spread.unwrap_or((0.0, std::f64::consts::TAU));
        if hi - lo < shared.sectors[0] {
            return rows(simd, shared, self, plane, true, layer);
        }
        let sectors = ((hi - lo) / shared.sectors[1]).ceil();
        let exist = (self.fore.exists, self.wrist.exists);
        for k in 0..sectors as u32 {
            let border = |k: u32| (lo + (hi - lo) * f64::from(k) / sectors).sin_cos();
            let ((sin, cos), (next_sin, next_cos)) = (border(k), border(k + 1));
            let sides = [[sin as f32, -cos as f32], [-next_sin as f32, next_cos as f32]];
            self.fan = Fan::new(sides.into_iter().chain(body.own_directions(lean).map(|[x, z]| [x, -z])), shared.apart);
            (self.fore.exists, self.wrist.exists) = exist;
            self.grown(simd, shared, body, lean, Some(sides));
            rows(simd, shared, self, plane, k == 0, layer);
        }
        false
    }

    /// The outlines of forearm and wrist, or what of them lies in a sector of these two normals, turned by half a step of
    /// θ2; the directions in which the larger lies before it is turned.
    #[inline(always)]
    fn grown<S: Simd, B: Body>(
        &mut self,
        simd: S,
        shared: &Shared,
        body: &B,
        lean: f32,
        sector: Option<[[f32; 2]; 2]>,
    ) -> Option<(f64, f64)> {
        let Self { fan, raw, fore, wrist, .. } = self;
        let mut spread: Option<Option<(f64, f64)>> = None;
        for (part, radius) in [(wrist, shared.arm.wrist_radius_m), (fore, shared.arm.fore_radius_m)] {
            if !part.exists {
                continue;
            }
            far(simd, shared, body, fan, (lean, radius as f32), &mut raw.far);
            for [x, y] in sector.into_iter().flatten() {
                // The nearest direction is this one: sides come first into the fan.
                let along = |k: &usize| fan.x[*k] * x + fan.y[*k] * y;
                if let Some(k) = (0..fan.count).max_by(|a, b| along(a).total_cmp(&along(b))) {
                    raw.far[k] = raw.far[k].min(shared.margin);
                }
            }
            raw.exists = raw.close(simd, fan);
            if !raw.exists {
                part.exists = false;
                continue;
            }
            let seen = raw.spread(simd, fan);
            spread = Some(match (spread, seen) {
                (None, seen) => seen,
                (Some(Some(a)), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
                _ => None,
            });
            raw.turned_both_ways(simd, fan, shared.turn, part);
        }
        // Where rounding says that there is no such outline, the forearm's serves for its end.
        if self.fore.exists && !self.wrist.exists {
            self.wrist.clone_from(&self.fore);
        }
        reached_from(simd, shared, &self.fan, &self.wrist, &mut self.reached_from);
        spread.flatten()
    }
}

/// Seen within the first angle from the shoulder a solid is taken whole, otherwise in sectors of about the second; radians.
/// Coarse tables have few cells inside for those that are blocked needlessly at the border, and few rows to pay for; floors
/// and walls that the arm just reaches are all border.
fn sectors(step2: f64, large: bool) -> [f64; 2] {
    let whole = if large { 0.6 } else { (0.08 / step2).clamp(0.6, 2.0) };
    [whole, 0.25]
}

/// Cosine of the angle between neighbouring lines: 24 degrees, 12 in coarse tables.
fn apart(step2: f64) -> f32 {
    if step2 > 0.045 { 0.978 } else { 0.9135 }
}

/// The radius from which on the grown solid reaches into the wedge, metres; negative where it does by itself.
#[inline(always)]
fn gap<S: Simd, B: Body>(simd: S, body: &B, lean: f32, side: f32, shared: &Shared) -> f32 {
    let (none, one) = (splat(simd, 0.0), splat(simd, 1.0));
    let right = Tilt { x: none, z: none, lean: splat(simd, lean), side: one };
    let left = Tilt { side: -one, ..right };
    let over = splat(simd, 1.0 / (1.0 + lean * lean).sqrt());
    let beside = body.piece(simd, &right, one).slope.min(body.piece(simd, &left, one).slope) * over;
    let ahead = Tilt { x: splat(simd, side), z: none, lean: none, side: none };
    let ahead = body.piece(simd, &ahead, none).at + splat(simd, side * shared.arm.offset_m as f32);
    -beside.min(ahead).to_array()[0]
}

/// Distances of the outline's lines from the shoulder.
#[inline(always)]
fn far<S: Simd, B: Body>(
    simd: S,
    shared: &Shared,
    body: &B,
    fan: &Fan,
    (lean, radius): (f32, f32),
    out: &mut [f32; SIZE],
) {
    let radius = radius + shared.margin;
    let zero = splat(simd, 0.0);
    let side = splat(simd, lean.signum());
    let offset = splat(simd, shared.arm.offset_m as f32);
    let [up, down] = body.heights();
    // A point at x along the wedge's middle may be x/cos δ1 from the axis.
    let farthest = shared.center.x.hypot(shared.center.y) + shared.around;
    let stretch = splat(simd, (farthest * shared.stretch) as f32);
    // What the arm cannot reach is of no use, and far corners would be turned far.
    let length = (shared.arm.upper_length_m + shared.arm.fore_length_m) as f32;
    let limit = splat(simd, length * (1.0 + 1e-5) + shared.margin);
    for at in (0..fan.count).step_by(WIDTH) {
        let (x, z) = (load(simd, &fan.x[at..]), -load(simd, &fan.y[at..]));
        let reached = reach(simd, body, [x, z], lean, radius);
        // Nothing of this wedge lies beyond the base axis.
        let height = (z * splat(simd, up)).max(z * splat(simd, -down));
        let axis = mad(z.abs(), splat(simd, radius), height) - x * offset;
        let inward = (x * side).simd_lt(zero);
        let reached = inward.select(reached.min(axis), reached);
        let outward = (x * side).max(zero) * stretch;
        (reached + outward).min(limit).store_slice(&mut out[at..at + WIDTH]);
    }
}
