//! How far the part of a grown solid that lies in the wedge reaches, in directions of the plane.
//!
//! The wedge of one side of the base axis is `|y| ≤ t·x`. For any `m ≥ 0` the reach of the whole grown solid in the
//! direction `u + m·(t, ±1, 0)` bounds the reach in `u` of what lies in the wedge (the wedge's points have
//! `t·x ± y ≥ 0`), and the least of these bounds is the reach itself (convex duality). So an early stop, or a rounding, only
//! makes the outline larger.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::body::{Body, Piece, Tilt};
use super::lanes::{F, mad, splat};

/// Directions tilt at most this far out of the plane (tangent).
const STEEPEST: f32 = 24.0;
/// A slope is asked just beside the plane, where corners that are equally far do not hide it.
const BESIDE: f32 = 2e-5;
/// Linear pieces that are looked at; a box has at most four.
const STEPS: usize = 3;

/// The curved part: a ball's reach, `radius·√(1 + 2·b·m + c·m²)`.
struct Round<S: Simd> {
    radius: F<S>,
    b: F<S>,
    c: F<S>,
    /// √(c − b²), 1/(radius·√c), 1/c.
    deep: F<S>,
    over: F<S>,
    over_c: F<S>,
}

impl<S: Simd> Round<S> {
    #[inline(always)]
    fn new(simd: S, tilt: &Tilt<S>, radius: f32) -> Self {
        let (lean, one) = (tilt.lean, splat(simd, 1.0));
        let (b, c) = (lean * tilt.x, mad(lean, lean, one));
        let radius = splat(simd, radius.max(1e-7));
        Self { radius, b, c, deep: (c - b * b).sqrt(), over: one / (radius * c.sqrt()), over_c: one / c }
    }

    #[inline(always)]
    fn norm(&self, simd: S, m: F<S>) -> F<S> {
        mad(mad(self.c, m, self.b + self.b), m, splat(simd, 1.0)).sqrt()
    }

    /// Slope of the ball's reach at `m`.
    #[inline(always)]
    fn slope(&self, simd: S, m: F<S>) -> F<S> {
        self.radius * mad(self.c, m, self.b) / self.norm(simd, m)
    }

    /// Where a linear piece and the ball together are least, within 0..steepest.
    #[inline(always)]
    fn least(&self, simd: S, slope: F<S>) -> F<S> {
        let k = -(slope * self.over);
        let inside = splat(simd, 1.0) - k * k;
        let y = k * self.deep / inside.max(splat(simd, 1e-12)).sqrt();
        ((y - self.b) * self.over_c).max(splat(simd, 0.0)).min(splat(simd, STEEPEST))
    }
}

/// Reach in sixteen directions `(x, z)` of the plane, from the shoulder, metres.
#[inline(always)]
pub(super) fn reach<S: Simd, B: Body>(simd: S, body: &B, [x, z]: [F<S>; 2], lean: f32, radius: f32) -> F<S> {
    let one = splat(simd, 1.0);
    let mut tilt = Tilt { x, z, lean: splat(simd, lean), side: one };
    let round = Round::new(simd, &tilt, radius);
    let start = splat(simd, BESIDE);
    // To which side does the farthest point lie outside the wedge?
    let curved = round.slope(simd, start);
    let right = body.piece(simd, &tilt, start);
    tilt.side = -one;
    let left = body.piece(simd, &tilt, start);
    let to_right = right.slope.simd_lt(left.slope);
    let lower = Piece { at: to_right.select(right.at, left.at), slope: to_right.select(right.slope, left.slope) };
    let outside = (lower.slope + curved).simd_lt(splat(simd, 0.0));
    let beside = mad(start, lower.slope, lower.at) + round.radius * round.norm(simd, start);
    if outside.to_bitmask() == 0 {
        return beside;
    }
    tilt.side = to_right.select(one, -one);
    beside.min(tilted(simd, body, &tilt, &round, lower))
}

