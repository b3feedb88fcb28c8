//! Obstacles that a camera or a source of point clouds of a cell sees, and the cells of joint space that they block
//! (`elbowroom watch`).

mod joint_track;
mod record;
mod sensor;

use std::path::{Path, PathBuf};

use elbowroom_cell::{Cell, CellSensor, SensorKind};
use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, LayerMap, RemainingJoints};
use elbowroom_formats::frame_files::{self, FrameFile, FrameKind};
use elbowroom_formats::{Diagnostic, read_file};
use elbowroom_perception::{Prism, WatchedRobot};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_vision::ArmPart;

use crate::cover_cache::CoverCache;
use crate::map::mapped_joints::MappedJoints;
use crate::map::select_map;
use joint_track::JointTrack;
use sensor::Sensor;

use self::record::NoUpdate;
pub use record::{HiddenFloorRecord, WatchRecord, WatchStatus, WatchedObstacle};

/// Largest picture or cloud, bytes.
const MAX_BYTES: u64 = 1 << 30;
/// Largest deviation (rad or m) of a motion from the polyline through its samples.
const CURVE_MARGIN: f64 = 1e-3;

/// A request to watch a sensor.
#[derive(Debug, Clone, Default)]
pub struct WatchRequest {
    /// The sensor; optional if there is only one that fits.
    pub sensor: Option<String>,
    /// Source of its pictures or clouds.
    pub input: WatchInput,
    /// Joint values over time; `None`: the file that the cell file names. Without either all robots stay at their
    /// start.
    pub joints: Option<PathBuf>,
}

/// Source of pictures or clouds.
#[derive(Debug, Clone, Default)]
pub enum WatchInput {
    /// The folder that the cell file names.
    #[default]
    CellFile,
    /// A folder of pictures, of a camera or of depths.
    Pictures(PathBuf),
    /// A folder of point clouds.
    Clouds(PathBuf),
    /// Pictures are passed one by one ([`SensorWatch::record_bytes`]).
    Stream,
}

/// A sensor of a cell, its pictures or clouds, and the map of a robot.
#[derive(Debug)]
pub struct SensorWatch {
    /// Warnings for the user; records can add to them.
    pub warnings: Vec<Diagnostic>,
    /// A warning about the sensor, still without text.
    about: Diagnostic,
    files: Vec<FrameFile>,
    joints: JointTrack,
    sensor: Sensor,
    mapped: MapScope,
}

/// The robot and the joints for which the map proves paths free.
#[derive(Debug, Clone)]
struct MapScope {
    robot: RobotId,
    /// Indices among the robot's joint values.
    joints: [usize; 3],
    /// The map holds for all values of the other joints.
    others_are_any: bool,
}

impl SensorWatch {
    /// Opens the sensor and the files of a request.
    ///
    /// # Errors
    /// [`Diagnostic`] names the file and the line, or the key that is missing.
    pub fn new(cell: &Cell, request: &WatchRequest) -> Result<Self, Diagnostic> {
        let sensor = select_sensor(cell, request)?;
        let folder = match &request.input {
            WatchInput::Pictures(folder) | WatchInput::Clouds(folder) => Some(folder),
            WatchInput::CellFile => sensor.folder.as_ref(),
            WatchInput::Stream => return Self::of_sensor(cell, sensor, Vec::new(), request.joints.as_deref()),
        };
        let folder = folder.ok_or_else(|| without_folder(cell, sensor))?;
        let (files, warnings) = read_folder(sensor, folder, &request.input)?;
        let mut watch = Self::of_sensor(cell, sensor, files, request.joints.as_deref())?;
        watch.warnings.extend(warnings);
        Ok(watch)
    }

    /// Opens a sensor with the folder that the cell file names, for a run.
    ///
    /// # Errors
    /// As for [`SensorWatch::new`].
    pub fn in_run(cell: &Cell, sensor: &CellSensor) -> Result<Self, Diagnostic> {
        let folder = sensor.folder.as_ref().ok_or_else(|| without_folder(cell, sensor))?;
        let (files, warnings) = read_folder(sensor, folder, &WatchInput::CellFile)?;
        let mut watch = Self::of_sensor(cell, sensor, files, None)?;
        watch.warnings.extend(warnings);
        Ok(watch)
    }

    /// A sensor of a live cell: what it sees is sent, one by one ([`record_sent`](Self::record_sent)).
    ///
    /// # Errors
    /// [`Diagnostic`] if its robot has no map of three joints.
    pub fn sent(cell: &Cell, sensor: &CellSensor) -> Result<Self, Diagnostic> {
        Self::of_sensor(cell, sensor, Vec::new(), None)
    }

