//! Builder of layers of a robot's map on covers.

use std::sync::OnceLock;

use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;
use elbowroom_validity::{BuiltCovers, CoverSource, SphereCover, covers};

use super::super::builder::RobotMapBuilder;
use super::super::driven_chain::RemainingJoints;
use super::super::error::RobotMapError;
use super::super::placed_obstacle::PlacedObstacle;
use super::super::rigid_groups::{RigidGroup, RigidGroups};
use super::axis_roles::AxisRoles;
use super::box_division::{self, BoxDivision};
use super::cell_bits::CellBits;
use super::cover_class::{CoverClass, CoveredGroup, classes};
use super::obstacle::CoverObstacle;
use super::obstacle_lanes::ObstacleLanes;
use super::planar_arm_map::PlanarArmMap;
use super::seeds::seeds;
use super::slice_map::{RingSector, SliceDivision, SliceMotions};
use super::step_chain::StepChain;
use crate::seed_expansion::expand;
use crate::{Grid, Layer, ObstacleModel, RowSpan, SeedExpansion};

/// Slack of covers as a fraction of the robot's reach; then its limits, m.
const SLACK_SHARE: f64 = 0.0018;
const LEAST_SLACK_M: f64 = 0.001;
const MOST_SLACK_M: f64 = 0.0045;

/// Largest number of cells of all three axes, and of the two axes that are not in lanes: tables of them take 256 MiB
/// and 200 MB.
const MOST_CELLS: usize = 1 << 31;
const MOST_ROWS: usize = 1 << 20;

/// Settings of a [`CoverMapBuilder`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoverMapSettings {
    /// Largest protrusion of a cover from its link, m; `None`: depends on the size of the robot, 1 to 4.5 mm.
    pub slack_m: Option<f64>,
    /// Distance up to which cells count as blocked, m: a cover is larger than the robot by this distance.
    pub clearance_m: f64,
}

/// Builds maps of one robot on sphere covers of its links, in milliseconds: a [`Layer`] per obstacle, over three axes.
///
/// A layer blocks every cell with a configuration in which a link that the axes move is in contact with the obstacle.
///
/// ```
/// use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, LayerMap, RemainingJoints};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_robot::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// let robot = example::arm()?;
/// let grid = Grid::new(["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 3.0).unwrap()))?;
/// let settings = CoverMapSettings::default();
/// let builder = CoverMapBuilder::new(&robot, Pose::IDENTITY, &grid, [0, 1, 2], RemainingJoints::Swept, settings)?;
/// let ball = builder.obstacle(&Shape::Sphere(Sphere { radius: 0.2 }))?;
/// let mut map = LayerMap::new(&grid);
/// map.set_layer("ball", builder.layer(&ball, &Pose::from_translation(Vec3::new(0.7, 0.0, 0.7)))?);
/// assert!(map.is_blocked([0.0, 0.6, 0.6]) && !map.is_blocked([1.5, 0.0, 0.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CoverMapBuilder {
    /// The robot's own solids.
    exact: RobotMapBuilder,
    grid: Grid,
    roles: AxisRoles,
    steps: StepChain,
    classes: Vec<CoverClass>,
    planar: Option<PlanarArmMap>,
    /// Computed for the first slices.
    slice_motions: OnceLock<SliceMotions>,
    slack_m: f64,
}

impl CoverMapBuilder {
    /// Creates a builder for a robot with its base at `base_in_world`; `joints[i]` is the index of axis `i` among the
    /// joint values.
    ///
    /// # Errors
    /// The errors of [`RobotMapBuilder::new`]; the links are not all carried by one joint of the map; or there are more
    /// cells than tables can hold.
    pub fn new(
        robot: &Robot,
        base_in_world: Pose,
        grid: &Grid,
        joints: [usize; 3],
        remaining: RemainingJoints<'_>,
        settings: CoverMapSettings,
    ) -> Result<Self, RobotMapError> {
        Self::with_covers(robot, base_in_world, grid, joints, remaining, settings, &BuiltCovers)
    }

