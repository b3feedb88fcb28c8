//! What the sensors of a cell see during a run: obstacles that no file names.

use std::sync::Arc;

use elbowroom_analysis::watch::{SensorWatch, WatchRecord, WatchStatus};
use elbowroom_cell::{Cell, CellSensor};
use elbowroom_formats::{FormatError, Warning};
use elbowroom_perception::Prism;
use elbowroom_proximity::{HullError, Shape};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use crate::recording::{SensorTrack, TickTimes};

/// An obstacle that a sensor sees, as solids in the world.
#[derive(Debug, Clone)]
pub(super) struct PerceivedObstacle {
    /// `sensor#number`.
    pub name: String,
    /// Where it was seen, with the uncertainty.
    pub observed: PerceivedSolid,
    /// That, and where it will be.
    pub predicted: PerceivedSolid,
}

/// A solid in the world.
#[derive(Debug, Clone)]
pub(super) struct PerceivedSolid {
    pub shape: Shape,
    /// Boxes that together contain it, for joint-space maps.
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

/// One sensor, as far as its pictures or clouds were taken in.
#[derive(Debug)]
struct RunSensor<'a> {
    spec: &'a CellSensor,
    watch: SensorWatch,
    /// Number of the next picture or cloud.
    next: usize,
    /// Stamp of the last accepted one, s.
    accepted_s: Option<f64>,
    obstacles: Vec<PerceivedObstacle>,
    records: Vec<WatchRecord>,
    processing_ns: Vec<u64>,
}

impl RunSensor<'_> {
    /// Takes in all pictures that are due; true if one was accepted.
    fn take_in(&mut self, t_s: f64, q_at: &dyn Fn(f64) -> Vec<Vec<f64>>) -> bool {
        let mut is_accepted = false;
        while let Some(stamp_s) = self.watch.files().get(self.next).map(|f| f.t_s) {
            // A picture at the time of a tick is due at that tick, whatever the rounding.
            if stamp_s + self.spec.latency_s > t_s + 1e-9 {
                break;
            }
            let record = self.watch.record_in_run(self.next, &q_at(stamp_s));
            self.next += 1;
            let obstacles = self.watch.prisms().iter().map(|p| PerceivedObstacle::of(&self.spec.name, p));
            // A prism without a volume says nothing of where the obstacle is: as if the picture were rejected.
            if record.status == WatchStatus::Accepted
                && let Ok(obstacles) = obstacles.collect::<Result<Vec<_>, _>>()
            {
                (self.obstacles, self.accepted_s) = (obstacles, Some(stamp_s));
                is_accepted = true;
            }
            self.records.push(record);
        }
        is_accepted
    }
}

/// The sensors of a cell that have a folder of pictures or clouds.
#[derive(Debug)]
pub(super) struct PerceivedObstacles<'a> {
    sensors: Vec<RunSensor<'a>>,
}

impl<'a> PerceivedObstacles<'a> {
    /// Opens the folders of the sensors.
    ///
    /// # Errors
    /// [`FormatError`] if a folder cannot be read, or the robot of a sensor has no map of three joints.
    pub fn of_cell(cell: &'a Cell, notes: &mut Vec<Warning>) -> Result<Self, FormatError> {
        let mut sensors = Vec::new();
        for spec in cell.sensors.iter().filter(|s| s.folder.is_some() && !s.robots.is_empty()) {
            let mut watch = SensorWatch::in_run(cell, spec)?;
            notes.append(&mut watch.warnings);
            sensors.push(RunSensor {
                spec,
                watch,
                next: 0,
                accepted_s: None,
                obstacles: Vec::new(),
                records: Vec::new(),
                processing_ns: Vec::new(),
            });
        }
        Ok(Self { sensors })
    }

    /// Time (s) that a search for a path of a robot takes, the longest of its sensors; `None` for a robot that no sensor guards.
    pub fn search_s(&self, robot: RobotId) -> Option<f64> {
        self.of_robot(robot).map(|s| s.spec.search_s).reduce(f64::max)
    }

    fn of_robot(&self, robot: RobotId) -> impl Iterator<Item = &RunSensor<'a>> {
        self.sensors.iter().filter(move |s| s.spec.robots.contains(&robot))
    }

    /// Takes in what is due at a time (s); `q_at` are the joint values of all robots at an earlier time. True if
    /// something was accepted.
    pub fn take_in(&mut self, t_s: f64, q_at: &dyn Fn(f64) -> Vec<Vec<f64>>) -> bool {
        let mut is_accepted = false;
        for sensor in &mut self.sensors {
            is_accepted |= sensor.take_in(t_s, q_at);
        }
        is_accepted
    }

    /// Adds the wall-clock time (ns) from the pictures that were taken in last until the paths of all robots were checked.
    pub fn add_processing_time(&mut self, ns: u64) {
        for sensor in &mut self.sensors {
            sensor.processing_ns.push(ns);
        }
    }

    /// What a robot keeps clear of.
    pub fn obstacles(&self, robot: RobotId) -> impl Iterator<Item = &PerceivedObstacle> {
        self.of_robot(robot).flat_map(|s| &s.obstacles)
    }

    /// True if the joint-space maps prove a path of a robot free (rad or m).
    pub fn prove_free(&self, robot: RobotId, path: &[(f64, Vec<f64>)]) -> bool {
        self.of_robot(robot).all(|s| s.watch.proves_free(robot, path.iter().map(|(_, q)| &q[..])))
    }

    /// The sensor of a robot whose last accepted picture is too old at a time (s), or that has none yet.
    pub fn stale(&self, robot: RobotId, t_s: f64) -> Option<&str> {
        let is_stale = |s: &&RunSensor<'_>| !s.accepted_s.is_some_and(|stamp_s| t_s - stamp_s <= s.spec.stale_s);
        self.of_robot(robot).find(is_stale).map(|s| s.spec.name.as_str())
    }

    /// True if pictures or clouds are still to come.
    pub fn has_more(&self) -> bool {
        self.sensors.iter().any(|s| s.next < s.watch.files().len())
    }

    /// What the sensors found that the user should know.
    pub fn take_warnings(&mut self, notes: &mut Vec<Warning>) {
        self.sensors.iter_mut().for_each(|s| notes.append(&mut s.watch.warnings));
    }

    /// The recording.
    pub fn finish(self) -> Vec<SensorTrack> {
        let track = |s: RunSensor<'_>| SensorTrack {
            name: s.spec.name.clone(),
            kind: s.spec.table(),
            latency_s: s.spec.latency_s,
            records: s.records,
            processing_ns: TickTimes::of(s.processing_ns),
        };
        self.sensors.into_iter().map(track).collect()
    }
}
