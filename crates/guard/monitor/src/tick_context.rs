//! The state that the laws of one tick evaluate.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::Vec3;

use crate::placement::Placement;
use crate::point_motion::{LinkPoint, region_point_motion};
use crate::volume_region_pair::VolumeRegionPair;
use crate::{Configuration, RegionId, Snapshot};

/// Settings of the direction-aware law and of recovery.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DirectionSettings {
    /// Prediction time along the program's velocities, s.
    pub(crate) lookahead_s: f64,
    /// Smallest rate at which the distance of a leaving volume grows, m/s.
    pub(crate) leaving_speed: f64,
}

impl Default for DirectionSettings {
    fn default() -> Self {
        Self { lookahead_s: 0.01, leaving_speed: 5e-4 }
    }
}

/// The state of the robot and the regions in one tick.
#[derive(Clone, Copy)]
pub(crate) struct TickContext<'a> {
    pub(crate) config: &'a Configuration,
    pub(crate) snapshot: &'a Snapshot<'a>,
    pub(crate) now: &'a Placement,
    /// The placement after [`DirectionSettings::lookahead_s`], for the direction-aware law.
    pub(crate) predicted: Option<&'a Placement>,
    /// The chain at the program's velocities at override 1, for the laws that need it.
    pub(crate) intent: Option<&'a ChainState>,
    /// The override of the last tick, which the robot may still be executing.
    pub(crate) last_override: f64,
    pub(crate) direction: DirectionSettings,
}

impl TickContext<'_> {
    /// Velocity (m/s) of the point of a volume at `point` (world, m) when the chain moves as in `state`.
    pub(crate) fn volume_point_velocity(&self, state: &ChainState, volume: usize, point: Vec3) -> Vec3 {
        LinkPoint::new(self.config, state, self.config.volumes[volume].link, point).velocity()
    }

    /// Velocity (m/s) of the point of a region at `point` (world, m).
    pub(crate) fn region_point_velocity(&self, region: RegionId, point: Vec3) -> Vec3 {
        region_point_motion(&self.config.regions[region.0], self.snapshot.sources, point).velocity
    }

    /// True if the program leaves the region along `away`, and the robot's actual motion is not towards the region.
    pub(crate) fn leaves_along(&self, pair: &VolumeRegionPair, intent: &ChainState, away: Vec3) -> bool {
        let region_velocity = self.region_point_velocity(pair.region, pair.separation.on_b);
        let velocity = |state| self.volume_point_velocity(state, pair.volume, pair.separation.on_a) - region_velocity;
        velocity(intent).dot(away) > self.direction.leaving_speed && velocity(&self.now.chain).dot(away) >= 0.0
    }
}
