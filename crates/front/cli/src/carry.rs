//! `--carry ROBOT=OBJECT`: objects that robots hold.

use elbowroom::cell::Cell;
use elbowroom::formats::suggest;
use elbowroom::robot::{ObjectId, RobotId};
use elbowroom::scene::Attachment;
use elbowroom::sim::held_object;

use crate::output::Failure;

/// Returns the held objects, each attached as the robot's program grips it.
pub(crate) fn attachments(cell: &Cell, carry: &[String]) -> Result<Vec<(ObjectId, Attachment)>, Failure> {
    let mut held: Vec<(ObjectId, Attachment)> = Vec::new();
    for text in carry {
        let (robot, object) = parse(cell, text)?;
        if held.iter().any(|(known, _)| *known == object) {
            let name = &cell.objects[object.0].name;
            return Err(wrong(&format!("\"{name}\" is held twice"), "--carry ROBOT=OBJECT once per object"));
        }
        held.push((object, held_object(cell, robot, object)?));
    }
    Ok(held)
}

fn parse(cell: &Cell, text: &str) -> Result<(RobotId, ObjectId), Failure> {
    let Some((robot, object)) = text.split_once('=') else {
        return Err(wrong(&format!("`{text}` is no robot and object"), "--carry ROBOT=OBJECT, as --carry arm=part"));
    };
    let (robot, object) = (robot.trim(), object.trim());
    let robots = || cell.robots.iter().map(|r| r.name.as_str());
    let objects = || cell.objects.iter().map(|o| o.name.as_str());
    let id = cell
        .robot(robot)
        .ok_or_else(|| wrong(&format!("\"{robot}\" is no robot of this cell"), &suggest::hint(robot, robots())))?;
    let index = objects()
        .position(|name| name == object)
        .ok_or_else(|| wrong(&format!("\"{object}\" is no object of this cell"), &suggest::hint(object, objects())))?;
    Ok((id, ObjectId(index)))
}

fn wrong(what: &str, hint: &str) -> Failure {
    Failure::Wrong(format!("--carry: {what}\n  write: {hint}"))
}
