//! `[camera.NAME]`: a calibrated camera above the floor of the cell, and what is known of what it sees.

use std::path::{Path, PathBuf};

use elbowroom_formats::FormatError;
use elbowroom_robot::RobotId;
use elbowroom_vision::{
    Camera, CameraTracker, CameraTrackerSettings, Intrinsics, Point2, ShadowSettings, Template, VisionError,
};

use super::read::{Table, Value};
use super::robot::robot_of;
use crate::{Cell, CellCamera, Units};

type Result<T> = std::result::Result<T, FormatError>;

const KEYS: &[&str] = &[
    "size",
    "focal_px",
    "centre_px",
    "center_px",
    "distortion",
    "pose",
    "area",
    "floor",
    "learning_frames",
    "templates",
    "uncertainty",
    "max_speed",
    "shadows",
    "prediction",
    "mask_margin",
    "robot",
    "frames",
    "joints",
];
const TEMPLATE: &str = "templates = [{ name = \"crate\", size = [600, 400], height = 320 }]";
const AREA: &str = "area = [[-1500, -1000], [1500, -1000], [1500, 1000], [-1500, 1000]]";
/// Largest picture, pixels along a side.
const MOST_PIXELS: u32 = 16_384;

pub(super) fn read(root: &Table<'_>, cell: &Cell) -> Result<Vec<CellCamera>> {
    root.named("camera")?.into_iter().map(|(name, t)| camera(name, &t, cell)).collect()
}

fn camera(name: &str, t: &Table<'_>, cell: &Cell) -> Result<CellCamera> {
    t.only(KEYS)?;
    let units = cell.units;
    let of_vision = |e: VisionError| refused(t, &e);
    let pose =
        units.pose(&t.need("pose", "pose = { at = [0, 0, 4000], rpy = [180, 0, 0] }   (z looks along the view)")?)?;
    let camera = Camera::new(intrinsics(t)?, pose).map_err(of_vision)?;
    let settings = settings(t, units)?;
    // Refuses a view of the horizon, and an area that is not in the picture.
    CameraTracker::new(camera.clone().into(), settings.clone()).map_err(of_vision)?;
    let seconds = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| v.not_negative());
    let length = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| units.not_negative_length(&v));
    Ok(CellCamera {
        name: name.to_owned(),
        line: t.line,
        camera,
        settings,
        robot: robot(t, cell)?,
        prediction_s: seconds("prediction", 0.5)?,
        mask_margin_m: length("mask_margin", 0.03)?,
        frames: t.get("frames").map(|v| folder(&v)).transpose()?,
        joints: t.get("joints").map(|v| super::models::path(&v)).transpose()?,
    })
}

/// An error of the camera at the key that is wrong, in the words of the cell file.
fn refused(t: &Table<'_>, e: &VisionError) -> FormatError {
    const LOOKS_DOWN: &str = "pose = { at = [0, 0, 4000], rpy = [180, 0, 0] }   (z looks along the view)";
    let key = match e {
        VisionError::Setting { name, .. } => name.trim_end_matches("_mps").trim_end_matches("_m"),
        VisionError::Calibration(why) if why.contains("distortion") => "distortion",
        VisionError::Calibration(why) if why.contains("focal") => "focal_px",
        _ => "pose",
    };
    let Some(v) = t.get(key) else { return t.error(format!("`{}`: {e}", t.name)).hint(LOOKS_DOWN) };
    match e {
        VisionError::Setting { expected, .. } => v.error("is out of its range").hint(*expected),
        _ if key == "pose" => v.error(format!("does not show the floor: {e}")).hint(LOOKS_DOWN),
        _ => v.error(e.to_string()).hint("the numbers of the calibration, for pictures of this `size`"),
    }
}

