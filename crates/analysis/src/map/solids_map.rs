//! What computes the blocked cells: sphere covers where they can, else the robot's own solids.

use std::time::{Duration, Instant};

use elbowroom_cell::CellRobot;
use elbowroom_cspace::{
    CoverMapBuilder, CoverMapSettings, Grid, GridAxis, Layer, OccupancyBitmap, RemainingJoints, RobotMapBuilder,
    RobotMapError,
};
use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

use super::BlockedCells;
use crate::cover_cache::CoverCache;

/// Computes the cells that solids block.
pub(super) enum SolidsMap {
    /// On sphere covers of the links: three joints that hang on one of them.
    Covers(Box<CoverMapBuilder>),
    /// With the robot's own solids.
    Exact(Box<RobotMapBuilder>),
}

impl SolidsMap {
    pub fn new(
        robot: &CellRobot,
        axes: &[GridAxis],
        joints: &[usize],
        others: RemainingJoints<'_>,
        exact: bool,
    ) -> Result<Self, RobotMapError> {
        let (model, base) = (&robot.robot, robot.base_in_world);
        let three = <[GridAxis; 3]>::try_from(axes.to_vec()).ok().zip(<[usize; 3]>::try_from(joints).ok());
        if let Some((axes, joints)) = three.filter(|_| !exact)
            && let Ok(grid) = Grid::new(axes)
        {
            let settings = CoverMapSettings::default();
            let covers = CoverCache::of_user();
            match CoverMapBuilder::with_covers(model, base, &grid, joints, others, settings, &covers) {
                Ok(builder) => return Ok(Self::Covers(Box::new(builder))),
                Err(RobotMapError::NoCommonJoint | RobotMapError::Memory { .. }) => {}
                Err(other) => return Err(other),
            }
        }
        RobotMapBuilder::new(model, base, axes, joints, others).map(|builder| Self::Exact(Box::new(builder)))
    }

    /// The frame of the first axis in the world.
    pub fn base_in_world(&self) -> Pose {
        match self {
            Self::Covers(builder) => builder.base_in_world(),
            Self::Exact(builder) => builder.base_in_world(),
        }
    }

    /// The cells that solids block, placed in the world, and the time this takes without preparing the shapes.
    pub fn fill(&self, solids: &[(Shape, Pose)]) -> Result<(BlockedCells, Duration), RobotMapError> {
        match self {
            Self::Covers(builder) => {
                let mut time = Duration::ZERO;
                let mut layers: Vec<Layer> = Vec::with_capacity(solids.len());
                for (shape, in_world) in solids {
                    let obstacle = builder.obstacle(shape)?;
                    let begin = Instant::now();
                    layers.push(builder.layer(&obstacle, in_world)?);
                    time += begin.elapsed();
                }
                let grid = builder.grid().clone();
                let mut table = OccupancyBitmap::new(grid.shape());
                for layer in &layers {
                    table.add(layer);
                }
                Ok((BlockedCells::Table { grid: Box::new(grid), table }, time))
            }
            Self::Exact(builder) => {
                let begin = Instant::now();
                let tree = builder.build(solids)?;
                Ok((BlockedCells::Tree(tree), begin.elapsed()))
            }
        }
    }
}
