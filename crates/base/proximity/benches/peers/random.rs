//! Random directions and rotations, the same on every machine.

use elbowroom_spatial::{Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;

/// Random sizes, directions and rotations.
pub trait RandomGeometry {
    /// A number that is log-uniform in `low..high`.
    fn between_decades(&mut self, low: f64, high: f64) -> f64;

    /// A direction, uniform on the unit sphere.
    fn direction(&mut self) -> Vec3;

    /// A rotation, uniform over all rotations: a quaternion drawn from the ball in four dimensions.
    fn rotation(&mut self) -> Rotation;
}

impl RandomGeometry for SplitMix {
    fn between_decades(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::from(self.within(1.0));
            if v.length_squared() <= 1.0
                && let Some(unit) = v.try_normalize()
            {
                return unit;
            }
        }
    }

    fn rotation(&mut self) -> Rotation {
        loop {
            let q: [f64; 4] = self.within(1.0);
            let squared: f64 = q.iter().map(|x| x * x).sum();
            if (1e-6..=1.0).contains(&squared)
                && let Some(rotation) = Rotation::from_quaternion_xyzw(q.map(|x| x / squared.sqrt()))
            {
                return rotation;
            }
        }
    }
}
