//! `elbowroom map`: the joint-space occupancy of a cell's objects.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use elbowroom::cell::Cell;
use elbowroom::cspace::{GridAxis, ObstacleModel};
use elbowroom::formats::WholeFile;
use elbowroom::query::map::{self, CellMap, MapObstacle, MapProgress, MapRequest};
use elbowroom::report::{map_page, map_pictures};
use serde::Serialize;

use crate::args::MapArgs;
use crate::output::{ExitStatus, Failure, cannot_write, note, print, print_json};
use crate::output_file::write_file;
use crate::progress::Progress;

pub(crate) fn map(args: &MapArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let request = request(args);
    if args.out.is_some() && !request.model.is_conservative() {
        let what =
            "--out with --model seeds: cells that the model misses would be read as free\n  write: --model slices";
        return Err(Failure::Wrong(what.to_owned()));
    }
    let map = with_progress(&cell, &request)?;
    map.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    if let Some(path) = &args.out {
        write(&map, path)?;
    }
    let pictures = match &args.png {
        Some(folder) => Some((map_pictures::write(&map, folder).map_err(cannot_write(folder))?, folder)),
        None => None,
    };
    if let Some(path) = &args.page {
        WholeFile::write(path, |out| map_page::write(out, &map, cell.units))
            .map_err(|e| cannot_write_page(&map, path, &e))?;
    }
    if args.json {
        print_json(&Document::of(&map))?;
        return Ok(ExitStatus::Success);
    }
    print(&text(&map))?;
    if let Some(path) = &args.out {
        print(&format!("\ncells in {}\n", path.display()))?;
    }
    if let Some((count, folder)) = pictures {
        print(&format!("\n{count} pictures: open {}\n", folder.join("index.html").display()))?;
    }
    if let Some(path) = &args.page {
        print(&format!("\nslices with a slider: open {}\n", path.display()))?;
    }
    Ok(ExitStatus::Success)
}

fn cannot_write_page(map: &CellMap, path: &Path, e: &std::io::Error) -> Failure {
    match e.kind() {
        std::io::ErrorKind::InvalidInput => {
            Failure::Wrong(format!("{}: {e}\n  write: a larger step in [map.{}]", path.display(), map.robot))
        }
        _ => cannot_write(path)(std::io::Error::new(e.kind(), e.to_string())),
    }
}

fn request(args: &MapArgs) -> MapRequest {
    let deadline = args.deadline.map(|ms| Duration::from_secs_f64(ms * 1e-3));
    MapRequest { robot: args.robot.clone(), model: args.model, exact: args.exact, deadline }
}

/// Computes the map, with a progress bar if it takes long.
fn with_progress(cell: &Cell, request: &MapRequest) -> Result<CellMap, Failure> {
    let bar = Progress::share();
    let map = map::map_with(cell, request, &|p: MapProgress<'_>| bar.reach(p.share, p.what));
    bar.end();
    Ok(map?)
}

fn write(map: &CellMap, path: &Path) -> Result<(), Failure> {
    let dense = map.dense.as_ref().ok_or_else(|| {
        let what = format!("{}: {} cells are too many for a file of one byte each", path.display(), map.cells());
        Failure::Wrong(format!("{what}\n  write: a larger step, or fewer joints, in [map.{}]", map.robot))
    })?;
    write_file(path, |out| dense.write_npy(out))
}

/// The JSON document.
#[derive(Serialize)]
struct Document<'a> {
    robot: &'a str,
    axes: Vec<AxisRow<'a>>,
    cells: u64,
    static_blocked: u64,
    obstacles: Vec<ObstacleRow<'a>>,
    blocked: u64,
    bytes: usize,
}

#[derive(Serialize)]
struct AxisRow<'a> {
    joint: &'a str,
    min: f64,
    max: f64,
    step: f64,
    count: usize,
}

#[derive(Serialize)]
struct ObstacleRow<'a> {
    name: &'a str,
    model: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    spheres: Option<u32>,
    blocked: u64,
    time_us: f64,
}

impl<'a> Document<'a> {
    fn of(map: &'a CellMap) -> Self {
        let axis = |a: &'a GridAxis| AxisRow {
            joint: a.joint(),
            min: a.min(),
            max: a.max(),
            step: a.step(),
            count: a.count(),
        };
        let obstacle = |o: &'a MapObstacle| ObstacleRow {
            name: &o.name,
            model: o.model.to_string(),
            spheres: o.spheres,
            blocked: o.blocks.blocked(),
            time_us: o.time.as_secs_f64() * 1e6,
        };
        Self {
            robot: &map.robot,
            axes: map.axes.iter().map(axis).collect(),
            cells: map.cells(),
            static_blocked: map.static_blocked,
            obstacles: map.obstacles.iter().map(obstacle).collect(),
            blocked: map.blocked,
            bytes: map.bytes(),
        }
    }
}

/// Formats the table for the terminal. Writing to a String cannot fail.
fn text(map: &CellMap) -> String {
    let share = |blocked: u64| 100.0 * blocked as f64 / map.cells().max(1) as f64;
    let mut out = format!("{}: {} cells, {:.2} % blocked\n\n", map.robot, grouped(map.cells()), share(map.blocked));
    for (axis, is_angle) in map.axes.iter().zip(&map.is_angle) {
        let show = |v: f64| if *is_angle { format!("{:.1}°", v.to_degrees()) } else { format!("{v:.3} m") };
        let (min, max, step) = (show(axis.min()), show(axis.max()), show(axis.step()));
        let _ = writeln!(out, "  {:<24} {min:>9} to {max:>8}, {:>5} cells of {step}", axis.joint(), axis.count());
    }
    let _ = write!(out, "\n  {:<24} {:<11} {:>14} {:>9} {:>10}", "object", "model", "blocked cells", "share", "time");
    for o in &map.obstacles {
        let blocked = o.blocks.blocked();
        let model = o.spheres.map_or(o.model, |count| ObstacleModel::Spheres(count).into()).to_string();
        let (cells, percent) = (grouped(blocked), share(blocked));
        let time = format!("{:.1} ms", o.time.as_secs_f64() * 1e3);
        let _ = write!(out, "\n  {:<24} {model:<11} {cells:>14} {percent:>7.2} % {time:>10}", o.name);
    }
    let _ = writeln!(out, "\n\n{} kB of memory", map.bytes().div_ceil(1000));
    out
}

/// Groups digits by thousands: 1234567 as 1,234,567.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}
