//! Check that a monitor stops its robot exactly at readings beyond the joint limits.

use elbowroom_cell::Cell;
use elbowroom_monitor::{Fault, OverrideReason};
use elbowroom_robot::RobotId;
use elbowroom_sim::{InputFault, InputFaultKind, Recording};

use super::findings::{Finding, Findings};

/// Largest overshoot of a robot that states none, rad or m.
const DEFAULT_OVERSHOOT: f64 = 0.05;
/// Rounding of readings, rad or m.
const ROUNDING: f64 = 1e-6;

/// Finds readings farther beyond the limits than tolerated at which a robot moved on, and readings within them that were
/// reported as beyond. Only faults that shift a joint are compared: the others hide the reading.
pub fn check(cell: &Cell, recording: &Recording, faults: &[InputFault], findings: &mut Findings) {
    for (robot, track) in recording.robots.iter().enumerate() {
        let chain = &cell.robots[robot].robot.chain;
        let limits: Vec<_> = chain.active_joints().iter().map(|id| chain.joints()[id.0].limits).collect();
        for sample in &track.samples {
            let is_active =
                |f: &&InputFault| f.robot == RobotId(robot) && f.from_s <= sample.t_s && sample.t_s < f.to_s;
            let shift = match faults.iter().find(is_active).map(|f| f.kind) {
                None => None,
                Some(InputFaultKind::Jump { joint, by }) => Some((joint, by)),
                Some(_) => continue,
            };
            let beyond = |joint: usize| {
                let reading = sample.q[joint] + shift.filter(|(j, _)| *j == joint).map_or(0.0, |(_, by)| by);
                let tolerance = limits[joint].overshoot_tolerance.unwrap_or(DEFAULT_OVERSHOOT) + ROUNDING;
                reading < limits[joint].lower - tolerance || reading > limits[joint].upper + tolerance
            };
            let ignored = (0..limits.len()).find(|joint| beyond(*joint) && sample.speed_override > 0.0);
            let invented = match sample.reason {
                OverrideReason::Fault(Fault::BeyondLimits { joint, .. }) if !beyond(joint) => Some(joint),
                _ => None,
            };
            if let Some(joint) = ignored.or(invented) {
                let stopped = ignored.is_none();
                findings.list.push(Finding::MisreadLimits { robot, joint, t_s: sample.t_s, stopped });
                break;
            }
        }
    }
}
