//! Bases, hands, solids and joints of robots.

use elbowroom_cell::{Cell, CellRobot, ProgramBody};
use elbowroom_robot::Collider;
use elbowroom_sim::Recording;
use elbowroom_spatial::Vec3;
use toml::{Table, Value};

use super::compare::{Off, ROUNDING, compare};
use super::written::{Written, is_turned, number, numbers};
use crate::fuzz_cells::oracle::arm::Arm;
use crate::fuzz_cells::oracle::findings::{Finding, Findings};
use crate::fuzz_cells::oracle::frame::Frame;

/// By how much a joint may be faster than its limit: rounding of positions.
const FASTER: f64 = 1e-6;

pub fn check(file: &Written, cell: &Cell, off: &mut Off) {
    for (name, t) in file.tables("robot") {
        let what = format!("robot.{name}");
        let Some(robot) = cell.robots.iter().find(|r| r.name == *name) else {
            off.push((what, f64::INFINITY));
            continue;
        };
        if let Some(base) = table(t, "base") {
            compare(format!("{what}.base"), &file.pose(base), true, &Frame::of(&robot.base_in_world), off);
        }
        hand(&what, file, t, robot, off);
        solids(&what, file, t, robot, off);
        kinematics(&what, file, t, robot, off);
        start(&what, file, t, robot, off);
    }
}

fn table<'t>(t: &'t Table, key: &str) -> Option<&'t Table> {
    t.get(key)?.as_table()
}

fn hand(what: &str, file: &Written, t: &Table, robot: &CellRobot, off: &mut Off) {
    if let Some(load) = table(t, "load") {
        solid(&format!("{what}.load"), file, load, robot.payload.load.as_ref(), off);
    }
    if let Some(tool) = table(t, "tool") {
        let what = format!("{what}.tool");
        if let Some(tcp) = table(tool, "tcp") {
            compare(format!("{what}.tcp"), &file.pose(tcp), true, &Frame::of(&robot.tcp_in_flange), off);
        }
        tool_solid(&what, file, tool, robot.payload.tool.as_ref(), off);
    }
    for (name, tool) in table(t, "tools").into_iter().flatten().filter_map(|(n, v)| Some((n, v.as_table()?))) {
        let what = format!("{what}.tools.{name}");
        let Some(read) = robot.payload.tools.iter().find(|tool| tool.name == *name) else {
            off.push((what, f64::INFINITY));
            continue;
        };
        if let Some(tcp) = table(tool, "tcp") {
            compare(format!("{what}.tcp"), &file.pose(tcp), true, &Frame::of(&read.tcp_in_link), off);
        }
        tool_solid(&what, file, tool, read.collider.as_ref(), off);
        if let Some(flange) = tool.get("flange").and_then(Value::as_str)
            && robot.robot.chain.links()[read.flange.0] != flange
        {
            off.push((format!("{what}.flange"), f64::INFINITY));
        }
    }
}

/// A box, or a mesh whose pose is in the table of the tool.
fn tool_solid(what: &str, file: &Written, tool: &Table, read: Option<&Collider>, off: &mut Off) {
    if tool.contains_key("box") {
        let solid_of_it: Table =
            tool.iter().filter(|(key, _)| *key == "box").map(|(k, v)| (k.clone(), v.clone())).collect();
        solid(what, file, &solid_of_it, read, off);
    } else if tool.contains_key("mesh") {
        let Some(read) = read else { return off.push((what.to_owned(), f64::INFINITY)) };
        compare(what.to_owned(), &file.pose(tool), true, &Frame::of(&read.in_link), off);
        file.compare_size(what, "mesh", tool, &read.shape, off);
    }
}

/// A solid such as `{ box = { … } }`.
fn solid(what: &str, file: &Written, t: &Table, read: Option<&Collider>, off: &mut Off) {
    let Some((word, inner)) = t.iter().next().and_then(|(word, inner)| Some((word, inner.as_table()?))) else { return };
    let Some(read) = read else { return off.push((what.to_owned(), f64::INFINITY)) };
    let (expected, is_turned) = if inner.contains_key("from") {
        (Frame::shift((file.point(inner, "from") + file.point(inner, "to")) * 0.5), false)
    } else {
        (file.pose(inner), is_turned(inner))
    };
    compare(format!("{what}.{word}"), &expected, is_turned, &Frame::of(&read.in_link), off);
    file.compare_size(what, word, inner, &read.shape, off);
}

