//! The moves of a sweep.

use elbowroom_proximity::ccd::RigidMotion;
use elbowroom_robot::{ObjectId, RobotId};

/// A robot or object that moves while the time of a sweep runs from 0 to 1.
#[derive(Clone, Copy)]
pub enum SweepMove<'m> {
    /// A robot that starts at its configuration in the start state.
    ///
    /// Each joint moves at a constant rate, all together: `q(t) = q(0) + (to − q(0))·t`. Attached objects move along.
    Robot {
        /// The robot.
        robot: RobotId,
        /// Joint values at the end, rad or m.
        to: &'m [f64],
    },
    /// An unattached object. Its path gives its pose; its pose in the start state is ignored.
    Object {
        /// The object.
        object: ObjectId,
        /// Path: [`ConstantTwist`](elbowroom_proximity::ccd::ConstantTwist), or any other path with a speed bound.
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
