//! `elbowroom convert log.mcap log.csv`.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::Path;

use elbowroom::Diagnostic;
use elbowroom::recording::JointRecording;

use crate::output::{ExitStatus, Failure, cannot_read, cannot_write, note, print};

/// Writes the joint states of a ROS 2 recording as a table.
pub(crate) fn convert_recording(recording: &Path, topic: Option<&str>, to: &Path) -> Result<ExitStatus, Failure> {
    let bytes = File::open(recording).map_err(cannot_read(recording))?;
    let read = JointRecording::read(BufReader::new(bytes), topic);
    let read = read.map_err(|e| Diagnostic::new(recording, None, e))?;
    if read.cut_off {
        note("warning: the recording was cut off: it is read up to its last complete chunk");
    }
    let out = File::create_new(to).map(BufWriter::new).map_err(cannot_write(to))?;
    read.write_csv(out).map_err(cannot_write(to))?;
    let duration_s = read.rows.last().map_or(0.0, |(t_s, _)| *t_s);
    print(&format!(
        "{}: {} rows of {} joints, {duration_s:.3} s, from {}\n",
        to.display(),
        read.rows.len(),
        read.joints.len(),
        read.topic
    ))?;
    Ok(ExitStatus::Success)
}
