//! Support distances, in directions of the plane, of the part of a grown solid that is inside the wedge.
//!
//! The wedge on one side of the base axis is `|y| ≤ t·x`. For any `m ≥ 0`, the support distance of the whole grown
//! solid in the direction `u + m·(t, ±1, 0)` is an upper bound of the support distance in `u` of the part inside the
//! wedge (the wedge's points have `t·x ± y ≥ 0`). The least of these bounds is the support distance itself (convex
//! duality). Therefore an early stop or a rounding error only enlarges the outline.

use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::plane_solid::{LinearPiece, PlaneSolid, TiltedDirections};
use super::simd_math::{Lanes, mad, splat};

/// Largest tilt of directions out of the plane (tangent).
const MAX_TILT: f32 = 24.0;
/// Tilt at which the first slope is evaluated: in the plane itself, equally distant corners would hide the slope.
const MIN_TILT: f32 = 2e-5;
/// Number of evaluated linear pieces; a box has at most four.
const MAX_PIECES: usize = 3;

/// The curved part: the support distance of a ball, `radius·√(1 + 2·b·m + c·m²)`.
struct BallSupport<S: Simd> {
    radius: Lanes<S>,
    b: Lanes<S>,
    c: Lanes<S>,
    /// √(c − b²), 1/(radius·√c), 1/c.
    root: Lanes<S>,
    over: Lanes<S>,
    over_c: Lanes<S>,
}

impl<S: Simd> BallSupport<S> {
    #[inline(always)]
    fn new(simd: S, directions: &TiltedDirections<S>, radius: f32) -> Self {
        let (lean, one) = (directions.lean, splat(simd, 1.0));
        let (b, c) = (lean * directions.x, mad(lean, lean, one));
        let radius = splat(simd, radius.max(1e-7));
        Self { radius, b, c, root: (c - b * b).sqrt(), over: one / (radius * c.sqrt()), over_c: one / c }
    }

    #[inline(always)]
    fn norm(&self, simd: S, m: Lanes<S>) -> Lanes<S> {
        mad(mad(self.c, m, self.b + self.b), m, splat(simd, 1.0)).sqrt()
    }

    /// Slope of the ball's support distance at `m`.
    #[inline(always)]
    fn slope(&self, simd: S, m: Lanes<S>) -> Lanes<S> {
        self.radius * mad(self.c, m, self.b) / self.norm(simd, m)
    }

    /// The `m` in 0..[`MAX_TILT`] at which a linear piece and the ball together are least.
    #[inline(always)]
    fn minimum(&self, simd: S, slope: Lanes<S>) -> Lanes<S> {
        let k = -(slope * self.over);
        let inside = splat(simd, 1.0) - k * k;
        let y = k * self.root / inside.max(splat(simd, 1e-12)).sqrt();
        ((y - self.b) * self.over_c).max(splat(simd, 0.0)).min(splat(simd, MAX_TILT))
    }
}

#[inline(always)]
fn select<S: Simd>(
    which: elbowroom_validity::lanes::simd::mask32x16<S>,
    yes: LinearPiece<S>,
    no: LinearPiece<S>,
) -> LinearPiece<S> {
    LinearPiece { at: which.select(yes.at, no.at), slope: which.select(yes.slope, no.slope) }
}

/// Support distances in sixteen directions `(x, z)` of the plane, from the shoulder, metres.
#[inline(always)]
pub(super) fn support_distance<S: Simd, B: PlaneSolid>(
    simd: S,
    solid: &B,
    [x, z]: [Lanes<S>; 2],
    lean: f32,
    radius: f32,
) -> Lanes<S> {
    let one = splat(simd, 1.0);
    let mut directions = TiltedDirections { x, z, lean: splat(simd, lean), side: one };
    let ball = BallSupport::new(simd, &directions, radius);
    let start = splat(simd, MIN_TILT);
    // The side of the wedge beyond which the farthest point is.
    let curved = ball.slope(simd, start);
    let right = solid.linear_piece(simd, &directions, start);
    directions.side = -one;
    let left = solid.linear_piece(simd, &directions, start);
    let to_right = right.slope.simd_lt(left.slope);
    let lower = select(to_right, right, left);
    let outside = (lower.slope + curved).simd_lt(splat(simd, 0.0));
    let untilted = mad(start, lower.slope, lower.at) + ball.radius * ball.norm(simd, start);
    if outside.to_bitmask() == 0 {
        return untilted;
    }
    directions.side = to_right.select(one, -one);
    untilted.min(tilted_bound(simd, solid, &directions, &ball, lower))
}

