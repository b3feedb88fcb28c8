//! What the sensors of a cell see: obstacles that no file names.

use std::path::Path;
use std::sync::Arc;

use elbowroom_cell::{Cell, CellSensor};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_perception::Prism;
use elbowroom_proximity::{HullError, Shape};
use elbowroom_query::watch::{SensorWatch, WatchRecord, WatchStatus};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use crate::recording::{SensorTrack, TickTimes};

/// An obstacle that a sensor sees, as solids in the world.
#[derive(Debug, Clone)]
pub struct PerceivedObstacle {
    /// Name of the form `sensor#number`.
    pub name: String,
    /// Solid of the observed position, with the uncertainty.
    pub observed: PerceivedSolid,
    /// Solid of the observed and the predicted positions.
    pub predicted: PerceivedSolid,
}

/// A solid in the world.
#[derive(Debug, Clone)]
pub struct PerceivedSolid {
    /// The solid.
    pub shape: Shape,
    /// Boxes that together contain the solid, for joint-space maps.
    pub boxes: Vec<(Shape, Pose)>,
}

impl PerceivedObstacle {
    fn of(sensor: &str, prism: &Prism) -> Result<Self, HullError> {
        Ok(Self {
            name: format!("{sensor}{}", prism.id),
            observed: PerceivedSolid {
                shape: Shape::Hull(Arc::new(prism.observed_solid()?)),
                boxes: prism.observed_boxes(),
            },
            predicted: PerceivedSolid {
                shape: Shape::Hull(Arc::new(prism.predicted_solid()?)),
                boxes: prism.predicted_boxes(),
            },
        })
    }
}

/// When a sensor has last sent something that could be used.
#[derive(Debug, Clone, PartialEq)]
pub struct LastSight {
    /// The sensor.
    pub sensor: String,
    /// When that was taken, s; `None` if there was nothing yet.
    pub taken_s: Option<f64>,
    /// After this time (s) it is too old.
    pub stale_s: f64,
}

impl LastSight {
    /// Whether it is too old at a time (s), or there was nothing yet.
    pub fn is_stale(&self, t_s: f64) -> bool {
        !self.taken_s.is_some_and(|taken_s| t_s - taken_s <= self.stale_s)
    }
}

/// One sensor, as far as its pictures or clouds were processed.
#[derive(Debug)]
struct WatchedSensor<'a> {
    spec: &'a CellSensor,
    watch: SensorWatch,
    /// Number of the next picture or cloud of its folder.
    next: usize,
    /// So many of the folder are processed.
    files: usize,
    last: LastSight,
    /// Why the last picture or cloud was rejected; `None` if it was not.
    rejected: Option<String>,
    obstacles: Vec<PerceivedObstacle>,
    records: Vec<WatchRecord>,
    processing_ns: Vec<u64>,
}

impl<'a> WatchedSensor<'a> {
    fn new(spec: &'a CellSensor, mut watch: SensorWatch, notes: &mut Vec<Diagnostic>) -> Self {
        notes.append(&mut watch.warnings);
        Self {
            spec,
            next: 0,
            files: watch.files().len(),
            watch,
            last: LastSight { sensor: spec.name.clone(), taken_s: None, stale_s: spec.stale_s },
            rejected: None,
            obstacles: Vec::new(),
            records: Vec::new(),
            processing_ns: Vec::new(),
        }
    }

    /// Processes all pictures of the folder that are due; returns whether one was accepted.
    fn process_due(&mut self, t_s: f64, q_at: &dyn Fn(f64) -> Vec<Vec<f64>>) -> bool {
        let mut is_accepted = false;
        while let Some(stamp_s) = self.watch.files()[..self.files].get(self.next).map(|f| f.t_s) {
            // A picture at the time of a tick is due at that tick, in spite of rounding.
            if stamp_s + self.spec.latency_s > t_s + 1e-9 {
                break;
            }
            let record = self.watch.record_in_run(self.next, &q_at(stamp_s));
            self.next += 1;
            is_accepted |= self.accept(&record);
            self.records.push(record);
        }
        is_accepted
    }

    /// Takes over the obstacles of a picture, unless it was rejected; returns whether it did.
    fn accept(&mut self, record: &WatchRecord) -> bool {
        self.rejected.clone_from(&record.reason);
        let obstacles = self.watch.prisms().iter().map(|p| PerceivedObstacle::of(&self.spec.name, p));
        // A prism without a volume does not state where the obstacle is, so the picture is treated as rejected.
        if record.status == WatchStatus::Accepted
            && let Ok(obstacles) = obstacles.collect::<Result<Vec<_>, _>>()
        {
            (self.obstacles, self.last.taken_s) = (obstacles, Some(record.t_s));
            return true;
        }
        false
    }
}

/// The sensors of a cell that guard robots.
#[derive(Debug)]
pub struct PerceivedObstacles<'a> {
    sensors: Vec<WatchedSensor<'a>>,
}

impl<'a> PerceivedObstacles<'a> {
    /// Opens the folders of the sensors that guard robots. Sensors without a folder are omitted.
    ///
    /// # Errors
    /// [`Diagnostic`] if a folder cannot be read, or the robot of a sensor has no map of three joints.
    pub fn of_cell(cell: &'a Cell, notes: &mut Vec<Diagnostic>) -> Result<Self, Diagnostic> {
        let mut sensors = Vec::new();
        for spec in cell.sensors.iter().filter(|s| s.folder.is_some() && !s.robots.is_empty()) {
            sensors.push(WatchedSensor::new(spec, SensorWatch::in_run(cell, spec)?, notes));
        }
        Ok(Self { sensors })
    }

