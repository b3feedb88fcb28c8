//! `[virtual_robot.NAME]`: robots that act as one.

use elbowroom_cooperation::{CooperationSettings, Grasp};
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_spatial::Vec3;
use elbowroom_vision::Visibility;

use super::definitions::robot_id;
use super::mechanism;
use super::operator::{refuse_other_motion, stale_s, stream};
use super::schema::{GRASP, VIRTUAL_ROBOT, names};
use super::tools::with_exchanged_tools;
use crate::virtual_robot::{CellVirtualRobot, VirtualRobotMember, WorkPieceView};
use crate::{Cell, CellRobot, OperatorStream, SensorKind, Units};

/// Longest time that a hand takes to close or to open, s.
const MOST_SETTLE_S: f64 = 60.0;
/// Longest time that a motion is foreseen, s.
const MOST_HORIZON_S: f64 = 60.0;
/// Least speed of a hand, m/s.
const LEAST_APPROACH_M_S: f64 = 1e-3;

type Result<T> = std::result::Result<T, Diagnostic>;

const GRASPS: &str = "grasps = { left = [{ at = [0, 0, 80], rpy = [180, 0, 0], approach = 60 }], right = [...] }";
/// Most robots that act as one.
const MOST: usize = 8;

pub(super) fn read(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    for (name, t) in root.named("virtual_robot")? {
        let virtual_robot = virtual_robot(name, &t, cell)?;
        cell.guidance.virtual_robots.push(virtual_robot);
    }
    Ok(())
}

/// The names of the cameras that look at work-pieces, known or not.
pub(super) fn cameras<'t>(root: &Table<'t>) -> Result<Vec<&'t str>> {
    let named = root.named("virtual_robot")?.into_iter().filter_map(|(_, t)| t.get("seen_by"));
    named.map(|v| v.text()).collect()
}

fn virtual_robot(name: &str, t: &Table<'_>, cell: &Cell) -> Result<CellVirtualRobot> {
    t.only(&names(&[VIRTUAL_ROBOT]))?;
    let robots = robots(&t.need("robots", "robots = [\"left\", \"right\"]")?, cell)?;
    if let Some(robot) = with_exchanged_tools(&cell.robots) {
        let what = format!("`{}`: tools that are changed, as those of robot \"{}\", are not seen", t.name, robot.name);
        return Err(t.error(what).hint("mounted tools only, or no virtual robot"));
    }
    refuse_unseen_changes(t, cell)?;
    let work_piece = work_piece(&t.need("work_piece", "work_piece = \"part\"   (an object)")?, cell)?;
    let holder_value = t.need("holder", "holder = \"left\"   (one of `robots`)")?;
    let holder = robot_id(&holder_value, &cell.robots)?;
    let Some(holder) = robots.iter().position(|r| *r == holder) else {
        return Err(holder_value.error("is not one of `robots`").hint("a robot of the list `robots`"));
    };
    let grasps = t.need("grasps", GRASPS)?;
    let grasps = grasps.table(GRASPS)?;
    let known: Vec<&str> = robots.iter().map(|r| cell.robots[r.0].name.as_str()).collect();
    grasps.only(&known)?;
    let members = robots.iter().zip(&known).map(|(robot, name)| {
        let list = grasps.need(name, GRASPS)?;
        let of_robot = list.list(GRASPS)?.iter().map(|v| grasp(v, cell.units)).collect::<Result<Vec<Grasp>>>()?;
        if of_robot.is_empty() {
            return Err(list.error("has no grasp, so the robot never holds the work-piece").hint(GRASPS));
        }
        Ok(VirtualRobotMember { robot: *robot, grasps: of_robot })
    });
    let members = members.collect::<Result<_>>()?;
    let stream = stream(t, cell.units, (1.0, stale_s(t, 500.0)?), &[])?.0;
    Ok(CellVirtualRobot {
        name: name.to_owned(),
        line: t.line,
        work_piece,
        members,
        holder,
        settings: settings(t, cell.units)?,
        view: view(t, cell, work_piece, &stream)?,
        stream,
    })
}

