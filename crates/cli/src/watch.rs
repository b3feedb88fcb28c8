//! `elbowroom watch`: what a camera of a cell sees, picture by picture.

use std::fmt::Write;

use elbowroom::analysis::watch::{CameraWatch, WatchRecord, WatchRequest, WatchStatus};
use elbowroom::cell::Cell;

use crate::args::WatchArgs;
use crate::output::{ExitStatus, Failure, note, print};

pub(crate) fn watch(args: &WatchArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let request =
        WatchRequest { camera: args.camera.clone(), frames: args.frames.clone(), joints: args.joints.clone() };
    let mut watch = CameraWatch::new(&cell, &request)?;
    watch.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let mut summary = Summary::default();
    if !args.json {
        print("     t, s  picture               obstacles   blocked cells\n")?;
    }
    for index in 0..watch.frames() {
        let record = watch.record(index);
        if args.json {
            let line = serde_json::to_string(&record).map_err(|e| Failure::Wrong(e.to_string()))?;
            print(&format!("{line}\n"))?;
        } else if summary.is_news(&record) {
            print(&row(&record))?;
        }
        summary.add(&record);
    }
    if !args.json {
        print(&summary.text())?;
    }
    if summary.accepted == 0 {
        note(
            "warning: no picture was accepted: the first ones must show the empty cell (learning_frames), more must follow",
        );
    }
    Ok(ExitStatus::Success)
}

/// A line of the table: what changed.
fn row(record: &WatchRecord) -> String {
    let mut line =
        format!("{:9.3}  {:20}  {:9}  {:14}", record.t_s, record.frame, record.obstacles.len(), record.blocked);
    for (ids, word) in [(&record.entered, "entered"), (&record.left, "left")] {
        for id in ids {
            let known = record.obstacles.iter().find(|o| o.id == *id);
            let place = known.map(|o| format!(" at {:.3}, {:.3} m", o.centre_m[0], o.centre_m[1])).unwrap_or_default();
            let kind = known.and_then(|o| o.kind.as_deref()).map(|kind| format!(" ({kind})")).unwrap_or_default();
            // Writing to a text cannot fail.
            let _ = write!(line, "  #{id}{kind} {word}{place}");
        }
    }
    if let Some(reason) = &record.reason {
        let _ = write!(line, "  rejected: {reason}");
    }
    line.push('\n');
    line
}

/// What was seen in all pictures.
#[derive(Default)]
struct Summary {
    last: Option<WatchStatus>,
    learning: usize,
    accepted: usize,
    rejected: usize,
    entered: usize,
    times_us: Vec<u64>,
}

impl Summary {
    /// True where an obstacle enters or leaves, and where pictures begin or cease to be accepted.
    fn is_news(&self, record: &WatchRecord) -> bool {
        !record.entered.is_empty() || !record.left.is_empty() || self.last != Some(record.status)
    }

    fn add(&mut self, record: &WatchRecord) {
        self.last = Some(record.status);
        self.entered += record.entered.len();
        match record.status {
            WatchStatus::Learning => self.learning += 1,
            WatchStatus::Rejected => self.rejected += 1,
            WatchStatus::Accepted => {
                self.accepted += 1;
                self.times_us.push(record.time_us);
            }
        }
    }

    fn text(&mut self) -> String {
        let Self { learning, accepted, rejected, entered, times_us, .. } = self;
        times_us.sort_unstable();
        let median = times_us
            .get(times_us.len() / 2)
            .map_or_else(String::new, |us| format!("; {:.1} ms from picture to map in the median", *us as f64 / 1e3));
        format!(
            "\n{learning} pictures learnt, {accepted} accepted, {rejected} rejected; {entered} obstacles entered{median}\n"
        )
    }
}
