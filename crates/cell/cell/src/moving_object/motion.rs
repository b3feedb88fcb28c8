//! The motion of an object between two instants.

use elbowroom_proximity::ccd::{ConstantTwist, RigidMotion};
use elbowroom_spatial::Pose;

use super::drive::{Drive, MovingObject};

/// Motion of an object from one time to another; the parameter `t` of the [`RigidMotion`](elbowroom_proximity::ccd::RigidMotion) runs from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub struct ObjectMotion<'m> {
    moving_object: &'m MovingObject,
    from_s: f64,
    to_s: f64,
    constant_twist: Option<ConstantTwist>,
}

impl MovingObject {
    /// Its motion from one time to a later one (s).
    pub fn motion_between(&self, from_s: f64, to_s: f64) -> ObjectMotion<'_> {
        ObjectMotion::new(self, from_s, to_s)
    }
}

impl<'m> ObjectMotion<'m> {
    fn new(moving_object: &'m MovingObject, from_s: f64, to_s: f64) -> Self {
        let changes = match &moving_object.drive {
            Drive::Belt(encoder) => encoder.changes(from_s, to_s) || encoder.wraps(from_s, to_s),
            Drive::Path(path) => path.changes(from_s, to_s),
        };
        let constant_twist =
            || ConstantTwist::from_motion(moving_object.pose(from_s), &moving_object.motion(from_s), to_s - from_s);
        Self { moving_object, from_s, to_s, constant_twist: (!changes).then(constant_twist) }
    }

    /// True if the motion is not continuous: the belt wraps in between.
    pub fn jumps(&self) -> bool {
        match &self.moving_object.drive {
            Drive::Belt(encoder) => encoder.wraps(self.from_s, self.to_s),
            Drive::Path(_) => false,
        }
    }

    fn time(&self, t: f64) -> f64 {
        // Exact at both ends.
        if t == 1.0 { self.to_s } else { self.from_s + t * (self.to_s - self.from_s) }
    }
}

impl RigidMotion for ObjectMotion<'_> {
    fn pose(&self, t: f64) -> Pose {
        self.moving_object.pose(self.time(t))
    }

    fn speed(&self, radius: f64, from: f64, to: f64) -> f64 {
        let seconds = self.to_s - self.from_s;
        let fastest = match &self.moving_object.drive {
            _ if self.jumps() => return f64::INFINITY,
            Drive::Belt(encoder) => encoder.fastest(self.time(from), self.time(to)),
            Drive::Path(path) => path.fastest(radius),
        };
        // Rounding of distant positions must not make the bound too small.
        fastest * seconds * (1.0 + 1e-9)
    }

    fn constant_twist(&self) -> Option<ConstantTwist> {
        self.constant_twist
    }
}
