//! Sensors that see obstacles: cameras and sources of point clouds.

use std::path::PathBuf;

use elbowroom_robot::RobotId;
use elbowroom_vision::cloud::CloudTrackerSettings;
use elbowroom_vision::{Camera, CameraTrackerSettings};

/// A camera or a source of point clouds.
#[derive(Debug, Clone)]
pub struct CellSensor {
    /// Its name.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// What it measures, and how.
    pub kind: SensorKind,
    /// The robot in whose map its obstacles are.
    pub robot: RobotId,
    /// How long a moving obstacle also blocks where it will be, s.
    pub prediction_s: f64,
    /// The folder of its pictures or clouds.
    pub folder: Option<PathBuf>,
    /// The joint values at their times.
    pub joints: Option<PathBuf>,
    /// Time (s) from a stamp until its obstacles count in a run: transmission and perception.
    pub latency_s: f64,
    /// Time (s) that a search for a path around its obstacles may take in a run, and takes.
    pub search_s: f64,
    /// Time (s) after the last stamp from which nothing is known any more in a run.
    pub stale_s: f64,
    /// The robots that keep clear of its obstacles in a run.
    pub robots: Vec<RobotId>,
}

/// What a sensor measures.
#[derive(Debug, Clone)]
pub enum SensorKind {
    /// Pictures of a calibrated camera above the floor.
    Camera {
        /// Lens and pose in the world.
        camera: Camera,
        /// How obstacles are detected and tracked.
        settings: CameraTrackerSettings,
        /// By how much the silhouette of the robots is dilated, m.
        mask_margin_m: f64,
    },
    /// Point clouds.
    Cloud {
        /// Pose, and how obstacles are detected and tracked.
        settings: CloudTrackerSettings,
        /// For depth pictures: lens and pose, and metres per step of depth; `None` for files of points.
        depth: Option<(Camera, f64)>,
    },
}

impl CellSensor {
    /// `camera` or `cloud`: its table in the cell file.
    pub fn table(&self) -> &'static str {
        match self.kind {
            SensorKind::Camera { .. } => "camera",
            SensorKind::Cloud { .. } => "cloud",
        }
    }
}
