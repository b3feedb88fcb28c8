//! Check that the simulation respects the joints' limits: a run in which robots brake harder than they can proves nothing.

use elbowroom_cell::{Cell, ProgramBody};
use elbowroom_kinematics::TrajectoryRow;
use elbowroom_robot::RobotId;
use elbowroom_sim::Recording;

use super::findings::{Finding, Findings};

/// Tolerated relative excess over the larger of stop and programmed acceleration: a stop keeps a tenth in reserve for
/// the curve.
const SHARE: f64 = 0.12;
/// Largest rounding error of a second difference of positions, in units of position.
const ROUNDING: f64 = 2e-9;

/// Finds joints that decelerate harder than the larger of their stopping deceleration and programmed acceleration, plus
/// the changes of velocity in the recording that they play.
pub fn check(cell: &Cell, recording: &Recording, findings: &mut Findings) {
    let dt = recording.tick_s;
    // A surface stops a guided tool as fast as it must, and a proof a robot that acts with others.
    let is_guided = |robot: usize| {
        let (guidance, robot) = (&cell.guidance, RobotId(robot));
        guidance.operator_of(robot).is_some() || guidance.virtual_robot_of(robot).is_some()
    };
    for (robot, track) in recording.robots.iter().enumerate().filter(|(robot, _)| !is_guided(*robot)) {
        for (joint, l) in cell.robots[robot].limits.iter().enumerate() {
            let played = played(cell, robot).map_or(0.0, |rows| largest_change(rows, joint, dt) / dt);
            let limit = (l.stop.max(l.acceleration) + played) * (1.0 + SHARE) + ROUNDING / (dt * dt);
            let found = track.samples.windows(3).find_map(|w| {
                let (before, after) = (w[1].q[joint] - w[0].q[joint], w[2].q[joint] - w[1].q[joint]);
                let slower = before.abs() - after.abs();
                let deceleration = slower / (dt * dt);
                (before * after >= 0.0 && deceleration > limit).then_some((w[2].t_s, deceleration))
            });
            if let Some((t_s, deceleration)) = found {
                findings.list.push(Finding::TooHard { robot, joint, t_s, deceleration, limit });
                break;
            }
        }
    }
}

/// Returns the recording that a robot plays.
fn played(cell: &Cell, robot: usize) -> Option<&[TrajectoryRow]> {
    match &cell.robots[robot].program.as_ref()?.body {
        ProgramBody::Trajectory(trajectory) => Some(trajectory.rows()),
        ProgramBody::Steps(_) => None,
    }
}

/// Returns the largest change of a joint's velocity within two ticks; the velocity is 0 before and after the recording.
fn largest_change(rows: &[TrajectoryRow], joint: usize, tick_s: f64) -> f64 {
    let rate = |w: &[TrajectoryRow]| (w[1].q[joint] - w[0].q[joint]) / (w[1].t_s - w[0].t_s);
    let moving = rows.windows(2).map(|w| (w[0].t_s, w[1].t_s, rate(w)));
    let at_rest = |t_s: f64| (t_s, t_s, 0.0);
    let mut pieces: Vec<(f64, f64, f64)> = rows.first().map(|r| at_rest(r.t_s)).into_iter().chain(moving).collect();
    pieces.extend(rows.last().map(|r| at_rest(r.t_s)));
    let mut largest: f64 = 0.0;
    for (i, (_, end_s, before)) in pieces.iter().enumerate() {
        let near = pieces[i + 1..].iter().take_while(|(begin_s, _, _)| begin_s - end_s <= 2.0 * tick_s);
        largest = near.map(|(_, _, after)| (after - before).abs()).fold(largest, f64::max);
    }
    largest
}
