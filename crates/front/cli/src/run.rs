//! `elbowroom run`: a cell's programs in simulated time.

use std::path::Path;

use elbowroom::cell::Cell;
use elbowroom::cell::seal::Seal;
use elbowroom::report::{HtmlReport, ReportScene};
use elbowroom::sim::{Recording, RunOptions, RunSummary, SensorTrack, csv};

use crate::args::RunArgs;
use crate::live;
use crate::output::{ExitStatus, Failure, cannot_write, note, print, print_json, summary};
use crate::output_file::write_file;
use crate::simulation::Simulation;

pub(crate) fn run(args: &RunArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let options = RunOptions {
        apply_override: !args.no_monitor,
        avoidance: !args.no_avoidance,
        repeat: args.repeat,
        ..RunOptions::default()
    };
    let simulation = Simulation::of(&cell);
    if options.apply_override {
        simulation.warn_of_overruns()?;
    }
    let outcome = match &args.mcap {
        Some(file) => live::run_recorded(&simulation, &options, file)?,
        None => simulation.run(&options)?,
    };
    outcome.notes.iter().for_each(|w| note(format_args!("warning: {w}")));
    if let Some(dir) = &args.out {
        let without = if options.apply_override { planned(&simulation, &options)? } else { None };
        write_files(dir, &cell, &outcome.recording, without.as_ref(), args.compare)?;
    }
    if args.json {
        print_json(&Document { summary: RunSummary::from(&outcome.recording), seal: cell.approval.seal.as_ref() })?;
    } else {
        print(&summary(&outcome.recording))?;
        if let Some(seal) = &cell.approval.seal {
            print(&format!("\nSealed by {} ({}, key {}), {}\n", seal.name, seal.class, seal.key, seal.time))?;
        }
        if let Some(dir) = &args.out {
            print(&format!("\nFiles: {}\n", dir.join("{report.html,trace.csv,events.csv}").display()))?;
        }
        if let Some(file) = &args.mcap {
            print(&format!("\nRecording: {}\n", file.display()))?;
        }
    }
    Ok(if outcome.has_violation() { ExitStatus::NegativeResult } else { ExitStatus::Success })
}

/// Runs without the monitor; the report shows the distances beside those of the monitored run. Robots may meet that the
/// monitor keeps apart: if a program cannot continue then, there is no comparison.
fn planned(simulation: &Simulation<'_>, options: &RunOptions) -> Result<Option<Recording>, Failure> {
    match simulation.run(&RunOptions { apply_override: false, ..options.clone() }) {
        Ok(outcome) => Ok(Some(outcome.recording)),
        Err(Failure::Wrong(why)) => {
            note(format_args!("warning: no comparison with the run without the monitor: {why}"));
            Ok(None)
        }
        Err(closed) => Err(closed),
    }
}

/// The summary of a run, and the seal of a sealed cell.
#[derive(serde::Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    summary: RunSummary,
    #[serde(skip_serializing_if = "Option::is_none")]
    seal: Option<&'a Seal>,
}

/// Writes trace, events and the report.
///
/// `without` is the run without the monitor: the report shows its distances, with `compare` all of it.
pub(crate) fn write_files(
    dir: &Path,
    cell: &Cell,
    run: &Recording,
    without: Option<&Recording>,
    compare: bool,
) -> Result<(), Failure> {
    std::fs::create_dir_all(dir).map_err(cannot_write(dir))?;
    write_file(&dir.join("trace.csv"), |out| csv::write_trace(run, out))?;
    write_file(&dir.join("events.csv"), |out| csv::write_events(run, out))?;
    if run.robots.iter().any(|robot| robot.guidance.is_some()) {
        write_file(&dir.join("operator.csv"), |out| csv::write_operators(run, out))?;
    }
    if !run.virtual_robots.is_empty() {
        write_file(&dir.join("work_piece.csv"), |out| csv::write_work_pieces(run, out))?;
    }
    for sensor in &run.sensors {
        write_records(&dir.join(format!("{}-{}.jsonl", sensor.kind, sensor.name)), sensor)?;
    }
    let scene = ReportScene::of_cell(cell);
    let label = if run.monitored { "monitor on" } else { "monitor off" };
    let second = without.filter(|_| compare).map(|w| ("monitor off", w));
    let runs: Vec<(&str, &Recording)> = std::iter::once((label, run)).chain(second).collect();
    let mut page = HtmlReport::new(&scene, &runs);
    if let Some(without) = without {
        page = page.planned(without);
    }
    write_file(&dir.join("report.html"), |out| page.write(out))
}

/// Writes the records of a sensor: one JSON document per line for each picture or cloud, as `watch --json` prints it.
fn write_records(path: &Path, sensor: &SensorTrack) -> Result<(), Failure> {
    write_file(path, |out| {
        sensor.records.iter().try_for_each(|record| writeln!(out, "{}", serde_json::to_string(record)?))
    })
}
