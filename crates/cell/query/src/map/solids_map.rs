//! Computation of the blocked cells, on sphere covers if possible, otherwise with the robot's own solids.

use std::time::{Duration, Instant};

use elbowroom_cell::CellRobot;
use elbowroom_cspace::{
    CoverMapBuilder, CoverMapSettings, Grid, GridAxis, Layer, ObstacleModel, OccupancyBitmap, RemainingJoints,
    RobotMapBuilder, RobotMapError, SphereRefinement,
};
use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

use super::BlockedCells;
use crate::cover_cache::CoverCache;

/// Computes the cells that obstacles block.
#[derive(Debug)]
pub(crate) enum SolidsMap {
    /// On sphere covers of the links: for three joints, if one of these joints carries all links.
    Covers(Box<CoverMapBuilder>),
    /// With the robot's own solids.
    Exact(Box<RobotMapBuilder>),
}

/// The cells of an obstacle, and the time without preparing its shape.
pub(crate) struct FilledCells {
    pub blocks: BlockedCells,
    pub time: Duration,
    /// Number of spheres in place of the obstacle, if it was refined until a deadline.
    pub spheres: Option<u32>,
}

impl SolidsMap {
    /// Uses sphere covers with this clearance (m), if one is given and covers are possible, otherwise the solids,
    /// without a clearance.
    pub fn new(
        robot: &CellRobot,
        axes: &[GridAxis],
        joints: &[usize],
        others: RemainingJoints<'_>,
        on_covers: Option<f64>,
    ) -> Result<Self, RobotMapError> {
        let (model, base) = (&robot.robot, robot.base_in_world);
        let three = <[GridAxis; 3]>::try_from(axes.to_vec()).ok().zip(<[usize; 3]>::try_from(joints).ok());
        if let (Some((axes, joints)), Some(clearance_m)) = (three, on_covers)
            && let Ok(grid) = Grid::new(axes)
        {
            let settings = CoverMapSettings { clearance_m, ..CoverMapSettings::default() };
            let covers = CoverCache::of_user();
            match CoverMapBuilder::with_covers(model, base, &grid, joints, others, settings, &covers) {
                Ok(builder) => return Ok(Self::Covers(Box::new(builder))),
                Err(RobotMapError::NoCommonJoint | RobotMapError::Memory { .. }) => {}
                Err(other) => return Err(other),
            }
        }
        RobotMapBuilder::new(model, base, axes, joints, others).map(|builder| Self::Exact(Box::new(builder)))
    }

    /// The cells that a model of some obstacles blocks; `progress` receives the finished fraction.
    pub fn fill(
        &self,
        model: ObstacleModel,
        obstacles: &[(&Shape, Pose)],
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<FilledCells, RobotMapError> {
        match self {
            Self::Covers(builder) => {
                let (mut layers, mut time) = (Vec::new(), Duration::ZERO);
                for (shape, in_world) in obstacles {
                    time += add_layers(builder, model, shape, in_world, &mut layers)?;
                }
                Ok(FilledCells { blocks: table(builder, &layers), time, spheres: None })
            }
            Self::Exact(builder) => {
                let begin = Instant::now();
                let tree = builder.build_model(model, obstacles, progress)?;
                Ok(FilledCells { blocks: BlockedCells::Tree(tree), time: begin.elapsed(), spheres: None })
            }
        }
    }

    /// The cells around seeds of an obstacle; `None` without covers.
    pub fn expand(&self, shape: &Shape, in_world: &Pose) -> Option<Result<FilledCells, RobotMapError>> {
        let Self::Covers(builder) = self else { return None };
        let expand = || {
            let obstacle = builder.obstacle(shape)?;
            let begin = Instant::now();
            let table = builder.expand_from_seeds(&obstacle, in_world)?.occupancy;
            let blocks = BlockedCells::Table { grid: Box::new(builder.grid().clone()), table };
            Ok(FilledCells { blocks, time: begin.elapsed(), spheres: None })
        };
        Some(expand())
    }

    /// The cells of one sphere around each obstacle, then of more and smaller ones around its parts, up to `most`
    /// spheres.
    ///
    /// Obstacles are refined in turn until the deadline. `None` without covers.
    pub fn fill_until(
        &self,
        deadline: Instant,
        most: u32,
        obstacles: &[(&Shape, Pose)],
    ) -> Option<Result<Vec<FilledCells>, RobotMapError>> {
        let Self::Covers(builder) = self else { return None };
        let refine_all = || {
            let first = obstacles.iter().map(|&(shape, at)| first_sphere(builder, shape, at, most));
            let mut all = first.collect::<Result<Vec<_>, RobotMapError>>()?;
            let mut is_refining = true;
            while is_refining {
                is_refining = false;
                for (refinement, time) in &mut all {
                    let begin = Instant::now();
                    is_refining |= refinement.refine(Some(deadline))?;
                    *time += begin.elapsed();
                }
            }
            let filled = |(refinement, time): (SphereRefinement<'_>, Duration)| FilledCells {
                spheres: Some(refinement.spheres()),
                blocks: table(builder, &[refinement.into_layer()]),
                time,
            };
            Ok(all.into_iter().map(filled).collect())
        };
        Some(refine_all())
    }
}

/// One sphere around an obstacle, and the time.
fn first_sphere<'b>(
    builder: &'b CoverMapBuilder,
    shape: &'b Shape,
    in_world: Pose,
    most: u32,
) -> Result<(SphereRefinement<'b>, Duration), RobotMapError> {
    let begin = Instant::now();
    let refinement = SphereRefinement::new(builder, shape, in_world, most)?;
    Ok((refinement, begin.elapsed()))
}

/// Adds the layers of a model of an obstacle; returns the time without preparing its shape.
fn add_layers(
    builder: &CoverMapBuilder,
    model: ObstacleModel,
    shape: &Shape,
    in_world: &Pose,
    layers: &mut Vec<Layer>,
) -> Result<Duration, RobotMapError> {
    if model == ObstacleModel::Slices {
        builder.prepare_slices();
        let begin = Instant::now();
        layers.push(builder.slice_layer(shape, in_world)?);
        return Ok(begin.elapsed());
    }
    if let ObstacleModel::Spheres(most) = model {
        // Rounded up, as in every map.
        let (mut spheres, begun) = first_sphere(builder, shape, *in_world, most.next_power_of_two())?;
        let begin = Instant::now();
        while spheres.refine(None)? {}
        layers.push(spheres.into_layer());
        return Ok(begun + begin.elapsed());
    }
    let mut time = Duration::ZERO;
    for (shape, in_world) in model.solids(shape, in_world, &builder.base_in_world()) {
        let obstacle = builder.obstacle(&shape)?;
        let begin = Instant::now();
        layers.push(builder.layer(&obstacle, &in_world)?);
        time += begin.elapsed();
    }
    Ok(time)
}

fn table(builder: &CoverMapBuilder, layers: &[Layer]) -> BlockedCells {
    let grid = builder.grid().clone();
    let mut table = OccupancyBitmap::new(grid.shape());
    for layer in layers {
        table.add(layer);
    }
    BlockedCells::Table { grid: Box::new(grid), table }
}
