//! Check of the cell as it was read: poses, sizes, joints and speeds are those that the text of the file states.
//!
//! The oracle computes them from the numbers of the text, by its own formulas of roll, pitch and yaw, of quaternions and
//! of Denavit and Hartenberg.

mod compare;
mod goals;
mod regions;
mod robots;
mod scenes;
mod sensors;
#[cfg(test)]
mod tests;
mod written;

use elbowroom_cell::Cell;
use elbowroom_monitor::GridSpace;
use elbowroom_sim::Recording;
use toml::{Table, Value};

use super::arm::Arm;
use super::findings::{Finding, Findings};
use super::frame::Frame;
use compare::{Off, compare};
pub use scenes::check as check_scenes;
use written::Written;

/// Adds a finding for each thing that was read otherwise than the text states.
pub fn check(text: &str, cell: &Cell, recording: &Recording, findings: &mut Findings) {
    let Some(file) = text.parse::<Table>().ok().and_then(Written::new) else { return };
    let mut off = Vec::new();
    robots::check(&file, cell, &mut off);
    regions::check(&file, cell, &mut off);
    objects(&file, cell, &mut off);
    grids(&file, cell, &mut off);
    grasps(&file, cell, &mut off);
    sensors::check(&file, cell, &mut off);
    findings.list.extend(off.into_iter().map(|(table, off)| Finding::Misread { table, off }));
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    goals::check(&file, cell, recording, &arms, findings);
    robots::check_speeds(&file, cell, recording, findings);
}

fn objects(file: &Written, cell: &Cell, off: &mut Off) {
    for (name, t) in file.tables("object") {
        let Some(index) = cell.objects.iter().position(|o| o.name == *name) else {
            off.push((format!("object.{name}"), f64::INFINITY));
            continue;
        };
        // A belt has moved its objects at the start.
        if t.contains_key("follow") || t.contains_key("from") {
            continue;
        }
        let object = &cell.objects[index];
        compare(format!("object.{name}"), &file.pose(t), true, &Frame::of(&object.in_world), off);
        let word = t.get("shape").and_then(Value::as_str).unwrap_or_default();
        file.compare_size(&format!("object.{name}"), word, t, &object.shape, off);
    }
}

fn grids(file: &Written, cell: &Cell, off: &mut Off) {
    for (name, t) in file.tables("grid").filter(|(_, t)| !t.contains_key("joints")) {
        for of_robot in cell.monitoring.grids.iter().filter(|g| g.grid.name == *name) {
            let GridSpace::Tcp { frame_in_world } = &of_robot.grid.space else { continue };
            let (low, high) =
                (file.point(t, "from").min(file.point(t, "to")), file.point(t, "from").max(file.point(t, "to")));
            let mut bottom = (low + high) * 0.5;
            bottom.z = low.z;
            let expected = Frame::shift(bottom).then(&file.turn(t));
            compare(format!("grid.{name}"), &expected, true, &Frame::of(frame_in_world), off);
        }
    }
}

fn grasps(file: &Written, cell: &Cell, off: &mut Off) {
    for (name, t) in file.tables("virtual_robot") {
        let of_name = |v: &&elbowroom_cell::CellVirtualRobot| v.name == *name;
        let Some(read) = cell.guidance.virtual_robots.iter().find(of_name) else { continue };
        let Some(grasps) = t.get("grasps").and_then(Value::as_table) else { continue };
        for member in &read.members {
            let robot = &cell.robots[member.robot.0].name;
            let written = grasps.get(robot).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_table);
            for (grasp, read) in written.zip(&member.grasps) {
                let expected = file.pose(grasp);
                compare(
                    format!("virtual_robot.{name}.grasps.{robot}"),
                    &expected,
                    true,
                    &Frame::of(&read.tool_in_part),
                    off,
                );
            }
        }
    }
}
