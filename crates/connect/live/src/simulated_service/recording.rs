//! The recording of a simulated node: when the node ends, its ticks must give the same answers again.

use std::path::{Path, PathBuf};

use elbowroom_cell::Cell;
use elbowroom_recording::{BagError, CellWriter, Recorder, replay};

/// A recording that a node writes.
pub(super) struct NodeRecording {
    pub(super) recorder: Recorder,
    file: PathBuf,
}

impl NodeRecording {
    pub(super) fn start(cell: &Cell, folder: &Path, boot: u64) -> Self {
        let file = folder.join(format!("{boot}.mcap"));
        let writer = CellWriter::create(&file, cell, boot).unwrap_or_else(|e| panic!("{e}"));
        let recorder = Recorder::start(writer, |e| panic!("{e}")).unwrap_or_else(|e| panic!("{e}"));
        Self { recorder, file }
    }

    /// Completes the recording, and replays it. Returns the number of ticks, and what differs.
    pub(super) fn finish(self) -> (u64, Option<String>) {
        self.recorder.finish().unwrap_or_else(|e| panic!("{e}"));
        let bytes = std::fs::read(&self.file).expect("a recording");
        match replay(&bytes[..]) {
            Ok(replay) => {
                let first = replay.robots.iter().find_map(|robot| robot.first.clone());
                (replay.ticks, first.map(|first| format!("a replay differs: {first:?}")))
            }
            // The node ended before its first tick.
            Err(BagError::NothingToReplay { .. }) => (0, None),
            Err(e) => (0, Some(format!("a recording cannot be replayed: {e}"))),
        }
    }
}
