//! Boxes and convex polyhedra: outlines plane by plane, intervals row by row.

use std::ops::Range;

use elbowroom_spatial::Vec3;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::body::{Body, Tilt};
use super::fan::{Fan, SIZE};
use super::lanes::{F, WIDTH, atan2, load, mad, splat};
use super::outline::Outline;
use super::row::Rows;
use super::support::reach;
use super::{Directions, Filler, arcs, upper};
use crate::{Layer, PlanarArm};

/// What all planes share.
struct Shared {
    arm: PlanarArm,
    rows: Rows,
    /// The obstacle's enclosing ball, and the largest radius of the arm.
    center: Vec3,
    around: f64,
    /// Tangent of half a step of θ1, and 1/cos − 1.
    tangent: f64,
    stretch: f64,
    /// Sine and cosine of half a step of θ2.
    turn: [f32; 2],
    /// Margin for single precision, metres.
    margin: f32,
    /// From an elbow farther than this from the enclosing ball's middle nothing is reached, whatever θ1 and θ2 within their
    /// cells, metres.
    reach: f32,
    sectors: [f64; 2],
    apart: f32,
}

/// Outlines for the radii of the three parts: the upper arm's as it is, the others turned by half a step of θ2.
struct Outlines {
    fan: Fan,
    raw: Outline,
    upper: Outline,
    fore: Outline,
    wrist: Outline,
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
    let arm = filler.arm;
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
        margin: (4e-6 * size) as f32,
        reach: ((radius + thickest + arm.fore_length_m) * 1.001 + size * (half1 + half2)) as f32,
        sectors: sectors(half2 * 2.0, radius > arm.fore_length_m),
        apart: apart(half2 * 2.0),
    };
    let mut outlines = Outlines {
        fan: Fan::new([[1.0, 0.0]].into_iter(), shared.apart),
        raw: Outline::EMPTY,
        upper: Outline::EMPTY,
        fore: Outline::EMPTY,
        wrist: Outline::EMPTY,
    };
    let Filler { grid, planes, middles, scratch, .. } = filler;
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
                && let Some((lo, hi)) = outlines.upper.seen_from_shoulder(&outlines.fan, arm.upper_length_m)
            {
                upper::mark(shoulder, lo - UPPER_MARGIN, hi + UPPER_MARGIN, &mut scratch.full);
            }
            let out = center.x * plane[0] + center.y * plane[1] - arm.offset_m;
            let middle = [out as f32, (arm.height_m - center.z) as f32];
            let plane = Plane { row: i * shoulder.count(), rows: shoulder.count(), full: &scratch.full, middles, middle };
            ordered &= before == layer.spans.len();
            ordered &= outlines.parts(simd, &shared, body, side, &plane, layer);
        }
        if !ordered {
            layer.spans[before..].sort_unstable();
        }
    }
}

/// What the corners of outlines may be wrong by in single precision, seen from the shoulder, radians.
const UPPER_MARGIN: f64 = 1e-5;

impl Shared {
    /// False where not even the enclosing ball, grown by the thickest part, reaches into the wedge.
    fn may_reach(&self, [cos, sin]: [f64; 2], side: f64) -> bool {
        let x = (self.center.x * cos + self.center.y * sin) * side;
        let y = (self.center.y * cos - self.center.x * sin).abs();
        let around = self.around + f64::from(self.margin);
        let beyond = (y - self.tangent * x) / (1.0 + self.tangent * self.tangent).sqrt();
        x + around > 0.0 && beyond <= around
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
            let seen = raw.spread(fan);
            spread = Some(match (spread, seen) {
                (None, seen) => seen,
                (Some(Some(a)), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
                _ => None,
            });
            raw.turned_both_ways(simd, fan, shared.turn, part);
        }
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

/// The rows of one plane.
struct Plane<'a> {
    /// Number of the first row, and how many there are.
    row: usize,
    rows: usize,
    full: &'a [u16],
    middles: &'a Directions,
    /// The enclosing ball's middle, shoulder's frame.
    middle: [f32; 2],
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

/// Spans of all rows of one plane; false where they do not ascend.
#[inline(always)]
fn rows<S: Simd>(
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

/// The least and the greatest direction seen so far, as points.
#[derive(Clone, Copy)]
struct Seen<S: Simd> {
    lo: [F<S>; 2],
    hi: [F<S>; 2],
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

/// Where the forearm's axis meets its outline, sixteen rows.
struct Forearm<S: Simd> {
    /// All directions: the elbow is inside.
    all: u16,
    hit: u16,
    seen: Seen<S>,
}

impl<S: Simd> Forearm<S> {
    #[inline(always)]
    fn of(simd: S, shared: &Shared, outlines: &Outlines, elbow: [F<S>; 2]) -> Self {
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
struct Wrist<S: Simd> {
    all: u16,
    /// Rows with one arc.
    hit: u16,
    arc: Seen<S>,
    /// Rows with several arcs, or where single precision cannot tell.
    several: u16,
}

/// A circle that crosses a line this near to its end crosses it, metres.
const CROSSING: f32 = 1e-5;

impl<S: Simd> Wrist<S> {
    #[inline(always)]
    fn of(simd: S, shared: &Shared, outlines: &Outlines, elbow: [F<S>; 2]) -> Self {
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
