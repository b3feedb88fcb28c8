//! `[program.NAME]`: steps or a recorded trajectory.

use elbowroom_formats::{FormatError, JointStateOptions, JointStates, Warning};
use elbowroom_monitor::Life;

use super::models;
use super::read::{Table, Value};
use super::robot::joint_values;
use crate::{
    CellRegion, CellRegionId, CellRobot, MoveTarget, Program, ProgramBody, ProgramStep, StepAction, TrajectoryRow,
    Units, suggest,
};

type Result<T> = std::result::Result<T, FormatError>;

/// TCP speed (m/s) of a linear move that gives none: the reduced speed of ISO 10218-1.
const LINEAR_SPEED: f64 = 0.25;

pub(super) fn read(
    t: &Table<'_>,
    units: Units,
    robot: &CellRobot,
    regions: &[CellRegion],
    warnings: &mut Vec<Warning>,
) -> Result<Program> {
    t.only(&["override", "repeat", "steps", "trajectory"])?;
    let speed_override = t.get("override").map_or(Ok(1.0), |v| v.percent())?;
    let repeat = t.get("repeat").map_or(Ok(1), |v| v.whole(1, 1_000_000))?;
    let body = match (t.get("steps"), t.get("trajectory")) {
        (Some(_), Some(v)) => return Err(v.error("contradicts `steps`").hint("one of the two: steps or trajectory")),
        (Some(steps), None) => {
            let list = steps.list("steps = [{ move = \"joint\", to = [0, 0, 0, 0, 0, 0] }]")?;
            ProgramBody::Steps(list.iter().map(|s| step(s, units, robot, regions)).collect::<Result<_>>()?)
        }
        (None, Some(file)) => ProgramBody::Trajectory(trajectory(&file, robot, warnings)?),
        (None, None) => {
            let example = "steps = [{ move = \"joint\", to = [0, -20, 90, 0, 40, 0], speed = 50 }]   (or: trajectory = \"recorded.csv\")";
            return Err(t.error(format!("`{}` has neither `steps` nor `trajectory`", t.name)).hint(example));
        }
    };
    Ok(Program { speed_override, repeat, body, line: t.line })
}

fn step(v: &Value<'_>, units: Units, robot: &CellRobot, regions: &[CellRegion]) -> Result<ProgramStep> {
    const KINDS: [&str; 4] = ["move", "region", "wait", "override"];
    const EXAMPLE: &str =
        "{ move = \"joint\", to = […] }, { region = \"column\", active = false }, { wait = 0.5 } or { override = 50 }";
    let t = v.table(EXAMPLE)?;
    let given: Vec<&str> = KINDS.into_iter().filter(|k| t.get(k).is_some()).collect();
    let action = match given.as_slice() {
        ["move"] => movement(&t, units, robot)?,
        ["region"] => switch(&t, regions)?,
        ["wait"] => {
            t.only(&["wait"])?;
            StepAction::Wait(t.need("wait", "wait = 0.5")?.not_negative()?)
        }
        ["override"] => {
            t.only(&["override"])?;
            StepAction::Override(t.need("override", "override = 50")?.percent()?)
        }
        [] => {
            t.only(&["move", "to", "speed", "region", "active", "wait", "override"])?;
            return Err(v.error("is not a step").hint(EXAMPLE));
        }
        _ => return Err(v.error("is several steps in one").hint("one of move, region, wait, override per step")),
    };
    Ok(ProgramStep { line: t.line, action })
}

/// Kinds of moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Movement {
    Joint,
    Linear,
    Planned,
}

fn movement(t: &Table<'_>, units: Units, robot: &CellRobot) -> Result<StepAction> {
    t.only(&["move", "to", "speed"])?;
    let kinds = [("joint", Movement::Joint), ("linear", Movement::Linear), ("planned", Movement::Planned)];
    let kind = t.need("move", "move = \"joint\"")?.word(&kinds)?;
    let example = if kind == Movement::Linear {
        "to = { at = [900, 600, 700], rpy = [180, 0, 0] }"
    } else {
        "to = [0, -20, 90, 0, 40, 0]"
    };
    let to = target(&t.need("to", example)?, example, units, robot)?;
    let speed = t.get("speed");
    if kind == Movement::Linear {
        let speed = speed.map_or(Ok(LINEAR_SPEED), |v| units.positive_length(&v))?;
        return Ok(StepAction::Linear { to, speed });
    }
    let speed = speed.map_or(Ok(1.0), |v| {
        v.positive()?;
        v.percent()
    })?;
    Ok(if kind == Movement::Planned { StepAction::Planned { to, speed } } else { StepAction::Joint { to, speed } })
}

/// A pose, joint values, or the name of a state of the robot.
fn target(to: &Value<'_>, example: &str, units: Units, robot: &CellRobot) -> Result<MoveTarget> {
    if to.is_table() {
        return units.pose(to).map(MoveTarget::Tcp);
    }
    if to.is_list() {
        return joint_values(to, &robot.robot.chain, units).map(MoveTarget::Joints);
    }
    let Ok(name) = to.text() else {
        return Err(to.error("is neither joint values, a pose, nor the name of a state").hint(example));
    };
    robot.state(name).map(|q| MoveTarget::Joints(q.to_vec())).ok_or_else(|| {
        let known = robot.states.iter().map(|(name, _)| name.as_str());
        to.error(format!("names the state \"{name}\", which robot \"{}\" does not have", robot.name))
            .hint(suggest::hint(name, known))
    })
}

fn switch(t: &Table<'_>, regions: &[CellRegion]) -> Result<StepAction> {
    t.only(&["region", "active"])?;
    let v = t.need("region", "region = \"column\"")?;
    let name = v.text()?;
    let Some(index) = regions.iter().position(|r| r.region.name == name) else {
        let known = regions.iter().map(|r| r.region.name.as_str());
        return Err(v
            .error(format!("names the region \"{name}\", which is not in this cell"))
            .hint(suggest::hint(name, known)));
    };
    if regions[index].region.life == Life::Permanent {
        let what = format!(
            "switches the region \"{name}\", which is permanent (line {}): no program may",
            regions[index].line
        );
        return Err(v.error(what).hint(format!("life = \"temporary\" in [region.{name}], or leave the step out")));
    }
    let active = t.need("active", "active = true")?.flag()?;
    Ok(StepAction::Switch { region: CellRegionId(index), active })
}

fn trajectory(v: &Value<'_>, robot: &CellRobot, warnings: &mut Vec<Warning>) -> Result<Vec<TrajectoryRow>> {
    let options = JointStateOptions::trajectory(&robot.name, &robot.robot.chain);
    let states = JointStates::read(&models::path(v)?, &options)?;
    let row = |(i, t_s): (usize, &f64)| TrajectoryRow { t_s: *t_s, q: states.q(i, 0).to_vec() };
    let rows = states.times_s().iter().enumerate().map(row).collect();
    warnings.extend(states.warnings);
    Ok(rows)
}
