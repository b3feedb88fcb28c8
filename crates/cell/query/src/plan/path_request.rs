//! A request for a path.

use elbowroom_cell::PathPlanner;
use elbowroom_planner::RrtConnectSettings;
use elbowroom_robot::ObjectId;
use elbowroom_scene::Attachment;
use elbowroom_spatial::Pose;

use super::path_goal::PathGoal;
use super::tcp_motion::TcpMotion;

/// A request for a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathRequest {
    /// Name of the robot; optional if there is only one.
    pub robot: Option<String>,
    /// Values of all joints in the order of the chain, rad or m; `None`: the robot's `start`.
    pub from: Option<Vec<f64>>,
    /// The goal.
    pub to: PathGoal,
    /// The planner.
    pub planner: PathPlanner,
    /// How the TCP moves.
    pub tcp_motion: TcpMotion,
    /// Fraction of the joints' speeds that the motion uses, above 0 and at most 1.
    pub speed: f64,
    /// Time limit, clearance and seed.
    pub options: RrtConnectSettings,
    /// Period of the samples, s; `None`: the cell's tick.
    pub period_s: Option<f64>,
    /// Whether the search continues until the time limit, with shorter and shorter paths.
    pub optimize: bool,
    /// Objects at other poses than at the start of the cell's programs, with their pose in the world.
    pub placed: Vec<(ObjectId, Pose)>,
    /// Objects that a robot carries.
    pub carried: Vec<(ObjectId, Attachment)>,
}

impl Default for PathRequest {
    fn default() -> Self {
        let options = RrtConnectSettings::default();
        Self {
            robot: None,
            from: None,
            to: PathGoal::default(),
            planner: PathPlanner::default(),
            tcp_motion: TcpMotion::default(),
            speed: 1.0,
            options,
            period_s: None,
            optimize: false,
            placed: Vec::new(),
            carried: Vec::new(),
        }
    }
}
