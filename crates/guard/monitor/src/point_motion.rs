//! Motion of points of links, volumes and regions, in the world frame.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

use crate::placement::Placement;
use crate::{Configuration, Region, SourceState};

/// A material point of a link at one instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinkPoint<'a> {
    base_in_world: &'a Pose,
    link_motion: FrameMotion,
    /// Vector from the link's origin to the point, in the frame of the root link, m.
    offset: Vec3,
}

impl<'a> LinkPoint<'a> {
    /// The point of `link` that is at `point_in_world` (m) when the chain moves as in `state`.
    pub(crate) fn new(config: &'a Configuration, state: &ChainState, link: LinkId, point_in_world: Vec3) -> Self {
        let base_in_world = &config.base_in_world;
        let origin = base_in_world.transform_point(state.link_in_root(link).translation);
        Self {
            base_in_world,
            link_motion: state.link_motion(link),
            offset: base_in_world.inverse_transform_vector(point_in_world - origin),
        }
    }

    /// Velocity in the world, m/s.
    pub(crate) fn velocity(&self) -> Vec3 {
        self.base_in_world.transform_vector(self.link_motion.velocity_at(self.offset))
    }

    /// Acceleration in the world, m/s².
    pub(crate) fn acceleration(&self) -> Vec3 {
        self.base_in_world.transform_vector(self.link_motion.acceleration_at(self.offset))
    }

    /// Upper bound of the speed of any point within `radius` (m) of this one, m/s.
    pub(crate) fn max_speed_within(&self, radius: f64) -> f64 {
        self.link_motion.velocity_at(self.offset).length() + self.link_motion.angular_velocity.length() * radius
    }
}

/// Largest speed (m/s) along the unit vector `towards` of any point of a volume when the chain moves as in `state`. The
/// velocity field of a rigid body is linear, so a support point of the volume attains it.
pub(crate) fn max_speed_along(
    config: &Configuration,
    now: &Placement,
    volume_index: usize,
    state: &ChainState,
    towards: Vec3,
) -> f64 {
    let volume = &config.volumes[volume_index];
    let base = &config.base_in_world;
    let motion = state.link_motion(volume.link);
    let link_in_world = *base * state.link_in_root(volume.link);
    let velocity = base.transform_vector(motion.velocity);
    let angular_velocity = base.transform_vector(motion.angular_velocity);
    let lever = towards.cross(angular_velocity);
    let volume_in_world = &now.volume_in_world[volume_index];
    let farthest =
        volume_in_world.transform_point(volume.shape.support(volume_in_world.inverse_transform_vector(lever)));
    velocity.dot(towards) - lever.dot(link_in_world.translation - farthest)
}

/// Velocity (m/s) and acceleration (m/s²) of a point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct PointMotion {
    pub(crate) velocity: Vec3,
    pub(crate) acceleration: Vec3,
}

/// Motion of the point of a region at `point_in_world` (m).
pub(crate) fn region_point_motion(region: &Region, sources: &[SourceState], point_in_world: Vec3) -> PointMotion {
    let Some(source) = region.source_state(sources) else { return PointMotion::default() };
    let offset = point_in_world - source.pose.translation;
    PointMotion { velocity: source.motion.velocity_at(offset), acceleration: source.motion.acceleration_at(offset) }
}
