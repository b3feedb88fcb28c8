//! What a camera of a cell sees: obstacles with an identity, and the cells of joint space that they block (`elbowroom watch`).

mod joint_track;
mod record;

use std::path::{Path, PathBuf};

use elbowroom_cell::{Cell, CellCamera};
use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, RemainingJoints};
use elbowroom_formats::{FormatError, Warning, frame_files};
use elbowroom_perception::{ObstacleWatcher, PerceptionSettings, WatchedRobot};
use elbowroom_vision::Frame;

use crate::cover_cache::CoverCache;
use crate::map::{axes, select_map};
use joint_track::JointTrack;

pub use record::{WatchRecord, WatchStatus, WatchedObstacle};

/// What is watched.
#[derive(Debug, Clone, Default)]
pub struct WatchRequest {
    /// The camera; optional if there is only one.
    pub camera: Option<String>,
    /// The folder of pictures; `None`: that of the cell file.
    pub frames: Option<PathBuf>,
    /// Joint values over time; `None`: those of the cell file. Without either all robots stay at their start.
    pub joints: Option<PathBuf>,
}

/// A camera of a cell, its pictures, and the map of a robot.
#[derive(Debug)]
pub struct CameraWatch {
    /// What the user should know.
    pub warnings: Vec<Warning>,
    frames: Vec<frame_files::FrameFile>,
    joints: JointTrack,
    watcher: ObstacleWatcher,
    frame: Frame,
}

impl CameraWatch {
    /// Reads what a request names.
    ///
    /// # Errors
    /// [`FormatError`] names the file and the line, or the key that is missing.
    pub fn new(cell: &Cell, request: &WatchRequest) -> Result<Self, FormatError> {
        let camera = select_camera(cell, request.camera.as_deref())?;
        let refuse =
            |what: String| FormatError::new(&cell.file, camera.line, format!("camera \"{}\": {what}", camera.name));
        let folder = request.frames.as_ref().or(camera.frames.as_ref());
        let folder =
            folder.ok_or_else(|| refuse("has no pictures".into()).hint("--frames DIR, or frames = \"DIR\""))?;
        let (frames, mut warnings) = frame_files::read(folder)?;
        let joints = JointTrack::read(cell, request.joints.as_deref().or(camera.joints.as_deref()), &mut warnings)?;
        let builder = map_builder(cell, camera, &mut warnings)?;
        let robots = cell
            .robots
            .iter()
            .map(|r| WatchedRobot { robot: r.robot.clone(), base_in_world: r.base_in_world })
            .collect();
        let settings = PerceptionSettings {
            prediction_s: camera.prediction_s,
            mask_margin_m: camera.mask_margin_m,
            ..PerceptionSettings::default()
        };
        let watcher =
            ObstacleWatcher::new(robots, builder, camera.camera.clone().into(), camera.settings.clone(), settings)
                .map_err(|e| refuse(e.to_string()))?;
        Ok(Self { warnings, frames, joints, watcher, frame: Frame::default() })
    }

    /// Number of pictures.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// The record of a picture, by its number; they must be taken in order. A picture that cannot be used gives a record that
    /// says why: obstacles and map stay as they were.
    pub fn record(&mut self, index: usize) -> WatchRecord {
        let frames = &self.frames[index];
        let (path, t_s) = (frames.path.clone(), frames.t_s);
        let result = self.process(&path, t_s);
        WatchRecord::of(&path, t_s, result, &self.watcher)
    }

    fn process(&mut self, path: &Path, t_s: f64) -> Result<elbowroom_perception::ObstacleUpdate, String> {
        let q = self.joints.at(t_s)?;
        elbowroom_vision::read(path, None, &mut self.frame).map_err(|e| e.to_string())?;
        self.frame.stamp_s = t_s;
        let q: Vec<&[f64]> = q.iter().map(Vec::as_slice).collect();
        self.watcher.process_frame(&self.frame, &q).map_err(|e| e.to_string())
    }
}

fn select_camera<'c>(cell: &'c Cell, name: Option<&str>) -> Result<&'c CellCamera, FormatError> {
    let names = || cell.cameras.iter().map(|c| c.name.as_str());
    let refuse = |what: String, hint: String| FormatError::new(&cell.file, None, what).hint(hint);
    match (name, &cell.cameras[..]) {
        (_, []) => Err(refuse("has no camera".into(), "[camera.NAME]   (docs/cell-file.md has its keys)".into())),
        (None, [only]) => Ok(only),
        (None, _) => Err(refuse("has several cameras".into(), format!("--camera {}", cell.cameras[0].name))),
        (Some(name), all) => all
            .iter()
            .find(|c| c.name == name)
            .ok_or_else(|| refuse(format!("has no camera \"{name}\""), elbowroom_cell::suggest::hint(name, names()))),
    }
}

/// The builder of the map of the camera's robot, over three joints.
fn map_builder(cell: &Cell, camera: &CellCamera, warnings: &mut Vec<Warning>) -> Result<CoverMapBuilder, FormatError> {
    let (robot, spec) = select_map(cell, Some(&cell.robots[camera.robot.0].name))?;
    let refuse = |what: String, hint: &str| {
        FormatError::new(&cell.file, spec.line, format!("robot \"{}\": {what}", robot.name)).hint(hint)
    };
    let (all, _) = axes(cell, robot, &spec, warnings)?;
    let count = all.len();
    let three = <[GridAxis; 3]>::try_from(all).ok().zip(<[usize; 3]>::try_from(&spec.joints[..]).ok());
    let Some((axes, joints)) = three else {
        let what = format!("the map of a camera has three joints, not {count}");
        return Err(refuse(what, "joints = [\"joint_1\", \"joint_2\", \"joint_3\"]"));
    };
    let grid = Grid::new(axes).map_err(|e| refuse(e.to_string(), "step = 5   (larger)"))?;
    let others = if spec.others_at_start { RemainingJoints::Fixed(&robot.start) } else { RemainingJoints::Swept };
    let (settings, covers) = (CoverMapSettings::default(), CoverCache::of_user());
    CoverMapBuilder::with_covers(&robot.robot, robot.base_in_world, &grid, joints, others, settings, &covers)
        .map_err(|e| refuse(e.to_string(), "joints = [\"joint_1\", \"joint_2\", \"joint_3\"]"))
}
