//! `[fixture.NAME]`: a shield that protects an object and is opened along a target.

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_proximity::Shape;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_shared_control::{ShieldSettings, ShieldTarget};
use elbowroom_spatial::{Pose, Vec3};

use super::schema::{FIXTURE, FIXTURE_DRILL, FIXTURE_FACES, FIXTURE_TARGET, names};
use crate::fixture::{CellFixture, FixtureTool};
use crate::{Cell, CellRobot, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const TARGET: &str = "target = { line = [[0, 0, 100], [50, 0, 100]] }   (or area, drill, faces_within)";
const TOOL: &str = "tool = \"ROBOT/TOOL\"   (or the robot alone, if it has one tool)";

pub(super) fn read(root: &Table<'_>, cell: &Cell) -> Result<Vec<CellFixture>> {
    root.named("fixture")?.into_iter().map(|(name, t)| fixture(name, &t, cell)).collect()
}

fn fixture(name: &str, t: &Table<'_>, cell: &Cell) -> Result<CellFixture> {
    t.only(&names(&[FIXTURE]))?;
    let units = cell.units;
    let protects = object(&t.need("protects", "protects = \"bone\"   (an object)")?, cell)?;
    let object_in_world = cell.objects[protects.0].in_world;
    let (target, depth_m) = target(&t.need("target", TARGET)?, units, object_in_world)?;
    let length = |key: &str, default_m: f64| t.get(key).map_or(Ok(default_m), |v| units.not_negative_length(&v));
    let depth = t.get("depth");
    if let (Some(depth), Some(_)) = (&depth, depth_m) {
        return Err(depth.error("contradicts the depth of `drill`").hint("the depth in `drill` alone"));
    }
    let flare_rad = t.get("flare").map_or(Ok(0.0), |v| {
        let flare_rad = units.angle.to_radians(v.not_negative()?);
        let is_usable = flare_rad.to_degrees() <= 80.0;
        if is_usable { Ok(flare_rad) } else { Err(v.error("is more than 80°").hint("flare = 15   (degrees)")) }
    })?;
    Ok(CellFixture {
        name: name.to_owned(),
        line: t.line,
        protects,
        target,
        settings: ShieldSettings {
            offset_m: length("offset", 0.002)?,
            width_m: units.positive_length(&t.need("width", "width = 8   (of the opening)")?)?,
            depth_m: depth_m.map_or_else(|| length("depth", 0.0), Ok)?,
            flare_rad,
            tolerance_m: t.get("tolerance").map_or(Ok(0.002), |v| units.positive_length(&v))?,
        },
        tool: t.get("tool").map(|v| tool(&v, cell)).transpose()?,
        active: t.flag_or("active", true)?,
    })
}

fn object(v: &Value<'_>, cell: &Cell) -> Result<ObjectId> {
    let name = v.text()?;
    let known = || cell.objects.iter().map(|o| o.name.as_str());
    let index = known().position(|n| n == name).ok_or_else(|| {
        v.error(format!("names the object \"{name}\", which is not in this cell")).hint(suggest::hint(name, known()))
    })?;
    if matches!(cell.objects[index].shape, Shape::HalfSpace(_)) {
        return Err(v.error("is a plane, which has no inside to open").hint("a box, or a mesh that is closed"));
    }
    Ok(ObjectId(index))
}

/// The target in the frame of the object, and the depth of a drill.
fn target(v: &Value<'_>, units: Units, object_in_world: Pose) -> Result<(ShieldTarget, Option<f64>)> {
    let t = v.table(TARGET)?;
    t.only(&names(&[FIXTURE_TARGET]))?;
    let given: Vec<&str> = FIXTURE_TARGET.iter().map(|k| k.name).filter(|k| t.get(k).is_some()).collect();
    let [kind] = given[..] else {
        return Err(v.error(format!("has {} of line, area, drill and faces_within", given.len())).hint(TARGET));
    };
    let local = |p: Vec3| object_in_world.inverse_transform_point(p);
    let points = |key: &str, least: usize| -> Result<Vec<Vec3>> {
        let value = t.need(key, TARGET)?;
        let list = value.list(TARGET)?;
        if list.len() < least {
            return Err(value.error(format!("needs at least {least} points")).hint(TARGET));
        }
        list.iter().map(|v| units.point(v).map(local)).collect()
    };
    match kind {
        "line" => Ok((ShieldTarget::Line(points("line", 2)?), None)),
        "area" => Ok((ShieldTarget::Area(points("area", 3)?), None)),
        "drill" => {
            const EXAMPLE: &str = "drill = { at = [0, 0, 100], axis = [0, 0, -1], depth = 20 }";
            let drill = t.need("drill", TARGET)?.table(EXAMPLE)?;
            drill.only(&names(&[FIXTURE_DRILL]))?;
            let at = local(units.point(&drill.need("at", EXAMPLE)?)?);
            let given = drill.need("axis", EXAMPLE)?;
            let axis = object_in_world.inverse_transform_vector(given.three()?);
            if axis.try_normalize().is_none() {
                return Err(given.error("has no length").hint(EXAMPLE));
            }
            let depth_m = units.not_negative_length(&drill.need("depth", EXAMPLE)?)?;
            Ok((ShieldTarget::Drill { at, axis }, Some(depth_m)))
        }
        _ => {
            const EXAMPLE: &str = "faces_within = { at = [0, 0, 100], radius = 10 }";
            let faces = t.need("faces_within", TARGET)?.table(EXAMPLE)?;
            faces.only(&names(&[FIXTURE_FACES]))?;
            let at = local(units.point(&faces.need("at", EXAMPLE)?)?);
            let radius_m = units.positive_length(&faces.need("radius", EXAMPLE)?)?;
            Ok((ShieldTarget::FacesWithin { at, radius_m }, None))
        }
    }
}

fn tool(v: &Value<'_>, cell: &Cell) -> Result<FixtureTool> {
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
