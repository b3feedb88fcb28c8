//! Whether the simulation keeps to the joints' limits: a run in which robots brake harder than they can proves nothing.

use elbowroom_cell::Cell;
use elbowroom_sim::Recording;

use super::findings::{Finding, Findings};

/// Beyond the larger of stop and programmed acceleration by this share: a stop keeps a tenth in reserve for the curve.
const SHARE: f64 = 0.12;
/// And by what the rounding of positions can make of a second difference, in units of position.
const ROUNDING: f64 = 2e-9;

/// Looks for joints that slow down harder than the larger of their stopping deceleration and programmed acceleration.
pub fn check(cell: &Cell, recording: &Recording, findings: &mut Findings) {
    let dt = recording.tick_s;
    for (robot, track) in recording.robots.iter().enumerate() {
        for (joint, l) in cell.robots[robot].limits.iter().enumerate() {
            let limit = l.stop.max(l.acceleration) * (1.0 + SHARE) + ROUNDING / (dt * dt);
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
