//! Axes of a tool that keep their direction on planned moves.

use elbowroom_cell::{Cell, CellRobot, MoveTarget, ProgramBody, StepAction};
use elbowroom_sim::Recording;
use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::findings::{Finding, Findings};
use super::frame::Frame;

/// Distance from the target at which a move has ended, rad and m: the next one may begin within a tick.
const ARRIVED: f64 = 1e-3;
/// Angle by which an axis may be off beyond its tolerance, rad: what the distance above turns it.
const TOLERANCE_RAD: f64 = 0.01;

/// A move of a program: its target, and the axis that it keeps with the largest angle.
struct Move<'c> {
    to: &'c [f64],
    keep: Option<(Vec3, f64)>,
}

/// Adds a finding for each robot whose axis left its direction.
pub fn check(cell: &Cell, recording: &Recording, arms: &[Arm], findings: &mut Findings) {
    for (robot, (r, track)) in cell.robots.iter().zip(&recording.robots).enumerate() {
        let moves = moves(r);
        if moves.iter().all(|m| m.keep.is_none()) {
            continue;
        }
        let direction = |q: &[f64], axis: Vec3| {
            let flange = &arms[robot].frames(q)[r.flange.0];
            flange.then(&Frame::of(&r.tcp_in_flange)).vector(axis)
        };
        let (mut present, mut from) = (0, &track.samples[0].q);
        for sample in &track.samples {
            let now = &moves[present % moves.len()];
            if let Some((axis, within)) = now.keep {
                let off_rad = direction(&sample.q, axis).dot(direction(from, axis)).clamp(-1.0, 1.0).acos();
                if !(off_rad <= within + TOLERANCE_RAD) {
                    findings.list.push(Finding::Tilted { robot, t_s: sample.t_s, off_rad, within_rad: within });
                    break;
                }
            }
            if sample.q.iter().zip(now.to).all(|(q, to)| (q - to).abs() <= ARRIVED) {
                (present, from) = (present + 1, &sample.q);
            }
        }
    }
}

/// The moves of a program, if the oracle knows all of their targets and the robot's only tool.
fn moves(robot: &CellRobot) -> Vec<Move<'_>> {
    let Some(ProgramBody::Steps(steps)) = robot.program.as_ref().map(|p| &p.body) else { return Vec::new() };
    if !robot.payload.tools.is_empty() {
        return Vec::new();
    }
    steps.iter().filter_map(|step| move_of(&step.action)).collect()
}

fn move_of(action: &StepAction) -> Option<Move<'_>> {
    match action {
        StepAction::Joint { to: MoveTarget::Joints(to), .. }
        | StepAction::Linear { to: MoveTarget::Joints(to), .. } => Some(Move { to, keep: None }),
        StepAction::Planned { to: MoveTarget::Joints(to), keep, .. } => {
            let keep = keep.map(|keep| (keep.axis_in_tcp * (1.0 / keep.axis_in_tcp.length()), keep.tolerance_rad));
            Some(Move { to, keep })
        }
        _ => None,
    }
}
