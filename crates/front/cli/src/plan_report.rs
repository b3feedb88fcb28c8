//! `elbowroom plan --report`: the page of a run in which robots play their paths.

use std::path::Path;

use elbowroom::cell::{Cell, Program, ProgramBody, TrajectoryRow, Travel};
use elbowroom::report::{self, ReportScene};
use elbowroom::robot::RobotId;
use elbowroom::sim::RunOptions;

use crate::output::Failure;
use crate::output_file::write_file;
use crate::simulation::Simulation;

/// A robot and the samples of its path: time in s, joint values in rad or m.
pub(crate) type PlayedPath = (RobotId, Vec<(f64, Vec<f64>)>);

/// Writes the page.
///
/// As in the plan, all other robots stay at their start and objects at their initial poses; the monitor does not limit
/// the speed, so the times are those of the plan.
pub(crate) fn write(path: &Path, cell: &Cell, paths: Vec<PlayedPath>) -> Result<(), Failure> {
    let mut cell = cell.clone();
    for robot in &mut cell.robots {
        (robot.program, robot.avoidance) = (None, None);
    }
    cell.moving_objects.clear();
    for encoder in &mut cell.frame_sources.encoders {
        let (at_m, _) = encoder.at(0.0);
        encoder.travel = Travel::Constant { at_m, speed: 0.0, start_s: 0.0, end_s: 0.0 };
    }
    for (robot, rows) in paths {
        let Some((_, first)) = rows.first() else { continue };
        let robot = &mut cell.robots[robot.0];
        robot.start.clone_from(first);
        let rows = rows.into_iter().map(|(t_s, q)| TrajectoryRow { t_s, q }).collect();
        let body = ProgramBody::Trajectory(rows);
        robot.program = Some(Program { speed_override: 1.0, repeat: 1, body, line: robot.line });
    }
    let options = RunOptions { apply_override: false, avoidance: false, ..RunOptions::default() };
    let played = Simulation::of(&cell).run(&options)?.recording;
    write_file(path, |out| report::write_html(out, &ReportScene::of_cell(&cell), &[("plan", &played)]))
}
