//! Observed obstacles as layers of the joint-space map of any robot.

use elbowroom_cspace::{CoverMapBuilder, LayerMap};
use elbowroom_vision::{self as vision, ObstacleId, Point2, Stopwatch};

use crate::error::PerceptionError;
use crate::map_updater::{Changed, MapUpdater, PrismMap, PrismSettings};
use crate::obstacle_update::{ObstacleUpdate, Prism};
use crate::prism_boxes::prism_boxes;

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
        let prisms = RobotPrisms { map: LayerMap::new(builder.grid()), builder, parts: Vec::new() };
        Self { prisms, updater: MapUpdater::default(), settings }
    }

    pub fn map(&self) -> &LayerMap {
        &self.prisms.map
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
        self.prisms.map.publish();
        update.times.publish = stopwatch.lap();
        Ok(())
    }
}

/// Prisms as boxes in the map of any robot.
#[derive(Debug)]
struct RobotPrisms {
    map: LayerMap,
    builder: CoverMapBuilder,
    /// Number of boxes of each obstacle.
    parts: Vec<(ObstacleId, usize)>,
}

impl PrismMap for RobotPrisms {
    fn set(&mut self, id: ObstacleId, footprint_m: &[Point2], heights_m: [f64; 2]) -> Result<Changed, PerceptionError> {
        let boxes = prism_boxes(footprint_m, heights_m);
        if boxes.is_empty() || !(heights_m[1] > heights_m[0]) {
            return Err(PerceptionError::Obstacle(format!("{id} has no volume")));
        }
        let layer = |(shape, in_world)| self.builder.layer(&self.builder.obstacle(shape)?, in_world);
        let layers = boxes.iter().map(|(shape, pose)| layer((shape, pose)));
        let layers: Vec<_> = layers.collect::<Result<_, _>>().map_err(|e| PerceptionError::Obstacle(e.to_string()))?;
        // The new ones first, so that no cell is free in between.
        let count = layers.len();
        let mut changed = Changed::default();
        for (part, layer) in layers.into_iter().enumerate() {
            changed += Changed::of(self.map.set_layer(&part_name(id, part), layer));
        }
        let before = self.parts.iter().position(|(known, _)| *known == id).map(|at| self.parts.swap_remove(at).1);
        for part in count..before.unwrap_or(0) {
            changed += self.map.remove(&part_name(id, part)).map_or_else(Changed::default, Changed::of);
        }
        self.parts.push((id, count));
        Ok(changed)
    }

    fn remove(&mut self, id: ObstacleId) -> Option<Changed> {
        let at = self.parts.iter().position(|(known, _)| *known == id)?;
        let mut changed = Changed::default();
        for part in 0..self.parts.swap_remove(at).1 {
            changed += self.map.remove(&part_name(id, part)).map_or_else(Changed::default, Changed::of);
        }
        Some(changed)
    }
}

fn part_name(id: ObstacleId, part: usize) -> String {
    format!("{id}.{part}")
}
