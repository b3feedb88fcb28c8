//! Convex outlines in the arm's plane: lines, and the stretch of each that bounds the outline.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, mask32x16};

use super::clip;
use super::fan::{Fan, SIZE};
use super::lanes::{F, WIDTH, atan2, load, mad, splat};

/// A line beside the outline whose neighbours meet before it by more than this is drawn in, metres.
const LOOSE: f32 = 2e-4;

/// A convex outline, shoulder's frame (x outward, y down): points with `normal·p ≤ far` for every direction of a [`Fan`].
///
/// Line `k` bounds the outline from `from` to `to` along its tangent (the normal turned by +90°), counted from the foot of
/// the shoulder. A line that does not touch the outline has `from > to`; its neighbours then reach a little too far.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    pub far: [f32; SIZE],
    pub from: [f32; SIZE],
    pub to: [f32; SIZE],
    /// Corner `k`, between lines `k − 1` and `k`.
    pub corner_x: [f32; SIZE],
    pub corner_y: [f32; SIZE],
    /// False where nothing is inside.
    pub exists: bool,
}

impl Outline {
    pub const EMPTY: Self = Self {
        far: [0.0; SIZE],
        from: [0.0; SIZE],
        to: [0.0; SIZE],
        corner_x: [0.0; SIZE],
        corner_y: [0.0; SIZE],
        exists: false,
    };

    /// Corners and stretches from the lines' distances; lines that do not touch are drawn in first. False where nothing is
    /// inside.
    #[inline(always)]
    pub fn close<S: Simd>(&mut self, simd: S, fan: &Fan) -> bool {
        self.corners(simd, fan);
        let mut loose = false;
        for at in (0..fan.count).step_by(WIDTH) {
            let by = load(simd, &self.from[at..]) - load(simd, &self.to[at..]);
            loose |= by.simd_gt(splat(simd, LOOSE)).any_true();
        }
        if loose {
            if !clip::tighten(fan, &mut self.far) {
                return false;
            }
            self.corners(simd, fan);
        }
        true
    }

    #[inline(always)]
    fn corners<S: Simd>(&mut self, simd: S, fan: &Fan) {
        let first = self.far[0];
        self.far[fan.count..].fill(first);
        for at in (0..fan.count).step_by(WIDTH) {
            let [x, y, far] = [load(simd, &fan.x[at..]), load(simd, &fan.y[at..]), load(simd, &self.far[at..])];
            let [next_x, next_y, next_far] =
                [load(simd, &fan.x[at + 1..]), load(simd, &fan.y[at + 1..]), load(simd, &self.far[at + 1..])];
            let over = splat(simd, 1.0) / (x * next_y - y * next_x);
            let corner_x = (far * next_y - next_far * y) * over;
            let corner_y = (next_far * x - far * next_x) * over;
            corner_x.store_slice(&mut self.corner_x[at + 1..][..WIDTH]);
            corner_y.store_slice(&mut self.corner_y[at + 1..][..WIDTH]);
        }
        self.corner_x[0] = self.corner_x[fan.count];
        self.corner_y[0] = self.corner_y[fan.count];
        for at in (0..fan.count).step_by(WIDTH) {
            let [x, y] = [load(simd, &fan.x[at..]), load(simd, &fan.y[at..])];
            let along = |corner_x: F<S>, corner_y: F<S>| corner_y * x - corner_x * y;
            let before = along(load(simd, &self.corner_x[at..]), load(simd, &self.corner_y[at..]));
            let after = along(load(simd, &self.corner_x[at + 1..]), load(simd, &self.corner_y[at + 1..]));
            before.store_slice(&mut self.from[at..][..WIDTH]);
            after.store_slice(&mut self.to[at..][..WIDTH]);
        }
    }

    /// An outline that holds this one turned about the shoulder by any angle up to the one of this sine and cosine, to
    /// either side.
    #[inline(always)]
    pub fn turned_both_ways<S: Simd>(&self, simd: S, fan: &Fan, [sine, cosine]: [f32; 2], out: &mut Self) {
        let (sine, cosine) = (splat(simd, sine), splat(simd, cosine));
        for at in (0..fan.count).step_by(WIDTH) {
            let [x, y] = [load(simd, &fan.x[at..]), load(simd, &fan.y[at..])];
            let mut most = splat(simd, f32::NEG_INFINITY);
            for k in 0..fan.count {
                let (corner_x, corner_y) = (splat(simd, self.corner_x[k]), splat(simd, self.corner_y[k]));
                let along = mad(corner_x, x, corner_y * y);
                let across = (corner_y * x - corner_x * y).abs();
                most = most.max(mad(across, sine, along.max(along * cosine)));
            }
            most.store_slice(&mut out.far[at..][..WIDTH]);
        }
        out.corners(simd, fan);
        out.exists = self.exists;
    }