    /// Opens the sensors of a live cell that guard one of these robots.
    ///
    /// A sensor that has no folder, or that `is_sent` accepts, is live: pass each of its pictures or clouds to
    /// [`process`](Self::process). From the folder of a live sensor only files from before the start are processed; they show the
    /// empty cell.
    ///
    /// # Errors
    /// As for [`of_cell`](Self::of_cell).
    pub fn of_live_cell(
        cell: &'a Cell,
        robots: &[RobotId],
        is_sent: impl Fn(&CellSensor) -> bool,
        notes: &mut Vec<Diagnostic>,
    ) -> Result<Self, Diagnostic> {
        let mut sensors = Vec::new();
        for spec in cell.sensors.iter().filter(|s| s.robots.iter().any(|robot| robots.contains(robot))) {
            let has_folder = spec.folder.is_some();
            let watch = if has_folder { SensorWatch::in_run(cell, spec)? } else { SensorWatch::sent(cell, spec)? };
            let mut sensor = WatchedSensor::new(spec, watch, notes);
            if has_folder && is_sent(spec) {
                sensor.files = sensor.watch.files().iter().take_while(|file| file.t_s < 0.0).count();
            }
            sensors.push(sensor);
        }
        Ok(Self { sensors })
    }

    /// Processes a picture or cloud that a sensor has sent: its bytes, when it was taken (s), and where the robots were then. Returns
    /// whether it was accepted.
    pub fn process(&mut self, sensor: &str, bytes: &[u8], t_s: f64, q: &[Vec<f64>]) -> bool {
        let Some(sensor) = self.sensors.iter_mut().find(|s| s.spec.name == sensor) else { return false };
        let record = sensor.watch.record_sent(bytes, Path::new(&sensor.spec.name), t_s, q);
        sensor.accept(&record)
    }

    /// Takes note that a picture or cloud of a sensor cannot be used.
    pub fn reject(&mut self, sensor: &str, why: &str) {
        if let Some(sensor) = self.sensors.iter_mut().find(|s| s.spec.name == sensor) {
            sensor.rejected = Some(why.to_owned());
        }
    }

    /// Per sensor why its last picture or cloud was rejected; `None` if it was not.
    pub fn rejections(&self) -> impl Iterator<Item = (&str, Option<&str>)> {
        self.sensors.iter().map(|s| (s.spec.name.as_str(), s.rejected.as_deref()))
    }

    /// Time (s) that a path search of a robot takes: the longest of its sensors; `None` if no sensor guards the robot.
    pub fn search_s(&self, robot: RobotId) -> Option<f64> {
        self.of_robot(robot).map(|s| s.spec.search_s).reduce(f64::max)
    }

    fn of_robot(&self, robot: RobotId) -> impl Iterator<Item = &WatchedSensor<'a>> {
        self.sensors.iter().filter(move |s| s.spec.robots.contains(&robot))
    }

    /// Processes what is due at a time (s) of the sensors with a folder; `q_at` are the joint values of all robots at an earlier
    /// time. Returns whether something was accepted.
    pub fn process_due(&mut self, t_s: f64, q_at: &dyn Fn(f64) -> Vec<Vec<f64>>) -> bool {
        let mut is_accepted = false;
        for sensor in &mut self.sensors {
            is_accepted |= sensor.process_due(t_s, q_at);
        }
        is_accepted
    }

    /// Adds the wall-clock time (ns) from loading the last pictures to the end of the path checks of all robots.
    pub fn add_processing_time(&mut self, ns: u64) {
        for sensor in &mut self.sensors {
            sensor.processing_ns.push(ns);
        }
    }

    /// Obstacles that a robot avoids.
    pub fn obstacles(&self, robot: RobotId) -> impl Iterator<Item = &PerceivedObstacle> {
        self.of_robot(robot).flat_map(|s| &s.obstacles)
    }

    /// True if the joint-space maps prove that a path (rad or m) of a robot is free.
    pub(super) fn prove_free(&self, robot: RobotId, path: &[(f64, Vec<f64>)]) -> bool {
        self.of_robot(robot).all(|s| s.watch.proves_free(robot, path.iter().map(|(_, q)| &q[..])))
    }

    /// What the sensors of a robot saw last.
    pub fn last_sights(&self, robot: RobotId) -> impl Iterator<Item = &LastSight> {
        self.of_robot(robot).map(|s| &s.last)
    }

    /// True if pictures or clouds remain.
    pub fn has_more(&self) -> bool {
        self.sensors.iter().any(|s| s.next < s.files)
    }

    /// Moves the warnings of the sensors to `notes`.
    pub fn take_warnings(&mut self, notes: &mut Vec<Diagnostic>) {
        self.sensors.iter_mut().for_each(|s| notes.append(&mut s.watch.warnings));
    }

    /// The recording.
    pub(crate) fn finish(self) -> Vec<SensorTrack> {
        let track = |s: WatchedSensor<'_>| SensorTrack {
            name: s.spec.name.clone(),
            kind: s.spec.table(),
            latency_s: s.spec.latency_s,
            records: s.records,
            processing_ns: TickTimes::of(s.processing_ns),
        };
        self.sensors.into_iter().map(track).collect()
    }
}
