//! `elbowroom watch`: the obstacles that a camera or point-cloud source of a cell detects, picture by picture.

use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use elbowroom::cell::Cell;
use elbowroom::formats::PngStream;
use elbowroom::query::watch::{SensorWatch, WatchInput, WatchRecord, WatchRequest, WatchStatus};

use crate::args::WatchArgs;
use crate::output::{ExitStatus, Failure, note, print};

pub(crate) fn watch(args: &WatchArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let is_stream = args.frames.as_deref() == Some(Path::new("-"));
    let period_s = period_s(args.fps, is_stream)?;
    let input = match (&args.frames, &args.clouds) {
        (Some(_), _) if is_stream => WatchInput::Stream,
        (Some(folder), _) => WatchInput::Pictures(folder.clone()),
        (None, Some(folder)) => WatchInput::Clouds(folder.clone()),
        (None, None) => WatchInput::CellFile,
    };
    let request = WatchRequest { sensor: args.camera.clone(), input, joints: args.joints.clone() };
    let mut watch = SensorWatch::new(&cell, &request)?;
    note_warnings(&mut watch);
    let mut output = WatchOutput::begin(args.json)?;
    if is_stream {
        watch_stream(&mut watch, period_s, &mut output)?;
    } else {
        for index in 0..watch.files().len() {
            output.add(&watch.record(index))?;
            note_warnings(&mut watch);
        }
    }
    output.end()?;
    Ok(ExitStatus::Success)
}

fn note_warnings(watch: &mut SensorWatch) {
    watch.warnings.drain(..).for_each(|w| note(format_args!("warning: {w}")));
}

/// Returns the period of `--fps`, s.
fn period_s(fps: Option<f64>, is_stream: bool) -> Result<Option<f64>, Failure> {
    match fps {
        Some(_) if !is_stream => {
            Err(Failure::Wrong("--fps is for a stream of pictures: write --frames -, or leave it out".into()))
        }
        Some(fps) if !(fps.is_finite() && fps > 0.0) => {
            Err(Failure::Wrong(format!("--fps {fps} is no rate: write a number above 0, such as --fps 25")))
        }
        fps => Ok(fps.map(|fps| 1.0 / fps)),
    }
}

/// Processes the pictures of standard input as they arrive.
fn watch_stream(watch: &mut SensorWatch, period_s: Option<f64>, output: &mut WatchOutput) -> Result<(), Failure> {
    let mut stream = PngStream::new(std::io::stdin().lock());
    let begin = Instant::now();
    for index in 0_u64.. {
        let picture = stream.next_picture().map_err(|e| {
            let instead =
                "PNG pictures one after another: ffmpeg … -f image2pipe -c:v png - | elbowroom watch … --frames -";
            Failure::Wrong(format!("standard input, picture {index}: {e}\n  write: {instead}"))
        })?;
        let Some(picture) = picture else { break };
        let t_s = period_s.map_or_else(|| begin.elapsed().as_secs_f64(), |period_s| index as f64 * period_s);
        output.add(&watch.record_bytes(&picture, Path::new(&format!("picture {index}")), t_s))?;
        note_warnings(watch);
    }
    Ok(())
}

/// Prints records, as JSON lines or as a table of changes.
struct WatchOutput {
    json: bool,
    summary: Summary,
}

impl WatchOutput {
    fn begin(json: bool) -> Result<Self, Failure> {
        if !json {
            print("     t, s  picture               obstacles   blocked cells\n")?;
        }
        Ok(Self { json, summary: Summary::default() })
    }

    fn add(&mut self, record: &WatchRecord) -> Result<(), Failure> {
        if self.json {
            let line = serde_json::to_string(record).map_err(|e| Failure::Wrong(e.to_string()))?;
            print(&format!("{line}\n"))?;
        } else if self.summary.is_news(record) {
            print(&row(record))?;
        }
        self.summary.add(record);
        Ok(())
    }

    fn end(mut self) -> Result<(), Failure> {
        if !self.json {
            print(&self.summary.text())?;
        }
        if self.summary.accepted == 0 {
            note(
                "warning: no picture was accepted: the first ones must show the empty cell (learning_frames), more must follow",
            );
        }
        Ok(())
    }
}

/// Formats a line of the table: the changes of one picture.
fn row(record: &WatchRecord) -> String {
    let mut line =
        format!("{:9.3}  {:20}  {:9}  {:14}", record.t_s, record.frame, record.obstacles.len(), record.blocked);
    for (ids, word) in [(&record.entered, "entered"), (&record.left, "left")] {
        for id in ids {
            let known = record.obstacles.iter().find(|o| o.id == *id);
            let place = known.map(|o| format!(" at {:.3}, {:.3} m", o.centre_m[0], o.centre_m[1])).unwrap_or_default();
            let kind = known.and_then(|o| o.kind.as_deref()).map(|kind| format!(" ({kind})")).unwrap_or_default();
            // Writing to a String cannot fail.
            let _ = write!(line, "  #{id}{kind} {word}{place}");
        }
    }
    if let Some(reason) = &record.reason {
        let _ = write!(line, "  rejected: {reason}");
    }
    line.push('\n');
    line
}

/// Totals over all pictures.
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
    /// Whether an obstacle enters or leaves, or the status of the picture differs from the last one.
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