    /// Directions from the shoulder in which the outline lies, lowest and highest angle, radians; `None` where the
    /// shoulder is inside.
    #[inline(always)]
    pub fn spread<S: Simd>(&self, simd: S, fan: &Fan) -> Option<(f64, f64)> {
        let mut seen = Seen::from_shoulder(simd, fan, self)?;
        for at in (0..fan.count).step_by(WIDTH) {
            let corner = [load(simd, &self.corner_x[at..]), load(simd, &self.corner_y[at..])];
            seen.take(simd, in_fan(fan, at), corner);
        }
        seen.angles(simd)
    }

    /// Directions from the shoulder in which a link of length `reach` meets the outline: lowest and highest angle,
    /// radians; `None` where it never does.
    #[inline(always)]
    pub fn seen_from_shoulder<S: Simd>(&self, simd: S, fan: &Fan, reach: f32) -> Option<(f64, f64)> {
        let Some(mut seen) = Seen::from_shoulder(simd, fan, self) else {
            return Some((-std::f64::consts::PI, std::f64::consts::PI));
        };
        for at in (0..fan.count).step_by(WIDTH) {
            let [x, y] = [load(simd, &fan.x[at..]), load(simd, &fan.y[at..])];
            let far = load(simd, &self.far[at..]);
            let square = splat(simd, reach * reach) - far * far;
            let half = square.max(splat(simd, 0.0)).sqrt();
            let [from, to] = [load(simd, &self.from[at..]).max(-half), load(simd, &self.to[at..]).min(half)];
            let meets = (from.simd_le(to) & square.simd_ge(splat(simd, 0.0))).to_bitmask() & in_fan(fan, at);
            for s in [from, to] {
                seen.take(simd, meets, [far * x - s * y, mad(far, y, s * x)]);
            }
        }
        seen.angles(simd)
    }
}

/// Bits of the lanes from line `at` on that are lines of the fan.
fn in_fan(fan: &Fan, at: usize) -> u64 {
    !0 >> (64 - (fan.count - at).min(WIDTH))
}

/// What of an outline was seen, as tangents of the angle from a direction ahead.
struct Seen<S: Simd> {
    ahead: [f32; 2],
    /// How far the shoulder is outside.
    depth: f32,
    lo: F<S>,
    hi: F<S>,
}

impl<S: Simd> Seen<S> {
    /// Looks square at the line that the shoulder is farthest outside of: all of the outline is beyond it. `None` where the
    /// shoulder is inside.
    #[inline(always)]
    fn from_shoulder(simd: S, fan: &Fan, outline: &Outline) -> Option<Self> {
        let (mut k, mut least) = (0, f32::INFINITY);
        for (line, &far) in outline.far[..fan.count].iter().enumerate() {
            if far < least {
                (k, least) = (line, far);
            }
        }
        let ahead = [-fan.x[k], -fan.y[k]];
        let (lo, hi) = (splat(simd, f32::INFINITY), splat(simd, f32::NEG_INFINITY));
        (least < 0.0).then_some(Self { ahead, depth: -least, lo, hi })
    }

    #[inline(always)]
    fn take(&mut self, simd: S, lanes: u64, [x, y]: [F<S>; 2]) {
        let lanes = mask32x16::from_bitmask(simd, lanes);
        let [ahead_x, ahead_y] = [splat(simd, self.ahead[0]), splat(simd, self.ahead[1])];
        let ahead = mad(ahead_x, x, ahead_y * y).max(splat(simd, self.depth));
        let tangent = (ahead_x * y - ahead_y * x) / ahead;
        self.lo = lanes.select(self.lo.min(tangent), self.lo);
        self.hi = lanes.select(self.hi.max(tangent), self.hi);
    }

    /// Lowest and highest angle; `None` where nothing was seen.
    #[inline(always)]
    fn angles(&self, simd: S) -> Option<(f64, f64)> {
        let (lo, hi) = (self.lo.min(self.lo.slide::<8>(self.lo)), self.hi.max(self.hi.slide::<8>(self.hi)));
        let (lo, hi) = (lo.min(lo.slide::<4>(lo)), hi.max(hi.slide::<4>(hi)));
        let (lo, hi) = (lo.min(lo.slide::<2>(lo)), hi.max(hi.slide::<2>(hi)));
        let (lo, hi) = (lo.min(lo.slide::<1>(lo)).to_array()[0], hi.max(hi.slide::<1>(hi)).to_array()[0]);
        let (mut x, mut y) = ([1.0; WIDTH], [0.0; WIDTH]);
        (x[0], y[0], y[1], y[2]) = (self.ahead[0], self.ahead[1], lo, hi);
        let angles = atan2(simd, load(simd, &y), load(simd, &x)).to_array();
        let middle = f64::from(angles[0]);
        (lo <= hi).then(|| (middle + f64::from(angles[1]), middle + f64::from(angles[2])))
    }
}