/// The solids of the links of a `dh` robot.
fn solids(what: &str, file: &Written, t: &Table, robot: &CellRobot, off: &mut Off) {
    let bare = robot.without_payload();
    let mut all = |what: String, written: &Value, link: usize| {
        let list = match written {
            Value::Array(list) => list.iter().filter_map(Value::as_table).collect(),
            one => Vec::from_iter(one.as_table()),
        };
        for (index, one) in list.iter().enumerate() {
            solid(&format!("{what}[{index}]"), file, one, bare.colliders[link].get(index), off);
        }
    };
    if let Some(base) = t.get("base_link") {
        all(format!("{what}.base_link"), base, robot.robot.chain.root().0);
    }
    for (index, written) in t.get("links").and_then(Value::as_array).into_iter().flatten().enumerate() {
        let Some(link) = robot.robot.chain.link(&format!("link_{}", index + 1)) else { continue };
        all(format!("{what}.links[{index}]"), written, link.0);
    }
}

/// The frame of the last link at the start, by the rows of `dh` or as the VRML file draws it.
fn kinematics(what: &str, file: &Written, t: &Table, robot: &CellRobot, off: &mut Off) {
    let base = table(t, "base").map_or(Frame::IDENTITY, |base| file.pose(base));
    let q = &robot.start;
    let (link, expected) = match (t.get("dh").and_then(Value::as_array), t.get("model").and_then(Value::as_str)) {
        (Some(rows), _) => {
            let rows = rows.iter().filter_map(Value::as_table).zip(q);
            let frames = rows.map(|(row, q)| of_row(file, row, *q));
            (format!("link_{}", q.len()), frames.fold(base, |frame, row| frame.then(&row)))
        }
        (None, Some("arm.wrl")) => {
            let turned = Frame::shift(Vec3::Z * 0.3).then(&Frame::turn(Vec3::Z, q[0]));
            ("hand".to_owned(), base.then(&turned).then(&Frame::shift(Vec3::X * (0.6 + q[1]))))
        }
        _ => return,
    };
    let Some(link) = robot.robot.chain.link(&link) else { return off.push((format!("{what}: {link}"), f64::INFINITY)) };
    compare(format!("{what}: joints"), &expected, true, &Arm::new(robot).frames(q)[link.0], off);
}

/// `Rz(θ) · Tz(d) · Tx(a) · Rx(α)`, where the joint value adds to θ or d.
fn of_row(file: &Written, row: &Table, q: f64) -> Frame {
    let slides = row.get("kind").and_then(Value::as_str) == Some("prismatic");
    let (turn, slide) = if slides { (0.0, q) } else { (q, 0.0) };
    Frame::turn(Vec3::Z, file.angle(row, "theta") + turn)
        .then(&Frame::shift(Vec3::new(file.length(row, "a"), 0.0, file.length(row, "d") + slide)))
        .then(&Frame::turn(Vec3::X, file.angle(row, "alpha")))
}

/// The joint values of the state in which the robot starts, or those of `start`.
fn start(what: &str, file: &Written, t: &Table, robot: &CellRobot, off: &mut Off) {
    let of_state = |name: &str| table(t, "states")?.get(name).and_then(numbers);
    let written = match t.get("start") {
        Some(Value::String(name)) => of_state(name),
        other => other.and_then(numbers),
    };
    let Some(written) = written else { return };
    let slides = slides(robot);
    let by = |((value, slides), read): ((&f64, &bool), &f64)| (file.joint(*slides, *value) - read).abs();
    let by = written.iter().zip(&slides).zip(&robot.start).map(by).fold(0.0, f64::max);
    if !(by <= ROUNDING) || written.len() != robot.start.len() {
        off.push((format!("{what}: start"), by));
    }
}

/// Whether each joint slides.
fn slides(robot: &CellRobot) -> Vec<bool> {
    let chain = &robot.robot.chain;
    let kind = |id: &elbowroom_kinematics::JointId| chain.joints()[id.0].kind;
    chain.active_joints().iter().map(|id| kind(id) == elbowroom_kinematics::JointKind::Prismatic).collect()
}

/// A robot that follows its steps, and evades nothing, is not faster than its `speed`.
pub fn check_speeds(file: &Written, cell: &Cell, recording: &Recording, findings: &mut Findings) {
    for (name, t) in file.tables("robot") {
        let Some(speed) = t.get("speed").and_then(number) else { continue };
        let Some(robot) = cell.robots.iter().position(|r| r.name == *name) else { continue };
        let r = &cell.robots[robot];
        let has_steps = matches!(r.program.as_ref().map(|p| &p.body), Some(ProgramBody::Steps(_)));
        if !has_steps || r.avoidance.is_some() {
            continue;
        }
        let slides = slides(r);
        for pair in recording.robots[robot].samples.windows(2) {
            let of_joint =
                |j: usize| (pair[1].q[j] - pair[0].q[j]).abs() / recording.tick_s / file.joint(slides[j], speed);
            let share = (0..slides.len()).map(of_joint).fold(0.0, f64::max);
            if share > 1.0 + FASTER {
                findings.list.push(Finding::TooFast { robot, t_s: pair[1].t_s, share });
                break;
            }
        }
    }
}