    fn of_sensor(
        cell: &Cell,
        sensor: &CellSensor,
        files: Vec<FrameFile>,
        joints: Option<&Path>,
    ) -> Result<Self, Diagnostic> {
        let mut warnings = Vec::new();
        let joints = JointTrack::read(cell, joints.or(sensor.joints.as_deref()), &mut warnings)?;
        let (builder, mapped) = map_builder(cell, sensor, &mut warnings)?;
        let robots = cell
            .robots
            .iter()
            .map(|r| WatchedRobot { robot: r.robot.clone(), base_in_world: r.base_in_world })
            .collect();
        let refuse = |what: String| refusal(cell, sensor, &what);
        let about = Diagnostic::new(&cell.file, sensor.line, format!("{} \"{}\": ", sensor.table(), sensor.name));
        let sensor = Sensor::new(sensor, robots, fixed_objects(cell), builder).map_err(|e| refuse(e.to_string()))?;
        Ok(Self { warnings, about, files, joints, sensor, mapped })
    }

    /// The pictures or clouds of the folder, in the order of time; empty for a stream.
    pub fn files(&self) -> &[FrameFile] {
        &self.files
    }

    /// The obstacles in the map.
    pub fn prisms(&self) -> &[Prism] {
        self.sensor.prisms()
    }

    /// The joint-space map.
    pub fn map(&self) -> &LayerMap {
        self.sensor.map()
    }

    /// True if the map proves that a path of a robot is free.
    ///
    /// This needs free cells everywhere on and near the polyline through these joint values (rad or m). The map does
    /// not contain what the robot carries.
    pub fn proves_free<'q>(&self, robot: RobotId, path: impl IntoIterator<Item = &'q [f64]>) -> bool {
        let MapScope { robot: mapped, joints, others_are_any } = self.mapped;
        if self.prisms().is_empty() {
            return true;
        }
        if robot != mapped || !others_are_any {
            return false;
        }
        let points: Vec<[f64; 3]> = path.into_iter().map(|q| joints.map(|j| q[j])).collect();
        let ends = points.first().zip(points.last()).map(|(first, last)| [[*first; 2], [*last; 2]]);
        let segments = points.windows(2).map(|w| [w[0], w[1]]);
        segments.chain(ends.into_iter().flatten()).all(|segment| self.is_free_around(segment))
    }

    /// True if all cells around a segment of the map's joints are free.
    fn is_free_around(&self, [a, b]: [[f64; 3]; 2]) -> bool {
        let (grid, occupancy) = (self.map().grid(), self.map().occupancy());
        let cell =
            |towards: fn(f64, f64) -> f64, margin: f64| grid.cell([0, 1, 2].map(|i| towards(a[i], b[i]) + margin));
        let (Some(low), Some(high)) = (cell(f64::min, -CURVE_MARGIN), cell(f64::max, CURVE_MARGIN)) else {
            return false;
        };
        let ranges = [0, 1, 2].map(|i| low[i]..=high[i]);
        let [first, second, third] = ranges;
        first.into_iter().all(|i| second.clone().all(|j| third.clone().all(|k| !occupancy.is_blocked([i, j, k]))))
    }

    /// The record of a picture or cloud of the folder, by its number. The numbers must come in order.
    ///
    /// A picture that cannot be used gives a record with the reason; obstacles and map stay as they were.
    pub fn record(&mut self, index: usize) -> WatchRecord {
        self.record_with(index, None)
    }

    /// Like [`record`](Self::record), for a run.
    ///
    /// At times that the file of joint values does not cover, and without such a file, the robots are at `q` (rad or
    /// m).
    pub fn record_in_run(&mut self, index: usize, q: &[Vec<f64>]) -> WatchRecord {
        let recorded = self.joints.recorded_at(self.files[index].t_s);
        self.record_with(index, Some(recorded.as_deref().unwrap_or(q)))
    }

    fn record_with(&mut self, index: usize, q: Option<&[Vec<f64>]>) -> WatchRecord {
        let FrameFile { path, t_s } = self.files[index].clone();
        let bytes = read_file(&path, MAX_BYTES, "a smaller picture or a thinner cloud");
        match bytes {
            Ok(bytes) => self.process(&bytes, &path, t_s, q),
            Err(e) => WatchRecord::of(&path, t_s, Err(e.into()), &self.sensor),
        }
    }

    /// The record of a picture of a stream: its bytes, a name for messages, and its time (s).
    pub fn record_bytes(&mut self, bytes: &[u8], name: &Path, t_s: f64) -> WatchRecord {
        self.process(bytes, name, t_s, None)
    }

    /// The record of a picture or cloud that was sent: its bytes, a name for messages, when it was taken (s), and where the robots
    /// were then (rad or m).
    pub fn record_sent(&mut self, bytes: &[u8], name: &Path, t_s: f64, q: &[Vec<f64>]) -> WatchRecord {
        self.process(bytes, name, t_s, Some(q))
    }

    fn process(&mut self, bytes: &[u8], name: &Path, t_s: f64, q: Option<&[Vec<f64>]>) -> WatchRecord {
        let q = q.map_or_else(|| self.joints.at(t_s), |q| Ok(q.to_vec()));
        let result = q.map_err(NoUpdate::from).and_then(|q| Ok(self.sensor.process(bytes, name, t_s, &q)?));
        let record = WatchRecord::of(name, t_s, result, &self.sensor);
        if let Some(hidden) = &record.hidden_floor {
            let about = self.about.clone();
            self.warnings.push(
                Diagnostic { message: format!("{}{hidden}", about.message), ..about }.hint(record::SHOW_THE_FLOOR),
            );
        }
        record
    }
}

