//! Observations of a moving object by a robot: delayed and noisy.

use elbowroom_avoidance::ObservedObject;
use elbowroom_cell::MovingObject;
use elbowroom_planner::Random;
use elbowroom_proximity::ccd::{ConstantTwist, RigidMotion};
use elbowroom_spatial::Vec3;

/// Time between the two positions from which a tracker estimates a velocity, s.
const VELOCITY_WINDOW_S: f64 = 0.5;

/// Noise and delay of observations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ObservationModel {
    /// Standard deviation of each coordinate of a position, m.
    pub noise_m: f64,
    /// Age of an observation when it arrives, s.
    pub delay_s: f64,
}

impl ObservationModel {
    /// The observation of an object that arrives at `t_s`.
    ///
    /// It was made `delay_s` earlier; the object is assumed to have continued its motion since. The noise depends on
    /// the time and the object, so it is the same in every run.
    pub fn observe(&self, object: &MovingObject, t_s: f64, known: bool) -> ObservedObject {
        let seen_s = (t_s - self.delay_s).max(0.0);
        let mut motion = object.motion(seen_s);
        let mut seen = object.pose(seen_s);
        if self.noise_m > 0.0 {
            let [now, before] = [seen_s, seen_s - VELOCITY_WINDOW_S].map(|t| self.error(object, t));
            seen.translation += now;
            motion.velocity += (now - before) / VELOCITY_WINDOW_S;
        }
        let in_world =
            if t_s > seen_s { ConstantTwist::from_motion(seen, &motion, t_s - seen_s).pose(1.0) } else { seen };
        ObservedObject { object: object.object, in_world, motion, known }
    }

    /// Error of the position that is seen at a time, m: uniform, with `noise_m` as the standard deviation of each
    /// coordinate.
    fn error(&self, object: &MovingObject, t_s: f64) -> Vec3 {
        let instant = (t_s * 1e6).round() as i64 as u64;
        let mut random = Random::new(instant ^ ((object.object.0 as u64) << 48));
        let width = self.noise_m * 12.0_f64.sqrt();
        let [x, y, z] = std::array::from_fn(|_| random.between(-0.5, 0.5) * width);
        Vec3::new(x, y, z)
    }
}