/// The robot in whose map the obstacles are: the one named, or the only one.
fn robot(t: &Table<'_>, cell: &Cell) -> Result<RobotId> {
    match t.get("robot") {
        Some(v) => {
            let name = v.text()?;
            robot_of(name, &t.clone().at_line(v.line), &cell.robots).map(|(id, _)| id)
        }
        None if cell.robots.len() == 1 => Ok(RobotId(0)),
        None => {
            let names = cell.robots.iter().map(|r| format!("\"{}\"", r.name)).collect::<Vec<_>>().join(" or ");
            Err(t.error(format!("`{}` needs the key `robot`", t.name)).hint(format!("robot = {names}")))
        }
    }
}

fn intrinsics(t: &Table<'_>) -> Result<Intrinsics> {
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

fn settings(t: &Table<'_>, units: Units) -> Result<CameraTrackerSettings> {
    let default = CameraTrackerSettings::default();
    let length = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| units.not_negative_length(&v));
    Ok(CameraTrackerSettings {
        area_m: t.get("area").map_or(Ok(Vec::new()), |v| area(&v, units))?,
        floor_z_m: t.get("floor").map_or(Ok(default.floor_z_m), |v| units.length_of(&v))?,
        uncertainty_m: length("uncertainty", default.uncertainty_m)?,
        max_speed_mps: t.get("max_speed").map_or(Ok(default.max_speed_mps), |v| units.positive_length(&v))?,
        learning_frames: t.get("learning_frames").map_or(Ok(default.learning_frames), |v| v.whole(2, 10_000))?,
        shadows: t.flag_or("shadows", false)?.then(ShadowSettings::default),
        templates: t
            .get("templates")
            .map_or(Ok(Vec::new()), |v| v.list(TEMPLATE)?.iter().map(|v| template(v, units)).collect())?,
        ..default
    })
}

/// The polygon of the floor that is watched, world x and y.
fn area(v: &Value<'_>, units: Units) -> Result<Vec<Point2>> {
    let corners = v.list(AREA)?;
    if corners.len() < 3 {
        return Err(v.error(format!("has {} corners and needs three or more", corners.len())).hint(AREA));
    }
    let corner =
        |v: &Value<'_>| two(v, AREA).map(|[x, y]| Point2::new(units.length.to_metres(x), units.length.to_metres(y)));
    corners.iter().map(corner).collect()
}

/// A known kind of object: `size` of its footprint (or `diameter`) and `height`.
fn template(v: &Value<'_>, units: Units) -> Result<Template> {
    let t = v.table(TEMPLATE)?;
    t.only(&["name", "size", "diameter", "height", "tolerance", "height_tolerance"])?;
    let name = t.need("name", TEMPLATE)?.text()?;
    let height = units.positive_length(&t.need("height", TEMPLATE)?)?;
    let mut template = match (t.get("size"), t.get("diameter")) {
        (Some(size), None) => {
            let [length, width] = two(&size, TEMPLATE)?.map(|side| units.length.to_metres(side));
            if !(length > 0.0 && width > 0.0) {
                return Err(size.error("must be two lengths above 0").hint(TEMPLATE));
            }
            Template::new(name, length, width, height)
        }
        (None, Some(diameter)) => Template::cylinder(name, units.positive_length(&diameter)?, height),
        _ => return Err(t.error(format!("`{}` needs either `size` or `diameter`", t.name)).hint(TEMPLATE)),
    };
    if let Some(v) = t.get("tolerance") {
        template.tolerance_m = units.not_negative_length(&v)?;
    }
    if let Some(v) = t.get("height_tolerance") {
        template.height_tolerance_m = units.not_negative_length(&v)?;
    }
    Ok(template)
}

fn two(v: &Value<'_>, example: &str) -> Result<[f64; 2]> {
    let numbers = v.numbers(example)?;
    <[f64; 2]>::try_from(numbers.as_slice())
        .map_err(|_| v.error(format!("needs 2 numbers, not {}", numbers.len())).hint(example))
}

/// The folder that a value names, relative to the cell file; it need not exist yet.
fn folder(v: &Value<'_>) -> Result<PathBuf> {
    let name = v.text()?;
    if name.is_empty() || name.contains('\0') {
        return Err(v.error("names no folder").hint("frames = \"frames\""));
    }
    Ok(v.file.parent().unwrap_or(Path::new("")).join(name))
}
