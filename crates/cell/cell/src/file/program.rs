//! `[program.NAME]`: steps or a recorded trajectory.

use elbowroom_formats::recording::{self, RecordingLayout};
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, JointStateOptions, JointStates, suggest};
use elbowroom_kinematics::JointTrajectory;
use elbowroom_monitor::Life;
use elbowroom_proximity::Shape;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::{AngleUnit, LengthUnit};

use super::schema::{self, KEPT_AXIS, STEPS, names};
use super::{goal, mechanism, models};
use crate::{
    Cell, CellRegion, CellRegionId, CellRobot, KeptAxis, PathPlanner, Program, ProgramBody, ProgramStep, StepAction,
    Units,
};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Default TCP speed (m/s) of a linear move: the reduced speed of ISO 10218-1.
const LINEAR_SPEED: f64 = 0.25;

pub(super) fn read(t: &Table<'_>, cell: &Cell, robot: &CellRobot, warnings: &mut Vec<Diagnostic>) -> Result<Program> {
    t.only(&names(&[schema::PROGRAM]))?;
    let speed_override = t.get("override").map_or(Ok(1.0), |v| v.percent())?;
    let repeat = t.get("repeat").map_or(Ok(1), |v| v.whole(1, 1_000_000))?;
    let body = match (t.get("steps"), t.get("trajectory")) {
        (Some(_), Some(v)) => return Err(v.error("contradicts `steps`").hint("one of the two: steps or trajectory")),
        (Some(steps), None) => {
            let list = steps.list("steps = [{ move = \"joint\", to = [0, 0, 0, 0, 0, 0] }]")?;
            ProgramBody::Steps(list.iter().map(|s| step(s, cell, robot)).collect::<Result<_>>()?)
        }
        (None, Some(file)) => ProgramBody::Trajectory(trajectory(&file, robot, warnings)?),
        (None, None) => {
            let example = "steps = [{ move = \"joint\", to = [0, -20, 90, 0, 40, 0], speed = 50 }]   (or: trajectory = \"recorded.csv\")";
            return Err(t.error(format!("`{}` has neither `steps` nor `trajectory`", t.name)).hint(example));
        }
    };
    Ok(Program { speed_override, repeat, body, line: t.line })
}

fn step(v: &Value<'_>, cell: &Cell, robot: &CellRobot) -> Result<ProgramStep> {
    const EXAMPLE: &str = "{ move = \"joint\", to = […] }, { region = \"column\", active = false }, { wait = 0.5 }, \
                           { override = 50 }, { grip = \"part\" }, { release = \"part\" } or { tool = \"gripper\" }";
    let t = v.table(EXAMPLE)?;
    let given: Vec<_> = STEPS.iter().filter(|kind| t.get(kind.word).is_some()).collect();
    let kind = match given[..] {
        [kind] => kind,
        [] => {
            t.only(&STEPS.iter().flat_map(|kind| names(&[kind.keys])).collect::<Vec<_>>())?;
            return Err(v.error("is not a step").hint(EXAMPLE));
        }
        _ => {
            let hint = "one of move, region, wait, override, grip, release, tool per step";
            return Err(v.error("is several steps in one").hint(hint));
        }
    };
    t.only(&names(&[kind.keys]))?;
    refuse_hand(&t, kind.word, robot)?;
    let action = match kind.word {
        "move" => movement(&t, cell.units, robot)?,
        "region" => switch(&t, &cell.regions)?,
        "grip" => StepAction::Grip(part(&t, "grip", cell)?),
        "release" => StepAction::Release(part(&t, "release", cell)?),
        "tool" => StepAction::Tool(tool(&t, robot)?),
        "wait" => StepAction::Wait(t.need("wait", "wait = 0.5")?.not_negative()?),
        _ => StepAction::Override(t.need("override", "override = 50")?.percent()?),
    };
    Ok(ProgramStep { line: t.line, action })
}

