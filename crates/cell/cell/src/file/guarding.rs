//! Check that a region guards a part of each robot that it applies to.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::Table;
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{Guards, Part, Region, RegionKind};
use elbowroom_spatial::Vec3;

use crate::{Cell, CellRegionId, CellRobot};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Refuses a region that guards no part of a robot, and warns if it does not guard the links.
///
/// A monitored region without slow-down causes only a warning: its output never rises.
pub(super) fn check(t: &Table<'_>, cell: &Cell, region: CellRegionId, warnings: &mut Vec<Diagnostic>) -> Result<()> {
    let (robots, region) = (&cell.robots, &cell.regions[region.0]);
    if region.robots.is_empty() && cell.guarded_robots().next().is_some() {
        let what = format!(
            "region \"{}\" concerns no robot: a robot is not guarded against a region that follows it",
            region.region.name
        );
        let line = t.get("follow").map_or(t.line, |v| v.line);
        let error = Diagnostic::new(t.file, line, what)
            .hint("robots = [\"…\"]   (the robots to keep out; or another source to follow)");
        match region.region.kind {
            RegionKind::Monitored { .. } => warnings.push(error),
            RegionKind::Forbidden | RegionKind::Exchange { .. } => return Err(error),
        }
    }
    let line = t.get("guards").map_or(t.line, |v| v.line);
    for id in &region.robots {
        let robot = &robots[id.0];
        let grips = !cell.gripped_objects(*id).is_empty();
        let Some(missing) = MissingPart::of(robot, grips, region.region.guards) else { continue };
        let error =
            Diagnostic::new(t.file, line, missing.what(&region.region, robot)).hint(missing.hint(robot, robots.len()));
        match region.region.kind {
            _ if missing == MissingPart::Links => warnings.push(error),
            RegionKind::Monitored { slow_to: None } => warnings.push(error),
            _ => return Err(error),
        }
    }
    Ok(())
}

/// The part that a region guards and the robot does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MissingPart {
    /// The guarded part is fixed: no joint moves it.
    Fixed,
    /// Neither tool nor load.
    Tool,
    /// No solid that a joint moves.
    Solids,
    /// Tool or load, but no link has a solid.
    Links,
}

impl MissingPart {
    /// Finds the missing part. `grips` states that the robot's program grips objects.
    fn of(robot: &CellRobot, grips: bool, guards: Guards) -> Option<Self> {
        let moves = |link: LinkId| {
            let chain = &robot.robot.chain;
            chain.path(link).iter().any(|j| chain.joints()[j.0].kind.moves())
        };
        let flange_moves = moves(robot.flange);
        if guards.tcp && flange_moves {
            return None;
        }
        let links =
            robot.without_payload().colliders.iter().enumerate().any(|(i, b)| !b.is_empty() && moves(LinkId(i)));
        let has_tool =
            robot.payload.colliders().next().is_some() || robot.payload.tools.iter().any(|t| t.collider.is_some());
        let carried = flange_moves && (grips || has_tool);
        // A point is guarded in place of a tool's solid only if the file defines a tool.
        let point_tool = || {
            let tool = robot.tcp_in_flange.translation != Vec3::ZERO;
            flange_moves && tool && robot.guarded_volumes().iter().any(|v| v.part == Part::TcpOutside)
        };
        match (guards.arm, links, carried) {
            (true, true, _) | (false, _, true) => None,
            (true, false, true) => Some(Self::Links),
            (true, false, false) => Some(Self::Solids),
            (false, _, false) if guards.tool && point_tool() => None,
            (false, _, false) => Some(if guards.tool { Self::Tool } else { Self::Fixed }),
        }
    }

    fn what(self, region: &Region, robot: &CellRobot) -> String {
        let (region, robot) = (&region.name, &robot.name);
        let why = match self {
            Self::Fixed => "no joint moves its tool centre point",
            Self::Tool => "it has no tool and no load",
            Self::Solids => "none of its links that move has a solid (a URDF needs <collision>, not only <visual>)",
            Self::Links => {
                return format!(
                    "region \"{region}\" guards only tool and load of robot \"{robot}\": none of its links has a solid"
                );
            }
        };
        format!("region \"{region}\" guards nothing of robot \"{robot}\": {why}")
    }

    fn hint(self, robot: &CellRobot, robots: usize) -> String {
        let solid = "solids for the links: `links = [{ capsule = { … } }, …]` beside `dh`, <collision> in a URDF";
        let name = &robot.name;
        let mut hint = match self {
            Self::Fixed => format!("`flange` of [robot.{name}]: a link that a joint moves"),
            Self::Tool => {
                format!("guards = [\"arm\"], or [robot.{name}.tool] box = {{ at = [0, 0, 125], size = [80, 80, 250] }}")
            }
            Self::Solids => format!("{solid}; or guards = [\"tcp\"]: the tool centre point alone"),
            Self::Links => return solid.to_owned(),
        };
        if robots > 1 {
            hint = format!("{hint}; or `robots` without \"{name}\"");
        }
        hint
    }
}
