//! A rendered scene with a tracker.

#![allow(dead_code, reason = "each test file uses its own part")]

use elbowroom_spatial::Vec3;
use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom_vision::{
    ArmPart, Camera, CameraTracker, CameraTrackerSettings, Channels, Frame, FrameReport, FrameStatus, Intrinsics,
    Obstacle, PixelMask, Point2, polygon,
};

/// Time between frames, seconds.
pub const PERIOD_S: f64 = 0.04;

pub struct SyntheticScene {
    pub tracker: CameraTracker,
    pub renderer: Renderer,
    pub frame: Frame,
    pub conditions: RenderConditions,
    pub frames: u32,
    mask: PixelMask,
}

/// A camera 4 m above the floor; a pixel is about 7.7 mm of the floor at 640 columns.
pub fn camera(width: usize, height: usize) -> Camera {
    let lens = Intrinsics::pinhole(width, height, 1.1);
    Camera::look_at(lens, Vec3::new(0.2, -0.3, 4.0), Vec3::new(0.2, -0.2, 0.0), Vec3::Y).unwrap()
}

impl SyntheticScene {
    pub fn new(width: usize, height: usize, settings: CameraTrackerSettings) -> Self {
        Self::with_camera(camera(width, height), Channels::Grey, settings)
    }

    pub fn with_camera(camera: Camera, channels: Channels, settings: CameraTrackerSettings) -> Self {
        let (width, height) = (camera.intrinsics().width, camera.intrinsics().height);
        let mut scene = Self {
            tracker: CameraTracker::new(camera.clone().into(), settings).unwrap(),
            renderer: Renderer::new(camera, channels, 3),
            frame: Frame::default(),
            conditions: RenderConditions::default(),
            frames: 0,
            mask: PixelMask::new(width, height),
        };
        while scene.tracker.settings().learning_frames > scene.frames {
            let report = scene.step(&[]);
            assert!(matches!(report.status, FrameStatus::Learning { .. }) && report.obstacles.is_empty());
        }
        scene
    }

    pub fn step(&mut self, solids: &[RenderedSolid]) -> &FrameReport {
        self.step_with_arm(solids, &[])
    }

    pub fn step_with_arm(&mut self, solids: &[RenderedSolid], arm: &[ArmPart]) -> &FrameReport {
        self.frames += 1;
        self.conditions.seed += 1;
        self.frame.stamp_s = f64::from(self.frames) * PERIOD_S;
        let painted: Vec<(ArmPart, u8)> = arm.iter().map(|part| (part.clone(), 225)).collect();
        self.renderer.render(solids, &painted, &self.conditions, &mut self.frame).unwrap();
        self.mask.clear();
        self.mask.mask_arm(self.tracker.calibration(), arm, 0.02).unwrap();
        self.tracker.process(&self.frame, Some(&self.mask)).unwrap()
    }
}

/// Whether the prism contains the solid.
pub fn covers(obstacle: &Obstacle, solid: &RenderedSolid) -> bool {
    obstacle.z_from_m <= solid.z_from_m
        && obstacle.z_to_m >= solid.z_to_m
        && solid.footprint_m.iter().all(|&p| polygon::convex_contains(&obstacle.footprint_m, p))
}

/// Whether each sample of the solid's footprint is in at least one of the prisms.
pub fn cover_together(obstacles: &[Obstacle], solid: &RenderedSolid) -> bool {
    let middle = polygon::centroid(&solid.footprint_m);
    let samples = polygon::edges(&solid.footprint_m).flat_map(|(a, b)| {
        (0..10).flat_map(move |i| {
            let on_edge = a + (b - a) * (f64::from(i) / 10.0);
            [1.0, 0.7, 0.3].map(|k| middle + (on_edge - middle) * k)
        })
    });
    samples
        .into_iter()
        .all(|p| obstacles.iter().any(|o| o.z_to_m >= solid.z_to_m && polygon::convex_contains(&o.footprint_m, p)))
}

pub fn middle(solid: &RenderedSolid) -> Point2 {
    polygon::centroid(&solid.footprint_m)
}

pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