/// Searches the least bound: between a falling and a rising piece, the next `m` is where the two together are
/// least.
#[inline(always)]
fn tilted_bound<S: Simd, B: PlaneSolid>(
    simd: S,
    solid: &B,
    directions: &TiltedDirections<S>,
    ball: &BallSupport<S>,
    lower: LinearPiece<S>,
) -> Lanes<S> {
    let (mut falls, mut rises) = (lower, solid.linear_piece(simd, directions, splat(simd, MAX_TILT)));
    let (mut falls_to, mut rises_from) = (ball.minimum(simd, falls.slope), ball.minimum(simd, rises.slope));
    let mut least_bound = splat(simd, f32::INFINITY);
    for _ in 0..MAX_PIECES {
        let between = rises.slope - falls.slope;
        let crossing = (falls.at - rises.at) / between.max(splat(simd, 1e-9));
        let m = crossing.max(rises_from).min(falls_to);
        let piece = solid.linear_piece(simd, directions, m);
        let norm = ball.norm(simd, m);
        least_bound = least_bound.min(mad(m, piece.slope, piece.at) + ball.radius * norm);
        let minimum = ball.minimum(simd, piece.slope);
        let rising = mad(piece.slope, norm, ball.radius * mad(ball.c, m, ball.b)).simd_ge(splat(simd, 0.0));
        rises = select(rising, piece, rises);
        falls = select(rising, falls, piece);
        rises_from = rising.select(minimum, rises_from);
        falls_to = rising.select(falls_to, minimum);
    }
    least_bound
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{Pose, Vec3};
    use elbowroom_validity::lanes::simd::{Level as SimdLevel, dispatch, prelude::*};

    use super::*;
    use crate::planar_map::plane_solid::PlaneBox;

    /// The least bound computed by evaluating many tilts in f64.
    fn brute_force(corners: &[Vec3], [x, z]: [f64; 2], lean: f64, radius: f64) -> f64 {
        let mut best = f64::INFINITY;
        for i in -4000..=4000 {
            let angle = f64::from(i) / 4000.0 * f64::from(MAX_TILT).atan();
            let (m, side) = (angle.tan().abs(), angle.signum());
            let v = Vec3::new(x + m * lean, m * side, z);
            let far = corners.iter().map(|c| c.dot(v)).fold(f64::NEG_INFINITY, f64::max);
            best = best.min(far + radius * v.length());
        }
        best
    }

    fn compare(at: [f64; 3], rpy: [f64; 3], half: [f64; 3], turn: f64) {
        let pose = Pose::from_xyz_rpy(at, rpy);
        let mut solid = PlaneBox::new(&pose, Vec3::from(half), [0.0, 0.0]);
        solid.rotate_to_plane([turn.cos(), turn.sin()]);
        let turned = Pose::from_xyz_rpy([0.0; 3], [0.0, 0.0, -turn]);
        let obstacle = crate::ConvexObstacle::cuboid(pose, Vec3::from(half)).unwrap();
        let corners: Vec<Vec3> = obstacle.corners().iter().map(|&c| turned.transform_point(c)).collect();
        for lean in [0.0174, -0.0174, 0.1] {
            for i in 0..32 {
                let (z, x) = (f64::from(i) / 32.0 * std::f64::consts::TAU).sin_cos();
                let fast = dispatch!(SimdLevel::new(), simd => {
                    let u = [splat(simd, x as f32), splat(simd, z as f32)];
                    support_distance(simd, &solid, u, lean as f32, 0.2).to_array()[0]
                });
                let slow = brute_force(&corners, [x, z], lean, 0.2);
                // The samples are coarse: their minimum is slightly above the least bound.
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
