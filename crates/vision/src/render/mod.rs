//! Synthetic frames: an overhead camera's picture of prisms on a textured floor, for tests and demonstrations.
//!
//! Painter's algorithm through the same [`Camera`] that [`Vision`](crate::Vision) is given: floor, shadows, prisms from
//! far to near, the arm, then light and noise. The same seed gives the same picture on every machine.

mod paint;

use elbowroom_spatial::Vec3;

use crate::{ArmPart, Camera, Channels, Frame, Point2, VisionError};
use paint::Canvas;

/// A prism on the floor, one colour for its top and shades of it for its sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Convex footprint, counter-clockwise, world x and y, metres.
    pub footprint_m: Vec<Point2>,
    /// Lower end, world z, metres.
    pub z_from_m: f64,
    /// Upper end, world z, metres.
    pub z_to_m: f64,
    /// Red, green, blue of its top; grey frames show the green.
    pub colour: [u8; 3],
}

impl Solid {
    /// A box on the floor (z = 0) turned by `angle` radians about its middle.
    pub fn cuboid(middle_m: Point2, size_m: Vec3, angle: f64, grey: u8) -> Self {
        let (sin, cos) = angle.sin_cos();
        let corner = |(sx, sy): (f64, f64)| {
            let (x, y) = (sx * size_m.x / 2.0, sy * size_m.y / 2.0);
            middle_m + Point2::new(cos * x - sin * y, sin * x + cos * y)
        };
        let footprint_m = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec();
        Self { footprint_m, z_from_m: 0.0, z_to_m: size_m.z, colour: [grey; 3] }
    }

    /// An upright cylinder on the floor (z = 0), with 32 sides about the circle's inside.
    pub fn cylinder(middle_m: Point2, radius_m: f64, height_m: f64, grey: u8) -> Self {
        let corner = |i: u32| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 32.0).sin_cos();
            middle_m + Point2::new(cos, sin) * radius_m
        };
        Self { footprint_m: (0..32).map(corner).collect(), z_from_m: 0.0, z_to_m: height_m, colour: [grey; 3] }
    }
}

/// The light and the sensor in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Brightness relative to the first frame.
    pub gain: f64,
    /// What the sensor adds, grey levels.
    pub offset: f64,
    /// How much more gain at the right edge than at the left one.
    pub slope: f64,
    /// Standard deviation of the noise, grey levels.
    pub noise: f64,
    /// The way that light travels, world frame, for shadows on the floor; `None` for light without shadows.
    pub light: Option<Vec3>,
    /// Brightness of the floor in shadow.
    pub shadow: f64,
    /// Seed of the noise: another one for each frame.
    pub seed: u64,
}

impl Default for Conditions {
    fn default() -> Self {
        Self { gain: 1.0, offset: 0.0, slope: 0.0, noise: 2.0, light: None, shadow: 0.65, seed: 1 }
    }
}

/// Draws frames of one camera.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::render::{Conditions, Renderer, Solid};
/// use elbowroom_vision::{Camera, Channels, Frame, Intrinsics, Point2};
/// let lens = Intrinsics::ideal(64, 48, 1.2);
/// let camera = Camera::looking_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?;
/// let mut renderer = Renderer::new(camera, Channels::Grey, 7);
/// let mut frame = Frame::default();
/// let pallet = Solid::cuboid(Point2::new(0.0, 0.0), Vec3::new(1.2, 0.8, 0.15), 0.3, 230);
/// renderer.render(&[pallet], &[], &Conditions::default(), &mut frame)?;
/// assert!(frame.row(24)[32] > 200 && frame.row(2)[2] < 160);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Renderer {
    camera: Camera,
    channels: Channels,
    floor: Vec<[u8; 3]>,
    canvas: Canvas,
    order: Vec<(f64, usize)>,
}

impl Renderer {
    /// A floor with a pattern (waves, joints of slabs, grain) that depends on `seed`.
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

    /// Draws a frame; its name and time stay. Arm parts are drawn over everything, with their grey.
    ///
    /// # Errors
    /// None that a camera that was made can cause; as [`Frame::fill`].
    pub fn render(
        &mut self,
        solids: &[Solid],
        arm: &[(ArmPart, u8)],
        conditions: &Conditions,
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

    /// Light, noise and bytes.
    fn expose(&self, conditions: &Conditions, frame: &mut Frame) -> Result<(), VisionError> {
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

fn distance(solid: &Solid, eye: Vec3) -> f64 {
    let middle = crate::polygon::centroid(&solid.footprint_m);
    Vec3::new(middle.x, middle.y, f64::midpoint(solid.z_from_m, solid.z_to_m)).distance(eye)
}

/// Xorshift64* (Marsaglia, Vigna): the same numbers everywhere.
#[derive(Debug, Clone)]
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        random.next();
        random
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Nearly normal, mean 0, deviation 1: the sum of four even bytes.
    fn normal(&mut self) -> f64 {
        let [a, b, c, d, ..] = self.next().to_be_bytes();
        let sum = u32::from(a) + u32::from(b) + u32::from(c) + u32::from(d);
        (f64::from(sum) - 510.0) / 147.8
    }
}
