//! The radius within which pairs matter, with what f32 may be wrong added on the safe side.

use elbowroom_spatial::Vec3;

use super::placement::Pairing;

/// What a pair of boxes, slabs or triangles must exceed to be left out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    /// Units of A.
    pub gap: f32,
    /// Its square, for sums of squared gaps.
    pub squared: f32,
    /// Axes along the line of the best pair, once there is one.
    pub sight: Option<Sight>,
}

/// A frame whose first axis points from A to B along the line of the best pair: gaps measured there are tightest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    /// Rows: the axes in A's axes; in B's axes, times the ratio of units.
    pub of_a: [[f32; 3]; 3],
    pub of_b: [[f32; 3]; 3],
    /// Origin of B.
    pub shift: [f32; 3],
}

impl Limit {
    /// Pairs farther apart than `radius` (units of A) are out.
    #[inline]
    pub fn new(radius: f64, pairing: &Pairing) -> Self {
        let mut limit = Self { gap: 0.0, squared: 0.0, sight: None };
        limit.set_radius(radius, pairing);
        limit
    }

    /// The same line of sight with another radius.
    #[cfg(test)]
    pub fn with_radius(mut self, radius: f64, pairing: &Pairing) -> Self {
        self.set_radius(radius, pairing);
        self
    }

    #[inline]
    fn set_radius(&mut self, radius: f64, pairing: &Pairing) {
        self.gap = up(radius + pairing.doubt);
        // Twice the doubt, and the axes of a frame are orthonormal up to f32 rounding.
        let square = (radius + 2.0 * pairing.doubt) * (radius + 2.0 * pairing.doubt) * (1.0 + 1e-5);
        self.squared = up(square);
    }

    /// A smaller radius, and the line along which it was found.
    #[inline]
    pub fn tighten(&mut self, radius: f64, on_a: Vec3, on_b: Vec3, pairing: &Pairing) {
        self.set_radius(radius, pairing);
        self.look_along(on_b - on_a, pairing);
    }

    /// Measures gaps along this line from now on.
    #[inline]
    pub fn look_along(&mut self, line: Vec3, pairing: &Pairing) {
        self.sight = line.try_normalize().map(|n| Sight::along(n, pairing));
    }
}

impl Sight {
    #[inline]
    fn along(n: Vec3, pairing: &Pairing) -> Self {
        let side = if n.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
        let u = n.cross(side);
        let u = u * (1.0 / u.length());
        let v = n.cross(u);
        let m = &pairing.exact;
        let in_b = |d: Vec3| {
            let along = |k: usize| (d.x * m[0][k] + d.y * m[1][k] + d.z * m[2][k]) as f32;
            ([d.x as f32, d.y as f32, d.z as f32], [along(0), along(1), along(2)], along(3))
        };
        let (n, u, v) = (in_b(n), in_b(u), in_b(v));
        Self { of_a: [n.0, u.0, v.0], of_b: [n.1, u.1, v.1], shift: [n.2, u.2, v.2] }
    }
}

/// Rounded up with two units in the last place to spare.
#[inline]
fn up(x: f64) -> f32 {
    (x * (1.0 + 3e-7)) as f32
}
