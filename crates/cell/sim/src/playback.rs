//! Cells in which robots play motions that are planned already.

use elbowroom_cell::{Cell, Program, ProgramBody, Travel};
use elbowroom_kinematics::JointTrajectory;
use elbowroom_robot::RobotId;

use crate::RunOptions;

/// Returns a cell in which these robots play their motions, and the options of the run.
///
/// As in a plan, all other robots stay at their start and objects at their first poses; nothing is perceived, and the
/// monitors do not limit the speed, so the times are those of the motions. Without motions the run is the cell at its start.
pub fn playback(cell: &Cell, motions: impl IntoIterator<Item = (RobotId, JointTrajectory)>) -> (Cell, RunOptions) {
    // The copy has the shields that are made already.
    for fixture in &cell.guidance.fixtures {
        let _ = fixture.shield(cell);
    }
    let mut cell = cell.clone();
    cell.sensors.clear();
    for robot in &mut cell.robots {
        (robot.program, robot.avoidance) = (None, None);
    }
    cell.guidance.operators.clear();
    cell.guidance.virtual_robots.clear();
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
    (cell, RunOptions { apply_override: false, avoidance: false, ..RunOptions::default() })
}
