//! Keys that `[camera.NAME]` and `[cloud.NAME]` share: files, times, robots.

use std::path::{Path, PathBuf};

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_robot::RobotId;
use elbowroom_vision::{Intrinsics, Point2, TrackSettings};

use super::mechanism;
use super::robot::robot_of;
use super::tools::with_exchanged_tools;
use crate::{Cell, CellSensor, SensorKind, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const AREA: &str = "area = [[-1500, -1000], [1500, -1000], [1500, 1000], [-1500, 1000]]";
/// Largest picture, pixels along a side.
const MOST_PIXELS: u32 = 16_384;
/// Default latency of a picture, s.
const LATENCY_S: f64 = 0.1;
/// Default time of a path search, s.
const SEARCH_S: f64 = 0.2;
/// Longest time of a path search, s.
const LONGEST_SEARCH_S: f64 = 60.0;
/// Default age at which the last picture is stale, s.
const STALE_S: f64 = 0.5;

/// A sensor whose files are in the folder of the key `folder_key`. One that `only_views` a work-piece has no robots unless
/// they are named.
pub(super) fn sensor(
    name: &str,
    t: &Table<'_>,
    cell: &Cell,
    (folder_key, only_views): (&str, bool),
    kind: SensorKind,
) -> Result<CellSensor> {
    let seconds = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| v.not_negative());
    let milliseconds = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| v.positive().map(|ms| ms / 1e3));
    let latency_s = t.get("latency_ms").map_or(Ok(LATENCY_S), |v| v.not_negative().map(|ms| ms / 1e3))?;
    let stale_s = milliseconds("stale_ms", STALE_S.max(2.0 * latency_s))?;
    if let Some(v) = t.get("stale_ms").filter(|_| stale_s <= latency_s) {
        let what = format!("must be longer than the latency of {} ms: every picture would be stale", 1e3 * latency_s);
        return Err(v.error(what).hint(format!("stale_ms = {}", 1e3 * STALE_S.max(2.0 * latency_s))));
    }
    Ok(CellSensor {
        name: name.to_owned(),
        line: t.line,
        kind,
        robot: if only_views && t.get("robot").is_none() { RobotId(0) } else { robot(t, cell)? },
        prediction_s: seconds("prediction", 0.5)?,
        folder: t.get(folder_key).map(|v| folder(&v, folder_key)).transpose()?,
        joints: t.get("joints").map(|v| super::models::path(&v)).transpose()?,
        latency_s,
        search_s: t.get("search_ms").map_or(Ok(SEARCH_S), |v| search_s(&v))?,
        stale_s,
        robots: if only_views && t.get("robots").is_none() { Vec::new() } else { robots(t, cell)? },
    })
}

fn search_s(v: &Value<'_>) -> Result<f64> {
    let seconds = v.positive()? / 1e3;
    if seconds <= LONGEST_SEARCH_S {
        return Ok(seconds);
    }
    Err(v.error(format!("is {seconds} s: a robot would stand for a path")).hint("search_ms = 200   (up to 60000)"))
}

/// The robot whose map contains the obstacles: the named one, or the only one.
fn robot(t: &Table<'_>, cell: &Cell) -> Result<RobotId> {
    match t.get("robot") {
        Some(v) => {
            let name = v.text()?;
            let (id, robot) = robot_of(name, &t.clone().at_line(v.line), &cell.robots)?;
            mechanism::refuse(&v, robot, "plans no paths around the cells of a map")?;
            Ok(id)
        }
        None => match cell.guarded_robots().collect::<Vec<_>>()[..] {
            [only] => Ok(only),
            ref several => {
                let name = |id: &RobotId| format!("\"{}\"", cell.robots[id.0].name);
                let names = several.iter().map(name).collect::<Vec<_>>().join(" or ");
                Err(t.error(format!("`{}` needs the key `robot`", t.name)).hint(format!("robot = {names}")))
            }
        },
    }
}

/// The robots that avoid the obstacles: the named ones, or all.
fn robots(t: &Table<'_>, cell: &Cell) -> Result<Vec<RobotId>> {
    let found = named_robots(t, cell)?;
    if let Some(robot) = with_exchanged_tools(found.iter().map(|id| &cell.robots[id.0])) {
        let what = format!(
            "`{}`: who keeps clear of what a sensor sees cannot change tools, as robot \"{}\" does",
            t.name, robot.name
        );
        return Err(t.error(what).hint("mounted tools only, or `robots` without this one"));
    }
    Ok(found)
}

