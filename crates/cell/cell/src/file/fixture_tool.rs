//! The tool of a fixture, an operator or a force.

use elbowroom_formats::toml_tables::Value;
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_robot::RobotId;

use super::mechanism;
use crate::fixture::FixtureTool;
use crate::{Cell, CellRobot};

type Result<T> = std::result::Result<T, Diagnostic>;

/// How a tool is written.
pub(super) const TOOL: &str = "tool = \"ROBOT/TOOL\"   (or the robot alone, if it has one tool)";

/// The tool that a value names: `"ROBOT/TOOL"`.
pub(super) fn tool(v: &Value<'_>, cell: &Cell) -> Result<FixtureTool> {
    let text = v.text()?;
    let (robot_name, tool_name) = text.split_once('/').unwrap_or((text, "tool"));
    let robots = || cell.robots.iter().map(|r| r.name.as_str());
    let robot = robots().position(|n| n == robot_name).ok_or_else(|| {
        v.error(format!("names the robot \"{robot_name}\", which is not in this cell"))
            .hint(suggest::hint(robot_name, robots()))
    })?;
    tool_of(v, cell, RobotId(robot), tool_name)
}

/// The tool of this name of a robot; it must have a solid.
pub(super) fn tool_of(v: &Value<'_>, cell: &Cell, robot: RobotId, tool_name: &str) -> Result<FixtureTool> {
    mechanism::refuse(v, &cell.robots[robot.0], "carries no tool")?;
    let CellRobot { name: robot_name, payload, .. } = &cell.robots[robot.0];
    let tools = &payload.tools;
    let is_only = tool_name == "tool" && tools.len() == 1;
    let named = tools.iter().position(|t| t.name == tool_name || is_only);
    if named.is_none() && !(tools.is_empty() && tool_name == "tool") {
        let what = format!("names the tool \"{tool_name}\", which robot \"{robot_name}\" does not have");
        let known = tools.iter().map(|t| t.name.as_str()).chain(tools.is_empty().then_some("tool"));
        return Err(v.error(what).hint(suggest::hint(tool_name, known)));
    }
    let tool = FixtureTool { robot, named };
    if tool.solid(cell).is_none() {
        let what = format!("has no solid, so nothing says whether it passes: robot \"{robot_name}\"");
        return Err(v.error(what).hint(format!("`box` or `mesh` in [robot.{robot_name}.tool]; or {TOOL}")));
    }
    Ok(tool)
}
