//! `elbowroom region export`: regions as zones of a robot's controller.

use elbowroom::cell::{Cell, ExportedRegion, ZoneExport, ZoneFrame, export_zones};
use elbowroom::query::plan::select_robot;
use serde::Serialize;

use super::args::ExportArgs;
use crate::output::{ExitStatus, Failure, note, print, print_json};
use crate::output_file::write_bytes;

#[derive(Serialize)]
struct Document<'a> {
    cell: &'a str,
    robot: &'a str,
    language: &'static str,
    /// Link or world in which the zones are given.
    /// The link whose frame it is; null for the world of the cell.
    frame: Option<&'a str>,
    regions: Vec<Row<'a>>,
    /// The text for the controller.
    text: &'a str,
}

#[derive(Serialize)]
struct Row<'a> {
    name: &'a str,
    kind: &'static str,
    /// Names of its zones in the text.
    zones: &'a [String],
    /// What of it the text does not express.
    missing: Vec<Missing<'a>>,
}

#[derive(Serialize)]
struct Missing<'a> {
    reason: &'a str,
    write: Option<&'a str>,
}

pub(super) fn export(args: &ExportArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let (id, robot) = select_robot(&cell, args.robot.as_deref())?;
    if robot.is_mechanism() {
        let what = format!("robot \"{}\" is a mechanism: no region applies to it, so it has no zones", robot.name);
        return Err(Failure::Wrong(format!("{what}\n  write: --robot with the name of a robot that is guarded")));
    }
    let frame = ZoneFrame::new(&cell, id, args.frame.as_deref())?;
    let language = args.to.into();
    let exported = export_zones(&cell, id, &frame, language);
    for missing in exported.regions.iter().flat_map(|region| &region.missing) {
        note(format_args!("not expressed: {missing}"));
    }
    if let Some(path) = &args.out {
        write_bytes(path, &exported.text)?;
        note(format_args!("wrote {}: {}", path.display(), counts(&exported)));
    }
    if args.json {
        let regions = exported.regions.iter().map(|region| row(&cell, region)).collect();
        let (cell, robot, frame) = (&cell.name, &robot.name, frame.link.as_deref());
        print_json(&Document { cell, robot, language: language.name(), frame, regions, text: &exported.text })?;
    } else if args.out.is_none() {
        print(&exported.text)?;
    }
    Ok(if exported.is_complete() { ExitStatus::Success } else { ExitStatus::NegativeResult })
}

fn counts(exported: &ZoneExport) -> String {
    let written = exported.regions.iter().filter(|region| !region.zones.is_empty()).count();
    format!("zones for {written} of {} regions", exported.regions.len())
}

fn row<'a>(cell: &'a Cell, exported: &'a ExportedRegion) -> Row<'a> {
    let region = &cell.regions[exported.region.0].region;
    let missing = exported.missing.iter().map(|m| Missing { reason: &m.message, write: m.hint.as_deref() }).collect();
    Row { name: &region.name, kind: region.kind.name(), zones: &exported.zones, missing }
}
