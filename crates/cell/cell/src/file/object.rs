//! `[object.NAME]`: solid objects, and their motion.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_proximity::{HalfSpace, Shape};
use elbowroom_robot::ObjectId;
use elbowroom_scene::Object;
use elbowroom_spatial::{Pose, Vec3};

use super::definitions::encoder_index;
use super::schema::{OBJECT, OBJECT_FOLLOW, OBJECT_MOTION, OBJECT_SHAPES, names};
use crate::{Cell, Drive, MeasuredSource, MovingObject, ObjectPath, PathRepeat, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const MOTION: &str = "motion = { via = [[2000, 1000, 100]], speed = 500 }";
/// Corners closer than this (m) are one point.
const ONE_POINT_M: f64 = 1e-9;

pub(super) fn read(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    for (name, t) in root.named("object")? {
        let units = cell.units;
        let word = t.need("shape", "shape = \"box\"   (or sphere, cylinder, capsule, plane, mesh)")?;
        let words: Vec<_> = OBJECT_SHAPES.iter().map(|s| (s.word, s)).collect();
        let own = word.word(&words)?;
        t.only(&names(&[OBJECT, own.keys]))?;
        let (shape, in_world) = match own.word {
            "box" => units.cuboid(&t),
            "sphere" => units.sphere(&t),
            "cylinder" => units.cylinder(&t),
            "capsule" => units.capsule(&t),
            "plane" => plane(&t, units),
            _ => units.mesh(&t, "mesh"),
        }?;
        if cell.robots.iter().any(|r| r.name == name) {
            let what = format!("object and robot are both named \"{name}\"; reports could not distinguish them");
            return Err(t.error(what).hint(format!("[object.{name}_2]")));
        }
        let drive = drive(&t, cell, in_world)?;
        if t.flag_or("measured", false)? {
            measured(&t.need("measured", "measured = true")?, &shape, drive.as_ref())?;
            cell.frame_sources.measured.push(MeasuredSource::Object(ObjectId(cell.objects.len())));
        }
        let moving_object =
            drive.map(|drive| MovingObject { object: ObjectId(cell.objects.len()), rest_in_world: in_world, drive });
        let in_world = moving_object.as_ref().map_or(in_world, |m| m.pose(0.0));
        cell.objects.push(Object { name: name.to_owned(), shape, in_world });
        cell.moving_objects.extend(moving_object);
    }
    Ok(())
}

/// Refuses `measured` for an object whose pose cannot arrive by itself.
fn measured(v: &Value<'_>, shape: &Shape, drive: Option<&Drive>) -> Result<()> {
    if matches!(shape, Shape::HalfSpace(_)) {
        return Err(v.error("moves a plane, which is unbounded").hint("shape = \"box\", as large as what moves"));
    }
    if matches!(drive, Some(Drive::Belt(_))) {
        let hint = "measured = true   in the table of the encoder";
        return Err(v.error("contradicts `follow`: the object is where its encoder brings it").hint(hint));
    }
    Ok(())
}

/// Everything below the x-y plane of its frame.
fn plane(t: &Table<'_>, units: Units) -> Result<(Shape, Pose)> {
    if let Some(v) = ["follow", "motion"].iter().find_map(|key| t.get(key)) {
        return Err(v.error("moves a plane, which is unbounded").hint("shape = \"box\", as large as what moves"));
    }
    Ok((Shape::HalfSpace(HalfSpace), units.place(t)?))
}

/// The drive of the object; `None` for a fixed object.
fn drive(t: &Table<'_>, cell: &Cell, rest_in_world: Pose) -> Result<Option<Drive>> {
    match (t.get("follow"), t.get("motion")) {
        (None, None) => Ok(None),
        (Some(_), Some(motion)) => Err(motion
            .error("contradicts `follow`: an object has one source of motion")
            .hint("either follow or motion")),
        (Some(v), None) => belt(&v, cell).map(Some),
        (None, Some(v)) => path(&v, cell.units, rest_in_world).map(|path| Some(Drive::Path(path))),
    }
}

fn belt(v: &Value<'_>, cell: &Cell) -> Result<Drive> {
    const EXAMPLE: &str = "follow = { encoder = \"belt\" }";
    let t = v.table(EXAMPLE)?;
    if let Some(robot) = t.get("robot") {
        let what = "attaches an object to a robot: a carried part is its `load` or its tool";
        return Err(robot
            .error(what)
            .hint("[robot.NAME] load = { box = { at = [0, 0, 350], size = [200, 200, 200] } }"));
    }
    t.only(&names(&[OBJECT_FOLLOW]))?;
    let index = encoder_index(&t.need("encoder", "encoder = \"belt\"")?, &cell.frame_sources.encoders)?;
    Ok(Drive::Belt(cell.frame_sources.encoders[index].clone()))
}

fn path(v: &Value<'_>, units: Units, rest_in_world: Pose) -> Result<ObjectPath> {
    let t = v.table(MOTION)?;
    t.only(&names(&[OBJECT_MOTION]))?;
    let angular_velocity =
        t.get("turn").map_or(Ok(Vec3::ZERO), |v| v.three().map(|w| w * units.angle.to_radians(1.0)))?;
    let start_s = t.get("start").map_or(Ok(0.0), |v| v.not_negative())?;
    let corners = corners(&t, units, rest_in_world.translation, angular_velocity)?;
    if corners.len() == 1 {
        if let Some(v) = ["speed", "repeat"].iter().find_map(|k| t.get(k)) {
            return Err(v.error("belongs to `via`: an object that only rotates has no path").hint(MOTION));
        }
        return Ok(ObjectPath::new(corners, 0.0, start_s, PathRepeat::Once, angular_velocity));
    }
    let speed = units.positive_length(&t.need("speed", "speed = 500   (length units per second)")?)?;
    let repeat = t.get("repeat").map_or(Ok(PathRepeat::Once), |v| {
        v.word(&[("no", PathRepeat::Once), ("loop", PathRepeat::Loop), ("ping-pong", PathRepeat::PingPong)])
    })?;
    Ok(ObjectPath::new(corners, speed, start_s, repeat, angular_velocity))
}

/// The initial position and the points of `via`.
fn corners(t: &Table<'_>, units: Units, rest: Vec3, angular_velocity: Vec3) -> Result<Vec<Vec3>> {
    const EXAMPLE: &str = "via = [[2000, 1000, 100]]   (one point or more; the object starts at its `at`)";
    let Some(via) = t.get("via") else {
        if angular_velocity != Vec3::ZERO {
            return Ok(vec![rest]);
        }
        return Err(t.error(format!("`{}` moves nothing: it has neither `via` nor `turn`", t.name)).hint(EXAMPLE));
    };
    let mut corners = vec![rest];
    let points = via.list(EXAMPLE)?;
    if points.is_empty() {
        return Err(via.error("is empty").hint(EXAMPLE));
    }
    for v in &points {
        if !v.is_list() {
            return Err(v.error("must be a point, not one number").hint(EXAMPLE));
        }
        let point = units.point(v)?;
        if corners.last().is_some_and(|last| last.distance(point) < ONE_POINT_M) {
            let what = "is where the object is already: the path starts at its `at`";
            return Err(v.error(what).hint("each point away from the one before"));
        }
        corners.push(point);
    }
    Ok(corners)
}
