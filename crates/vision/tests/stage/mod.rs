//! A rendered cell with a watcher.

#![allow(dead_code, reason = "each test file uses its own part")]

use elbowroom_spatial::Vec3;
use elbowroom_vision::render::{Conditions, Renderer, Solid};
use elbowroom_vision::{
    ArmPart, Camera, Channels, Frame, Intrinsics, Obstacle, PixelMask, Point2, Report, Settings, Sight, Vision, polygon,
};

/// Seconds between frames.
pub const PERIOD_S: f64 = 0.04;

pub struct Stage {
    pub vision: Vision,
    pub renderer: Renderer,
    pub frame: Frame,
    pub conditions: Conditions,
    pub frames: u32,
    mask: PixelMask,
}

/// Looks down from 4 m; a pixel is about 7.7 mm of the floor at 640 columns.
pub fn camera(width: usize, height: usize) -> Camera {
    let lens = Intrinsics::ideal(width, height, 1.1);
    Camera::looking_at(lens, Vec3::new(0.2, -0.3, 4.0), Vec3::new(0.2, -0.2, 0.0), Vec3::Y).unwrap()
}

impl Stage {
    pub fn new(width: usize, height: usize, settings: Settings) -> Self {
        Self::with_camera(camera(width, height), Channels::Grey, settings)
    }

    pub fn with_camera(camera: Camera, channels: Channels, settings: Settings) -> Self {
        let (width, height) = (camera.intrinsics().width, camera.intrinsics().height);
        let mut stage = Self {
            vision: Vision::new(camera.clone().into(), settings).unwrap(),
            renderer: Renderer::new(camera, channels, 3),
            frame: Frame::default(),
            conditions: Conditions::default(),
            frames: 0,
            mask: PixelMask::new(width, height),
        };
        while stage.vision.settings().learning_frames > stage.frames {
            let report = stage.step(&[]);
            assert!(matches!(report.sight, Sight::Learning { .. }) && report.obstacles.is_empty());
        }
        stage
    }

    pub fn step(&mut self, solids: &[Solid]) -> &Report {
        self.step_with_arm(solids, &[])
    }

    pub fn step_with_arm(&mut self, solids: &[Solid], arm: &[ArmPart]) -> &Report {
        self.frames += 1;
        self.conditions.seed += 1;
        self.frame.stamp_s = f64::from(self.frames) * PERIOD_S;
        let painted: Vec<(ArmPart, u8)> = arm.iter().map(|part| (part.clone(), 225)).collect();
        self.renderer.render(solids, &painted, &self.conditions, &mut self.frame).unwrap();
        self.mask.clear();
        self.mask.hide_arm(self.vision.calibration(), arm, 0.02).unwrap();
        self.vision.process(&self.frame, Some(&self.mask)).unwrap()
    }
}

/// Whether the prism told contains the solid.
pub fn covers(obstacle: &Obstacle, solid: &Solid) -> bool {
    obstacle.z_from_m <= solid.z_from_m
        && obstacle.z_to_m >= solid.z_to_m
        && solid.footprint_m.iter().all(|&p| polygon::convex_contains(&obstacle.footprint_m, p))
}

/// Whether corners, edges and inside of the solid's footprint lie in one or another of the prisms told.
pub fn cover_together(obstacles: &[Obstacle], solid: &Solid) -> bool {
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

pub fn middle(solid: &Solid) -> Point2 {
    polygon::centroid(&solid.footprint_m)
}

pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
