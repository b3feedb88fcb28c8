//! `elbowroom plan --report`: the page of a run in which robots play their paths.

use std::path::Path;

use elbowroom::cell::Cell;
use elbowroom::kinematics::JointTrajectory;
use elbowroom::report::{self, ReportScene};
use elbowroom::robot::RobotId;
use elbowroom::sim::playback;

use crate::output::Failure;
use crate::output_file::write_file;
use crate::simulation::Simulation;

/// Writes the page.
pub(crate) fn write(path: &Path, cell: &Cell, motions: Vec<(RobotId, JointTrajectory)>) -> Result<(), Failure> {
    let (cell, options) = playback(cell, motions);
    let played = Simulation::of(&cell).run(&options)?.recording;
    write_file(path, |out| report::write_html(out, &ReportScene::of_cell(&cell), &[("plan", &played)]))
}
