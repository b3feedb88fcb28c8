//! The state that the laws of one tick evaluate.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::Vec3;

use crate::placement::Placement;
use crate::point_motion::{LinkPoint, region_point_motion};
use crate::volume_region_pair::VolumeRegionPair;
use crate::{Configuration, RegionId, Snapshot};

/// Prediction time of the direction-aware law along the program's velocities, s.
pub(crate) const LOOKAHEAD_S: f64 = 0.01;
/// Smallest rate at which the distance of a leaving volume grows, m/s.
pub(crate) const LEAVING_SPEED: f64 = 5e-4;

/// The state of the robot and the regions in one tick.
#[derive(Clone, Copy)]
pub(crate) struct TickContext<'a> {
    pub(crate) config: &'a Configuration,
    pub(crate) snapshot: &'a Snapshot<'a>,
    pub(crate) now: &'a Placement,
    /// The placement after [`LOOKAHEAD_S`], for the direction-aware law.
    pub(crate) predicted: Option<&'a Placement>,
    /// The chain at the program's velocities at override 1, for the laws that need it.
    pub(crate) intent: Option<&'a ChainState>,
    /// The override of the last tick, which the robot may still be executing.
    pub(crate) last_override: f64,
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
        velocity(intent).dot(away) > LEAVING_SPEED && velocity(&self.now.chain).dot(away) >= 0.0
    }
}
