//! Around a corner without a stop.
//!
//! The velocity goes smoothly from one leg's to the other's, `v1 + (v2 − v1)·S(t/T)` with `S = 3τ² − 2τ³`. So no joint is
//! faster than on the legs, accelerations are at most 1.5·|v2 − v1|/T and 0 at the ends, jerks at most 6·|v2 − v1|/T²; and
//! as `S` is below its mirror image in the first half, the curve stays in the triangle of its ends and the corner.

use super::limits::MotionLimits;

/// A rounded corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blend {
    /// Where it begins.
    pub from: [f64; 3],
    /// Velocities before and after, rad/s.
    pub before: [f64; 3],
    pub after: [f64; 3],
    pub seconds: f64,
}

impl Blend {
    /// Seconds it takes at a speed along both legs (unit directions).
    pub fn seconds(speed: f64, [u, v]: [[f64; 3]; 2], limits: &MotionLimits) -> f64 {
        let each = (0..3).map(|i| {
            let change = speed * (v[i] - u[i]).abs();
            (1.5 * change / limits.acceleration[i]).max((6.0 * change / limits.jerk[i]).sqrt())
        });
        each.fold(0.0, f64::max)
    }

    /// Position, velocity, acceleration after `t` seconds.
    pub fn at(&self, t: f64) -> [[f64; 3]; 3] {
        let x = (t / self.seconds).clamp(0.0, 1.0);
        let share = x * x * (3.0 - 2.0 * x);
        let after = self.seconds * x * x * x * (1.0 - 0.5 * x);
        let before = self.seconds * x - after;
        let steep = 6.0 * x * (1.0 - x) / self.seconds;
        let each = |f: &dyn Fn(usize) -> f64| [f(0), f(1), f(2)];
        let (u, v) = (self.before, self.after);
        [
            each(&|i| self.from[i] + u[i] * before + v[i] * after),
            each(&|i| u[i] + (v[i] - u[i]) * share),
            each(&|i| (v[i] - u[i]) * steep),
        ]
    }
}