fn named_robots(t: &Table<'_>, cell: &Cell) -> Result<Vec<RobotId>> {
    let Some(v) = t.get("robots") else { return Ok(cell.guarded_robots().collect()) };
    let mut found = Vec::new();
    for name in v.list("robots = [\"arm\"]   (those that keep clear of its obstacles)")? {
        let (id, robot) = robot_of(name.text()?, t, &cell.robots)?;
        mechanism::refuse(&name, robot, "avoids nothing")?;
        if found.contains(&id) {
            return Err(name.error("names a robot for the second time").hint("each robot once"));
        }
        found.push(id);
    }
    Ok(found)
}

/// Lens: `size`, `focal_px`, `centre_px`, `distortion`.
pub(super) fn intrinsics(t: &Table<'_>) -> Result<Intrinsics> {
    const SIZE: &str = "size = [640, 480]   (columns and rows of a picture)";
    let size = t.need("size", SIZE)?;
    let sides = size.list(SIZE)?;
    let [width, height] = &sides[..] else {
        return Err(size.error(format!("needs 2 numbers, not {}", sides.len())).hint(SIZE));
    };
    let [width, height] = [width.whole(8, MOST_PIXELS)? as usize, height.whole(8, MOST_PIXELS)? as usize];
    let focal = t.need("focal_px", "focal_px = [600, 600]   (pixels, from the calibration)")?;
    let [fx, fy] = if focal.is_number() { [focal.positive()?; 2] } else { two(&focal, "focal_px = [600, 600]")? };
    let middle = [0.5 * width as f64, 0.5 * height as f64];
    if let (Some(_), Some(v)) = (t.get("centre_px"), t.get("center_px")) {
        return Err(v.error("contradicts `centre_px`").hint("one of the two spellings"));
    }
    let centre = t.get("centre_px").or_else(|| t.get("center_px"));
    let [cx, cy] = centre.map_or(Ok(middle), |v| two(&v, "centre_px = [320, 240]"))?;
    let mut radial = [0.0; 3];
    if let Some(v) = t.get("distortion") {
        const EXAMPLE: &str = "distortion = [-0.1, 0.01, 0]   (k1, k2, k3)";
        let given = v.numbers(EXAMPLE)?;
        if given.len() > 3 {
            let what = format!("has {} coefficients; the model has the radial ones k1, k2 and k3", given.len());
            return Err(v.error(what).hint(EXAMPLE));
        }
        radial[..given.len()].copy_from_slice(&given);
    }
    Ok(Intrinsics { width, height, fx, fy, cx, cy, radial })
}

/// The settings that every tracker has.
pub(super) fn track(t: &Table<'_>, units: Units, default: &TrackSettings) -> Result<TrackSettings> {
    let length = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| units.not_negative_length(&v));
    Ok(TrackSettings {
        area_m: area(t, units)?,
        floor_z_m: t.get("floor").map_or(Ok(default.floor_z_m), |v| units.length_of(&v))?,
        uncertainty_m: length("uncertainty", default.uncertainty_m)?,
        max_speed_mps: t.get("max_speed").map_or(Ok(default.max_speed_mps), |v| units.positive_length(&v))?,
        ..default.clone()
    })
}

/// The polygon of the floor that is watched, world x and y; empty if none is given.
fn area(t: &Table<'_>, units: Units) -> Result<Vec<Point2>> {
    let Some(v) = t.get("area") else { return Ok(Vec::new()) };
    let corners = v.list(AREA)?;
    if corners.len() < 3 {
        return Err(v.error(format!("has {} corners and needs three or more", corners.len())).hint(AREA));
    }
    let corner =
        |v: &Value<'_>| two(v, AREA).map(|[x, y]| Point2::new(units.length.to_metres(x), units.length.to_metres(y)));
    corners.iter().map(corner).collect()
}

pub(super) fn two(v: &Value<'_>, example: &str) -> Result<[f64; 2]> {
    let numbers = v.numbers(example)?;
    <[f64; 2]>::try_from(numbers.as_slice())
        .map_err(|_| v.error(format!("needs 2 numbers, not {}", numbers.len())).hint(example))
}

/// The folder that a value names, relative to the cell file; it need not exist yet.
fn folder(v: &Value<'_>, key: &str) -> Result<PathBuf> {
    let name = v.text()?;
    if name.is_empty() || name.contains('\0') {
        return Err(v.error("names no folder").hint(format!("{key} = \"{key}\"")));
    }
    Ok(v.file.parent().unwrap_or(Path::new("")).join(name))
}
