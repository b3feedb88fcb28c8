//! Observed obstacles as layers of the joint-space map of any robot.

use std::ops::AddAssign;

use elbowroom_cspace::{CellChanges, CoverMapBuilder, LayerMap};
use elbowroom_vision::{ObstacleId, Point2};

use crate::error::PerceptionError;
use crate::prism_boxes::prism_boxes;

/// A map of prisms, which are stored as boxes with one layer per box.
#[derive(Debug)]
pub(super) struct RobotPrisms {
    map: LayerMap,
    builder: CoverMapBuilder,
    /// Number of boxes of each obstacle.
    parts: Vec<(ObstacleId, usize)>,
}

impl RobotPrisms {
    /// Creates a map without obstacles.
    pub fn new(builder: CoverMapBuilder) -> Self {
        Self { map: LayerMap::new(builder.grid()), builder, parts: Vec::new() }
    }

    pub fn map(&self) -> &LayerMap {
        &self.map
    }

    /// Publishes the present map to readers.
    pub fn publish(&mut self) {
        self.map.publish();
    }

    /// Blocks the cells of an upright prism, which replaces the obstacle's previous prism.
    ///
    /// # Errors
    /// The prism has no volume or is too far away; the map is unchanged.
    pub fn set(
        &mut self,
        id: ObstacleId,
        footprint_m: &[Point2],
        heights_m: [f64; 2],
    ) -> Result<Changed, PerceptionError> {
        let boxes = prism_boxes(footprint_m, heights_m);
        if boxes.is_empty() || !(heights_m[1] > heights_m[0]) {
            return Err(PerceptionError::Obstacle(format!("{id} has no volume")));
        }
        let layer = |(shape, in_world)| self.builder.layer(&self.builder.obstacle(shape)?, in_world);
        let layers = boxes.iter().map(|(shape, pose)| layer((shape, pose)));
        let layers: Vec<_> = layers.collect::<Result<_, _>>().map_err(|e| PerceptionError::Obstacle(e.to_string()))?;
        // The new layers first, so that no cell is free in between.
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

    /// Frees the cells of an obstacle; `None` if the obstacle is not in the map.
    pub fn remove(&mut self, id: ObstacleId) -> Option<Changed> {
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

/// Numbers of cells that changed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Changed {
    pub blocked: usize,
    pub freed: usize,
}

impl Changed {
    pub fn of(changes: &CellChanges) -> Self {
        Self { blocked: changes.blocked(), freed: changes.freed() }
    }
}

impl AddAssign for Changed {
    fn add_assign(&mut self, other: Self) {
        self.blocked += other.blocked;
        self.freed += other.freed;
    }
}
