//! Why an arm cannot hold the work-piece at a pose.

use elbowroom_robot::GeometryId;

/// Why an arm cannot hold the work-piece at a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HoldLimit {
    /// It does not reach that far, or only in another branch of its inverse kinematics.
    Reach,
    /// A joint is at its limit; the index of the joint.
    JointRange(usize),
    /// A joint would have to be too fast; the index of the joint.
    JointSpeed(usize),
    /// It is near a singularity.
    Singularity,
    /// Its hand could not move back from the work-piece any more.
    Retreat,
    /// There is no room beside the arm that holds the work-piece.
    OtherArm,
    /// It would hide more of the work-piece from the camera than it may. The motion is not stopped for this.
    Hidden,
    /// Two parts would be too near to each other.
    Contact(GeometryId, GeometryId),
}
