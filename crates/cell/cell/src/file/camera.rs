//! `[camera.NAME]`: a calibrated camera above the floor of the cell.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_vision::{Camera, CameraTracker, CameraTrackerSettings, ShadowSettings, Template, VisionError};

use super::schema::{self, CAMERA, LENS, SENSOR, names};
use super::sensor::{self, two};
use crate::{Cell, CellSensor, SensorKind, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const TEMPLATE: &str = "templates = [{ name = \"crate\", size = [600, 400], height = 320 }]";

/// Reads a camera. One that a virtual robot `views` its work-piece with, and that has nothing but a lens and a pose, detects no
/// obstacles and need not show the floor; any other key is of a camera that detects them.
pub(super) fn read(name: &str, t: &Table<'_>, cell: &Cell, views: bool) -> Result<CellSensor> {
    t.only(&names(&[LENS, CAMERA, SENSOR]))?;
    let detects = |key: &&str| *key != "pose" && t.get(key).is_some();
    let only_views = views && !names(&[CAMERA, SENSOR]).iter().any(detects);
    let units = cell.units;
    let of_vision = |e: VisionError| refused(t, &e);
    let pose =
        units.pose(&t.need("pose", "pose = { at = [0, 0, 4000], rpy = [180, 0, 0] }   (z looks along the view)")?)?;
    let camera = Camera::new(sensor::intrinsics(t)?, pose).map_err(of_vision)?;
    let settings = settings(t, units)?;
    if !only_views {
        // Refuses a view of the horizon, and an area that is not in the picture.
        CameraTracker::new(camera.clone().into(), settings.clone()).map_err(of_vision)?;
    }
    let mask_margin_m = t.get("mask_margin").map_or(Ok(0.03), |v| units.not_negative_length(&v))?;
    let kind = SensorKind::Camera { camera, settings, mask_margin_m };
    sensor::sensor(name, t, cell, ("frames", only_views), kind)
}

/// An error of the camera at the key that is wrong, in the words of the cell file.
fn refused(t: &Table<'_>, e: &VisionError) -> Diagnostic {
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
        _ => v.error(e).hint("the numbers of the calibration, for pictures of this `size`"),
    }
}

fn settings(t: &Table<'_>, units: Units) -> Result<CameraTrackerSettings> {
    let default = CameraTrackerSettings::default();
    Ok(CameraTrackerSettings {
        track: sensor::track(t, units, &default.track)?,
        learning_frames: t.get("learning_frames").map_or(Ok(default.learning_frames), |v| v.whole(2, 10_000))?,
        shadows: t.flag_or("shadows", false)?.then(ShadowSettings::default),
        templates: t
            .get("templates")
            .map_or(Ok(Vec::new()), |v| v.list(TEMPLATE)?.iter().map(|v| template(v, units)).collect())?,
        ..default
    })
}

/// A known kind of object: `size` of its footprint (or `diameter`) and `height`.
fn template(v: &Value<'_>, units: Units) -> Result<Template> {
    let t = v.table(TEMPLATE)?;
    t.only(&names(&[schema::TEMPLATE]))?;
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
