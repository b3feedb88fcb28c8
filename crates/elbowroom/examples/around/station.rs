//! The cell: a KR125 between two stations, a camera above.

use std::path::PathBuf;
use std::sync::Arc;

use elbowroom::cell::watch::{Exact, Guide, GuideSettings, Watch, WatchSettings, WatchedArm};
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::planner::MotionLimits;
use elbowroom::spatial::{Pose, Vec3};
use elbowroom::vision::{Camera, Intrinsics, Point2, Settings, Template};

pub type Failure = Box<dyn std::error::Error>;

/// Seconds between frames.
pub const PERIOD_S: f64 = 0.04;
/// Seconds from a frame to what it means for the arm, assumed; what it took is told beside it.
pub const LATENCY_S: f64 = 0.02;
/// Seconds of a control tick.
pub const TICK_S: f64 = 0.004;
/// No thing is faster, metres per second.
const FASTEST_MPS: f64 = 0.8;
/// Width of the map's cells, degrees.
pub const STEP_DEG: f64 = 2.0;

/// The two stations, and where to get out of the way: degrees as the KR125 counts them.
pub const STATIONS: [[f64; 6]; 2] = [[60.0, -31.1, 76.6, 0.0, 44.5, 0.0], [-60.0, -31.1, 76.6, 0.0, 44.5, 0.0]];
const RETREAT: [f64; 6] = [0.0, -120.0, 130.0, 0.0, 44.5, 0.0];

pub struct Station {
    pub arm: Arc<WatchedArm>,
    pub camera: Camera,
    pub watch: Watch,
    pub guide: Guide,
}

pub fn radians(degrees: [f64; 6]) -> Vec<f64> {
    degrees.iter().map(|d| d.to_radians()).collect()
}

pub fn camera() -> Result<Camera, Failure> {
    // 6.5 m above the floor, a pixel is 1 cm there; some distortion, as cheap lenses have it.
    let lens = Intrinsics { radial: [-0.03, 0.0, 0.0], ..Intrinsics::ideal(640, 480, 0.92) };
    Ok(Camera::looking_at(lens, Vec3::new(1.7, 0.0, 6.5), Vec3::new(1.7, 0.0, 0.0), Vec3::Y)?)
}

fn seeing() -> Settings {
    Settings {
        // What is in front of the robot. Its foot, which the camera never sees the floor under, is left out.
        cell: [(0.75, -3.0), (4.8, -3.0), (4.8, 3.0), (0.75, 3.0)].map(|(x, y)| Point2::new(x, y)).to_vec(),
        // A pixel and a half, and how far the fastest thing goes until the next frame has been worked up.
        uncertainty_m: 0.015 + FASTEST_MPS * (PERIOD_S + LATENCY_S),
        learning_frames: 60,
        templates: vec![Template::new("bin", 0.8, 0.6, 0.45)],
        most_speed_mps: 2.0,
        ..Settings::default()
    }
}

pub fn build() -> Result<Station, Failure> {
    let urdf = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/models/kr125/kr125.urdf"));
    let srdf = urdf.with_extension("srdf");
    let robot = load(&urdf, &LoadOptions { srdf: Some(srdf), ..LoadOptions::default() })?.robot;
    let arm = Arc::new(WatchedArm::kr125(robot, Pose::IDENTITY));
    let camera = camera()?;
    let settings = WatchSettings { ahead_s: 0.5, ..WatchSettings::default() };
    let watch = Watch::new(Arc::clone(&arm), STEP_DEG.to_radians(), camera.clone().into(), seeing(), settings)?;
    let deg = |value: f64| vec![value.to_radians(); 3];
    let limits = MotionLimits {
        velocity: deg(100.0), // the KR125's
        acceleration: deg(200.0),
        jerk: deg(2000.0),
    };
    let retreat = arm.to_planar(&radians(RETREAT));
    let settings = GuideSettings { retreat: Some(retreat), ..GuideSettings::new(limits) };
    let exact = Exact::new(Arc::clone(&arm), Vec::new())?;
    let start = radians(STATIONS[0]);
    let guide = Guide::new(Arc::clone(&arm), watch.map().grid(), watch.reader(), Some(exact), settings, &start)?;
    Ok(Station { arm, camera, watch, guide })
}