fn refusal(cell: &Cell, sensor: &CellSensor, what: &str) -> Diagnostic {
    Diagnostic::new(&cell.file, sensor.line, format!("{} \"{}\": {what}", sensor.table(), sensor.name))
}

fn without_folder(cell: &Cell, sensor: &CellSensor) -> Diagnostic {
    let (what, hint) = match sensor.kind {
        SensorKind::Camera { .. } => ("has no pictures", "--frames DIR, or frames = \"DIR\""),
        SensorKind::Cloud { .. } => ("has no clouds", "--clouds DIR, or clouds = \"DIR\""),
    };
    refusal(cell, sensor, what).hint(hint)
}

/// The files of a sensor: pictures for a camera or for depths, otherwise clouds.
fn read_folder(
    sensor: &CellSensor,
    folder: &Path,
    input: &WatchInput,
) -> Result<(Vec<FrameFile>, Vec<Diagnostic>), Diagnostic> {
    let kind = match (&sensor.kind, input) {
        (SensorKind::Cloud { depth: None, .. }, WatchInput::CellFile | WatchInput::Clouds(_)) => FrameKind::Cloud,
        _ => FrameKind::Picture,
    };
    frame_files::read(folder, kind)
}

/// The sensor that a request names, or the only one that fits.
fn select_sensor<'c>(cell: &'c Cell, request: &WatchRequest) -> Result<&'c CellSensor, Diagnostic> {
    let refuse = |what: String, hint: String| Diagnostic::new(&cell.file, None, what).hint(hint);
    let fits = |s: &&CellSensor| match request.input {
        WatchInput::CellFile => true,
        WatchInput::Pictures(_) | WatchInput::Stream => matches!(s.kind, SensorKind::Camera { .. }),
        WatchInput::Clouds(_) => matches!(s.kind, SensorKind::Cloud { .. }),
    };
    let table = if matches!(request.input, WatchInput::Clouds(_)) { "cloud" } else { "camera" };
    let all: Vec<&CellSensor> = cell.sensors.iter().filter(fits).collect();
    match (&request.sensor, &all[..]) {
        (_, []) => Err(refuse(format!("has no {table}"), format!("[{table}.NAME]   (docs/cell-file.md has its keys)"))),
        (None, [only]) => Ok(only),
        (None, [first, ..]) => Err(refuse(format!("has several {table}s"), format!("--camera {}", first.name))),
        (Some(name), all) => all.iter().copied().find(|s| s.name == *name).ok_or_else(|| {
            let known = all.iter().map(|s| s.name.as_str());
            refuse(format!("has no {table} \"{name}\""), elbowroom_formats::suggest::hint(name, known))
        }),
    }
}

/// The objects that no drive moves, as solids in the world. The first place of a gripped part stays in the list.
fn fixed_objects(cell: &Cell) -> Vec<ArmPart> {
    let moves = |o: ObjectId| cell.moving_objects.iter().any(|m| m.object == o);
    let fixed = cell.objects.iter().enumerate().filter(|(i, _)| !moves(ObjectId(*i)));
    fixed.filter_map(|(_, o)| ArmPart::from_shape(&o.shape, &o.in_world)).collect()
}

/// The builder of the map of the sensor's robot, over three joints.
fn map_builder(
    cell: &Cell,
    sensor: &CellSensor,
    warnings: &mut Vec<Diagnostic>,
) -> Result<(CoverMapBuilder, MapScope), Diagnostic> {
    let (_, robot, spec) = select_map(cell, Some(&cell.robots[sensor.robot.0].name))?;
    let refuse = |what: String, hint: &str| {
        Diagnostic::new(&cell.file, spec.line, format!("robot \"{}\": {what}", robot.name)).hint(hint)
    };
    let purpose = format!("obstacles of a {}", sensor.table());
    let MappedJoints { joints, grid } = MappedJoints::of(cell, robot, (&purpose, None), warnings)?;
    let others = if spec.others_at_start { RemainingJoints::Fixed(&robot.start) } else { RemainingJoints::Swept };
    let (settings, covers) = (CoverMapSettings::default(), CoverCache::of_user());
    let builder =
        CoverMapBuilder::with_covers(&robot.robot, robot.base_in_world, &grid, joints, others, settings, &covers)
            .map_err(|e| refuse(e.to_string(), "joints = [\"joint_1\", \"joint_2\", \"joint_3\"]"))?;
    Ok((builder, MapScope { robot: sensor.robot, joints, others_are_any: !spec.others_at_start }))
}
