//! A placed obstacle relative to sixteen values of the axis in lanes.

use elbowroom_spatial::Pose;

use super::axis_roles::AxisRoles;
use super::block_level::single;
use super::cover_class::CoverClass;
use super::obstacle::{CoverObstacle, Element};
use super::step_chain::Step;
use crate::Grid;

/// Rounding errors of coordinates and distances in single precision, per metre of the coordinates' range: six rotations
/// and translations, each rounded (3·10⁻⁷), and the products and sums of three of them.
const ROUNDING_SHARE: f64 = 5e-6;

/// Pose of the first joint's frame in the frame of the obstacle.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellPose {
    pub columns: [[f32; 3]; 3],
    pub origin: [f32; 3],
}

/// A placed obstacle.
#[derive(Debug)]
pub(super) struct ObstacleLanes<'a> {
    pub elements: &'a [Element],
    /// Poses per level and box of the first axis.
    pub poses: Vec<Vec<CellPose>>,
    /// Rounding errors of a distance, m.
    pub rounding: f32,
}

impl<'a> ObstacleLanes<'a> {
    /// Places an obstacle; `first` is the joint of the axis in lanes.
    pub fn new(
        obstacle: &'a CoverObstacle,
        in_world: &Pose,
        first: &Step,
        classes: &[CoverClass],
        grid: &Grid,
        roles: &AxisRoles,
    ) -> Self {
        let at_zero = (*in_world * obstacle.frame).inverse() * first.at_zero;
        let reach = classes.iter().map(|class| class.reach_m).fold(0.0, f64::max);
        let rounding = ROUNDING_SHARE * (1.0 + at_zero.translation.length() + 2.0 * reach + obstacle.reach_m);
        let levels = classes.iter().map(|class| class.levels.len()).max().unwrap_or(0);
        let axis = &grid.axes()[roles.lanes];
        let poses = |level: usize| {
            let size = 1usize << level;
            let boxes = roles.lane_count().div_ceil(size);
            let value = |at: usize| axis.border(at * size) + 0.5 * size as f64 * axis.step();
            let pose = |at: usize| at_zero * first.moved(value(at) * first.multiplier);
            (0..boxes).map(|at| CellPose::new(&pose(at))).collect()
        };
        Self { elements: &obstacle.elements, poses: (0..levels).map(poses).collect(), rounding: rounding as f32 }
    }
}

impl CellPose {
    fn new(pose: &Pose) -> Self {
        let rotation = pose.rotation;
        Self {
            columns: [rotation.x_axis(), rotation.y_axis(), rotation.z_axis()].map(single),
            origin: single(pose.translation),
        }
    }
}