/// The camera that looks at the work-piece.
fn view(t: &Table<'_>, cell: &Cell, work_piece: ObjectId, stream: &OperatorStream) -> Result<Option<WorkPieceView>> {
    let Some(v) = t.get("seen_by") else {
        let alone = t.get("hidden").map(|v| v.error("needs the camera from which the work-piece would be hidden"));
        return alone.map_or(Ok(None), |e| Err(e.hint("seen_by = \"above\"   (a [camera.NAME] of this file)")));
    };
    let name = v.text()?;
    let cameras = cell.sensors.iter().filter_map(|sensor| match &sensor.kind {
        SensorKind::Camera { camera, .. } => Some((sensor.name.as_str(), camera)),
        SensorKind::Cloud { .. } => None,
    });
    let Some((_, camera)) = cameras.clone().find(|(known, _)| *known == name) else {
        let what = format!("names the camera \"{name}\", which is not in this cell");
        return Err(v.error(what).hint(suggest::hint(name, cameras.map(|(known, _)| known))));
    };
    let part = &cell.objects[work_piece.0];
    let mut visibility = Visibility::new(camera.clone(), &part.shape);
    let mut poses = stream.rows_between(None, f64::INFINITY).filter_map(|(_, pose)| pose);
    if !visibility.is_in_view(&part.in_world) && !poses.any(|pose| visibility.is_in_view(&pose)) {
        let what = format!("names the camera \"{name}\", which shows \"{}\" at no pose of the stream", part.name);
        let hint = format!("a `pose` of [camera.{name}] from which it is in the picture: z looks along the view");
        return Err(v.error(what).hint(hint));
    }
    Ok(Some(WorkPieceView { camera: name.to_owned(), visibility }))
}

/// Speed of a hand; with a slower one than this, a hand-over would seem to hang.
fn approach_speed(t: &Table<'_>, units: Units, default_m_s: f64) -> Result<f64> {
    let Some(v) = t.get("approach_speed") else { return Ok(default_m_s) };
    let speed_m_s = units.positive_length(&v)?;
    if speed_m_s >= LEAST_APPROACH_M_S {
        return Ok(speed_m_s);
    }
    let what = format!("is {} mm/s: a hand-over would take for ever", 1e3 * speed_m_s);
    Err(v.error(what).hint("a speed of at least 1 mm/s"))
}

fn settings(t: &Table<'_>, units: Units) -> Result<CooperationSettings> {
    let default = CooperationSettings::default();
    let length = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| units.positive_length(&v));
    let angular_speed_rad_s = match t.get("turn_speed") {
        Some(v) => units.angle.to_radians(v.positive()?),
        None => default.angular_speed_rad_s,
    };
    let seconds = |key: &str, per_s: f64, default: f64, most_s: f64| {
        let Some(v) = t.get(key) else { return Ok(default) };
        let seconds = v.positive()? / per_s;
        if seconds <= most_s {
            return Ok(seconds);
        }
        let what = format!("is {seconds} s, more than {most_s} s");
        Err(v.error(what).hint(format!("{key} = {}   (at most {})", default * per_s, most_s * per_s)))
    };
    Ok(CooperationSettings {
        speed_m_s: length("speed", default.speed_m_s)?,
        angular_speed_rad_s,
        gap_m: length("gap", default.gap_m)?,
        approach_m_s: approach_speed(t, units, default.approach_m_s)?,
        settle_s: seconds("settle_ms", 1e3, default.settle_s, MOST_SETTLE_S)?,
        horizon_s: seconds("horizon_s", 1.0, default.horizon_s, MOST_HORIZON_S)?,
        hidden_share: t.get("hidden").map_or(Ok(default.hidden_share), |v| v.percent())?,
        ..default
    })
}

