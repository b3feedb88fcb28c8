//! Spheres around the parts of an obstacle, refined until a deadline (the joint-space paper, section VI.C), for any
//! robot.

use std::time::Instant;

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

use super::covers::CoverMapBuilder;
use super::error::RobotMapError;
use crate::obstacle_model::MAX_SPHERES;
use crate::{Layer, ObstacleModel};

/// The cells that spheres around the parts of an obstacle block: first one sphere, then 2, 4, 8 …
///
/// Each refinement only frees cells: its cells are intersected with the cells of fewer spheres, and both sets contain
/// all cells that the obstacle blocks. A refinement that the deadline interrupts is discarded.
/// [`spheres_until`](crate::spheres_until) does the same for an arm of capsules in a plane.
///
/// ```
/// use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, RemainingJoints, SphereRefinement};
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_robot::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// use std::time::{Duration, Instant};
/// let robot = example::arm()?;
/// let grid = Grid::new(["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 5.0).unwrap()))?;
/// let settings = CoverMapSettings::default();
/// let builder = CoverMapBuilder::new(&robot, Pose::IDENTITY, &grid, [0, 1, 2], RemainingJoints::Swept, settings)?;
/// let beam = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.1, 0.4, 0.1) });
/// let deadline = Instant::now() + Duration::from_millis(5);
/// let mut spheres = SphereRefinement::new(&builder, &beam, Pose::from_translation(Vec3::new(0.7, 0.0, 0.7)), 64)?;
/// while spheres.refine(Some(deadline))? {}
/// assert!(spheres.spheres() >= 1 && spheres.spheres() <= 64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SphereRefinement<'b> {
    builder: &'b CoverMapBuilder,
    shape: &'b Shape,
    in_world: Pose,
    most: u32,
    spheres: u32,
    layer: Layer,
}

impl<'b> SphereRefinement<'b> {
    /// Starts with one sphere around an obstacle, placed in the world, to be refined to at most a given number. Half
    /// spaces and spheres are used unchanged.
    ///
    /// # Errors
    /// The errors of [`CoverMapBuilder::obstacle`] and [`CoverMapBuilder::layer`].
    pub fn new(
        builder: &'b CoverMapBuilder,
        shape: &'b Shape,
        in_world: Pose,
        most: u32,
    ) -> Result<Self, RobotMapError> {
        let is_final = matches!(shape, Shape::HalfSpace(_) | Shape::Sphere(_));
        let most = if is_final { 1 } else { most.min(MAX_SPHERES) };
        let mut first = Self { builder, shape, in_world, most, spheres: 1, layer: Layer::new() };
        // Without a deadline, `layer_of` always returns a layer.
        first.layer = first.layer_of(1, None)?.unwrap_or_default();
        Ok(first)
    }

    /// Doubles the number of spheres, unless there would be too many or the deadline, if there is one, passes. The time is checked only
    /// between two spheres: a sphere that is begun is finished. Returns false if nothing changed.
    ///
    /// # Errors
    /// The errors of [`CoverMapBuilder::layer`].
    pub fn refine(&mut self, deadline: Option<Instant>) -> Result<bool, RobotMapError> {
        if self.spheres.saturating_mul(2) > self.most {
            return Ok(false);
        }
        let Some(finer) = self.layer_of(self.spheres * 2, deadline)? else { return Ok(false) };
        self.layer.intersect(&finer, self.builder.grid().shape()[2]);
        self.spheres *= 2;
        Ok(true)
    }

    /// Number of parts that have a sphere, empty ones included.
    pub fn spheres(&self) -> u32 {
        self.spheres
    }

    /// Returns the blocked cells.
    pub fn into_layer(self) -> Layer {
        self.layer
    }

    /// The cells that a number of spheres blocks; `None` if the deadline passes.
    fn layer_of(&self, count: u32, deadline: Option<Instant>) -> Result<Option<Layer>, RobotMapError> {
        let base = self.builder.base_in_world();
        let mut whole = Layer::new();
        for (shape, in_world) in ObstacleModel::Spheres(count).solids(self.shape, &self.in_world, &base) {
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return Ok(None);
            }
            let layer = self.builder.layer(&self.builder.obstacle(&shape)?, &in_world)?;
            whole.spans.extend_from_slice(&layer.spans);
        }
        whole.spans.sort_unstable();
        Ok(Some(whole))
    }
}
