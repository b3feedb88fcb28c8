//! What moves during a sweep.

use elbowroom_proximity::ccd::RigidMotion;
use elbowroom_robot::{ObjectId, RobotId};

/// A robot or object that moves while the time of a sweep runs from 0 to 1.
#[derive(Clone, Copy)]
pub enum SweepMove<'m> {
    /// A robot, from its configuration in the start state: every joint at a constant rate, all joints together,
    /// `q(t) = q(0) + (to − q(0))·t`. Objects attached to it move along.
    Robot {
        /// The robot.
        robot: RobotId,
        /// Joint values at the end, rad or m.
        to: &'m [f64],
    },
    /// An object that is not attached. The path gives its pose; that in the start state is ignored.
    Object {
        /// The object.
        object: ObjectId,
        /// Its path: [`ConstantTwist`](elbowroom_proximity::ccd::ConstantTwist), or any other path with a speed bound.
        path: &'m dyn RigidMotion,
    },
}

impl std::fmt::Debug for SweepMove<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Robot { robot, to } => f.debug_struct("Robot").field("robot", robot).field("to", to).finish(),
            Self::Object { object, .. } => f.debug_struct("Object").field("object", object).finish_non_exhaustive(),
        }
    }
}
