//! Velocity and acceleration of a frame.

use crate::Vec3;

/// Linear and angular velocity and acceleration of a frame, seen from and expressed in the outer frame.
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

    /// The motion of a frame fixed to this one, with its origin at `offset` from this one's.
    #[inline]
    #[must_use]
    pub fn shifted(&self, offset: Vec3) -> Self {
        Self { velocity: self.velocity_at(offset), acceleration: self.acceleration_at(offset), ..*self }
    }

    /// True where no component is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        self.velocity.is_finite()
            && self.angular_velocity.is_finite()
            && self.acceleration.is_finite()
            && self.angular_acceleration.is_finite()
    }
}