/// The least bound found: between a piece that still falls and one that rises, next is the `m` where both together are
/// least.
#[inline(always)]
fn tilted<S: Simd, B: Body>(simd: S, body: &B, tilt: &Tilt<S>, round: &Round<S>, lower: Piece<S>) -> F<S> {
    let (mut falls, mut rises) = (lower, body.piece(simd, tilt, splat(simd, STEEPEST)));
    let (mut falls_to, mut rises_from) = (round.least(simd, falls.slope), round.least(simd, rises.slope));
    let mut least_bound = splat(simd, f32::INFINITY);
    for _ in 0..STEPS {
        let between = rises.slope - falls.slope;
        let crossing = (falls.at - rises.at) / between.max(splat(simd, 1e-9));
        let m = crossing.max(rises_from).min(falls_to);
        let piece = body.piece(simd, tilt, m);
        let norm = round.norm(simd, m);
        least_bound = least_bound.min(mad(m, piece.slope, piece.at) + round.radius * norm);
        let least = round.least(simd, piece.slope);
        let rising = mad(piece.slope, norm, round.radius * mad(round.c, m, round.b)).simd_ge(splat(simd, 0.0));
        rises = Piece { at: rising.select(piece.at, rises.at), slope: rising.select(piece.slope, rises.slope) };
        falls = Piece { at: rising.select(falls.at, piece.at), slope: rising.select(falls.slope, piece.slope) };
        rises_from = rising.select(least, rises_from);
        falls_to = rising.select(falls_to, least);
    }
    least_bound
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{Pose, Vec3};
    use fearless_simd::{Level, dispatch, prelude::*};

    use super::*;
    use crate::fill::body::BoxBody;

    /// The same bound by trying many tilts in f64.
    fn slowly(corners: &[Vec3], [x, z]: [f64; 2], lean: f64, radius: f64) -> f64 {
        let mut best = f64::INFINITY;
        for i in -4000..=4000 {
            let angle = f64::from(i) / 4000.0 * f64::from(STEEPEST).atan();
            let (m, side) = (angle.tan().abs(), angle.signum());
            let v = Vec3::new(x + m * lean, m * side, z);
            let far = corners.iter().map(|c| c.dot(v)).fold(f64::NEG_INFINITY, f64::max);
            best = best.min(far + radius * v.length());
        }
        best
    }

    fn compare(at: [f64; 3], rpy: [f64; 3], half: [f64; 3], turn: f64) {
        let pose = Pose::from_xyz_rpy(at, rpy);
        let mut body = BoxBody::new(&pose, Vec3::from(half), [0.0, 0.0]);
        body.turn([turn.cos(), turn.sin()]);
        let turned = Pose::from_xyz_rpy([0.0; 3], [0.0, 0.0, -turn]);
        let obstacle = crate::Obstacle::cuboid(pose, Vec3::from(half)).unwrap();
        let corners: Vec<Vec3> = obstacle.corners().iter().map(|&c| turned.transform_point(c)).collect();
        for lean in [0.0174, -0.0174, 0.1] {
            for i in 0..32 {
                let (z, x) = (f64::from(i) / 32.0 * std::f64::consts::TAU).sin_cos();
                let fast = dispatch!(Level::new(), simd => {
                    let u = [splat(simd, x as f32), splat(simd, z as f32)];
                    reach(simd, &body, u, lean as f32, 0.2).to_array()[0]
                });
                let slow = slowly(&corners, [x, z], lean, 0.2);
                // The trying is coarse: it finds a little more than the least.
                let size = 1.0 + half[0] + half[1] + half[2];
                let off = (f64::from(fast) - slow) / size;
                assert!(off > -1e-3 && off < 2e-5, "{at:?} turned {turn}, lean {lean}, ({x}, {z}): {fast}, not {slow}");
            }
        }
    }

    #[test]
    fn bounds_are_the_least_there_are() {
        for turn in [-2.0, -0.6, 0.0, 0.3, 0.31, 1.0] {
            compare([1.3, 0.4, 0.9], [0.0, 0.0, 0.5], [0.25, 0.2, 0.3], turn);
            compare([1.3, 0.4, 0.9], [0.4, 0.7, 0.5], [0.25, 0.2, 0.3], turn);
            compare([1.5, 0.0, 0.9], [0.0, 0.0, 0.2], [0.01, 1.5, 0.01], turn);
            compare([40.0, 0.0, 0.0], [0.0, 0.0, 0.0], [38.5, 30.0, 30.0], turn);
        }
    }
}
