//! The cell: a KR125 between two stations, a camera above.

use std::path::PathBuf;
use std::sync::Arc;

use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::perception::{
    ExactPathChecker, ExecutorSettings, MappedArm, PerceptionPipeline, PerceptionSettings, ReplanningExecutor,
};
use elbowroom::planner::KinematicLimits;
use elbowroom::spatial::{Pose, Vec3};
use elbowroom::vision::{Camera, CameraTrackerSettings, Intrinsics, Point2, Template};

pub type Failure = Box<dyn std::error::Error>;

/// Seconds between frames.
pub const PERIOD_S: f64 = 0.04;
/// Assumed latency of the pipeline, seconds; the measured time is in the report.
pub const LATENCY_S: f64 = 0.02;
/// Seconds of a control tick.
pub const TICK_S: f64 = 0.004;
/// Largest speed of obstacles, metres per second.
const FASTEST_MPS: f64 = 0.8;
/// Width of the map's cells, degrees.
pub const STEP_DEG: f64 = 2.0;

/// The two stations, and the retreat configuration: degrees, signs of the KR125.
pub const STATIONS: [[f64; 6]; 2] = [[60.0, -31.1, 76.6, 0.0, 44.5, 0.0], [-60.0, -31.1, 76.6, 0.0, 44.5, 0.0]];
const RETREAT: [f64; 6] = [0.0, -120.0, 130.0, 0.0, 44.5, 0.0];

/// The arm, its camera, and the stages that process the images and move the arm.
pub struct Station {
    pub arm: Arc<MappedArm>,
    pub camera: Camera,
    pub pipeline: PerceptionPipeline,
    pub executor: ReplanningExecutor,
}

pub fn radians(degrees: [f64; 6]) -> Vec<f64> {
    degrees.iter().map(|d| d.to_radians()).collect()
}

pub fn camera() -> Result<Camera, Failure> {
    // 6.5 m above the floor, where a pixel is 1 cm; some lens distortion.
    let lens = Intrinsics { radial: [-0.03, 0.0, 0.0], ..Intrinsics::pinhole(640, 480, 0.92) };
    Ok(Camera::look_at(lens, Vec3::new(1.7, 0.0, 6.5), Vec3::new(1.7, 0.0, 0.0), Vec3::Y)?)
}

fn vision_settings() -> CameraTrackerSettings {
    CameraTrackerSettings {
        // The area in front of the robot. Its base is left out: the camera never sees the floor below.
        area_m: [(0.75, -3.0), (4.8, -3.0), (4.8, 3.0), (0.75, 3.0)].map(|(x, y)| Point2::new(x, y)).to_vec(),
        // 1.5 pixels, and the travel of the fastest obstacle until the next frame has been processed.
        uncertainty_m: 0.015 + FASTEST_MPS * (PERIOD_S + LATENCY_S),
        learning_frames: 60,
        templates: vec![Template::new("bin", 0.8, 0.6, 0.45)],
        max_speed_mps: 2.0,
        ..CameraTrackerSettings::default()
    }
}

pub fn build() -> Result<Station, Failure> {
    let urdf = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../examples/models/kr125/kr125.urdf"));
    let srdf = urdf.with_extension("srdf");
    let robot = load(&urdf, &LoadOptions { srdf: Some(srdf), ..LoadOptions::default() })?.robot;
    let arm = Arc::new(MappedArm::kr125(robot, Pose::IDENTITY));
    let camera = camera()?;
    let settings = PerceptionSettings { prediction_s: 0.5, ..PerceptionSettings::default() };
    let pipeline = PerceptionPipeline::new(
        Arc::clone(&arm),
        STEP_DEG.to_radians(),
        camera.clone().into(),
        vision_settings(),
        settings,
    )?;
    let deg = |value: f64| vec![value.to_radians(); 3];
    let limits = KinematicLimits {
        velocity: deg(100.0), // the KR125's
        acceleration: deg(200.0),
        jerk: deg(2000.0),
    };
    let retreat = arm.to_planar(&radians(RETREAT));
    let settings = ExecutorSettings { retreat: Some(retreat), ..ExecutorSettings::new(limits) };
    let exact = ExactPathChecker::new(Arc::clone(&arm), Vec::new())?;
    let start = radians(STATIONS[0]);
    let executor = ReplanningExecutor::new(
        Arc::clone(&arm),
        pipeline.map().grid(),
        pipeline.reader(),
        Some(exact),
        settings,
        &start,
    )?;
    Ok(Station { arm, camera, pipeline, executor })
}
