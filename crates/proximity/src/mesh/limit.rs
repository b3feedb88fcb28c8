//! The radius within which pairs matter, with what f32 may be wrong added on the safe side.

use elbowroom_spatial::Vec3;

use super::placement::Pairing;

/// What a pair of boxes, slabs or triangles must exceed to be left out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    /// Units of A.
    pub gap: f32,
    /// Its square, for sums of squared gaps, in units of A and of B.
    pub squared_a: f32,
    pub squared_b: f32,
    /// Unit vector from A to B, in A's axes and (times the ratio of units) in B's.
    pub direction_a: [f32; 3],
    pub direction_b: [f32; 3],
    /// A pair is out where its supports along the direction sum up to less.
    pub reach: f32,
    /// The radius, units of A.
    radius: f64,
}

impl Limit {
    /// Pairs farther apart than `radius` (units of A) are out.
    #[inline]
    pub fn new(radius: f64, pairing: &Pairing) -> Self {
        let mut limit = Self {
            gap: 0.0,
            squared_a: 0.0,
            squared_b: 0.0,
            direction_a: [0.0; 3],
            direction_b: [0.0; 3],
            reach: f32::NEG_INFINITY,
            radius,
        };
        limit.set_radius(radius, pairing);
        limit
    }

    #[inline]
    fn set_radius(&mut self, radius: f64, pairing: &Pairing) {
        self.radius = radius;
        self.gap = up(radius + pairing.doubt);
        let square = (radius + 2.0 * pairing.doubt) * (radius + 2.0 * pairing.doubt) * (1.0 + 1e-5);
        self.squared_a = up(square);
        self.squared_b = up(square / (pairing.scale * pairing.scale));
    }

    /// A smaller radius, and the line along which it was found.
    #[inline]
    pub fn tighten(&mut self, radius: f64, on_a: Vec3, on_b: Vec3, pairing: &Pairing) {
        self.set_radius(radius, pairing);
        let Some(d) = (on_b - on_a).try_normalize() else {
            self.reach = f32::NEG_INFINITY;
            return;
        };
        self.direction_a = d.to_array().map(|x| x as f32);
        // What was rounded is the direction from now on: f64 holds it exactly.
        let d = Vec3::from(self.direction_a.map(f64::from));
        let m = &pairing.exact;
        self.direction_b = std::array::from_fn(|k| (d.x * m[0][k] + d.y * m[1][k] + d.z * m[2][k]) as f32);
        let along = d.dot(Vec3::new(m[0][3], m[1][3], m[2][3]));
        // Supports are at most 2√3 (1 + scale), summed with less than 100 half-units of rounding; README.md.
        let doubt = (1.0 + pairing.scale) / 131_072.0 + (along.abs() + radius) * 1e-14;
        self.reach = down(along - radius * d.length() - doubt);
    }
}

/// Rounded up with two units in the last place to spare.
#[inline]
fn up(x: f64) -> f32 {
    (x * (1.0 + 3e-7)) as f32
}

#[inline]
fn down(x: f64) -> f32 {
    (x - x.abs() * 3e-7) as f32
}
