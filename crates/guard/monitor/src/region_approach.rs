//! How far a region that moves and turns at a constant rate comes towards a volume.

use elbowroom_spatial::FrameMotion;

/// The approach of a region by its own motion; `docs/laws.md`, section 7.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct RegionApproach {
    /// Largest closing speed of its points now, m/s; negative if all recede.
    speed: f64,
    /// Largest acceleration of its points, m/s²: a turning point keeps its speed and changes its direction.
    acceleration: f64,
    /// Largest speed of its points in any direction, m/s.
    max_speed: f64,
    /// Time (s) by which the reading of the region's motion is older than the robot's reading.
    older_s: f64,
}

impl RegionApproach {
    /// The approach with a reading that is `older_s` (s) older than the robot's joint values.
    pub(crate) fn older_by(self, older_s: f64) -> Self {
        Self { older_s, ..self }
    }

    /// Upper bound of the distance (m) by which the region comes closer, from its reading until `time_s` after the
    /// robot's reading.
    pub(crate) fn travel_m(&self, time_s: f64) -> f64 {
        // For a region at rest the age does not count, even if it is infinite.
        if self.is_still() {
            return 0.0;
        }
        let time_s = time_s + self.older_s;
        // The sum is convex in time: it is largest at the beginning or at the end.
        let turning = self.speed * time_s + 0.5 * self.acceleration * time_s * time_s;
        // NaN passes through: the caller treats it as too far.
        if turning < 0.0 {
            0.0
        } else if turning > self.max_speed * time_s {
            self.max_speed * time_s
        } else {
            turning
        }
    }

    /// Whether all points of the region are at rest.
    pub(crate) fn is_still(&self) -> bool {
        self.max_speed == 0.0
    }
}

/// Bounds of the motion of a body, up to some radius, that moves and turns at a constant rate or that an arm carries
/// whose joints do.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TurningMotion {
    /// Largest speed of its points by turning, m/s.
    swings: f64,
    /// Largest speed of its points, m/s.
    fastest: f64,
    /// Largest acceleration of its points, m/s².
    bends: f64,
}

impl TurningMotion {
    /// Bounds the motion of all points within `radius_m` of the frame's origin. The frame keeps its velocity, or its
    /// velocity turns with it (an object beside its axis, the hand of a robot).
    pub(crate) fn new(motion: &FrameMotion, radius_m: f64) -> Self {
        let turns = motion.angular_velocity.length();
        // Without rotation the radius does not count, even if it is infinite.
        let times_radius = |rate: f64| if rate > 0.0 { rate * radius_m } else { 0.0 };
        let (swings, fastest) = (times_radius(turns), motion.velocity.length() + times_radius(turns));
        // In both cases the acceleration of a point is at most its angular speed times its largest speed. The hand of an arm
        // with several joints may circle without turning: then its path bends as it does now.
        let turning = if turns > 0.0 { turns * fastest } else { 0.0 };
        let now = motion.acceleration.length()
            + times_radius(motion.angular_acceleration.length())
            + turns * times_radius(turns);
        Self { swings, fastest, bends: turning.max(now) }
    }

    /// Largest speed (m/s) that its points have from turning.
    pub(crate) fn swinging_speed(&self) -> f64 {
        self.swings
    }

    /// The approach in a direction in which no point is faster than `closing_speed` (m/s) now.
    pub(crate) fn approach(&self, closing_speed: f64) -> RegionApproach {
        RegionApproach { speed: closing_speed, acceleration: self.bends, max_speed: self.fastest, older_s: 0.0 }
    }

    /// The approach if the body may come from any side.
    pub(crate) fn approach_any_direction(&self) -> RegionApproach {
        RegionApproach { speed: self.fastest, acceleration: 0.0, max_speed: self.fastest, older_s: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{Pose, Rotation, Vec3};
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    #[test]
    fn no_point_of_a_body_that_turns_comes_closer_than_its_travel() {
        let mut random = SplitMix(5);
        let mut vector = |length: f64| Vec3::from(random.within(length));
        for _ in 0..2000 {
            let (turn, velocity, point) = (vector(3.0), vector(1.0), vector(1.0));
            let towards = vector(1.0).try_normalize().unwrap();
            let motion = FrameMotion { velocity, angular_velocity: turn, ..FrameMotion::default() };
            let approach = TurningMotion::new(&motion, point.length()).approach(motion.velocity_at(point).dot(towards));
            for step in 1..=40 {
                let t = 0.05 * f64::from(step);
                let turned = |t: f64| Rotation::from_rotation_vector(turn * t);
                // The origin keeps its velocity.
                let straight = velocity * t + turned(t) * point - point;
                assert!(straight.dot(towards) <= approach.travel_m(t) + 1e-9);
                // The velocity of the origin turns with the body: summed over short steps.
                let arc = (0..200).fold(Pose::IDENTITY, |at, i| {
                    let s = t / 200.0;
                    let rotation = turned((f64::from(i) + 1.0) * s);
                    Pose { translation: at.translation + turned((f64::from(i) + 0.5) * s) * velocity * s, rotation }
                });
                let curved = arc.transform_point(point) - point;
                assert!(curved.dot(towards) <= approach.travel_m(t) + 1e-4);
            }
        }
    }

    /// The hand of an arm whose joints turn against each other.
    #[test]
    fn what_circles_without_turning_comes_no_closer_than_its_travel() {
        let mut random = SplitMix(6);
        for _ in 0..2000 {
            let (rate, radius) = (random.between(0.1, 3.0), random.between(0.1, 2.0));
            let at = |t: f64| Vec3::new((rate * t).cos(), (rate * t).sin(), 0.0) * radius;
            let velocity = Vec3::new(0.0, rate * radius, 0.0);
            let motion = FrameMotion { velocity, acceleration: at(0.0) * (-rate * rate), ..FrameMotion::default() };
            let towards = Vec3::from(random.within(1.0)).try_normalize().unwrap();
            let approach = TurningMotion::new(&motion, 0.3).approach(velocity.dot(towards));
            for step in 1..=40 {
                let t = 0.05 * f64::from(step);
                assert!((at(t) - at(0.0)).dot(towards) <= approach.travel_m(t) + 1e-9);
            }
        }
    }

    #[test]
    fn what_does_not_turn_approaches_at_its_speed_and_what_recedes_does_not() {
        let motion = FrameMotion { velocity: Vec3::new(0.0, 0.5, 0.0), ..FrameMotion::default() };
        let approach = |speed: f64| TurningMotion::new(&motion, f64::INFINITY).approach(speed);
        assert_eq!((approach(0.25).travel_m(2.0), approach(-0.25).travel_m(2.0)), (0.5, 0.0));
        assert!(RegionApproach::default().is_still() && !approach(-0.25).is_still());
        assert!(approach(f64::NAN).travel_m(1.0).is_nan());
        assert_eq!(approach(0.25).older_by(0.5).travel_m(2.0), 0.625);
    }
}
