//! `[cloud.NAME]`: a sensor of points above or beside the cell: point clouds, or pictures of depths.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::Table;
use elbowroom_vision::cloud::{CloudTracker, CloudTrackerSettings};
use elbowroom_vision::{Camera, VisionError};

use super::schema::{self, names};
use super::sensor;
use crate::{Cell, CellSensor, SensorKind};

type Result<T> = std::result::Result<T, Diagnostic>;

const POSE: &str = "pose = { at = [0, 0, 4000], rpy = [180, 0, 0] }   (of the sensor, in whose frame the points are)";
const DEPTH: &str = "depth = { size = [640, 480], focal_px = [600, 600], step = 1 }   (step: the length of depth 1)";

pub(super) fn read(name: &str, t: &Table<'_>, cell: &Cell) -> Result<CellSensor> {
    t.only(&names(&[schema::CLOUD, schema::SENSOR]))?;
    let units = cell.units;
    let of_vision = |e: VisionError| t.error(format!("`{}`: {e}", t.name));
    let default = CloudTrackerSettings::default();
    let length = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| units.not_negative_length(&v));
    let positive = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| units.positive_length(&v));
    let count = |key: &str, default: u32, least: u32| t.get(key).map_or(Ok(default), |v| v.whole(least, 10_000));
    let settings = CloudTrackerSettings {
        sensor_in_world: units.pose(&t.need("pose", POSE)?)?,
        track: sensor::track(t, units, &default.track)?,
        floor_thickness_m: length("floor_thickness", default.floor_thickness_m)?,
        ceiling_m: positive("ceiling", default.ceiling_m)?,
        voxel_m: positive("voxel", default.voxel_m)?,
        min_points: count("min_points", default.min_points, 1)?,
        min_voxels: count("min_voxels", default.min_voxels, 1)?,
        arm_margin_m: length("mask_margin", default.arm_margin_m)?,
        extend_to_floor: t.flag_or("to_floor", default.extend_to_floor)?,
        learning_clouds: count(schema::LEARNING_CLOUDS, default.learning_clouds, 0)?,
        ..default
    };
    CloudTracker::new(settings.clone()).map_err(of_vision)?;
    let depth = t.get("depth").map(|v| {
        let lens = v.table(DEPTH)?;
        lens.only(&names(&[schema::LENS, schema::DEPTH]))?;
        let camera = Camera::new(sensor::intrinsics(&lens)?, settings.sensor_in_world).map_err(of_vision)?;
        Ok((camera, units.positive_length(&lens.need("step", DEPTH)?)?))
    });
    let depth = depth.transpose()?;
    sensor::sensor(name, t, cell, ("clouds", false), SensorKind::Cloud { settings, depth })
}
