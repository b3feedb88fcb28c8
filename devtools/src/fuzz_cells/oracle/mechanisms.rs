//! Check that nothing slows a mechanism down: it moves by its program alone.

use elbowroom_cell::{Cell, CellRobot, ProgramBody, StepAction};
use elbowroom_sim::Recording;

use super::findings::{Finding, Findings};

/// Finds mechanisms that were slower than their programs say, or that a region concerns.
pub fn check(cell: &Cell, recording: &Recording, findings: &mut Findings) {
    for (robot, track) in recording.robots.iter().enumerate().filter(|(robot, _)| cell.robots[*robot].is_mechanism()) {
        let least = least_override(&cell.robots[robot]);
        let slowed = track.samples.iter().find(|s| s.speed_override < least);
        let is_guarded = cell.regions.iter().any(|r| r.robots.iter().any(|guarded| guarded.0 == robot));
        let t_s = slowed.map(|s| s.t_s).or(is_guarded.then_some(0.0));
        findings.list.extend(t_s.map(|t_s| Finding::Slowed { robot, t_s }));
    }
}

/// The smallest override that the program sets.
fn least_override(robot: &CellRobot) -> f64 {
    let Some(program) = &robot.program else { return 1.0 };
    let ProgramBody::Steps(steps) = &program.body else { return program.speed_override };
    let set = steps.iter().filter_map(|step| match step.action {
        StepAction::Override(fraction) => Some(fraction),
        _ => None,
    });
    set.fold(program.speed_override, f64::min)
}
