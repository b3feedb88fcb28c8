//! A camera or a source of point clouds with its tracker and its map.

use std::path::Path;

use elbowroom_cell::{CellSensor, SensorKind};
use elbowroom_cspace::{CoverMapBuilder, LayerMap};
use elbowroom_perception::{
    CloudWatcher, ObstacleUpdate, ObstacleWatcher, PerceptionError, PerceptionSettings, Prism, WatchedRobot,
};
use elbowroom_vision::cloud::PointCloud;
use elbowroom_vision::{ArmPart, Camera, Frame, HiddenFloor, decode, decode_grey16};

/// Decodes what a sensor sends, and tracks what it sees.
#[derive(Debug)]
pub(super) enum Sensor {
    Camera { watcher: Box<ObstacleWatcher>, frame: Frame },
    Cloud { watcher: Box<CloudWatcher>, cloud: PointCloud, depth: Option<(Camera, f64)> },
}

impl Sensor {
    /// Opens a sensor of a cell; `known` are the objects that do not move.
    pub fn new(
        sensor: &CellSensor,
        robots: Vec<WatchedRobot>,
        known: Vec<ArmPart>,
        builder: CoverMapBuilder,
    ) -> Result<Self, PerceptionError> {
        let prediction_s = sensor.prediction_s;
        Ok(match &sensor.kind {
            SensorKind::Camera { camera, settings, mask_margin_m } => {
                let of_mask = PerceptionSettings { prediction_s, mask_margin_m: *mask_margin_m };
                let watcher = ObstacleWatcher::new(robots, builder, camera.clone().into(), settings.clone(), of_mask)?;
                Self::Camera { watcher: Box::new(watcher), frame: Frame::default() }
            }
            SensorKind::Cloud { settings, depth } => {
                let of_map = PerceptionSettings { prediction_s, ..PerceptionSettings::default() };
                let watcher = CloudWatcher::new(robots, builder, settings.clone(), known, of_map)?;
                Self::Cloud { watcher: Box::new(watcher), cloud: PointCloud::default(), depth: depth.clone() }
            }
        })
    }

    pub fn map(&self) -> &LayerMap {
        match self {
            Self::Camera { watcher, .. } => watcher.map(),
            Self::Cloud { watcher, .. } => watcher.map(),
        }
    }

    pub fn prisms(&self) -> &[Prism] {
        match self {
            Self::Camera { watcher, .. } => watcher.prisms(),
            Self::Cloud { watcher, .. } => watcher.prisms(),
        }
    }

    /// The floor that was hidden while the empty cell was learnt; only for a camera.
    pub fn hidden_floor(&self) -> Option<HiddenFloor> {
        match self {
            Self::Camera { watcher, .. } => watcher.tracker().hidden_floor(),
            Self::Cloud { .. } => None,
        }
    }

    /// Processes a picture or cloud: the bytes of its file, its name, its time (s), and the robots' joint values at
    /// that time.
    pub fn process(
        &mut self,
        bytes: &[u8],
        name: &Path,
        t_s: f64,
        q: &[Vec<f64>],
    ) -> Result<ObstacleUpdate, PerceptionError> {
        let q: Vec<&[f64]> = q.iter().map(Vec::as_slice).collect();
        match self {
            Self::Camera { watcher, frame } => {
                decode(bytes, name, None, frame)?;
                frame.stamp_s = t_s;
                watcher.process_frame(frame, &q)
            }
            Self::Cloud { watcher, cloud, depth } => {
                match depth {
                    Some((camera, step_m)) => {
                        let (_, _, depths) = decode_grey16(bytes, name)?;
                        cloud.name = name.to_string_lossy().into_owned();
                        cloud.fill_from_grey16(camera, &depths, *step_m)?;
                    }
                    None => cloud.decode(bytes, name)?,
                }
                cloud.stamp_s = t_s;
                watcher.process_cloud(cloud, &q)
            }
        }
    }
}
