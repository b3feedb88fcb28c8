//! Convex outlines in the arm's plane: lines, and the part of each line that bounds the outline.

use std::f64::consts::TAU;

use elbowroom_validity::lanes::simd::{
    Level as SimdLevel, Select, Simd, SimdBase, SimdFloat, SimdMask, dispatch, mask32x16,
};

use super::half_planes;
use super::normals::{OutlineNormals, PADDED_NORMALS};
use super::simd_math::{Lanes, WIDTH, atan2, load, mad, splat};

/// Overlap, in metres, by which the neighbours of a line meet in front of it before it is moved inward.
const SLACK_LINE_M: f32 = 2e-4;

/// A convex outline in the shoulder's frame (x outward, y down): points with `normal·p ≤ far` for all [`OutlineNormals`].
///
/// Line `k` bounds the outline from `from` to `to` along its tangent (the normal rotated by +90°), counted from the
/// foot of the perpendicular from the shoulder. A line that does not touch the outline has `from > to`; its neighbours
/// then extend slightly too far.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    pub far: [f32; PADDED_NORMALS],
    pub from: [f32; PADDED_NORMALS],
    pub to: [f32; PADDED_NORMALS],
    /// Corner `k`, between lines `k − 1` and `k`.
    pub corner_x: [f32; PADDED_NORMALS],
    pub corner_y: [f32; PADDED_NORMALS],
    /// False if the outline is empty.
    pub exists: bool,
}

impl Outline {
    pub const EMPTY: Self = Self {
        far: [0.0; PADDED_NORMALS],
        from: [0.0; PADDED_NORMALS],
        to: [0.0; PADDED_NORMALS],
        corner_x: [0.0; PADDED_NORMALS],
        corner_y: [0.0; PADDED_NORMALS],
        exists: false,
    };

    /// Computes corners and stretches from the lines' distances, after moving lines inward that do not touch; false if
    /// the outline is empty.
    #[inline(always)]
    fn complete<S: Simd>(&mut self, simd: S, normals: &OutlineNormals) -> bool {
        let mut is_tight = false;
        loop {
            self.set_corners(simd, normals);
            if is_tight || !self.is_slack(simd, normals) {
                return true;
            }
            if !half_planes::tighten(normals, &mut self.far) {
                return false;
            }
            is_tight = true;
        }
    }

    /// Whether some line does not touch the outline.
    #[inline(always)]
    fn is_slack<S: Simd>(&self, simd: S, normals: &OutlineNormals) -> bool {
        let mut slack = false;
        for at in (0..normals.count).step_by(WIDTH) {
            let by = load(simd, &self.from[at..]) - load(simd, &self.to[at..]);
            slack |= by.simd_gt(splat(simd, SLACK_LINE_M)).any_true();
        }
        slack
    }

    #[inline(always)]
    fn set_corners<S: Simd>(&mut self, simd: S, normals: &OutlineNormals) {
        let first = self.far[0];
        self.far[normals.count..].fill(first);
        for at in (0..normals.count).step_by(WIDTH) {
            let [x, y, far] = [load(simd, &normals.x[at..]), load(simd, &normals.y[at..]), load(simd, &self.far[at..])];
            let [next_x, next_y, next_far] =
                [load(simd, &normals.x[at + 1..]), load(simd, &normals.y[at + 1..]), load(simd, &self.far[at + 1..])];
            let over = splat(simd, 1.0) / (x * next_y - y * next_x);
            let corner_x = (far * next_y - next_far * y) * over;
            let corner_y = (next_far * x - far * next_x) * over;
            corner_x.store_slice(&mut self.corner_x[at + 1..][..WIDTH]);
            corner_y.store_slice(&mut self.corner_y[at + 1..][..WIDTH]);
        }
        self.corner_x[0] = self.corner_x[normals.count];
        self.corner_y[0] = self.corner_y[normals.count];
        for at in (0..normals.count).step_by(WIDTH) {
            let [x, y] = [load(simd, &normals.x[at..]), load(simd, &normals.y[at..])];
            let along = |corner_x: Lanes<S>, corner_y: Lanes<S>| corner_y * x - corner_x * y;
            let before = along(load(simd, &self.corner_x[at..]), load(simd, &self.corner_y[at..]));
            let after = along(load(simd, &self.corner_x[at + 1..]), load(simd, &self.corner_y[at + 1..]));
            before.store_slice(&mut self.from[at..][..WIDTH]);
            after.store_slice(&mut self.to[at..][..WIDTH]);
        }
    }

