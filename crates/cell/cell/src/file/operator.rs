//! `[operator.NAME]`: a robot that a person guides.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_proximity::Shape;
use elbowroom_robot::RobotId;
use elbowroom_shared_control::{NavigatorSettings, ProtectedSurface};
use elbowroom_spatial::Pose;

use super::definitions::robot_id;
use super::fixture_tool::tool_of;
use super::mechanism;
use super::poses::read_with;
use super::schema::{OPERATOR, names};
use super::tools::with_exchanged_tools;
use crate::guided_arm::CHORD_M;
use crate::operator::{CellOperator, Interpolation, OperatorRow, OperatorStream};
use crate::{Cell, FixtureRef, FixtureSwitches, FixtureTool, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const STREAM: &str = "stream = \"hand.csv\"   (t_s,x,y,z,qx,qy,qz,qw and, if wanted, enable,clutch)";
/// Range of the scale of motions.
const SCALES: (f64, f64) = (1e-3, 100.0);
/// Most age of a row, ms.
const MOST_STALE_MS: f64 = 1000.0;

pub(super) fn read(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    for (name, t) in root.named("operator")? {
        let operator = operator(name, &t, cell)?;
        if let Some(other) = cell.guidance.operator_of(operator.robot) {
            let what = format!("`{}`: the robot has the operator \"{}\" already", t.name, other.name);
            return Err(t.error(what).hint("one operator per robot"));
        }
        cell.guidance.operators.push(operator);
    }
    let guidance = &cell.guidance;
    let idle = guidance.guides.iter().filter(|g| !guidance.operators.iter().any(|o| o.tool == g.tool));
    let warnings = idle.map(|g| {
        let what = format!("the guide \"{}\" does nothing: no operator guides its tool", g.name);
        Diagnostic::new(&cell.file, g.line, what).hint("a table [operator.NAME]")
    });
    cell.warnings.extend(warnings.collect::<Vec<_>>());
    Ok(())
}

fn operator(name: &str, t: &Table<'_>, cell: &Cell) -> Result<CellOperator> {
    t.only(&names(&[OPERATOR]))?;
    let units = cell.units;
    let robot_value = t.need("robot", "robot = \"arm\"")?;
    let robot = robot_id(&robot_value, &cell.robots)?;
    mechanism::refuse(&robot_value, &cell.robots[robot.0], "has no tool that a person could guide")?;
    refuse_other_motion(&robot_value, cell, robot)?;
    refuse_unseen_changes(t, cell)?;
    let default = NavigatorSettings::default();
    let length = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| units.positive_length(&v));
    let gap_m = length("gap", default.gap_m)?;
    let stale_s = stale_s(t, 100.0)?;
    let scale = t.get("scale").map_or(Ok(1.0), |v| {
        let scale = v.positive()?;
        let is_usable = (SCALES.0..=SCALES.1).contains(&scale);
        if is_usable { Ok(scale) } else { Err(v.error(format!("is {scale}")).hint("scale = 1   (0.001 to 100)")) }
    })?;
    let tool = tool(t, cell, robot)?;
    let fixtures = fixtures_of(cell, tool);
    let columns: Vec<String> = fixtures.iter().map(|(_, name)| format!("fixture.{name}")).collect();
    let (stream, states) = stream(t, units, (scale, stale_s), &columns)?;
    let interpolations = [("hold", Interpolation::Hold), ("linear", Interpolation::Linear)];
    let interpolation = t.get("interpolation").map_or(Ok(Interpolation::Hold), |v| v.word(&interpolations))?;
    let mut switches = FixtureSwitches::default();
    for ((fixture, _), states) in fixtures.into_iter().zip(states) {
        if let Some(states) = states {
            switches.add(fixture, states);
        }
    }
    let operator = CellOperator {
        name: name.to_owned(),
        line: t.line,
        robot,
        tool,
        stream: stream.interpolated(interpolation),
        switches,
        settings: NavigatorSettings {
            gap_m,
            least_gap_m: 0.5 * gap_m,
            speed_m_s: length("speed", default.speed_m_s)?,
            acceleration_m_s2: length("acceleration", default.acceleration_m_s2)?,
            ..default
        },
    };
    check_fixtures(t, cell, &operator)?;
    Ok(operator)
}

/// Age (s) from which a row is too old.
pub(super) fn stale_s(t: &Table<'_>, default_ms: f64) -> Result<f64> {
    let stale = t.get("stale_ms");
    let stale_ms = stale.as_ref().map_or(Ok(default_ms), Value::positive)?;
    if let Some(v) = stale.filter(|_| stale_ms > MOST_STALE_MS) {
        let what = format!("is {stale_ms} ms: for so long a robot would follow a hand that is gone");
        return Err(v.error(what).hint("stale_ms = 100   (at most 1000)"));
    }
    Ok(1e-3 * stale_ms)
}

