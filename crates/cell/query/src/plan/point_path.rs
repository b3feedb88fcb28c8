//! The path of a point of a link, of which a plan is asked.

use elbowroom_cell::CellRobot;
use elbowroom_kinematics::JointId;
use elbowroom_planner::{PointGoal, TimedPath};
use elbowroom_robot::RobotId;
use elbowroom_scene::Scene;
use serde::Serialize;

/// How a point of a link moves on a path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointPath {
    /// The link.
    pub link: String,
    /// The point in the frame of the link, m.
    pub in_link_m: [f64; 3],
    /// The independent joints that move it, from the base outwards.
    pub moved_by: Vec<String>,
    /// Its place in the world at each waypoint, m.
    pub waypoints_m: Vec<[f64; 3]>,
    /// Length of its way, m.
    pub length_m: f64,
}

impl PointPath {
    /// The way of a point on a path.
    pub(super) fn of(scene: &Scene, (id, robot): (RobotId, &CellRobot), point: &PointGoal, timed: &TimedPath) -> Self {
        let chain = &robot.robot.chain;
        let name = |joint: JointId| chain.joints()[joint.0].name.clone();
        let mut place = point.placement(scene, id);
        let way: Vec<_> = timed.trajectory.rows().iter().map(|row| place(&row.q)).collect();
        Self {
            link: chain.links()[point.link.0].clone(),
            in_link_m: point.point_in_link.to_array(),
            moved_by: point.moved_by(scene, id).into_iter().map(name).collect(),
            waypoints_m: timed.path.waypoints.iter().map(|q| place(q).to_array()).collect(),
            length_m: way.windows(2).map(|w| w[0].distance(w[1])).sum(),
        }
    }
}
