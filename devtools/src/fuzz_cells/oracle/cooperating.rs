//! Check of robots that act as one: the work-piece is always in a hand and on its path, nothing touches, joints keep their
//! speeds.

use elbowroom_cell::{Cell, CellVirtualRobot, OperatorInput};
use elbowroom_sim::{Recording, VirtualRobotTrack};
use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::findings::{Finding, Findings, TOLERANCE_M};
use super::frame::Frame;
use super::guarded::Guarded;
use super::in_view;
use super::solid::OracleSolid;

/// Distances beyond this are not computed, m.
const FAR_M: f64 = 0.3;
/// Rounding of a pose in a hand, m.
const RIGID_M: f64 = 1e-7;

pub fn check(cell: &Cell, recording: &Recording, arms: &[Arm], findings: &mut Findings) {
    for (spec, track) in cell.guidance.virtual_robots.iter().zip(&recording.virtual_robots) {
        held(cell, spec, recording, track, arms, findings);
        on_path(cell, spec, track, findings);
        speeds(cell, spec, recording, findings);
        in_view::check(cell, spec, recording, track, arms, findings);
        for member in &spec.members {
            distances(cell, spec, recording, (member.robot.0, &arms[member.robot.0]), findings);
            if let Some(collision) = recording.robots[member.robot.0].collisions.first() {
                findings.list.push(Finding::Touched { robot: member.robot.0, t_s: collision.t_s });
            }
        }
    }
}

/// The work-piece moves with the flange of the robot that holds it, and keeps its place while it changes hands.
fn held(
    cell: &Cell,
    spec: &CellVirtualRobot,
    recording: &Recording,
    track: &VirtualRobotTrack,
    arms: &[Arm],
    findings: &mut Findings,
) {
    let mut known: Option<(usize, Frame)> = None;
    for (k, sample) in track.samples.iter().enumerate() {
        let robot = spec.members[sample.holder].robot.0;
        // The sample is the end of the tick.
        let Some(state) = recording.robots[robot].samples.get(k + 1) else { return };
        let flange = arms[robot].frames(&state.q)[cell.robots[robot].flange.0];
        let part = Frame::of(&sample.part_in_world);
        let in_hand = part.seen_from(&flange);
        match known {
            Some((holder, before)) if holder == robot => {
                let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
                let moved = corners.iter().map(|p| in_hand.point(*p).distance(before.point(*p))).fold(0.0, f64::max);
                if !(moved <= RIGID_M) {
                    findings.list.push(Finding::NotHeld { robot, t_s: state.t_s, by_m: moved });
                    return;
                }
            }
            _ => known = Some((robot, in_hand)),
        }
    }
}

/// The work-piece is on the line through the desired poses that have come so far.
fn on_path(cell: &Cell, spec: &CellVirtualRobot, track: &VirtualRobotTrack, findings: &mut Findings) {
    let mut corners = vec![cell.objects[spec.work_piece.0].in_world.translation];
    for sample in &track.samples {
        if let OperatorInput::Pose(pose) = spec.stream.at(sample.t_s)
            && corners.last() != Some(&pose.translation)
        {
            corners.push(pose.translation);
        }
        let p = sample.part_in_world.translation;
        let off = |w: &[Vec3]| {
            let (along, to) = (w[1] - w[0], p - w[0]);
            let share = (along.dot(to) / along.length_squared().max(1e-30)).clamp(0.0, 1.0);
            (to - along * share).length()
        };
        let off_m = corners.windows(2).map(off).fold((p - corners[0]).length(), f64::min);
        if !(off_m <= TOLERANCE_M) {
            findings.list.push(Finding::OffPath { t_s: sample.t_s, off_m });
            return;
        }
    }
}

fn speeds(cell: &Cell, spec: &CellVirtualRobot, recording: &Recording, findings: &mut Findings) {
    for robot in spec.members.iter().map(|m| m.robot.0) {
        for w in recording.robots[robot].samples.windows(2) {
            let moves = w[0].q.iter().zip(&w[1].q).zip(&cell.robots[robot].limits);
            let speed = |((a, b), l): ((&f64, &f64), &elbowroom_kinematics::JointLimits)| {
                (b - a).abs() / recording.tick_s / l.velocity
            };
            let share = moves.map(speed).fold(0.0, f64::max);
            if !(share <= 1.0 + 1e-6) {
                findings.list.push(Finding::TooFast { robot, t_s: w[1].t_s, share });
                return;
            }
        }
    }
}

/// The arm and the work-piece touch no object.
fn distances(
    cell: &Cell,
    spec: &CellVirtualRobot,
    recording: &Recording,
    (robot, arm): (usize, &Arm),
    findings: &mut Findings,
) {
    let bar = OracleSolid::eroded(&cell.objects[spec.work_piece.0].shape, 0.0);
    let parts = Guarded::all(&cell.robots[robot]);
    let track = recording.virtual_robots.iter().find(|t| t.name == spec.name);
    for (object, o) in cell.objects.iter().enumerate().filter(|(object, _)| *object != spec.work_piece.0) {
        let (solid, at) = (OracleSolid::eroded(&o.shape, 0.0), Frame::of(&o.in_world));
        // How much nearer it may have come than at the last measurement, m.
        let mut slack_m = 0.0;
        let mut before: Option<&[f64]> = None;
        let levers: Vec<Vec<f64>> = parts.iter().map(|part| arm.lever_arms(part.link, part.radius_m)).collect();
        for (k, sample) in recording.robots[robot].samples.iter().enumerate() {
            let moved = |lever: &Vec<f64>| -> f64 {
                let before = before.unwrap_or(&sample.q);
                sample.q.iter().zip(before).zip(lever).map(|((a, b), lever)| (a - b).abs() * lever).sum()
            };
            slack_m -= levers.iter().map(moved).fold(0.0, f64::max);
            before = Some(&sample.q);
            let mut nearest = f64::INFINITY;
            if slack_m <= 0.0 {
                let frames = arm.frames(&sample.q);
                let all = parts.iter().map(|part| part.distance(&frames, &solid, &at, FAR_M));
                let (lower, upper) =
                    all.fold((f64::INFINITY, f64::INFINITY), |n, b| (n.0.min(b.lower), n.1.min(b.upper)));
                (slack_m, nearest) = (lower, upper);
            }
            let carried = k.checked_sub(1).and_then(|k| track?.samples.get(k));
            if let Some(carried) = carried.filter(|s| spec.members[s.holder].robot.0 == robot) {
                nearest = nearest.min(bar.distance(&Frame::of(&carried.part_in_world), &solid, &at, FAR_M).upper);
            }
            if nearest <= 0.0 {
                findings.list.push(Finding::TooNear {
                    robot,
                    object,
                    t_s: sample.t_s,
                    distance_m: nearest,
                    least_m: 0.0,
                });
                return;
            }
        }
    }
}