/// The members do not see what others carry, and others do not see the work-piece.
fn refuse_unseen_changes(t: &Table<'_>, cell: &Cell) -> Result<()> {
    let carries = |(index, _): &(usize, &CellRobot)| !cell.gripped_objects(RobotId(*index)).is_empty();
    let mut robots = cell.robots.iter().enumerate();
    let other = match (robots.find(carries), cell.guidance.operators.first()) {
        (Some((_, robot)), _) => format!("robot \"{}\", which carries something else", robot.name),
        (None, Some(operator)) => format!("the operator \"{}\"", operator.name),
        (None, None) => match cell.robots.iter().find(|r| r.avoidance.is_some()) {
            Some(robot) => format!("robot \"{}\", which avoids obstacles", robot.name),
            None => return Ok(()),
        },
    };
    let what = format!("`{}` is beside {other}: they do not see what the others carry", t.name);
    Err(t.error(what).hint("one virtual robot, beside robots whose programs do not grip"))
}

/// The robots, which are not moved by anything else.
fn robots(v: &Value<'_>, cell: &Cell) -> Result<Vec<RobotId>> {
    let mut robots = Vec::new();
    for v in v.list("robots = [\"left\", \"right\"]")? {
        let robot = robot_id(&v, &cell.robots)?;
        mechanism::refuse(&v, &cell.robots[robot.0], "carries nothing")?;
        let name = &cell.robots[robot.0].name;
        if robots.contains(&robot) {
            return Err(v.error(format!("names \"{name}\" twice")).hint("each robot once"));
        }
        refuse_other_motion(&v, cell, robot)?;
        if let Some(operator) = cell.guidance.operator_of(robot) {
            let what = format!("is guided by the operator \"{}\"", operator.name);
            return Err(v.error(what).hint("a robot without an operator"));
        }
        if let Some(other) = cell.guidance.virtual_robot_of(robot) {
            let what = format!("is a member of the virtual robot \"{}\" already", other.name);
            return Err(v.error(what).hint("each robot in one virtual robot"));
        }
        robots.push(robot);
    }
    if (2..=MOST).contains(&robots.len()) {
        return Ok(robots);
    }
    Err(v.error(format!("has {} robots", robots.len())).hint("two to eight robots"))
}

/// The work-piece, which nothing else moves.
fn work_piece(v: &Value<'_>, cell: &Cell) -> Result<ObjectId> {
    let name = v.text()?;
    let names = || cell.objects.iter().map(|o| o.name.as_str());
    let object = names().position(|n| n == name).map(ObjectId).ok_or_else(|| {
        v.error(format!("names the object \"{name}\", which is not in this cell")).hint(suggest::hint(name, names()))
    })?;
    if cell.moving_objects.iter().any(|m| m.object == object) {
        return Err(v.error(format!("names \"{name}\", which moves by itself")).hint("an object that is at rest"));
    }
    let robots = (0..cell.robots.len()).map(RobotId);
    if let Some(robot) = robots.into_iter().find(|r| cell.gripped_objects(*r).contains(&object)) {
        let what = format!("names \"{name}\", which robot \"{}\" grips", cell.robots[robot.0].name);
        return Err(v.error(what).hint("an object that no program grips and no other virtual robot carries"));
    }
    Ok(object)
}

/// `{ at, rpy, approach }`.
fn grasp(v: &Value<'_>, units: Units) -> Result<Grasp> {
    let t = v.table("{ at = [0, 0, 80], rpy = [180, 0, 0], approach = 60 }")?;
    t.only(&names(&[GRASP]))?;
    let tool_in_part = units.place(&t)?;
    let along = |length_m: f64| tool_in_part.rotation.z_axis() * length_m;
    let approach = match t.get("approach") {
        None => along(0.05),
        Some(v) if v.is_list() => {
            let approach: Vec3 = units.point(&v)?;
            if approach.length() < 1e-6 {
                return Err(v.error("has length 0").hint("approach = 60   (a length), or a vector"));
            }
            approach
        }
        Some(v) => along(units.positive_length(&v)?),
    };
    Ok(Grasp { tool_in_part, approach })
}
