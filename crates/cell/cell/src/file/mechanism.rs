//! Mechanisms: `kind = "mechanism"` of `[robot.NAME]`, such as doors, gates and positioners. They move and are obstacles,
//! but no monitor guards them.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_monitor::VolumeModel;

use crate::CellRobot;

type Result<T> = std::result::Result<T, Diagnostic>;

/// Why no region and no grid applies to a mechanism.
pub(super) const NOT_GUARDED: &str = "has no monitor";

/// Keys of `[robot.NAME]` that say how a robot is guarded or what it carries.
const OF_ROBOTS: [(&str, &str); 7] = [
    ("tool", "carries no tool"),
    ("tools", "carries no tool"),
    ("load", "carries no load"),
    ("flange", "carries no tool"),
    ("volumes", "is not guarded"),
    ("overshoot", "has no monitor"),
    ("stop_time", "follows no override"),
];

/// How the links of a robot become guarded volumes; `None` for a mechanism, whose table has no keys of robots.
pub(super) fn volumes(name: &str, t: &Table<'_>) -> Result<Option<VolumeModel>> {
    let is_mechanism = t.get("kind").map_or(Ok(false), |v| v.word(&[("robot", false), ("mechanism", true)]))?;
    if !is_mechanism {
        return t.get("volumes").map_or(Ok(VolumeModel::default()), |v| model(&v)).map(Some);
    }
    match OF_ROBOTS.iter().find_map(|(key, why)| Some((t.get(key)?, why))) {
        Some((v, why)) => Err(v
            .error(format!("belongs to robots, and \"{name}\" is a mechanism: it {why}"))
            .hint("leave it out; or kind = \"robot\", which is guarded")),
        None => Ok(None),
    }
}

fn model(v: &Value<'_>) -> Result<VolumeModel> {
    v.word(&[
        ("auto", VolumeModel::Tightest),
        ("capsule", VolumeModel::Capsule),
        ("box", VolumeModel::Box),
        ("hull", VolumeModel::Hull),
        ("mesh", VolumeModel::Exact),
    ])
}

/// Refuses a mechanism where only a robot makes sense. `why` completes "it …".
pub(super) fn refuse(v: &Value<'_>, robot: &CellRobot, why: &str) -> Result<()> {
    if robot.is_mechanism() { Err(refusal(v.error(text(robot, why)), robot)) } else { Ok(()) }
}

/// Like [`refuse`], for a table that is named after the robot.
pub(super) fn refuse_table(t: &Table<'_>, robot: &CellRobot, why: &str) -> Result<()> {
    if !robot.is_mechanism() {
        return Ok(());
    }
    Err(refusal(t.error(format!("`{}` {}", t.name, text(robot, why))), robot))
}

fn text(robot: &CellRobot, why: &str) -> String {
    format!("names \"{}\", which is a mechanism: it {why}", robot.name)
}

fn refusal(error: Diagnostic, robot: &CellRobot) -> Diagnostic {
    error.hint(format!("a robot; or [robot.{}] without kind = \"mechanism\"", robot.name))
}

/// Refuses a step that a mechanism cannot do.
pub(super) fn refuse_step(v: &Value<'_>, robot: &CellRobot, why: &str) -> Result<()> {
    if !robot.is_mechanism() {
        return Ok(());
    }
    let what = format!("is a step of the mechanism \"{}\", which {why}", robot.name);
    Err(v.error(what).hint("move = \"joint\", or a step of a robot's program"))
}
