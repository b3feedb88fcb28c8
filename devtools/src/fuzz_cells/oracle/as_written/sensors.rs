//! Sensors: where they are, how they see, and the numbers of their tables.

use elbowroom_cell::{Cell, CellSensor, SensorKind};
use elbowroom_spatial::Pose;
use elbowroom_vision::{Camera, Point2, Template, TrackSettings};
use toml::{Table, Value};

use super::compare::{Off, ROUNDING, compare};
use super::written::{Written, number, numbers};
use crate::fuzz_cells::oracle::frame::Frame;

pub fn check(file: &Written, cell: &Cell, off: &mut Off) {
    for word in ["camera", "cloud"] {
        for (name, t) in file.tables(word) {
            let what = format!("{word}.{name}");
            match cell.sensors.iter().find(|s| s.name == *name && s.table() == word) {
                Some(read) => sensor(file, &what, t, read, off),
                None => off.push((what, f64::INFINITY)),
            }
        }
    }
}

fn sensor(file: &Written, what: &str, t: &Table, read: &CellSensor, off: &mut Off) {
    let length = |t: &Table, key: &str| t.get(key).map(|_| file.length(t, key));
    let plain = |t: &Table, key: &str| t.get(key).and_then(number);
    let mut values = vec![
        ("latency_ms", plain(t, "latency_ms"), 1e3 * read.latency_s),
        ("stale_ms", plain(t, "stale_ms"), 1e3 * read.stale_s),
        ("search_ms", plain(t, "search_ms"), 1e3 * read.search_s),
        ("prediction", plain(t, "prediction"), read.prediction_s),
    ];
    let (pose, track) = pose_and_track(read);
    values.extend([
        ("floor", length(t, "floor"), track.floor_z_m),
        ("uncertainty", length(t, "uncertainty"), track.uncertainty_m),
        ("max_speed", length(t, "max_speed"), track.max_speed_mps),
        ("area", t.get("area").map(|_| 0.0), area_off(file, t, &track.area_m)),
    ]);
    match &read.kind {
        SensorKind::Camera { camera, settings, mask_margin_m } => {
            values.extend([
                ("mask_margin", length(t, "mask_margin"), *mask_margin_m),
                ("learning_frames", plain(t, "learning_frames"), f64::from(settings.learning_frames)),
                ("shadows", flag(t, "shadows"), f64::from(u8::from(settings.shadows.is_some()))),
                ("size", Some(0.0), lens_off(t, camera)),
                ("templates", Some(0.0), templates_off(file, t, &settings.templates)),
            ]);
        }
        SensorKind::Cloud { settings, depth } => {
            values.extend([
                ("mask_margin", length(t, "mask_margin"), settings.arm_margin_m),
                ("learning_clouds", plain(t, "learning_clouds"), f64::from(settings.learning_clouds)),
                ("floor_thickness", length(t, "floor_thickness"), settings.floor_thickness_m),
                ("ceiling", length(t, "ceiling"), settings.ceiling_m),
                ("voxel", length(t, "voxel"), settings.voxel_m),
                ("min_points", plain(t, "min_points"), f64::from(settings.min_points)),
                ("min_voxels", plain(t, "min_voxels"), f64::from(settings.min_voxels)),
                ("to_floor", flag(t, "to_floor"), f64::from(u8::from(settings.extend_to_floor))),
            ]);
            match (t.get("depth").and_then(Value::as_table), depth) {
                (Some(lens), Some((camera, step_m))) => {
                    values.extend([
                        ("depth", Some(0.0), lens_off(lens, camera)),
                        ("step", length(lens, "step"), *step_m),
                    ]);
                }
                (None, None) => {}
                _ => off.push((format!("{what}.depth"), f64::INFINITY)),
            }
        }
    }
    for (key, written, read) in values {
        if let Some(by) = written.map(|written| (written - read).abs()).filter(|by| !(*by <= ROUNDING)) {
            off.push((format!("{what}.{key}"), by));
        }
    }
    if let Some(written) = t.get("pose").and_then(Value::as_table) {
        compare(format!("{what}.pose"), &file.pose(written), true, &Frame::of(pose), off);
    }
}

