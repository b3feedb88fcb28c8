//! The obstacle model of a map.

use std::str::FromStr;

use elbowroom_cspace::{ObstacleModel, UnknownObstacleModel};

/// Obstacle model of a map: what represents an object (the joint-space paper, sections II to V).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapModel {
    /// Solids that enclose the object: no cell is missed.
    Solids(ObstacleModel),
    /// The object itself, with its cells by expansion from seeds: parts of the cells are missed.
    Seeds,
}

impl MapModel {
    /// True if every cell in which the robot can touch the object is blocked.
    pub fn is_conservative(self) -> bool {
        self != Self::Seeds
    }
}

impl Default for MapModel {
    fn default() -> Self {
        Self::Solids(ObstacleModel::default())
    }
}

impl From<ObstacleModel> for MapModel {
    fn from(model: ObstacleModel) -> Self {
        Self::Solids(model)
    }
}

/// A word that is not the name of a map's obstacle model.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}, or seeds")]
pub struct UnknownMapModel(UnknownObstacleModel);

impl FromStr for MapModel {
    type Err = UnknownMapModel;

    fn from_str(word: &str) -> Result<Self, UnknownMapModel> {
        match word {
            "seeds" => Ok(Self::Seeds),
            _ => word.parse().map(Self::Solids).map_err(UnknownMapModel),
        }
    }
}

impl std::fmt::Display for MapModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Solids(model) => model.fmt(f),
            Self::Seeds => f.write_str("seeds"),
        }
    }
}
