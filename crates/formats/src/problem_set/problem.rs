//! A planning problem, as far as it is read.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

use super::collision_matrix::ProblemMatrix;

/// A planning problem: obstacles, a start and alternative goals.
#[derive(Debug, Clone)]
pub struct PlanningProblem {
    /// Name of its set.
    pub set: String,
    /// Its key in the set.
    pub id: String,
    /// Frames that objects may refer to, besides the links.
    pub frames: Vec<FixedFrame>,
    /// Obstacles.
    pub objects: Vec<ProblemObject>,
    /// Objects that the robot holds.
    pub attached: Vec<AttachedObject>,
    /// Pairs that may touch.
    pub matrix: ProblemMatrix,
    /// Pose of the robot's root link.
    pub base_in_world: Pose,
    /// Joint values at the start; no joint twice.
    pub start: Vec<JointValue>,
    /// Alternative goals, at least one; none is empty.
    pub goals: Vec<Vec<JointValue>>,
}

/// The value of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointValue {
    /// Name of the joint.
    pub joint: String,
    /// rad, m for prismatic joints; finite.
    pub value: f64,
}

/// A frame at a constant pose.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedFrame {
    /// Its name.
    pub name: String,
    /// The frame that it is in; empty for the world.
    pub parent: String,
    /// Its pose.
    pub in_parent: Pose,
}

/// An object of one or more solids.
#[derive(Debug, Clone)]
pub struct ProblemObject {
    /// Unique among the objects of a problem.
    pub id: String,
    /// The frame of the poses; empty for the world.
    pub frame: String,
    /// Shapes with their poses; at least one.
    pub solids: Vec<(Shape, Pose)>,
}

/// An object that a link carries.
#[derive(Debug, Clone)]
pub struct AttachedObject {
    /// The object; without a frame of its own it is in that of the link.
    pub object: ProblemObject,
    /// Name of the link.
    pub link: String,
    /// Names of the links that may touch it.
    pub touch_links: Vec<String>,
}
