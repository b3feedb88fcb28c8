//! Changes of the active tool of a robot, and of the tool on a flange.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::Presence;
use elbowroom_robot::{Robot, RobotId};
use elbowroom_spatial::{Pose, Vec3};

use crate::{Cell, CellRobot, CellTool};

impl CellRobot {
    /// The robot after the step `{ tool = … }`, with this tool active.
    ///
    /// A tool that is not mounted replaces the tools on its flange. An unknown index leaves the robot unchanged.
    #[must_use]
    pub fn with_tool(&self, index: usize) -> Self {
        let mut robot = self.clone();
        let Some(CellTool { flange, link, tcp_in_link, mounted, .. }) = self.payload.tools.get(index) else {
            return robot;
        };
        (robot.flange, robot.tcp_in_flange) = (*link, *tcp_in_link);
        if !mounted {
            robot.payload.tools.iter_mut().filter(|t| t.flange == *flange).for_each(|t| t.mounted = false);
            robot.payload.tools[index].mounted = true;
        }
        for tool in &robot.payload.tools {
            robot.robot.colliders[tool.link.0] = tool.collider.iter().filter(|_| tool.mounted).cloned().collect();
        }
        robot
    }

    /// The frame of the tool centre point in a link: of the tool that the link belongs to, otherwise of the active tool.
    pub fn tcp_in_link(&self, link: LinkId) -> Pose {
        self.payload.tools.iter().find(|tool| tool.link == link).map_or(self.tcp_in_flange, |tool| tool.tcp_in_link)
    }

    /// The robot with the colliders of all its tools, mounted or not.
    pub fn with_all_tools(&self) -> Robot {
        let mut robot = self.robot.clone();
        for tool in &self.payload.tools {
            robot.colliders[tool.link.0] = tool.collider.iter().cloned().collect();
        }
        robot
    }

    /// Presence of a tool: always, if all tools of its flange are mounted; otherwise attached or detached.
    pub(crate) fn presence(&self, tool: &CellTool) -> Presence {
        let is_changed = self.payload.tools.iter().any(|t| t.flange == tool.flange && !t.mounted);
        match (is_changed, tool.mounted) {
            (false, _) => Presence::Always,
            (true, true) => Presence::Attached,
            (true, false) => Presence::Detached,
        }
    }

    /// Tool centre point in the world (m) and its speed (m/s).
    pub fn tcp(&self, state: &ChainState) -> (Vec3, f64) {
        let flange_in_root = state.link_in_root(self.flange);
        let offset = flange_in_root.transform_vector(self.tcp_in_flange.translation);
        let tcp_in_root = flange_in_root * self.tcp_in_flange;
        let speed = state.link_motion(self.flange).velocity_at(offset).length();
        ((self.base_in_world * tcp_in_root).translation, speed)
    }
}

impl Cell {
    /// The cell after the step `{ tool = … }` of a robot; see [`CellRobot::with_tool`].
    #[must_use]
    pub fn with_tool(&self, robot: RobotId, index: usize) -> Self {
        let mut cell = self.clone();
        cell.robots[robot.0] = self.robots[robot.0].with_tool(index);
        cell
    }
}
