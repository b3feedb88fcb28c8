//! `elbowroom plan --report`: the page of a run in which robots play their paths.

use std::path::Path;

use elbowroom::cell::{Cell, Program, ProgramBody, Travel};
use elbowroom::kinematics::JointTrajectory;
use elbowroom::report::{self, ReportScene};
use elbowroom::robot::RobotId;
use elbowroom::sim::RunOptions;

use crate::output::Failure;
use crate::output_file::write_file;
use crate::simulation::Simulation;

/// Writes the page.
///
/// As in the plan, all other robots stay at their start and objects at their initial poses; the monitor does not limit
/// the speed, so the times are those of the plan.
pub(crate) fn write(path: &Path, cell: &Cell, motions: Vec<(RobotId, JointTrajectory)>) -> Result<(), Failure> {
    let mut cell = cell.clone();
    for robot in &mut cell.robots {
        (robot.program, robot.avoidance) = (None, None);
    }
    cell.moving_objects.clear();
    for encoder in &mut cell.frame_sources.encoders {
        let (at_m, _) = encoder.at(0.0);
        encoder.travel = Travel::Constant { at_m, speed: 0.0, start_s: 0.0, end_s: 0.0 };
    }
    for (robot, trajectory) in motions {
        let Some(first) = trajectory.first() else { continue };
        let robot = &mut cell.robots[robot.0];
        robot.start = first.to_vec();
        let body = ProgramBody::Trajectory(trajectory);
        robot.program = Some(Program { speed_override: 1.0, repeat: 1, body, line: robot.line });
    }
    let options = RunOptions { apply_override: false, avoidance: false, ..RunOptions::default() };
    let played = Simulation::of(&cell).run(&options)?.recording;
    write_file(path, |out| report::write_html(out, &ReportScene::of_cell(&cell), &[("plan", &played)]))
}