    /// Completes this outline and writes an outline that contains it after any rotation about the shoulder, to either
    /// side, up to the angle of this sine and cosine. Returns the directions in which this outline lies.
    pub fn rotate_both_ways(
        &mut self,
        simd_level: SimdLevel,
        normals: &OutlineNormals,
        sin_cos: [f32; 2],
        out: &mut Self,
    ) -> Directions {
        let directions = dispatch!(simd_level, simd => {
            if self.complete(simd, normals) {
                self.rotate_lanes(simd, normals, sin_cos, out);
                self.directions_lanes(simd, normals)
            } else {
                Directions::Nowhere
            }
        });
        (self.exists, out.exists) = (directions != Directions::Nowhere, directions != Directions::Nowhere);
        directions
    }

    #[inline(always)]
    fn rotate_lanes<S: Simd>(&self, simd: S, normals: &OutlineNormals, [sine, cosine]: [f32; 2], out: &mut Self) {
        let (sine, cosine) = (splat(simd, sine), splat(simd, cosine));
        for at in (0..normals.count).step_by(WIDTH) {
            let [x, y] = [load(simd, &normals.x[at..]), load(simd, &normals.y[at..])];
            let mut most = splat(simd, f32::NEG_INFINITY);
            for k in 0..normals.count {
                let (corner_x, corner_y) = (splat(simd, self.corner_x[k]), splat(simd, self.corner_y[k]));
                let along = mad(corner_x, x, corner_y * y);
                let across = (corner_y * x - corner_x * y).abs();
                most = most.max(mad(across, sine, along.max(along * cosine)));
            }
            most.store_slice(&mut out.far[at..][..WIDTH]);
        }
        out.set_corners(simd, normals);
    }

    /// Directions from the shoulder in which the outline lies.
    #[inline(always)]
    fn directions_lanes<S: Simd>(&self, simd: S, normals: &OutlineNormals) -> Directions {
        let Some(view) = ShoulderView::new(normals, self) else { return Directions::Everywhere };
        let mut range = TangentRange::new(simd, view);
        for at in (0..normals.count).step_by(WIDTH) {
            let corner = [load(simd, &self.corner_x[at..]), load(simd, &self.corner_y[at..])];
            range.include(simd, valid_lanes(normals, at), corner);
        }
        range.directions(simd).unwrap_or(Directions::Everywhere)
    }

    /// Completes this outline. Returns the directions from the shoulder in which a link of length `reach` meets it.
    pub fn complete_within(&mut self, simd_level: SimdLevel, normals: &OutlineNormals, reach: f32) -> Directions {
        dispatch!(simd_level, simd => {
            self.exists = self.complete(simd, normals);
            if self.exists { self.reachable_lanes(simd, normals, reach) } else { Directions::Nowhere }
        })
    }

    #[inline(always)]
    fn reachable_lanes<S: Simd>(&self, simd: S, normals: &OutlineNormals, reach: f32) -> Directions {
        let Some(view) = ShoulderView::new(normals, self) else { return Directions::Everywhere };
        let mut range = TangentRange::new(simd, view);
        for at in (0..normals.count).step_by(WIDTH) {
            let [x, y] = [load(simd, &normals.x[at..]), load(simd, &normals.y[at..])];
            let far = load(simd, &self.far[at..]);
            let square = splat(simd, reach * reach) - far * far;
            let half = square.max(splat(simd, 0.0)).sqrt();
            let [from, to] = [load(simd, &self.from[at..]).max(-half), load(simd, &self.to[at..]).min(half)];
            let meets = (from.simd_le(to) & square.simd_ge(splat(simd, 0.0))).to_bitmask() & valid_lanes(normals, at);
            for s in [from, to] {
                range.include(simd, meets, [far * x - s * y, mad(far, y, s * x)]);
            }
        }
        range.directions(simd).unwrap_or(Directions::Nowhere)
    }
}

/// A set of directions from the shoulder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Directions {
    /// Empty set: the outline is empty or out of reach.
    Nowhere,
    /// All directions: the shoulder is inside the outline.
    Everywhere,
    /// From the lowest to the highest angle, radians.
    Between(f64, f64),
}

