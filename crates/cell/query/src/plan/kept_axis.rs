//! An axis of the TCP that keeps its direction on a path.

use elbowroom_cell::{CellRobot, KeptAxis};
use elbowroom_kinematics::LinkId;
use elbowroom_planner::OrientationConstraint;
use elbowroom_robot::RobotId;
use elbowroom_scene::Scene;
use elbowroom_spatial::Vec3;

/// The direction that an axis of the TCP keeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeptDirection {
    link: LinkId,
    axis_in_link: Vec3,
    in_world: Vec3,
    tolerance_rad: f64,
}

impl KeptDirection {
    /// The direction at the joint values `from` (all of the chain's, rad or m), with the robot's active TCP.
    ///
    /// # Panics
    /// The number of values is wrong.
    pub fn of(robot: &CellRobot, kept: KeptAxis, from: &[f64]) -> Self {
        let axis = kept.axis_in_tcp;
        Self {
            link: robot.flange,
            axis_in_link: robot.tcp_in_flange.rotation * axis,
            in_world: robot.base_in_world.rotation * (robot.tcp_in_root(from).rotation * axis),
            tolerance_rad: kept.tolerance_rad,
        }
    }

    /// An axis of a link that stays within an angle (rad) of a direction in the world.
    pub(crate) fn new(link: LinkId, axis_in_link: Vec3, in_world: Vec3, tolerance_rad: f64) -> Self {
        Self { link, axis_in_link, in_world, tolerance_rad }
    }

    /// The constraint on the paths of the robot in a scene.
    ///
    /// # Panics
    /// The scene does not have this robot.
    pub fn constraint(&self, scene: &Scene, robot: RobotId) -> OrientationConstraint {
        let Self { link, axis_in_link, in_world, tolerance_rad } = *self;
        OrientationConstraint::new(scene, robot, link, axis_in_link, in_world, tolerance_rad)
    }
}
