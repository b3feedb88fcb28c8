//! `elbowroom check`: whether the laws exclude entry, and what is missing.

use elbowroom::cell::Cell;
use elbowroom::sim::check::{EntryCheck, recordings, table};
use elbowroom::sim::check_starts;
use serde::Serialize;

use crate::args::CheckArgs;
use crate::output::{ExitStatus, Failure, note, print, print_json};
use crate::simulation::Simulation;

#[derive(Serialize)]
struct Document<'a> {
    cell: &'a str,
    checksum: &'a str,
    regions: Vec<Row<'a>>,
}

#[derive(Serialize)]
struct Row<'a> {
    /// Name of the region.
    name: &'a str,
    robot: &'a str,
    kind: &'static str,
    excluded: bool,
    reason: &'a str,
    /// The keys to write into the cell file, if something is missing.
    write: Option<&'a str>,
    warning_m: f64,
    needed_warning_m: Option<f64>,
}

pub(crate) fn check(args: &CheckArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let checks = Simulation::of(&cell).check()?;
    for w in check_starts(&cell)?.into_iter().chain(recordings(&cell)) {
        note(format_args!("warning: {w}"));
    }
    if args.json {
        print_json(&Document {
            cell: &cell.name,
            checksum: &cell.approval.checksum,
            regions: checks.iter().map(|c| row(&cell, c)).collect(),
        })?;
    } else {
        print(&table(&cell, &checks))?;
    }
    Ok(if checks.iter().any(|c| c.is_bad(&cell)) { ExitStatus::NegativeResult } else { ExitStatus::Success })
}

fn row<'a>(cell: &'a Cell, check: &'a EntryCheck) -> Row<'a> {
    let region = &cell.regions[check.region.0].region;
    Row {
        name: &region.name,
        robot: &cell.robots[check.robot.0].name,
        kind: region.kind.name(),
        excluded: check.excluded,
        reason: &check.reason,
        write: check.write_instead.as_deref(),
        warning_m: region.warning_m,
        needed_warning_m: check.needed_warning_m,
    }
}
