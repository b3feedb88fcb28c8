//! The joint-space map of a robot with the observed obstacles.

use elbowroom_cspace::{CoverMapBuilder, LayerMap};
use elbowroom_vision::{self as vision, Stopwatch};

use crate::error::PerceptionError;
use crate::map_updater::{MapUpdater, PrismSettings};
use crate::obstacle_update::{ObstacleUpdate, Prism};
use crate::robot_prisms::RobotPrisms;

/// The map of a robot, with the observed obstacles.
#[derive(Debug)]
pub(super) struct RobotMap {
    prisms: RobotPrisms,
    updater: MapUpdater,
    settings: PrismSettings,
}

impl RobotMap {
    /// Creates a map without obstacles.
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

    /// Inserts the obstacles of an accepted frame or cloud, publishes the map, and records the times.
    ///
    /// # Errors
    /// The errors of [`MapUpdater::update`].
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
