//! When a robot moved last, in words.

use elbowroom_sim::RobotTrack;

/// Below this speed (m/s) a TCP counts as stationary.
pub const STATIONARY_M_S: f64 = 1e-4;

/// Until when a mechanism moved.
pub fn moved_until(mechanism: &RobotTrack) -> String {
    match mechanism.ending.stopped_at_s {
        Some(t_s) if t_s > 0.0 => format!("a mechanism, moved until {t_s:.2} s"),
        Some(_) => "a mechanism, did not move".into(),
        None => "a mechanism, still moving at the end".into(),
    }
}

/// When a robot finished. A robot without a program has nothing to finish.
pub fn finished_at(robot: &RobotTrack) -> String {
    let [first, .., last] = &robot.samples[..] else { return "did not move".into() };
    if robot.samples.iter().all(|s| s.q == first.q) {
        return "did not move".into();
    }
    format!("finished at {:.2} s", last_motion_s(robot).unwrap_or(last.t_s))
}

/// Time of the last motion of the TCP, s; `None` if it never moved.
fn last_motion_s(robot: &RobotTrack) -> Option<f64> {
    robot.samples.iter().rfind(|s| s.tcp_speed > STATIONARY_M_S).map(|s| s.t_s)
}
