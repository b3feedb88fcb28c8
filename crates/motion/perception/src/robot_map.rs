//! The joint-space map of a robot with the observed obstacles in it.

use elbowroom_cspace::{CoverMapBuilder, LayerMap};
use elbowroom_vision::{self as vision, Stopwatch};

use crate::error::PerceptionError;
use crate::map_updater::{MapUpdater, PrismSettings};
use crate::obstacle_update::{ObstacleUpdate, Prism};
use crate::robot_prisms::RobotPrisms;

/// The map of a robot, and the observed obstacles in it.
#[derive(Debug)]
pub(super) struct RobotMap {
    prisms: RobotPrisms,
    updater: MapUpdater,
    settings: PrismSettings,
}

impl RobotMap {
    /// An empty map.
    pub fn new(builder: CoverMapBuilder, settings: PrismSettings) -> Self {
        Self { prisms: RobotPrisms::new(builder), updater: MapUpdater::default(), settings }
    }

    pub fn map(&self) -> &LayerMap {
        self.prisms.map()
    }

    /// The obstacles in the map.
    pub fn prisms(&self) -> &[Prism] {
        self.updater.prisms()
    }

    /// Takes over the obstacles of an accepted frame or cloud, publishes the map, and adds the times.
    ///
    /// # Errors
    /// As [`MapUpdater::update`].
    pub fn take_over(
        &mut self,
        reported: &[vision::Obstacle],
        update: &mut ObstacleUpdate,
    ) -> Result<(), PerceptionError> {
        let mut stopwatch = Stopwatch::start();
        self.updater.update(reported, &self.settings, &mut self.prisms, update)?;
        update.times.map = stopwatch.lap();
        self.prisms.publish();
        update.times.publish = stopwatch.lap();
        Ok(())
    }
}