impl Directions {
    /// Lowest and highest angle, radians; for all directions, one turn that starts at `start`.
    pub fn range_from(self, start: f64) -> Option<(f64, f64)> {
        match self {
            Self::Nowhere => None,
            Self::Everywhere => Some((start, start + TAU)),
            Self::Between(lo, hi) => Some((lo, hi)),
        }
    }

    /// The smallest range that contains both sets.
    pub fn union(self, other: Self) -> Self {
        match (self, other) {
            (Self::Nowhere, any) | (any, Self::Nowhere) => any,
            (Self::Between(lo, hi), Self::Between(from, to)) => Self::Between(lo.min(from), hi.max(to)),
            _ => Self::Everywhere,
        }
    }
}

/// Bits of the lanes from line `at` on that are lines of the outline instead of padding.
fn valid_lanes(normals: &OutlineNormals, at: usize) -> u64 {
    !0 >> (64 - (normals.count - at).min(WIDTH))
}

/// An outline seen from the shoulder.
#[derive(Clone, Copy)]
struct ShoulderView {
    /// Reversed unit normal of the line of the outline from which the shoulder is farthest outside.
    ahead: [f32; 2],
    /// Distance of the shoulder from that line: the whole outline is beyond the line.
    depth: f32,
}

impl ShoulderView {
    /// Creates the view; `None` if the shoulder is inside the outline.
    #[inline(always)]
    fn new(normals: &OutlineNormals, outline: &Outline) -> Option<Self> {
        let (mut k, mut least) = (0, f32::INFINITY);
        for (line, &far) in outline.far[..normals.count].iter().enumerate() {
            if far < least {
                (k, least) = (line, far);
            }
        }
        (least < 0.0).then_some(Self { ahead: [-normals.x[k], -normals.y[k]], depth: -least })
    }
}

/// A range of directions from the shoulder, as tangents of the angle from the direction ahead.
struct TangentRange<S: Simd> {
    view: ShoulderView,
    lo: Lanes<S>,
    hi: Lanes<S>,
}

impl<S: Simd> TangentRange<S> {
    /// Creates an empty range.
    #[inline(always)]
    fn new(simd: S, view: ShoulderView) -> Self {
        Self { view, lo: splat(simd, f32::INFINITY), hi: splat(simd, f32::NEG_INFINITY) }
    }

    #[inline(always)]
    fn include(&mut self, simd: S, lanes: u64, [x, y]: [Lanes<S>; 2]) {
        let lanes = mask32x16::from_bitmask(simd, lanes);
        let [ahead_x, ahead_y] = [splat(simd, self.view.ahead[0]), splat(simd, self.view.ahead[1])];
        let ahead = mad(ahead_x, x, ahead_y * y).max(splat(simd, self.view.depth));
        let tangent = (ahead_x * y - ahead_y * x) / ahead;
        self.lo = lanes.select(self.lo.min(tangent), self.lo);
        self.hi = lanes.select(self.hi.max(tangent), self.hi);
    }

    /// The range as angles; `None` if it is empty.
    #[inline(always)]
    fn directions(&self, simd: S) -> Option<Directions> {
        let (lo, hi) = (self.lo.min(self.lo.slide::<8>(self.lo)), self.hi.max(self.hi.slide::<8>(self.hi)));
        let (lo, hi) = (lo.min(lo.slide::<4>(lo)), hi.max(hi.slide::<4>(hi)));
        let (lo, hi) = (lo.min(lo.slide::<2>(lo)), hi.max(hi.slide::<2>(hi)));
        let (lo, hi) = (lo.min(lo.slide::<1>(lo)).to_array()[0], hi.max(hi.slide::<1>(hi)).to_array()[0]);
        let (mut x, mut y) = ([1.0; WIDTH], [0.0; WIDTH]);
        (x[0], y[0], y[1], y[2]) = (self.view.ahead[0], self.view.ahead[1], lo, hi);
        let angles = atan2(simd, load(simd, &y), load(simd, &x)).to_array();
        let middle = f64::from(angles[0]);
        (lo <= hi).then(|| Directions::Between(middle + f64::from(angles[1]), middle + f64::from(angles[2])))
    }
}
