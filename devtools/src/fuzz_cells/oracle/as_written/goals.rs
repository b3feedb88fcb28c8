//! Moves to poses: the tool centre point comes to the pose, in the configuration that the step chooses.

use elbowroom_cell::Cell;
use elbowroom_sim::Recording;
use toml::{Table, Value};

use super::written::{Written, numbers};
use crate::fuzz_cells::oracle::arm::Arm;
use crate::fuzz_cells::oracle::findings::{Finding, Findings};
use crate::fuzz_cells::oracle::frame::Frame;

/// By how much a pose may be off, m and rad, and joint values near the given ones, rad.
const OFF: f64 = 1e-5;

pub fn check(file: &Written, cell: &Cell, recording: &Recording, arms: &[Arm], findings: &mut Findings) {
    for (name, program) in file.tables("program") {
        let Some(robot) = cell.robots.iter().position(|r| r.name == *name) else { continue };
        let steps = program.get("steps").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_table);
        let moves: Vec<&Table> = steps.filter(|step| step.contains_key("move")).collect();
        let (Some(first), Some(last)) = (moves.first(), moves.last()) else { continue };
        let samples = &recording.robots[robot].samples;
        if let (Some(end), true) = (samples.last(), recording.robots[robot].finished) {
            let off = at_goal(file, cell, (robot, &arms[robot]), last, &end.q);
            findings.list.extend(off.map(|off| Finding::OffGoal { robot, t_s: end.t_s, off }));
        }
        // A joint move is straight, so it is known from its beginning where it leads.
        let near = first.get("to").and_then(Value::as_table).and_then(|to| near(file, to));
        if let (Some(to), Some("joint")) = (near, first.get("move").and_then(Value::as_str)) {
            let path = samples.iter().map(|sample| (sample.t_s, &sample.q[..]));
            let off = off_line(&cell.robots[robot].start, &to, path);
            findings.list.extend(off.map(|(t_s, off)| Finding::OffGoal { robot, t_s, off }));
        }
    }
}

/// By how much joint values miss the goal of a move; `None` if they do not, or if it is none.
fn at_goal(file: &Written, cell: &Cell, (robot, arm): (usize, &Arm), last: &Table, q: &[f64]) -> Option<f64> {
    let to = last.get("to")?.as_table()?;
    let r = &cell.robots[robot];
    let tcp = arm.frames(q)[r.flange.0].then(&Frame::of(&r.tcp_in_flange));
    let goal = file.pose(to);
    let mut off = goal.at.distance(tcp.at).max(goal.turn_to(&tcp).length());
    for word in to.get("configuration").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str) {
        let is_right = match word {
            "no_flip" => q[4] >= 0.0,
            "flip" => q[4] <= 0.0,
            _ => true,
        };
        off = if is_right { off } else { f64::INFINITY };
    }
    if let Some(near) = near(file, to) {
        off = near.iter().zip(q).map(|(a, b)| (a - b).abs()).fold(off, f64::max);
    }
    (!(off <= OFF)).then_some(off)
}

/// The joint values of `near`; only robots with six revolute joints have them.
fn near(file: &Written, to: &Table) -> Option<Vec<f64>> {
    let values = to.get("near").and_then(numbers)?;
    Some(values.into_iter().map(|value| file.joint(false, value)).collect())
}

/// The first place off the straight line in joint space, before its end, and by how much.
fn off_line<'q>(from: &[f64], to: &[f64], path: impl Iterator<Item = (f64, &'q [f64])>) -> Option<(f64, f64)> {
    let way: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
    let squared: f64 = way.iter().map(|w| w * w).sum();
    for (t_s, q) in path {
        let along: f64 = q.iter().zip(from).zip(&way).map(|((q, a), w)| (q - a) * w).sum::<f64>() / squared;
        let off = q.iter().zip(from).zip(&way).map(|((q, a), w)| (q - a - along * w).abs()).fold(0.0, f64::max);
        if off > OFF {
            return Some((t_s, off));
        }
        if along >= 1.0 - OFF {
            return None;
        }
    }
    None
}
