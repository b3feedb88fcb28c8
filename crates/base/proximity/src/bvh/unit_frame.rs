//! The normalized frame of a mesh, in which its f32 boxes are stored.

use elbowroom_spatial::{Aabb, Vec3};

/// Origin and unit of a mesh: in this frame and unit all its coordinates are in [-1, 1].
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnitFrame {
    pub center: Vec3,
    /// Metres per unit, a power of two.
    pub unit: f64,
    pub inverse: f64,
}

impl UnitFrame {
    pub fn of(bounds: &Aabb) -> Self {
        let half = bounds.extent().max_element() * 0.5;
        // The power of two above the half extent, with a margin for the rounding of the centre; never less than a
        // micrometre, so that ratios of distances to units stay finite.
        let exponent = if half > 0.0 { (half * 1.000_001).log2().floor() + 1.0 } else { 0.0 };
        let unit = exponent.clamp(-20.0, 1000.0).exp2();
        Self { center: bounds.center(), unit, inverse: 1.0 / unit }
    }

    pub fn in_metres(self, p: [f32; 3]) -> Vec3 {
        Vec3::from(p.map(f64::from)) * self.unit + self.center
    }

    #[inline]
    pub fn to_units(self, p: Vec3) -> Vec3 {
        (p - self.center) * self.inverse
    }
}
