//! Where a robot is, as its controller says.

use elbowroom_cell::CellRobot;
use elbowroom_cell::configure::MonitorSetup;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::Presence;
use elbowroom_status::PoseStatus;
use serde::Serialize;

use crate::messages::JointState;

/// Largest speed of a joint at rest, rad/s or m/s.
const AT_REST: f64 = 1e-4;

/// A robot, and where it is if its controller is heard.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct RobotOverview {
    pub(crate) name: String,
    /// Whether its controller is heard.
    pub(crate) heard: bool,
    /// Whether a joint moves, if the controller tells its velocities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) moves: Option<bool>,
    /// Frame of the flange in the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) flange: Option<PoseStatus>,
    /// Frame of the tool centre point in the world: that of the tool on the robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) tcp: Option<PoseStatus>,
}

impl RobotOverview {
    pub(super) fn new(robot: &CellRobot, setup: Option<&MonitorSetup>, state: Option<&JointState>) -> Self {
        let chain = &robot.robot.chain;
        let placed = state.filter(|s| s.q.len() == chain.dof() && s.q.iter().all(|v| v.is_finite())).map(|state| {
            let tool = setup.and_then(|setup| present_tool(robot, setup, state));
            let robot = tool.map_or_else(|| robot.clone(), |tool| robot.with_tool(tool));
            let mut placed = ChainState::new(chain);
            placed.q.copy_from_slice(&state.q);
            chain.forward(&mut placed);
            let flange = robot.base_in_world * placed.link_in_root(robot.flange);
            [flange, flange * robot.tcp_in_flange]
        });
        let pose = |i: usize| placed.as_ref().map(|poses| PoseStatus::from(&poses[i]));
        let moves = state.filter(|s| !s.qd.is_empty()).map(|s| s.qd.iter().any(|v| !(v.abs() <= AT_REST)));
        Self { name: robot.name.clone(), heard: state.is_some(), moves, flange: pose(0), tcp: pose(1) }
    }
}

/// The tool whose volumes a controller says are attached; `None` if it names none.
fn present_tool(robot: &CellRobot, setup: &MonitorSetup, state: &JointState) -> Option<usize> {
    let volumes = setup.configuration.volumes();
    let links = state.attached.iter().filter_map(|a| volumes.get(a.volume.0));
    let of_tool = |link| robot.payload.tools.iter().position(|tool| tool.link == link);
    links.filter(|v| v.presence != Presence::Always).find_map(|v| of_tool(v.link))
}
