//! What the joints may do, as bounds of the next velocity.

use elbowroom_kinematics::Chain;

use crate::VelocityBounds;

/// One joint's limits: rad, or m where it slides, per s and s².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimit {
    /// Lowest value; −∞ where there is none.
    pub lower: f64,
    /// Highest value; +∞ where there is none.
    pub upper: f64,
    /// Top speed.
    pub speed: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Deceleration of a stop, at least the acceleration.
    pub stop: f64,
}

impl JointLimit {
    /// The limits of a chain's independent joints, with dynamics for all: full speed is reached in `rise_s` seconds and
    /// stopped in `stop_s`; joints without a speed go at most so fast (rad/s or m/s).
    pub fn of(chain: &Chain, rise_s: f64, stop_s: f64, fallback_speed: f64) -> Vec<Self> {
        let joints = chain.active_joints().iter().map(|id| &chain.joints()[id.0].limits);
        joints
            .map(|l| {
                let speed = l.velocity.filter(|v| v.is_finite() && *v > 0.0).unwrap_or(fallback_speed);
                Self {
                    lower: l.lower,
                    upper: l.upper,
                    speed,
                    acceleration: speed / rise_s,
                    stop: speed / stop_s.min(rise_s),
                }
            })
            .collect()
    }

    /// Velocities after which the joint can still stop before its limits, `dt` seconds being the command's length.
    fn soon(&self, q: f64, dt: f64) -> [f64; 2] {
        // v·dt + v²/(2a) = room
        let fastest = |room: f64| {
            if room.is_infinite() {
                return self.speed;
            }
            let a = self.stop;
            (a * ((dt * dt + 2.0 * room.max(0.0) / a).sqrt() - dt)).min(self.speed)
        };
        [-fastest(q - self.lower), fastest(self.upper - q)]
    }

    /// The same for the next command, from the velocity `qd`.
    fn now(&self, [low, high]: [f64; 2], qd: f64, dt: f64) -> [f64; 2] {
        let rate = |slows: bool| if slows { self.stop } else { self.acceleration };
        let (lower, upper) = (qd - rate(qd > 0.0) * dt, qd + rate(qd < 0.0) * dt);
        // A limit of the joint goes before one of its acceleration.
        [lower.clamp(low, high), upper.clamp(low, high)]
    }
}

/// Fills the bounds for joints at `q` with velocities `qd`.
pub fn fill(bounds: &mut VelocityBounds, limits: &[JointLimit], q: &[f64], qd: &[f64], dt: f64) {
    for (j, limit) in limits.iter().enumerate() {
        bounds.soon[j] = limit.soon(q[j], dt);
        bounds.now[j] = limit.now(bounds.soon[j], qd[j], dt);
    }
}
