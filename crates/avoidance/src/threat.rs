//! Something near the robot.

use elbowroom_kinematics::LinkId;
use elbowroom_spatial::Vec3;

/// One pair of nearest points: on a link of the robot, and on what it must not touch. All vectors are in the frame of the
/// robot's root link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Threat {
    /// The link.
    pub link: LinkId,
    /// Nearest point on it: the collision point that is steered (S4.6).
    pub on_link: Vec3,
    /// From the other to the link, length 1.
    pub away: Vec3,
    /// Between the two, m.
    pub distance_m: f64,
    /// Nearest point on the other.
    pub on_other: Vec3,
    /// What the other is.
    pub other: Other,
}

/// What a robot must not touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Other {
    /// A link of the robot itself.
    Own(LinkId),
    /// Something known that stands where the planner knew it: kept clear of, not fled from.
    Fixed,
    /// Something known that moves as it is known to: kept clear of, not fled from.
    Moving {
        /// Velocity of its nearest point, m/s.
        velocity: Vec3,
    },
    /// Something that comes, or that nobody planned for.
    Loose {
        /// Velocity of its nearest point, m/s.
        velocity: Vec3,
        /// Centre of a ball around it.
        centre: Vec3,
        /// Radius of that ball, m.
        radius_m: f64,
        /// Names it: the side on which it is passed is kept.
        key: usize,
    },
}

impl Threat {
    /// Velocity of the other's nearest point, m/s; own links are not asked here.
    pub(crate) fn velocity(&self) -> Vec3 {
        match self.other {
            Other::Loose { velocity, .. } | Other::Moving { velocity } => velocity,
            Other::Own(_) | Other::Fixed => Vec3::ZERO,
        }
    }
}
