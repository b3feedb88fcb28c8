//! Synthetic images of one camera.

use elbowroom_spatial::Vec3;

use super::canvas::Canvas;
use super::conditions::RenderConditions;
use super::random::Random;
use super::solid::RenderedSolid;
use crate::{ArmPart, Camera, Channels, Frame, VisionError, polygon};

/// Renders images of one camera.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
/// use elbowroom_vision::{Camera, Channels, Frame, Intrinsics, Point2};
/// let lens = Intrinsics::pinhole(64, 48, 1.2);
/// let camera = Camera::look_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?;
/// let mut renderer = Renderer::new(camera, Channels::Grey, 7);
/// let mut frame = Frame::default();
/// let pallet = RenderedSolid::cuboid(Point2::new(0.0, 0.0), Vec3::new(1.2, 0.8, 0.15), 0.3, 230);
/// renderer.render(&[pallet], &[], &RenderConditions::default(), &mut frame)?;
/// assert!(frame.row(24)[32] > 200 && frame.row(2)[2] < 160);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Renderer {
    camera: Camera,
    channels: Channels,
    floor: Vec<[u8; 3]>,
    canvas: Canvas,
    /// Distances and indices of solids.
    order: Vec<(f64, usize)>,
}

impl Renderer {
    /// Creates a floor with a texture (waves, joints of slabs, grain) that depends on `seed`.
    pub fn new(camera: Camera, channels: Channels, seed: u64) -> Self {
        let (width, height) = (camera.intrinsics().width, camera.intrinsics().height);
        let mut random = Random::new(seed);
        let pixel = |i: usize| (i % width, i / width);
        let floor = (0..width * height)
            .map(|i| {
                let (x, y) = pixel(i);
                let (u, v) = (x as f64, y as f64);
                let waves = 10.0 * (u / 37.0).sin() * (v / 23.0).cos() + 6.0 * ((u + 2.0 * v) / 11.0).sin();
                let joint = if x % 80 < 2 || y % 80 < 2 { -25.0 } else { 0.0 };
                let level = 115.0 + waves + joint + 5.0 * random.normal();
                [1.05, 1.0, 0.88].map(|tint| (level * tint).clamp(5.0, 250.0) as u8)
            })
            .collect();
        Self { canvas: Canvas::new(width, height), camera, channels, floor, order: Vec::new() }
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Renders an image into `frame`; its name and time do not change. Arm parts are drawn over everything else, in
    /// their grey level.
    ///
    /// # Errors
    /// The errors of [`Frame::fill`]; none for a camera with pixels.
    pub fn render(
        &mut self,
        solids: &[RenderedSolid],
        arm: &[(ArmPart, u8)],
        conditions: &RenderConditions,
        frame: &mut Frame,
    ) -> Result<(), VisionError> {
        self.canvas.pixels.clone_from(&self.floor);
        if let Some(light) = conditions.light {
            self.canvas.shadows(&self.camera, solids, light, conditions.shadow);
        }
        let eye = self.camera.eye_in_world();
        self.order.clear();
        self.order.extend(solids.iter().enumerate().map(|(i, solid)| (distance(solid, eye), i)));
        self.order.sort_by(|a, b| b.0.total_cmp(&a.0));
        for &(_, i) in &self.order {
            self.canvas.solid(&self.camera, &solids[i]);
        }
        for (part, grey) in arm {
            self.canvas.arm_part(&self.camera, part, *grey);
        }
        self.expose(conditions, frame)
    }

    /// Applies illumination and noise.
    fn expose(&self, conditions: &RenderConditions, frame: &mut Frame) -> Result<(), VisionError> {
        let (width, height) = (self.canvas.width, self.canvas.height);
        let mut random = Random::new(conditions.seed);
        let (gain, offset) = (conditions.gain as f32, conditions.offset as f32 + 0.5);
        let (slope, noise) = (conditions.slope as f32 / width as f32, conditions.noise as f32);
        let channels = self.channels;
        frame.fill(width, height, channels, |bytes| {
            bytes.clear();
            for (i, pixel) in self.canvas.pixels.iter().enumerate() {
                let gain = gain * (1.0 + slope * ((i % width) as f32 - width as f32 / 2.0));
                let mut level = |value: u8| (f32::from(value) * gain + offset + noise * random.normal() as f32) as u8;
                match channels {
                    Channels::Grey => bytes.push(level(pixel[1])),
                    Channels::Rgb => bytes.extend(pixel.map(level)),
                }
            }
        })
    }
}

fn distance(solid: &RenderedSolid, eye: Vec3) -> f64 {
    let centre = polygon::centroid(&solid.footprint_m);
    Vec3::new(centre.x, centre.y, f64::midpoint(solid.z_from_m, solid.z_to_m)).distance(eye)
}
