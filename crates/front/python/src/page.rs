//! HTML pages that need no network: of a cell, a path, a robot.

use elbowroom::cell::Cell;
use elbowroom::inspect::box_levels;
use elbowroom::kinematics::JointTrajectory;
use elbowroom::report::{ReportScene, levels_page, write_html};
use elbowroom::robot::{Robot, RobotId};
use elbowroom::sim::{Recording, playback, simulate};

use crate::error::Fault;

/// The report of a recording.
pub fn of_recording(cell: &Cell, label: &str, recording: &Recording) -> Result<String, Fault> {
    written(|page| write_html(page, &ReportScene::of_cell(cell), &[(label, recording)]))
}

/// A cell in which robots play motions; the others are at their start.
pub fn of_motions(cell: &Cell, label: &str, motions: Vec<(RobotId, JointTrajectory)>) -> Result<String, Fault> {
    let (cell, options) = playback(cell, motions);
    of_recording(&cell, label, &simulate(&cell, &options)?.recording)
}

/// A robot in 3-D, with a slider per joint.
pub fn of_robot(robot: &Robot) -> Result<String, Fault> {
    let levels = box_levels(robot).map_err(|e| Fault::Argument(format!("the page: {e}")))?;
    written(|page| levels_page::write(page, robot.chain.name(), robot, &levels))
}

fn written(write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()>) -> Result<String, Fault> {
    let mut page = Vec::new();
    let text = write(&mut page).and_then(|()| String::from_utf8(page).map_err(std::io::Error::other));
    text.map_err(|e| Fault::Argument(format!("the page: {e}")))
}
