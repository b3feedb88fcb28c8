//! Convex outlines in the arm's plane: lines, and the stretch of each that bounds the outline.

use fearless_simd::{Simd, SimdBase, SimdMask};

use super::{arcs, clip};
use super::fan::{Fan, SIZE};
use super::lanes::{F, WIDTH, load, mad, splat};

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
            let [next_x, next_y, next_far] = [load(simd, &fan.x[at + 1..]), load(simd, &fan.y[at + 1..]), load(simd, &self.far[at + 1..])];
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
    pub fn spread(&self, fan: &Fan) -> Option<(f64, f64)> {
        let (k, nearest) = (0..fan.count).map(|k| (k, self.far[k])).min_by(|a, b| a.1.total_cmp(&b.1))?;
        if !(nearest < 0.0) {
            return None;
        }
        let ahead = [-f64::from(fan.x[k]), -f64::from(fan.y[k])];
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in 0..fan.count {
            let (x, y) = (f64::from(self.corner_x[k]), f64::from(self.corner_y[k]));
            let tangent = (ahead[0] * y - ahead[1] * x) / (ahead[0] * x + ahead[1] * y).max(1e-12);
            (lo, hi) = (lo.min(tangent), hi.max(tangent));
        }
        let middle = ahead[1].atan2(ahead[0]);
        Some((middle + lo.atan(), middle + hi.atan()))
    }

    /// Directions from the shoulder in which a link of length `reach` meets the outline: lowest and highest angle,
    /// radians; `None` where it never does.
    pub fn seen_from_shoulder(&self, fan: &Fan, reach: f64) -> Option<(f64, f64)> {
        if (0..fan.count).all(|k| self.far[k] >= 0.0) {
            return Some((-std::f64::consts::PI, std::f64::consts::PI));
        }
        arcs::seen(self, fan, [0.0; 2], reach)
    }
}
