//! A simulated cell for tests: a KR125 below a camera with rendered images.
#![allow(dead_code)]

use std::path::Path;
use std::sync::Arc;

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_kinematics::ChainState;
use elbowroom_perception::{
    ExactPathChecker, ExecutorSettings, ExecutorStep, MappedArm, ObstacleUpdate, PerceptionError, PerceptionPipeline,
    PerceptionSettings, ReplanResult, ReplanningExecutor,
};
use elbowroom_planner::KinematicLimits;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom_vision::{Camera, CameraTrackerSettings, Channels, Frame, FrameStatus, Intrinsics, Point2, encode_png};

pub const PERIOD_S: f64 = 0.04;
pub const TICK_S: f64 = 0.004;
pub const A: [f64; 6] = [60.0, -31.1, 76.6, 0.0, 44.5, 0.0];
pub const B: [f64; 6] = [-60.0, -31.1, 76.6, 0.0, 44.5, 0.0];

pub fn radians(degrees: [f64; 6]) -> Vec<f64> {
    degrees.iter().map(|d| d.to_radians()).collect()
}

pub fn arm() -> Arc<MappedArm> {
    let urdf = elbowroom_testkit::folder::model("kr125");
    let options = LoadOptions { srdf: Some(urdf.with_extension("srdf")), ..LoadOptions::default() };
    Arc::new(MappedArm::kr125(load(&urdf, &options).unwrap().robot, Pose::IDENTITY))
}

pub fn limits() -> KinematicLimits {
    let deg = |value: f64| vec![value.to_radians(); 3];
    KinematicLimits { velocity: deg(100.0), acceleration: deg(200.0), jerk: deg(2000.0) }
}

pub fn camera() -> Camera {
    let lens = Intrinsics::pinhole(320, 240, 0.92);
    Camera::look_at(lens, Vec3::new(1.7, 0.0, 6.5), Vec3::new(1.7, 0.0, 0.0), Vec3::Y).unwrap()
}

pub fn tracker_settings() -> CameraTrackerSettings {
    CameraTrackerSettings {
        area_m: [(0.75, -3.0), (4.8, -3.0), (4.8, 3.0), (0.75, 3.0)].map(|(x, y)| Point2::new(x, y)).to_vec(),
        uncertainty_m: 0.03 + 0.5 * 0.06,
        learning_frames: 30,
        ..CameraTrackerSettings::default()
    }
}

/// A cell whose empty floor is learned while the arm moves.
pub struct SimulatedCell {
    pub arm: Arc<MappedArm>,
    pub pipeline: PerceptionPipeline,
    pub executor: ReplanningExecutor,
    pub t: f64,
    pub q: Vec<f64>,
    pub renderer: Renderer,
    pub frame: Frame,
    chain: ChainState,
    seed: u64,
}

impl SimulatedCell {
    pub fn new() -> Self {
        let arm = arm();
        let step = 3.0_f64.to_radians();
        let settings = PerceptionSettings::default();
        let pipeline =
            PerceptionPipeline::new(Arc::clone(&arm), step, camera().into(), tracker_settings(), settings).unwrap();
        let exact = ExactPathChecker::new(Arc::clone(&arm), Vec::new()).unwrap();
        let q = radians(A);
        let settings = ExecutorSettings::new(limits());
        let executor = ReplanningExecutor::new(
            Arc::clone(&arm),
            pipeline.map().grid(),
            pipeline.reader(),
            Some(exact),
            settings,
            &q,
        )
        .unwrap();
        let chain = ChainState::new(&arm.robot.chain);
        let renderer = Renderer::new(camera(), Channels::Grey, 9);
        let mut cell = Self { arm, pipeline, executor, t: 0.0, q, renderer, frame: Frame::default(), chain, seed: 1 };
        for n in 0..30 {
            let share = 0.5 - 0.5 * (f64::from(n) / 29.0 * std::f64::consts::TAU).cos();
            cell.q = radians(A).iter().zip(radians(B)).map(|(a, b)| a + (b - a) * share).collect();
            let update = cell.process_image(&[]).unwrap();
            assert!(matches!(update.status, FrameStatus::Learning { .. }));
            cell.t += PERIOD_S;
        }
        cell.q = radians(A);
        cell
    }

    /// Renders the image of the camera.
    pub fn render_image(&mut self, solids: &[RenderedSolid]) -> Vec<u8> {
        let mut parts = Vec::new();
        self.arm.parts_in_world(&mut self.chain, &self.q, &mut parts);
        let painted: Vec<_> = parts.into_iter().map(|part| (part, 235)).collect();
        self.seed += 1;
        let conditions = RenderConditions { seed: self.seed, ..RenderConditions::default() };
        self.renderer.render(solids, &painted, &conditions, &mut self.frame).unwrap();
        encode_png(&self.frame).unwrap()
    }

    pub fn process_image(&mut self, solids: &[RenderedSolid]) -> Result<ObstacleUpdate, PerceptionError> {
        let bytes = self.render_image(solids);
        self.send(&bytes)
    }

    pub fn send(&mut self, bytes: &[u8]) -> Result<ObstacleUpdate, PerceptionError> {
        self.pipeline.process_image(bytes, Path::new("camera.png"), self.t, &self.q)
    }

    /// A frame, its obstacle update, and the ticks until the next frame.
    pub fn step(&mut self, solids: &[RenderedSolid]) -> (ObstacleUpdate, ReplanResult, Vec<ExecutorStep>) {
        let update = self.process_image(solids).unwrap();
        let result = self.executor.update(&update);
        (update, result, self.ticks())
    }

    /// The ticks of one frame's period.
    pub fn ticks(&mut self) -> Vec<ExecutorStep> {
        let steps: Vec<ExecutorStep> = (0..10)
            .map(|_| {
                self.t += TICK_S;
                self.executor.tick(self.t, TICK_S)
            })
            .collect();
        self.q.clone_from(&steps[9].q);
        steps
    }
}
