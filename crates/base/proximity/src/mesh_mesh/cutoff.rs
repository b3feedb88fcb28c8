//! The cutoff distance of a traversal, with the f32 error added on the conservative side.

use elbowroom_spatial::Vec3;

use super::relative_placement::RelativePlacement;

/// Largest gap of a pair of boxes, slabs or triangles that is not excluded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cutoff {
    /// The largest gap, units of A.
    pub gap: f32,
    /// Its square, for comparison with sums of squared gaps.
    pub squared: f32,
    /// Axes along the line of the best pair, if one was found.
    pub witness_frame: Option<WitnessFrame>,
}

/// A frame whose first axis points from A to B along the line of the best pair so far. Gaps measured along its axes
/// are the tightest.
#[derive(Debug, Clone, Copy)]
pub(super) struct WitnessFrame {
    /// The axes in A's axes, as rows.
    pub of_a: [[f32; 3]; 3],
    /// The axes in B's axes, times the ratio of units, as rows.
    pub of_b: [[f32; 3]; 3],
    /// Origin of B.
    pub shift: [f32; 3],
}

impl Cutoff {
    /// Creates a cutoff that excludes pairs farther apart than `radius` (units of A).
    #[inline]
    pub fn new(radius: f64, placement: &RelativePlacement) -> Self {
        let mut cutoff = Self { gap: 0.0, squared: 0.0, witness_frame: None };
        cutoff.set_radius(radius, placement);
        cutoff
    }

    /// Changes the radius and keeps the witness frame.
    #[cfg(test)]
    pub fn with_radius(mut self, radius: f64, placement: &RelativePlacement) -> Self {
        self.set_radius(radius, placement);
        self
    }

    #[inline]
    fn set_radius(&mut self, radius: f64, placement: &RelativePlacement) {
        self.gap = round_up(radius + placement.f32_error);
        // Allow twice the error, because the axes of a frame are orthonormal only up to f32 rounding.
        let square = (radius + 2.0 * placement.f32_error) * (radius + 2.0 * placement.f32_error) * (1.0 + 1e-5);
        self.squared = round_up(square);
    }

    /// Sets a smaller radius, and aligns the witness frame with the points at which it was found.
    #[inline]
    pub fn tighten(&mut self, radius: f64, on_a: Vec3, on_b: Vec3, placement: &RelativePlacement) {
        self.set_radius(radius, placement);
        self.align(on_b - on_a, placement);
    }

    /// Aligns the witness frame with this direction.
    #[inline]
    pub fn align(&mut self, direction: Vec3, placement: &RelativePlacement) {
        self.witness_frame = direction.try_normalize().map(|n| WitnessFrame::along(n, placement));
    }
}

impl WitnessFrame {
    #[inline]
    fn along(n: Vec3, placement: &RelativePlacement) -> Self {
        let side = if n.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
        let u = n.cross(side);
        let u = u * (1.0 / u.length());
        let v = n.cross(u);
        let m = &placement.exact;
        let in_b = |d: Vec3| {
            let along = |k: usize| (d.x * m[0][k] + d.y * m[1][k] + d.z * m[2][k]) as f32;
            ([d.x as f32, d.y as f32, d.z as f32], [along(0), along(1), along(2)], along(3))
        };
        let (n, u, v) = (in_b(n), in_b(u), in_b(v));
        Self { of_a: [n.0, u.0, v.0], of_b: [n.1, u.1, v.1], shift: [n.2, u.2, v.2] }
    }
}

/// Rounds up with a margin of two units in the last place.
#[inline]
fn round_up(x: f64) -> f32 {
    (x * (1.0 + 3e-7)) as f32
}