    /// Like [`new`](Self::new), with the covers of the links from a source, such as a cache.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new).
    pub fn with_covers(
        robot: &Robot,
        base_in_world: Pose,
        grid: &Grid,
        joints: [usize; 3],
        remaining: RemainingJoints<'_>,
        settings: CoverMapSettings,
        source: &dyn CoverSource,
    ) -> Result<Self, RobotMapError> {
        let exact = RobotMapBuilder::new(robot, base_in_world, grid.axes(), &joints, remaining)?;
        let groups = RigidGroups::new(robot, &exact.chain)?.groups;
        let roles = AxisRoles::new(grid, &groups).ok_or(RobotMapError::NoCommonJoint)?;
        let [first, second] = roles.other_counts();
        if first * second > MOST_ROWS || grid.cells() > MOST_CELLS {
            return Err(RobotMapError::Memory { mib: MOST_CELLS >> 23 });
        }
        if let Some(slack_m) = settings.slack_m.filter(|slack_m| !(*slack_m > 0.0 && slack_m.is_finite())) {
            return Err(RobotMapError::Slack(slack_m));
        }
        let reach = reach_m(robot);
        let slack_m = settings.slack_m.unwrap_or_else(|| (SLACK_SHARE * reach).clamp(LEAST_SLACK_M, MOST_SLACK_M));
        if !(settings.clearance_m >= 0.0 && settings.clearance_m.is_finite()) {
            return Err(RobotMapError::Clearance(settings.clearance_m));
        }
        // The capsules of an arm in a plane are the capsules of its links.
        let has_clearance = settings.clearance_m > 0.0;
        let planar = if has_clearance { None } else { PlanarArmMap::new(&exact.chain, &groups, grid, slack_m) };
        let mut steps = StepChain::default();
        let mut covers = covers_of(&groups, slack_m, source)?;
        let outer = covers.iter_mut().flat_map(|cover| &mut cover.outer);
        outer.for_each(|ball| ball.radius += settings.clearance_m);
        let covered: Vec<CoveredGroup<'_>> = groups
            .iter()
            .zip(covers)
            .map(|(group, cover)| CoveredGroup {
                group,
                cover,
                path: steps.add_path(&exact.chain, grid.axes(), &group.joints),
            })
            .collect();
        let classes = classes(&covered, &steps, grid, &roles);
        let slice_motions = OnceLock::new();
        Ok(Self { grid: grid.clone(), roles, steps, classes, planar, slice_motions, slack_m, exact })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Whether the robot is an arm in a plane with round links. For these, convex obstacles take hundredths of a
    /// millisecond, as with a [`PlanarMapBuilder`](crate::PlanarMapBuilder).
    pub fn is_planar(&self) -> bool {
        self.planar.is_some()
    }

    /// Largest protrusion of a cover from its link, m.
    pub fn slack_m(&self) -> f64 {
        self.slack_m
    }

    /// The frame of the first axis in the world, for [`ObstacleModel::solids`](crate::ObstacleModel::solids): its z
    /// direction is along the axis.
    pub fn base_in_world(&self) -> Pose {
        self.exact.base_in_world()
    }

    /// Prepares an obstacle for [`layer`](Self::layer), once for all its poses.
    ///
    /// # Errors
    /// The shape contains NaN or infinite numbers.
    pub fn obstacle(&self, shape: &Shape) -> Result<CoverObstacle, RobotMapError> {
        CoverObstacle::new(shape, self.slack_m)
    }

    /// Computes the cells that an obstacle blocks, placed in the world, on all cores (of the pool of rayon).
    ///
    /// # Errors
    /// The pose is not finite or too far away.
    pub fn layer(&self, obstacle: &CoverObstacle, in_world: &Pose) -> Result<Layer, RobotMapError> {
        obstacle.validate_place(in_world)?;
        if let Some(layer) = self.layer_of_shape(ObstacleModel::Exact, &obstacle.shape, in_world)? {
            return Ok(layer);
        }
        let Some(first) = self.steps.steps.first() else { return Ok(Layer::new()) };
        let lanes = ObstacleLanes::new(obstacle, in_world, first, &self.classes, &self.grid, &self.roles);
        Ok(box_division::fill(&lanes, &self.classes, self.roles, first).to_layer(self.grid.shape()))
    }

    /// Computes the cells that [`ObstacleModel::Slices`] of a solid block: one slice, without the joint nearest the
    /// base, copied to the values of that joint at which the links can reach the solid. The solid needs no preparation.
    ///
    /// Half spaces, which have no bounds, and all solids if the joint nearest the base is prismatic, are mapped by
    /// themselves instead of by slices.
    ///
    /// # Errors
    /// The shape contains NaN or infinite numbers, or the pose is not finite or too far away.
    pub fn slice_layer(&self, shape: &Shape, in_world: &Pose) -> Result<Layer, RobotMapError> {
        if shape.validate().is_err() || !in_world.is_finite() {
            return Err(RobotMapError::InvalidPlacement("an obstacle".into()));
        }
        let turning = self.steps.steps.first().filter(|first| first.turns);
        let (Some(first), false) = (turning, matches!(shape, Shape::HalfSpace(_))) else {
            return self.layer(&self.obstacle(shape)?, in_world);
        };
        if let Some(layer) = self.layer_of_shape(ObstacleModel::Slices, shape, in_world)? {
            return Ok(layer);
        }
        let reach_m = self.classes.iter().map(|class| class.reach_m).fold(0.0, f64::max);
        let sector = RingSector::new(shape, in_world, first, reach_m);
        let sector = sector.ok_or_else(|| RobotMapError::InvalidPlacement("an obstacle".into()))?;
        let motions = self.slice_motions();
        let axis = &self.grid.axes()[self.roles.lanes];
        let mut division = SliceDivision::new(sector, &self.classes, motions, self.roles, first, axis);
        division.run();
        Ok(division.bits.to_layer(self.grid.shape()))
    }

    /// Blocks cells by expansion from seeds, the method of the joint-space paper, section IV. Seeds are cells at which
    /// a link is nearest to the obstacle's centre. From them, neighbours are tested until all free neighbours of
    /// blocked cells are tested. Cells between two blocked neighbours on opposite sides are blocked without a test.
    ///
    /// **Not conservative.** The expansion finds every blocked cell beside a blocked cell, but misses parts of the
    /// blocked cells that contain no seed: an arm that reaches the obstacle with two links, or over its back, has
    /// several such parts. For this reason the result is not a [`Layer`], and a map that guards a robot cannot use it.
    ///
    /// # Errors
    /// The pose is not finite or too far away.
    pub fn expand_from_seeds(&self, obstacle: &CoverObstacle, in_world: &Pose) -> Result<SeedExpansion, RobotMapError> {
        obstacle.validate_place(in_world)?;
        let shape = self.grid.shape();
        let Some(first) = self.steps.steps.first() else { return Ok(expand(shape, [], |_| false)) };
        let lanes = ObstacleLanes::new(obstacle, in_world, first, &self.classes, &self.grid, &self.roles);
        let mut bits = CellBits::new(self.roles);
        let mut division = BoxDivision::new(&lanes, &self.classes, self.roles, first, bits.all());
        let counts = self.roles.counts;
        let seeds = seeds(&mut division, counts);
        // Cells beyond one turn repeat the cells of the turn.
        Ok(expand(shape, seeds, |cell| division.may_touch([0, 1, 2].map(|k| usize::from(cell[k]) % counts[k]))))
    }

    /// Computes, once, the data of the robot that all slices need; otherwise the first
    /// [`slice_layer`](Self::slice_layer) computes it.
    pub fn prepare_slices(&self) {
        self.slice_motions();
    }

    fn slice_motions(&self) -> &SliceMotions {
        self.slice_motions
            .get_or_init(|| self.classes.iter().map(|class| class.motions_in_slice(&self.steps, &self.roles)).collect())
    }

    /// The layer of a solid that needs no division: the solid touches a swept volume that no axis moves, or the robot
    /// is an arm in a plane.
    fn layer_of_shape(
        &self,
        model: ObstacleModel,
        shape: &Shape,
        in_world: &Pose,
    ) -> Result<Option<Layer>, RobotMapError> {
        if self.exact.has_static_solids() && self.exact.is_blocked_throughout(&[PlacedObstacle::new(shape, in_world)?])
        {
            return Ok(Some(full(&self.grid)));
        }
        Ok(self.planar.as_ref().and_then(|planar| planar.layer(model, shape, in_world)))
    }
}

/// The covers of groups of links.
fn covers_of(groups: &[RigidGroup], slack_m: f64, source: &dyn CoverSource) -> Result<Vec<SphereCover>, RobotMapError> {
    let bodies: Vec<(Vec<(&Shape, Pose)>, f64)> = groups
        .iter()
        .map(|group| (group.solids.iter().map(|(shape, pose)| (shape, *pose)).collect(), slack_m))
        .collect();
    let invalid = || RobotMapError::InvalidPlacement("a link of the robot".into());
    covers(&bodies, source).into_iter().map(|cover| cover.ok_or_else(invalid)).collect()
}

/// Length from base to tip along the links, m.
fn reach_m(robot: &Robot) -> f64 {
    let chain = &robot.chain;
    chain.path(chain.tip()).iter().map(|j| chain.joints()[j.0].origin.translation.length()).sum()
}

/// A layer that blocks all cells.
fn full(grid: &Grid) -> Layer {
    let last = (grid.shape()[2] - 1) as u16;
    Layer { spans: (0..grid.rows() as u32).map(|row| RowSpan { row, first: 0, last }).collect() }
}
