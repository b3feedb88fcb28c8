//! Builder of the map of an obstacle for a planar arm.

use elbowroom_spatial::{Pose, Vec3};

use super::arm_grid::ArmGrid;
use super::context::ConvexContext;
use super::plane_solid::{PlaneBox, PlaneHull};
use super::simd_math::WIDTH;
use super::sphere::SphereObstacle;
use super::{convex, sphere};
use crate::convex_obstacle::ConvexShape;
use crate::{ArmError, ConvexObstacle, Grid, Layer, PlanarArm};

/// Computes the cells of a grid that an obstacle blocks for one planar arm.
///
/// ```
/// use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, Layer, PlanarMapBuilder, OccupancyBitmap, PlanarArm};
/// use elbowroom_spatial::Vec3;
/// let axes = [("base", 170.0, -170.0), ("shoulder", 90.0, -90.0), ("elbow", 150.0, -120.0)];
/// let [a, b, c] = axes.map(|(name, max, min)| GridAxis::from_degrees(name, min, max, 2.0).unwrap());
/// let grid = Grid::new([a, b, c])?;
/// let mut builder = PlanarMapBuilder::new(PlanarArm::KR125_SIZED, &grid)?;
/// let mut layer = Layer::new();
/// builder.build_layer(&ConvexObstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?, &mut layer);
/// let mut occupancy = OccupancyBitmap::new(grid.shape());
/// occupancy.add(&layer);
/// assert!(occupancy.is_blocked(grid.cell([0.3, 0.7, 0.5]).unwrap())); // the wrist is in the sphere
/// assert!(!occupancy.is_blocked(grid.cell([2.0, 0.7, 0.5]).unwrap()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PlanarMapBuilder {
    arm_grid: ArmGrid,
    /// Workspace: one bit per row of a plane, set if the upper arm blocks the whole row.
    full_rows: Vec<u16>,
}

/// Why a map cannot be built for an arm and a grid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanarMapError {
    /// A dimension of the arm is invalid.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A step is too coarse for the bounds.
    #[error("joint `{joint}`: a step of {degrees:.1} degrees is too coarse: at most {MAX_STEP_DEGREES} degrees")]
    Coarse {
        /// Name of the joint.
        joint: String,
        /// Step of the joint, degrees.
        degrees: f64,
    },
}

/// Largest step, degrees. Larger cells carry little information, and the limit bounds the number of lines of an
/// outline.
const MAX_STEP_DEGREES: f64 = 15.0;

impl PlanarMapBuilder {
    /// Creates a builder for an arm and a grid.
    ///
    /// # Errors
    /// A dimension of the arm is invalid, or a step is above 15 degrees.
    pub fn new(arm: PlanarArm, grid: &Grid) -> Result<Self, PlanarMapError> {
        arm.validate()?;
        for axis in grid.axes() {
            let degrees = axis.step().to_degrees();
            if degrees > MAX_STEP_DEGREES {
                return Err(PlanarMapError::Coarse { joint: axis.joint().to_owned(), degrees });
            }
        }
        let full_rows = vec![0; grid.axes()[1].count().div_ceil(WIDTH)];
        Ok(Self { arm_grid: ArmGrid::new(arm, grid), full_rows })
    }

    /// The arm.
    pub fn arm(&self) -> &PlanarArm {
        &self.arm_grid.arm
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.arm_grid.grid
    }

    /// Replaces a layer by the cells that an obstacle blocks: all cells whose box contains a configuration that touches
    /// it.
    pub fn build_layer(&mut self, obstacle: &ConvexObstacle, layer: &mut Layer) {
        layer.spans.clear();
        let Self { arm_grid, full_rows } = self;
        let planes = 0..arm_grid.planes.len();
        let shoulder = [arm_grid.arm.offset_m, arm_grid.arm.height_m];
        let (center, radius) = obstacle.enclosing_sphere();
        match &obstacle.solid {
            ConvexShape::Sphere { center, radius } => {
                let sphere = SphereObstacle { center: *center, radius: *radius };
                sphere::build(arm_grid, &sphere, planes, full_rows, layer);
            }
            ConvexShape::Cuboid { in_base, half_extents } => {
                let context = ConvexContext::new(arm_grid, center, radius);
                let mut solid = PlaneBox::new(in_base, *half_extents, shoulder);
                convex::build(arm_grid, &context, &mut solid, planes, full_rows, layer);
            }
            ConvexShape::Hull { in_base, hull } => {
                let context = ConvexContext::new(arm_grid, center, radius);
                let mut solid = PlaneHull::new(in_base, hull, shoulder);
                convex::build(arm_grid, &context, &mut solid, planes, full_rows, layer);
            }
        }
    }

    /// Computes the cells that a box blocks in the first plane, as one slice; the other planes stay free.
    pub(crate) fn build_slice(&mut self, in_base: &Pose, half_extents: Vec3, layer: &mut Layer) {
        layer.spans.clear();
        let Self { arm_grid, full_rows } = self;
        let shoulder = [arm_grid.arm.offset_m, arm_grid.arm.height_m];
        let context = ConvexContext::new(arm_grid, in_base.translation, half_extents.length()).without_sectors();
        let mut solid = PlaneBox::new(in_base, half_extents, shoulder);
        convex::build(arm_grid, &context, &mut solid, 0..1, full_rows, layer);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use elbowroom_proximity::ConvexHull;
    use elbowroom_spatial::{Pose, Vec3};
    use elbowroom_validity::lanes::simd::Level as SimdLevel;

    use super::*;
    use crate::GridAxis;

    #[test]
    fn every_instruction_set_blocks_the_same_cells() {
        let axis = |name: &str, half: f64| GridAxis::from_degrees(name, -half, half, 3.0).unwrap();
        let grid = Grid::new([axis("a", 170.0), axis("b", 100.0), axis("c", 140.0)]).unwrap();
        let tilted = Pose::from_xyz_rpy([0.9, 0.3, 1.2], [0.3, 0.5, 0.7]);
        let corners = [Vec3::ZERO, Vec3::X * 0.6, Vec3::Y * 0.5, Vec3::Z * 0.7, Vec3::new(0.3, 0.4, 0.3)];
        let hull = Arc::new(ConvexHull::from_points(&corners).unwrap());
        let obstacles = [
            ConvexObstacle::sphere(Vec3::new(0.2, -1.1, 0.8), 0.3).unwrap(),
            ConvexObstacle::cuboid(tilted, Vec3::new(0.4, 0.2, 0.6)).unwrap(),
            ConvexObstacle::hull(tilted, hull).unwrap(),
        ];
        for obstacle in &obstacles {
            let (mut best, mut baseline) = (Layer::new(), Layer::new());
            let mut builder = PlanarMapBuilder::new(PlanarArm::KR125_SIZED, &grid).unwrap();
            builder.build_layer(obstacle, &mut best);
            builder.arm_grid.simd_level = SimdLevel::baseline();
            builder.build_layer(obstacle, &mut baseline);
            assert_eq!(best, baseline);
            assert!(!best.spans().is_empty());
        }
    }
}