fn pose_and_track(read: &CellSensor) -> (&Pose, &TrackSettings) {
    match &read.kind {
        SensorKind::Camera { camera, settings, .. } => (camera.camera_in_world(), &settings.track),
        SensorKind::Cloud { settings, .. } => (&settings.sensor_in_world, &settings.track),
    }
}

fn flag(t: &Table, key: &str) -> Option<f64> {
    t.get(key)?.as_bool().map(|is_true| f64::from(u8::from(is_true)))
}

/// Largest difference of the corners of an area.
fn area_off(file: &Written, t: &Table, read: &[Point2]) -> f64 {
    let corners: Vec<Vec<f64>> =
        t.get("area").and_then(Value::as_array).into_iter().flatten().filter_map(numbers).collect();
    if corners.len() != read.len() {
        return f64::INFINITY;
    }
    let by = |(written, read): (&Vec<f64>, &Point2)| {
        (file.metres(written[0]) - read.x).abs().max((file.metres(written[1]) - read.y).abs())
    };
    corners.iter().zip(read).map(by).fold(0.0, f64::max)
}

/// Largest difference of the numbers of a lens, pixels.
fn lens_off(t: &Table, read: &Camera) -> f64 {
    let lens = read.intrinsics();
    let pair = |key: &str, default: [f64; 2]| {
        let one = t.get(key).and_then(number).map(|v| vec![v; 2]);
        one.or_else(|| t.get(key).and_then(numbers)).unwrap_or_else(|| default.to_vec())
    };
    let size = pair("size", [f64::NAN; 2]);
    let middle =
        pair(if t.contains_key("center_px") { "center_px" } else { "centre_px" }, [0.5 * size[0], 0.5 * size[1]]);
    let focal = pair("focal_px", [f64::NAN; 2]);
    let mut radial = t.get("distortion").and_then(numbers).unwrap_or_default();
    radial.resize(3, 0.0);
    let written = [size, focal, middle, radial].concat();
    let size = [lens.width as f64, lens.height as f64, lens.fx, lens.fy, lens.cx, lens.cy];
    let by = written.iter().zip(size.iter().chain(&lens.radial)).map(|(a, b)| (a - b).abs());
    // A number that is missing is a difference.
    by.fold(0.0, |most: f64, by| if by.is_nan() { f64::INFINITY } else { most.max(by) })
}

/// Largest difference of the sizes and tolerances of templates, m; infinite for another number of them.
fn templates_off(file: &Written, t: &Table, read: &[Template]) -> f64 {
    let written: Vec<&Table> =
        t.get("templates").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_table).collect();
    if written.len() != read.len() {
        return f64::INFINITY;
    }
    let one = |(t, read): (&&Table, &Template)| {
        let length = |key: &str, read: f64| t.get(key).map_or(0.0, |_| (file.length(t, key) - read).abs());
        let is_named = t.get("name").and_then(Value::as_str) == Some(&*read.name);
        let of_name = if is_named { 0.0 } else { f64::INFINITY };
        let heights = length("height", read.height_m).max(length("height_tolerance", read.height_tolerance_m));
        let diameter = t.get("diameter").map(|_| [file.length(t, "diameter"); 2]);
        let size = t.get("size").and_then(numbers).and_then(|size| <[f64; 2]>::try_from(size).ok());
        let [a, b] = diameter.or(size.map(|size| size.map(|side| file.metres(side)))).unwrap_or([f64::INFINITY; 2]);
        let sides = (a.max(b) - read.length_m).abs().max((a.min(b) - read.width_m).abs());
        of_name.max(heights).max(sides).max(length("tolerance", read.tolerance_m))
    };
    written.iter().zip(read).map(one).fold(0.0, f64::max)
}