/// Refuses a step that needs a hand or a tool centre point, in the program of a mechanism.
fn refuse_hand(t: &Table<'_>, word: &'static str, robot: &CellRobot) -> Result<()> {
    match t.get(word) {
        Some(v) if ["grip", "release", "tool"].contains(&word) => mechanism::refuse_step(&v, robot, "has no hand"),
        Some(v) if word == "move" && v.text().is_ok_and(|kind| kind == "linear") => {
            mechanism::refuse_step(&v, robot, "has no tool centre point that could move straight")
        }
        _ if word == "move" => match t.get("keep") {
            Some(v) => mechanism::refuse_step(&v, robot, "has no tool whose axis could be kept"),
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

/// The object that a step grips or releases.
fn part(t: &Table<'_>, key: &'static str, cell: &Cell) -> Result<ObjectId> {
    let v = t.need(key, &format!("{key} = \"part\""))?;
    let name = v.text()?;
    let index = cell.objects.iter().position(|o| o.name == name).ok_or_else(|| {
        let known = cell.objects.iter().map(|o| o.name.as_str());
        v.error(format!("names the object \"{name}\", which is not in this cell")).hint(suggest::hint(name, known))
    })?;
    if matches!(cell.objects[index].shape, Shape::HalfSpace(_)) {
        return Err(v
            .error(format!("names \"{name}\", a plane, which is unbounded"))
            .hint("an object of another shape"));
    }
    Ok(ObjectId(index))
}

/// The tool that a step makes active.
fn tool(t: &Table<'_>, robot: &CellRobot) -> Result<usize> {
    let v = t.need("tool", "tool = \"gripper\"")?;
    let name = v.text()?;
    robot.payload.tools.iter().position(|tool| tool.name == name).ok_or_else(|| {
        let what = format!("names the tool \"{name}\", which robot \"{}\" does not have", robot.name);
        let hint = if robot.payload.tools.is_empty() {
            format!("[robot.{}.tools.{name}] with its tcp and box", robot.name)
        } else {
            suggest::hint(name, robot.payload.tools.iter().map(|tool| tool.name.as_str()))
        };
        v.error(what).hint(hint)
    })
}

/// Kinds of moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Movement {
    Joint,
    Linear,
    Planned,
}

fn movement(t: &Table<'_>, units: Units, robot: &CellRobot) -> Result<StepAction> {
    let kinds = [("joint", Movement::Joint), ("linear", Movement::Linear), ("planned", Movement::Planned)];
    let kind = t.need("move", "move = \"joint\"")?.word(&kinds)?;
    let example = if kind == Movement::Linear {
        "to = { at = [900, 600, 700], rpy = [180, 0, 0] }"
    } else {
        "to = [0, -20, 90, 0, 40, 0]"
    };
    let to = goal::read(&t.need("to", example)?, example, units, robot, kind == Movement::Linear)?;
    let planner = t.get("planner");
    if let Some(v) = planner.as_ref().filter(|_| kind != Movement::Planned) {
        return Err(v.error("is of planned moves only").hint("move = \"planned\", or no `planner`"));
    }
    let keep = t.get("keep");
    if let Some(v) = keep.as_ref().filter(|_| kind != Movement::Planned) {
        return Err(v.error("is of planned moves only").hint("move = \"planned\", or no `keep`"));
    }
    let speed = t.get("speed");
    if kind == Movement::Linear {
        let speed = speed.map_or(Ok(LINEAR_SPEED), |v| units.positive_length(&v))?;
        return Ok(StepAction::Linear { to, speed });
    }
    let speed = speed.map_or(Ok(1.0), |v| {
        v.positive()?;
        v.percent()
    })?;
    if kind != Movement::Planned {
        return Ok(StepAction::Joint { to, speed });
    }
    let planners = [("rrt-connect", PathPlanner::RrtConnect), ("grid", PathPlanner::Grid)];
    let planner = planner.map_or(Ok(PathPlanner::default()), |v| v.word(&planners))?;
    let keep = keep.map(|v| kept_axis(&v, units)).transpose()?;
    Ok(StepAction::Planned { to, speed, planner, keep })
}

/// The axis that keeps its direction on a planned move.
fn kept_axis(v: &Value<'_>, units: Units) -> Result<KeptAxis> {
    const EXAMPLE: &str = "keep = { axis = \"z\", within = 5 }";
    let t = v.table(EXAMPLE)?;
    t.only(&names(&[KEPT_AXIS]))?;
    let axis = t.need("axis", "axis = \"z\"   (or a vector in the frame of the tool)")?;
    let axis_in_tcp = if axis.is_list() {
        axis.three()?.try_normalize().ok_or_else(|| axis.error("has no length").hint("axis = [0, 0, 1]"))?
    } else {
        axis.word(&[("x", Vec3::X), ("y", Vec3::Y), ("z", Vec3::Z)])?
    };
    let within = t.need("within", "within = 5   (an angle)")?;
    let tolerance_rad = units.angle.to_radians(within.positive()?);
    if tolerance_rad >= std::f64::consts::PI {
        return Err(within.error("is half a turn or more: every direction would do").hint("within = 5"));
    }
    Ok(KeptAxis { axis_in_tcp, tolerance_rad })
}

fn switch(t: &Table<'_>, regions: &[CellRegion]) -> Result<StepAction> {
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
        return Err(v.error(what).hint(format!(
            "life = \"temporary\" in the table of line {}, or leave the step out",
            regions[index].line
        )));
    }
    let active = t.need("active", "active = true")?.flag()?;
    Ok(StepAction::Switch { region: CellRegionId(index), active })
}

fn trajectory(v: &Value<'_>, robot: &CellRobot, warnings: &mut Vec<Diagnostic>) -> Result<JointTrajectory> {
    let chain = &robot.robot.chain;
    let (states, offset_s) = if v.is_table() {
        let t = v.table(RECORDING)?;
        t.only(&names(&[schema::RECORDING]))?;
        let layout = recording_layout(&t, robot)?;
        let offset_s = t.get("offset").map_or(Ok(0.0), |v| v.not_negative())?;
        (recording::read(&models::path(&t.need("file", RECORDING)?)?, &robot.name, chain, &layout)?, offset_s)
    } else {
        (JointStates::read(&models::path(v)?, &JointStateOptions::trajectory(&robot.name, chain))?, 0.0)
    };
    let trajectory = states.trajectory(RobotId(0));
    warnings.extend(states.warnings);
    // The robot rests at its first row for that long.
    Ok(if offset_s > 0.0 { trajectory.after_rest(offset_s) } else { trajectory })
}

const RECORDING: &str = "trajectory = { file = \"log.csv\", angle = \"deg\", period_ms = 4 }";

/// Layout of the file of a recording.
fn recording_layout(t: &Table<'_>, robot: &CellRobot) -> Result<RecordingLayout> {
    let angle = t
        .get("angle")
        .map_or(Ok(AngleUnit::Radian), |v| v.word(&[("rad", AngleUnit::Radian), ("deg", AngleUnit::Degree)]))?;
    let (time, period) = (t.get("time"), t.get("period_ms"));
    if let (Some(_), Some(period)) = (&time, &period) {
        return Err(period.error("contradicts `time`").hint("one of the two: time = \"COLUMN\" or period_ms = 4"));
    }
    if let (Some(unit), Some(_)) = (t.get("time_unit"), &period) {
        return Err(unit
            .error("contradicts `period_ms`, which is in milliseconds")
            .hint("time = \"COLUMN\" with it, or leave it out"));
    }
    let time_unit_s = t.get("time_unit").map(|v| v.word(&[("s", 1.0), ("ms", 1e-3), ("us", 1e-6)])).transpose()?;
    Ok(RecordingLayout {
        angle,
        length: t.get("length").map_or(Ok(LengthUnit::Metre), |v| models::mesh_unit(&v))?,
        time: time.map(|v| v.text().map(str::to_owned)).transpose()?,
        time_unit_s,
        period_s: period.map(|v| v.positive().map(|ms| ms / 1000.0)).transpose()?,
        columns: t.get("columns").map_or(Ok(Vec::new()), |v| columns(&v, robot))?,
    })
}

/// Joints and their columns: `columns = { joint_1 = "A1" }`.
fn columns(v: &Value<'_>, robot: &CellRobot) -> Result<Vec<(String, String)>> {
    let names = robot.joint_names();
    let t = v.table("columns = { joint_1 = \"A1\" }")?;
    t.only(&names.iter().map(String::as_str).collect::<Vec<_>>())?;
    t.each().map(|(joint, column)| Ok((joint.to_owned(), column.text()?.to_owned()))).collect()
}
