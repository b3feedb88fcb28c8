//! `[robot.NAME.tools.TOOL]`: several named tools of a robot.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_kinematics::{Chain, ChainError, Joint, JointId, JointKind, Limits, LinkId};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Vec3};

use super::flange::unknown_link;
use super::schema::NAMED_TOOL;
use crate::{CellRobot, CellTool, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const EXAMPLE: &str = "[robot.NAME.tools.gripper]   (tcp, box or mesh, flange, mounted)";

/// A tool's solid and TCP, as `[robot.NAME.tool]` has them.
pub(super) type ReadTool = fn(&Table<'_>, Units) -> Result<(Pose, Option<Collider>)>;

/// Reads the tools, and adds a link for each to the robot. `flange` carries the tools that name no flange.
pub(super) fn read(
    t: &Table<'_>,
    robot: &mut Robot,
    flange: LinkId,
    units: Units,
    read_tool: ReadTool,
) -> Result<Vec<CellTool>> {
    let Some(v) = t.get("tools") else { return Ok(Vec::new()) };
    for key in ["tool", "load"] {
        if let Some(other) = t.get(key) {
            let hint = if key == "tool" {
                "one of the two: tool or tools"
            } else {
                "a box or mesh of the tool, or an object that it grips"
            };
            return Err(other.error("goes with one `tool`, not with `tools`").hint(hint));
        }
    }
    let named = v.table(EXAMPLE)?;
    let mut tools: Vec<CellTool> = Vec::new();
    for (name, v) in named.each() {
        let tool = tool(name, &v, robot, flange, units, read_tool)?;
        if let Some(other) = tools.iter().find(|o| o.flange == tool.flange && o.mounted && tool.mounted) {
            let what = format!("is mounted on the flange of \"{}\"", other.name);
            return Err(v.error(what).hint("mounted = false for all but one of them, or another flange"));
        }
        tools.push(tool);
    }
    if tools.is_empty() {
        return Err(v.error("names no tool").hint(EXAMPLE));
    }
    if tools.iter().all(|t| !t.mounted) {
        return Err(v.error("has no tool that is mounted at the start").hint("one without `mounted = false`"));
    }
    for tool in tools.iter().filter(|t| t.mounted) {
        robot.colliders[tool.link.0].extend(tool.collider.clone());
    }
    Ok(tools)
}

fn tool(
    name: &str,
    v: &Value<'_>,
    robot: &mut Robot,
    flange: LinkId,
    units: Units,
    read_tool: ReadTool,
) -> Result<CellTool> {
    let t = v.table(EXAMPLE)?;
    let flange = match t.get("flange") {
        None => flange,
        Some(v) => {
            let name = v.text()?;
            robot.chain.link(name).ok_or_else(|| unknown_link(&v, name, &robot.chain))?
        }
    };
    let own: Vec<_> = t.entries.iter().filter(|e| NAMED_TOOL.iter().all(|k| k.name != e.key)).cloned().collect();
    let (tcp_in_link, collider) =
        read_tool(&Table { file: t.file, name: t.name.clone(), line: t.line, entries: &own }, units)?;
    let collider = collider.map(|c| Collider { name: name.to_owned(), ..c });
    if name.trim().is_empty() || name.contains(['/', ',', '"', '\n', '\r']) {
        return Err(v.error("is no name of a tool").hint("a name without slash, comma, quote and line break"));
    }
    if robot.chain.link(name).is_some() {
        return Err(v.error("has the name of a link of the robot").hint("another name: it appears where links do"));
    }
    let link = add_link(robot, name, flange).map_err(|e| v.error(format!("cannot be added: {e}")))?;
    let mounted = t.flag_or("mounted", true)?;
    Ok(CellTool { name: name.to_owned(), flange, link, tcp_in_link, collider, mounted })
}

/// Finds a robot whose program exchanges tools. Planning and avoidance know only the tools that are mounted at the
/// start.
pub(super) fn with_exchanged_tools<'c>(robots: impl IntoIterator<Item = &'c CellRobot>) -> Option<&'c CellRobot> {
    robots.into_iter().find(|robot| robot.payload.tools.iter().any(|tool| !tool.mounted))
}

/// Adds a link that is fixed to another one, at its frame.
fn add_link(robot: &mut Robot, name: &str, parent: LinkId) -> std::result::Result<LinkId, ChainError> {
    let chain = &robot.chain;
    let (mut links, mut joints) = (chain.links().to_vec(), chain.joints().to_vec());
    let link = LinkId(links.len());
    links.push(name.to_owned());
    let taken = |name: &str| (0..joints.len()).map(JointId).any(|j| chain.joints()[j.0].name == name);
    let mut joint = format!("{name}_mount");
    while taken(&joint) {
        joint.push('_');
    }
    joints.push(Joint {
        name: joint,
        kind: JointKind::Fixed,
        parent,
        child: link,
        origin: Pose::IDENTITY,
        axis: Vec3::Z,
        limits: Limits::range(0.0, 0.0),
        mimic: None,
    });
    robot.chain = Chain::new(chain.name(), links, joints)?;
    robot.colliders.push(Vec::new());
    robot.visuals.push(Vec::new());
    Ok(link)
}
