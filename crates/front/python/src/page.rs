//! HTML pages that need no network: of a cell, a path, a robot.

use std::path::Path;

use elbowroom::cell::Cell;
use elbowroom::inspect::{InspectOptions, Inspection};
use elbowroom::kinematics::JointTrajectory;
use elbowroom::report::{ReportScene, model_picture, write_html};
use elbowroom::robot::RobotId;
use elbowroom::sim::{Recording, playback, simulate};

use crate::error::Fault;

/// The report of a recording.
pub fn of_recording(cell: &Cell, label: &str, recording: &Recording) -> Result<String, Fault> {
    written(|page| write_html(page, &ReportScene::of_cell(cell), &[(label, recording)]))
}

/// A cell in which a robot plays a motion, or without one at its start.
pub fn of_motion(cell: &Cell, label: &str, motion: Option<(RobotId, JointTrajectory)>) -> Result<String, Fault> {
    let (cell, options) = playback(cell, motion);
    of_recording(&cell, label, &simulate(&cell, &options)?.recording)
}

/// Four views of a robot, with its joints.
pub fn of_robot(path: &Path, options: &InspectOptions) -> Result<String, Fault> {
    let inspection = Inspection::of(path, options)?;
    written(|page| model_picture::write_page(&inspection, None, page))
}

fn written(write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()>) -> Result<String, Fault> {
    let mut page = Vec::new();
    let text = write(&mut page).and_then(|()| String::from_utf8(page).map_err(std::io::Error::other));
    text.map_err(|e| Fault::Argument(format!("the page: {e}")))
}
