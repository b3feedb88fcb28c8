//! `elbowroom map`: the joint-space occupancy of a cell's objects.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use elbowroom::cell::Cell;
use elbowroom::cspace::{GridAxis, ObstacleModel};
use elbowroom::formats::WholeFile;
use elbowroom::query::map::{self, CellMap, MapObstacle, MapProgress, MapRequest};
use elbowroom::query::{LinkCells, blocked_by_link};
use elbowroom::report::{map_page, map_pictures};
use serde::Serialize;

use crate::args::MapArgs;
use crate::map_path::MapPath;
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
    let links = if args.links { blocked_by_link(&cell, &request)? } else { Vec::new() };
    let drawn = args.path.as_ref().map(|path| MapPath::read(path, &cell, &map)).transpose()?;
    if let Some(path) = &args.page {
        let rows = drawn.as_ref().map_or(&[][..], |drawn| &drawn.rows);
        WholeFile::write(path, |out| map_page::write(out, &map, &links, rows, cell.units))
            .map_err(|e| cannot_write_page(&map, path, &e))?;
    }
    if args.json {
        print_json(&Document::of(&map, drawn.as_ref(), args.links.then_some(&links[..])))?;
        return Ok(ExitStatus::Success);
    }
    print(&text(&map, &links))?;
    if let Some(path) = &args.out {
        print(&format!("\ncells in {}\n", path.display()))?;
    }
    if let Some((count, folder)) = pictures {
        print(&format!("\n{count} pictures: open {}\n", folder.join("index.html").display()))?;
    }
    if let Some(MapPath { rows, blocked }) = &drawn {
        print(&format!("\n{blocked} of {} rows of the path are in blocked cells\n", rows.len()))?;
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
    #[serde(skip_serializing_if = "Option::is_none")]
    path: Option<PathRow>,
}

#[derive(Serialize)]
struct PathRow {
    rows: usize,
    blocked: usize,
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
    /// Cells that each link blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    by_link: Option<BTreeMap<&'a str, u64>>,
}

impl<'a> Document<'a> {
    fn of(map: &'a CellMap, path: Option<&MapPath>, links: Option<&'a [LinkCells]>) -> Self {
        let axis = |a: &'a GridAxis| AxisRow {
            joint: a.joint(),
            min: a.min(),
            max: a.max(),
            step: a.step(),
            count: a.count(),
        };
        let of_links = |object: usize, links: &'a [LinkCells]| {
            links.iter().map(|l| (l.link.as_str(), l.blocked(object))).filter(|(_, cells)| *cells > 0).collect()
        };
        let obstacle = |(object, o): (usize, &'a MapObstacle)| ObstacleRow {
            name: &o.name,
            model: o.model.to_string(),
            spheres: o.spheres,
            blocked: o.blocks.blocked(),
            time_us: o.time.as_secs_f64() * 1e6,
            by_link: links.map(|links| of_links(object, links)),
        };
        Self {
            robot: &map.robot,
            axes: map.axes.iter().map(axis).collect(),
            cells: map.cells(),
            static_blocked: map.static_blocked,
            obstacles: map.obstacles.iter().enumerate().map(obstacle).collect(),
            blocked: map.blocked,
            bytes: map.bytes(),
            path: path.map(|path| PathRow { rows: path.rows.len(), blocked: path.blocked }),
        }
    }
}

/// Formats the table for the terminal. Writing to a String cannot fail.
fn text(map: &CellMap, links: &[LinkCells]) -> String {
    let share = |blocked: u64| 100.0 * blocked as f64 / map.cells().max(1) as f64;
    let mut out = format!("{}: {} cells, {:.2} % blocked\n\n", map.robot, grouped(map.cells()), share(map.blocked));
    for (axis, is_angle) in map.axes.iter().zip(&map.is_angle) {
        let show = |v: f64| if *is_angle { format!("{:.1}°", v.to_degrees()) } else { format!("{v:.3} m") };
        let (min, max, step) = (show(axis.min()), show(axis.max()), show(axis.step()));
        let _ = writeln!(out, "  {:<24} {min:>9} to {max:>8}, {:>5} cells of {step}", axis.joint(), axis.count());
    }
    let _ = write!(out, "\n  {:<24} {:<11} {:>14} {:>9} {:>10}", "object", "model", "blocked cells", "share", "time");
    for (object, o) in map.obstacles.iter().enumerate() {
        let blocked = o.blocks.blocked();
        let model = o.spheres.map_or(o.model, |count| ObstacleModel::Spheres(count).into()).to_string();
        let (cells, percent) = (grouped(blocked), share(blocked));
        let time = format!("{:.1} ms", o.time.as_secs_f64() * 1e3);
        let _ = write!(out, "\n  {:<24} {model:<11} {cells:>14} {percent:>7.2} % {time:>10}", o.name);
        for (link, cells) in links.iter().map(|l| (&l.link, l.blocked(object))).filter(|(_, cells)| *cells > 0) {
            let _ = write!(out, "\n    by {link:<33} {:>14}", grouped(cells));
        }
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
