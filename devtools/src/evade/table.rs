//! Table of `--csv`: a row per run.

use std::fs::File;
use std::io::Write;
use std::path::Path;

use elbowroom_avoidance::AvoiderState;

use super::comparison::RunComparison;

/// States with a column for their time.
const STATES: [AvoiderState; 6] = [
    AvoiderState::Following,
    AvoiderState::Evading,
    AvoiderState::Returning,
    AvoiderState::Detouring,
    AvoiderState::Waiting,
    AvoiderState::Halted,
];

/// The file of the table.
pub struct Table(File);

impl Table {
    /// Writes the first line.
    pub fn create(path: &Path) -> std::io::Result<Self> {
        let mut file = File::create(path)?;
        let states = STATES.map(|s| format!("{}_s", s.name())).join(",");
        writeln!(file, "run,hit_without,hit_with,finished,extra_s,{states},plans")?;
        Ok(Self(file))
    }

    /// Writes the line of a run.
    pub fn add(&mut self, run: &RunComparison) -> std::io::Result<()> {
        writeln!(self.0, "{}", row(run))
    }
}

/// Formats the line of a run.
fn row(RunComparison { number, off, on }: &RunComparison) -> String {
    let (without, with) = (&off.robots[0], &on.robots[0]);
    let hits = [without, with].map(|track| u8::from(!track.collisions.is_empty()));
    let samples = with.avoidance.iter().flat_map(|track| &track.samples);
    let mut times_s = [0.0; STATES.len()];
    for sample in samples {
        if let Some(state) = STATES.iter().position(|s| *s == sample.state) {
            times_s[state] += on.tick_s;
        }
    }
    let times = times_s.map(|t| format!("{t:.3}")).join(",");
    let plans = with.avoidance.as_ref().map_or(0, |track| track.plans.len());
    let (finished, extra_s) = (u8::from(with.finished), on.duration_s - off.duration_s);
    format!("{number},{},{},{finished},{extra_s:.3},{times},{plans}", hits[0], hits[1])
}
