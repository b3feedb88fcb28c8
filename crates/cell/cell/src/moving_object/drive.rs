//! A moving object, and its drive.

use elbowroom_robot::ObjectId;
use elbowroom_spatial::{FrameMotion, Pose};

use super::encoder::Encoder;
use super::path::ObjectPath;

/// A moving object: its pose and velocity at any time.
///
/// ```
/// # use elbowroom_cell::{Cell, ObjectMotion};
/// # use elbowroom_spatial::Vec3;
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [object.cart]
/// shape = "box"
/// size = [400, 300, 200]
/// at = [2000, 0, 100]
/// motion = { via = [[2000, 1000, 100]], speed = 500, start = 0.5 }
/// "#)?;
/// let cart = &cell.moving_objects[0];
/// assert_eq!(cart.motion(1.5).velocity, Vec3::Y * 0.5);
/// assert!((cart.pose(1.5).translation - Vec3::new(2.0, 0.5, 0.1)).length() < 1e-12);
/// // The motion from one tick to the next, for `Checker::sweep`:
/// let motion: ObjectMotion = cart.motion_between(1.5, 1.504);
/// # let _ = motion;
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
#[derive(Debug, Clone)]
pub struct MovingObject {
    /// The object of the cell.
    pub object: ObjectId,
    /// Pose from the cell file: at travel 0, or before the path begins.
    pub rest_in_world: Pose,
    /// Its drive.
    pub drive: Drive,
}

/// The drive of an object.
#[derive(Debug, Clone)]
pub enum Drive {
    /// A conveyor or rail that carries it.
    Belt(Encoder),
    /// A path that it follows by itself.
    Path(ObjectPath),
}

impl MovingObject {
    /// Pose of the object's frame in the world at a time (s).
    pub fn pose(&self, t_s: f64) -> Pose {
        match &self.drive {
            Drive::Belt(encoder) => Pose::from_translation(encoder.direction * encoder.at(t_s).0) * self.rest_in_world,
            Drive::Path(path) => path.pose(self.rest_in_world, t_s),
        }
    }

    /// Velocity of the object's frame in the world at a time (s); at a corner the velocity after it.
    ///
    /// Accelerations are omitted: between corners only the rotation has one.
    pub fn motion(&self, t_s: f64) -> FrameMotion {
        match &self.drive {
            Drive::Belt(encoder) => {
                FrameMotion { velocity: encoder.direction * encoder.at(t_s).1, ..FrameMotion::REST }
            }
            Drive::Path(path) => path.motion(t_s),
        }
    }

    /// True if its velocity is not zero.
    pub fn is_moving(&self, t_s: f64) -> bool {
        self.motion(t_s) != FrameMotion::REST
    }
}
