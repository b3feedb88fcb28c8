//! Corner blends: curves with continuous curvature that replace the corner between two straight segments.
//!
//! The tangent turns smoothly from one direction to the other, `q′ = u + (v − u)·S(σ/2d)` with `S = 3τ² − 2τ³`. The
//! result is a Bézier curve of degree 4 whose control points are on the two legs of the corner, at the distances d,
//! d/2, 0, d/2, d. Therefore the curve is in the triangle of its ends and the corner, and its curvature is 0 at both
//! ends.

/// Position along a blend and the first three derivatives of one joint, see [`CornerBlend`].
pub(super) fn derivatives(direction: f64, turn: f64, offset: f64, length: f64) -> [f64; 4] {
    let t = offset / length;
    [
        direction * offset + turn * length * t * t * t * (1.0 - 0.5 * t),
        direction + turn * t * t * (3.0 - 2.0 * t),
        turn * 6.0 * t * (1.0 - t) / length,
        turn * 6.0 * (1.0 - 2.0 * t) / (length * length),
    ]
}

/// A proposed corner blend: the caller, who knows the obstacles, decides whether it may be used.
#[derive(Debug, Clone, PartialEq)]
pub struct CornerBlend<'p> {
    pub(super) waypoint: usize,
    pub(super) corner: &'p [f64],
    /// Unit vectors.
    pub(super) before: &'p [f64],
    pub(super) after: &'p [f64],
    pub(super) distance: f64,
}

impl CornerBlend<'_> {
    /// Index of the waypoint that is the corner.
    pub fn waypoint(&self) -> usize {
        self.waypoint
    }

    /// Distance of both ends from the corner: the Euclidean norm over all joints, rad (m).
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Control points of the Bézier curve of degree 4, rad (m): the curve is in their convex hull.
    pub fn control_points(&self) -> [Vec<f64>; 5] {
        let [far, near] = [self.distance, 0.5 * self.distance];
        let along =
            |direction: &[f64], by: f64| self.corner.iter().zip(direction).map(|(q, d)| q + d * by).collect::<Vec<_>>();
        [
            along(self.before, -far),
            along(self.before, -near),
            self.corner.to_vec(),
            along(self.after, near),
            along(self.after, far),
        ]
    }

    /// Position at a fraction of the curve from 0 to 1, rad (m).
    pub fn at(&self, share: f64) -> Vec<f64> {
        let (length, share) = (2.0 * self.distance, share.clamp(0.0, 1.0));
        let legs = self.before.iter().zip(self.after);
        let each = self
            .corner
            .iter()
            .zip(legs)
            .map(|(q, (u, v))| q - u * self.distance + derivatives(*u, v - u, share * length, length)[0]);
        each.collect()
    }

    /// A polyline of this many pieces (at least one) through points of the curve, rad (m), and per joint the largest
    /// distance of the curve from the chord at the same fraction of a piece, rad (m).
    pub fn polyline(&self, pieces: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
        let pieces = pieces.max(1);
        let points = (0..=pieces).map(|n| self.at(n as f64 / pieces as f64)).collect();
        // An eighth of the second derivative, which is at most 1.5·|v − u|/(2d), times the squared length of a piece.
        let factor = 0.375 * self.distance / (pieces as f64).powi(2);
        (points, self.before.iter().zip(self.after).map(|(u, v)| factor * (v - u).abs()).collect())
    }
}