/// The fixtures of the tool must be able to do what they promise.
fn check_fixtures(t: &Table<'_>, cell: &Cell, operator: &CellOperator) -> Result<()> {
    let fixtures = cell.guidance.fixtures.iter().enumerate();
    for (index, fixture) in fixtures.filter(|(index, f)| operator.may_open(*index, f)) {
        let object = &cell.objects[fixture.protects.0];
        let refused = |why: &str, hint: &str| {
            let what = format!("fixture \"{}\" protects \"{}\", {why}", fixture.name, object.name);
            Err(Diagnostic::new(&cell.file, fixture.line, what).hint(hint))
        };
        if cell.moving_objects.iter().any(|m| m.object == fixture.protects) {
            return refused("which moves; the shield would not", "an object that stands still");
        }
        if !operator.switches.is_ever_off(FixtureRef::Shield(index), fixture.active) {
            continue;
        }
        // While it is off, the triangles of the object alone keep the tool out.
        let is_exact = match &object.shape {
            Shape::Mesh(mesh) => ProtectedSurface::new(mesh.clone(), Pose::IDENTITY).is_ok(),
            shape => matches!(shape, Shape::Cuboid(_) | Shape::Hull(_)),
        };
        if !is_exact {
            return refused("which is not a box or a closed mesh", "such an object, or a fixture that is always on");
        }
        if operator.settings.least_gap_m < CHORD_M {
            let what = format!("`{}`: `gap` is too small for a fixture that is switched", t.name);
            return Err(t.error(what).hint(format!("gap = {}", cell.units.in_file_units(5.0 * CHORD_M))));
        }
    }
    one_guide_at_a_time(t, cell, operator)
}

fn one_guide_at_a_time(t: &Table<'_>, cell: &Cell, operator: &CellOperator) -> Result<()> {
    let guides = cell.guidance.guides.iter().enumerate().filter(|(_, g)| g.tool == operator.tool);
    for t_s in operator.switches.times() {
        let is_on = |index: usize, active| operator.switches.is_on(FixtureRef::Guide(index), active, t_s);
        let mut on = guides.clone().filter(|(index, g)| is_on(*index, g.active)).map(|(_, g)| g.name.as_str());
        if let (Some(one), Some(other)) = (on.next(), on.next()) {
            let what = format!("`{}`: at {t_s} s the guides \"{one}\" and \"{other}\" are both on", t.name);
            return Err(t.error(what).hint("one guide at a time"));
        }
    }
    Ok(())
}

/// The fixtures of a tool, with their names.
fn fixtures_of(cell: &Cell, tool: FixtureTool) -> Vec<(FixtureRef, &str)> {
    let (fixtures, guides) = (&cell.guidance.fixtures, &cell.guidance.guides);
    let shields = fixtures.iter().enumerate().filter(|(_, f)| f.tool == Some(tool));
    let guides = guides.iter().enumerate().filter(|(_, g)| g.tool == tool);
    let shields = shields.map(|(index, f)| (FixtureRef::Shield(index), f.name.as_str()));
    shields.chain(guides.map(|(index, g)| (FixtureRef::Guide(index), g.name.as_str()))).collect()
}

/// States from times (s) on.
type States = Vec<(f64, bool)>;

/// The stream that a table names, and the states in other columns; `None` for one that the file does not have.
pub(super) fn stream(
    t: &Table<'_>,
    units: Units,
    (scale, stale_s): (f64, f64),
    columns: &[String],
) -> Result<(OperatorStream, Vec<Option<States>>)> {
    let others: Vec<&str> = ["enable", "clutch"].into_iter().chain(columns.iter().map(String::as_str)).collect();
    let (table, rows) = read_with(&t.need("stream", STREAM)?, units, &others)?;
    let states = (2..others.len()).map(|column| {
        let state = |row: &super::poses::PoseRow| Some((row.t_s, row.others[column]? != 0.0));
        let states: States = rows.iter().filter_map(state).collect();
        (!states.is_empty()).then_some(states)
    });
    let states = states.collect();
    let row = |r: super::poses::PoseRow| OperatorRow {
        t_s: r.t_s,
        pose: r.pose,
        enabled: r.others[0].is_none_or(|x| x != 0.0),
        clutch: r.others[1].is_some_and(|x| x != 0.0),
    };
    let rows: Vec<OperatorRow> = rows.into_iter().map(row).collect();
    Ok((OperatorStream::new(table.file.clone(), &rows, scale, stale_s), states))
}

/// A robot moves by its program, or by an operator.
pub(super) fn refuse_other_motion(v: &Value<'_>, cell: &Cell, robot: RobotId) -> Result<()> {
    let r = &cell.robots[robot.0];
    let other = match (&r.program, &r.avoidance) {
        (Some(_), _) => "program",
        (None, Some(_)) => "avoidance",
        (None, None) => return Ok(()),
    };
    let what = format!("has a table [{other}.{}]: a robot moves by itself, or is guided", r.name);
    Err(v.error(what).hint(format!("either [{other}.{}] or the operator", r.name)))
}

/// A guided arm knows robots and objects as they are at the start, and how objects move by themselves.
fn refuse_unseen_changes(t: &Table<'_>, cell: &Cell) -> Result<()> {
    if let Some(robot) = with_exchanged_tools(&cell.robots) {
        let what = format!(
            "`{}`: a guided arm does not see tools that are changed, as those of robot \"{}\"",
            t.name, robot.name
        );
        return Err(t.error(what).hint("mounted tools only, or no operator"));
    }
    let mut robots = cell.robots.iter().enumerate();
    if let Some((_, robot)) = robots.find(|(i, _)| !cell.gripped_objects(RobotId(*i)).is_empty()) {
        let what = format!(
            "`{}`: a guided arm does not see parts that are carried, as those of robot \"{}\"",
            t.name, robot.name
        );
        return Err(t.error(what).hint("programs without grips, or no operator"));
    }
    Ok(())
}

fn tool(t: &Table<'_>, cell: &Cell, robot: RobotId) -> Result<FixtureTool> {
    let r = &cell.robots[robot.0];
    match t.get("tool") {
        Some(v) => tool_of(&v, cell, robot, v.text()?),
        None => match r.payload.tools.iter().find(|tool| tool.mounted) {
            Some(tool) => tool_of(&t.need("robot", "robot = \"arm\"")?, cell, robot, &tool.name),
            None => tool_of(&t.need("robot", "robot = \"arm\"")?, cell, robot, "tool"),
        },
    }
}
