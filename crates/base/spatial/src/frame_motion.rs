//! Velocity and acceleration of a frame.

use crate::Vec3;

/// Linear and angular velocity and acceleration of a frame, measured in and expressed in the outer frame.
///
/// ```
/// use elbowroom_spatial::{FrameMotion, Vec3};
/// let turntable = FrameMotion { angular_velocity: Vec3::Z * 2.0, ..FrameMotion::REST };
/// let rim = Vec3::X * 0.5; // from the frame's origin
/// assert_eq!(turntable.velocity_at(rim), Vec3::Y);
/// assert_eq!(turntable.acceleration_at(rim), Vec3::X * -2.0); // centripetal
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameMotion {
    /// Velocity of the origin, m/s.
    pub velocity: Vec3,
    /// Angular velocity, rad/s.
    pub angular_velocity: Vec3,
    /// Acceleration of the origin, m/s².
    pub acceleration: Vec3,
    /// Angular acceleration, rad/s².
    pub angular_acceleration: Vec3,
}

impl FrameMotion {
    /// A frame at rest.
    pub const REST: Self = Self {
        velocity: Vec3::ZERO,
        angular_velocity: Vec3::ZERO,
        acceleration: Vec3::ZERO,
        angular_acceleration: Vec3::ZERO,
    };

    /// Velocity (m/s) of the point at `offset` from the origin that moves with the frame.
    #[inline]
    pub fn velocity_at(&self, offset: Vec3) -> Vec3 {
        self.velocity + self.angular_velocity.cross(offset)
    }

    /// Acceleration (m/s²) of the point at `offset` from the origin: linear, tangential and centripetal.
    #[inline]
    pub fn acceleration_at(&self, offset: Vec3) -> Vec3 {
        self.acceleration
            + self.angular_acceleration.cross(offset)
            + self.angular_velocity.cross(self.angular_velocity.cross(offset))
    }

    /// The motion of a frame fixed to this frame, with its origin at `offset` (m) from this frame's origin.
    #[inline]
    #[must_use]
    pub fn shifted(&self, offset: Vec3) -> Self {
        Self { velocity: self.velocity_at(offset), acceleration: self.acceleration_at(offset), ..*self }
    }

    /// True if no component is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        self.velocity.is_finite()
            && self.angular_velocity.is_finite()
            && self.acceleration.is_finite()
            && self.angular_acceleration.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rotation;
    use elbowroom_testkit::random::{split_mix, unit};

    /// Comparison with differences of the position of a point on a frame that travels and turns with constant
    /// accelerations.
    #[test]
    fn velocity_and_acceleration_are_the_derivatives_of_the_position() {
        let mut state = 6;
        let mut random = || 2.0 * unit(split_mix(&mut state)) - 1.0;
        let mut vec3 = || Vec3::new(random(), random(), random());
        for _ in 0..200 {
            let motion = FrameMotion {
                velocity: vec3(),
                angular_velocity: vec3(),
                acceleration: vec3(),
                angular_acceleration: vec3(),
            };
            let offset = vec3();
            let at = |t: f64| {
                // Exact to the second order in time.
                let turn = motion.angular_velocity * t + motion.angular_acceleration * (0.5 * t * t);
                let travel = motion.velocity * t + motion.acceleration * (0.5 * t * t);
                Rotation::from_rotation_vector(turn) * offset + travel
            };
            let h = 1e-4;
            let velocity = (at(h) - at(-h)) * (0.5 / h);
            let acceleration = (at(h) + at(-h) - at(0.0) * 2.0) * (1.0 / (h * h));
            assert!((motion.velocity_at(offset) - velocity).length() < 1e-6);
            assert!((motion.acceleration_at(offset) - acceleration).length() < 1e-5, "{motion:?} {offset:?}");
            assert_eq!(motion.shifted(offset).velocity_at(Vec3::ZERO), motion.velocity_at(offset));
        }
    }
}
