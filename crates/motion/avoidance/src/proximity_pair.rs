//! Pairs of a link and an obstacle near it.

use elbowroom_kinematics::LinkId;
use elbowroom_spatial::Vec3;

/// The witness points of a link of the robot and an obstacle. All vectors are in the frame of the robot's root link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProximityPair {
    /// The link.
    pub link: LinkId,
    /// Witness point on the link: the controlled collision point.
    pub on_link: Vec3,
    /// Unit vector from the obstacle to the link.
    pub away: Vec3,
    /// Separation distance, m.
    pub distance_m: f64,
    /// Witness point on the obstacle.
    pub on_obstacle: Vec3,
    /// The obstacle.
    pub obstacle: ObstacleKind,
}

/// The kind of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ObstacleKind {
    /// A link of the robot itself.
    OwnLink(LinkId),
    /// A known obstacle at the pose of the scene: the robot keeps its distance but does not evade it.
    Fixed,
    /// A known obstacle with a known motion: the robot keeps its distance but does not evade it.
    KnownMoving {
        /// Velocity of the witness point, m/s.
        velocity: Vec3,
    },
    /// A dynamic obstacle, or one that the path was not planned for: the robot evades it.
    Dynamic {
        /// Velocity of the witness point, m/s.
        velocity: Vec3,
        /// Centre of a bounding sphere.
        centre: Vec3,
        /// Radius of the bounding sphere, m.
        radius_m: f64,
        /// Identifies the obstacle between ticks, so that the robot keeps the side on which the obstacle passes.
        key: usize,
    },
}

impl ObstacleKind {
    pub(crate) fn is_dynamic(&self) -> bool {
        matches!(self, Self::Dynamic { .. })
    }

    /// Whether the obstacle is dynamic or a known moving one.
    pub(crate) fn may_move(&self) -> bool {
        matches!(self, Self::Dynamic { .. } | Self::KnownMoving { .. })
    }
}

impl ProximityPair {
    /// Velocity of the witness point on the obstacle, m/s; 0 for own links.
    pub(crate) fn obstacle_velocity(&self) -> Vec3 {
        match self.obstacle {
            ObstacleKind::Dynamic { velocity, .. } | ObstacleKind::KnownMoving { velocity } => velocity,
            ObstacleKind::OwnLink(_) | ObstacleKind::Fixed => Vec3::ZERO,
        }
    }
}
