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
    /// Kind of the sensor, with its settings.
    pub kind: SensorKind,
    /// The robot whose map contains its obstacles.
    pub robot: RobotId,
    /// Time for which a moving obstacle also blocks its predicted positions, s.
    pub prediction_s: f64,
    /// The folder of its pictures or clouds.
    pub folder: Option<PathBuf>,
    /// The file of joint values at the times of the pictures or clouds.
    pub joints: Option<PathBuf>,
    /// Time (s) from a stamp until its obstacles count in a run: transmission and perception.
    pub latency_s: f64,
    /// Time (s) that a search for a path around its obstacles takes in a run, which is also its limit.
    pub search_s: f64,
    /// Age (s) of the last stamp from which the sensor is stale in a run.
    pub stale_s: f64,
    /// The robots that avoid its obstacles in a run.
    pub robots: Vec<RobotId>,
}

/// Kind of a sensor, with its settings.
#[derive(Debug, Clone)]
pub enum SensorKind {
    /// Pictures of a calibrated camera above the floor.
    Camera {
        /// Lens and pose in the world.
        camera: Camera,
        /// Settings of the detection and tracking of obstacles.
        settings: CameraTrackerSettings,
        /// Width by which the silhouette of the robots is dilated, m.
        mask_margin_m: f64,
    },
    /// Point clouds.
    Cloud {
        /// Pose, and settings of the detection and tracking of obstacles.
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
