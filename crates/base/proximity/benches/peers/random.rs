//! Random numbers, the same on every machine.

use elbowroom_spatial::{Rotation, Vec3};
use elbowroom_testkit::random::{split_mix, unit};

/// `SplitMix64` (Steele, Lea, Flood 2014): small, and good enough to place meshes.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        split_mix(&mut self.0)
    }

    /// Uniform in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * unit(self.bits())
    }

    /// Log-uniform in `low..high`.
    pub fn between_decades(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            if v.length_squared() <= 1.0
                && let Some(unit) = v.try_normalize()
            {
                return unit;
            }
        }
    }

    /// Uniform over all rotations: a quaternion drawn from the ball in four dimensions.
    pub fn rotation(&mut self) -> Rotation {
        loop {
            let q: [f64; 4] = std::array::from_fn(|_| self.between(-1.0, 1.0));
            let squared: f64 = q.iter().map(|x| x * x).sum();
            if (1e-6..=1.0).contains(&squared)
                && let Some(rotation) = Rotation::from_quaternion_xyzw(q.map(|x| x / squared.sqrt()))
            {
                return rotation;
            }
        }
    }
}
