//! Frame to obstacles.

use std::time::{Duration, Instant};

use elbowroom_spatial::Vec3;

use crate::background::{Kernel, Limits, OBJECT, Plane, Rows};
use crate::detection::{Detections, Hidden};
use crate::light::Estimator;
use crate::morphology::Morphology;
use crate::report::{Blindness, Report, Sight, Timings};
use crate::tracker::Tracker;
use crate::{Calibration, Channels, Frame, Labeller, Light, PixelMask, Point2, Settings, VisionError};
use crate::{check, polygon, raster, shadow};

/// Rows between those that adapt in one frame; the next frame takes the rows beside them.
const ROWS_IN_TURN: usize = 4;
/// Gain and offset beyond which a picture is not believed.
const GAINS: std::ops::RangeInclusive<f64> = 0.4..=2.5;
const MOST_OFFSET: f64 = 60.0;
/// Pixels around a thing in which the background does not adapt.
const HELD_PX: f64 = 4.0;

/// Watches a cell through one camera.
///
/// The example learns an empty floor and sees a box of 0.4 × 0.4 m enter.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::{Camera, Change, Channels, Frame, Intrinsics, Settings, Sight, Vision};
/// let lens = Intrinsics::ideal(160, 120, 1.2);
/// let camera = Camera::looking_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?;
/// let mut vision = Vision::new(camera.clone().into(), Settings { learning_frames: 5, ..Settings::default() })?;
/// let mut frame = Frame::new("empty", 160, 120, Channels::Grey, vec![90; 160 * 120])?;
/// for i in 0..5 {
///     frame.stamp_s = f64::from(i) * 0.04;
///     vision.process(&frame, None)?;
/// }
/// let corner = camera.world_to_pixel(Vec3::new(0.2, 0.4, 0.0)).unwrap();
/// let opposite = camera.world_to_pixel(Vec3::new(0.6, 0.0, 0.0)).unwrap();
/// for y in corner.y.round() as usize..opposite.y.round() as usize {
///     for x in corner.x.round() as usize..opposite.x.round() as usize {
///         frame.pixels_mut()[y * 160 + x] = 200;
///     }
/// }
/// frame.stamp_s = 0.2;
/// let report = vision.process(&frame, None)?;
/// assert_eq!((report.sight, report.obstacles.len()), (Sight::Clear, 1));
/// let seen = &report.obstacles[0];
/// assert!(seen.change == Change::Entered && (seen.centre_m.x - 0.4).abs() < 0.02);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Vision {
    calibration: Calibration,
    settings: Settings,
    width: usize,
    height: usize,
    channels: Option<Channels>,
    frames: u64,
    learnt: u32,
    last_s: Option<f64>,
    /// When obstacles were last updated.
    seen_s: f64,
    planes: Vec<Plane>,
    split: Vec<u8>,
    class: Vec<u8>,
    foreground: Vec<u8>,
    held: Vec<u8>,
    /// Pictures of the empty cell in which each pixel was in sight.
    in_sight: Vec<u16>,
    /// Some pixels never were: what is there is unknown, so not free.
    some_never_seen: bool,
    no_mask: PixelMask,
    estimator: Estimator,
    morphology: Morphology,
    labeller: Labeller,
    detections: Detections,
    tracker: Tracker,
    outline_px: Vec<Point2>,
    spare_px: Vec<Point2>,
    report: Report,
}

impl Vision {
    /// A watcher that has seen nothing yet.
    ///
    /// # Errors
    /// A camera that was never calibrated or sees the horizon, settings out of range.
    pub fn new(calibration: Calibration, settings: Settings) -> Result<Self, VisionError> {
        settings.check()?;
        let (width, height) = calibration.size()?;
        check::floor_in_sight(&calibration, &settings, width, height)?;
        let pixels = width * height;
        Ok(Self {
            calibration,
            settings,
            width,
            height,
            channels: None,
            frames: 0,
            learnt: 0,
            last_s: None,
            seen_s: 0.0,
            planes: Vec::new(),
            split: Vec::new(),
            class: vec![0; pixels],
            foreground: vec![0; pixels],
            held: vec![0; pixels],
            in_sight: vec![0; pixels],
            some_never_seen: false,
            no_mask: PixelMask::new(width, height),
            estimator: Estimator::default(),
            morphology: Morphology::default(),
            labeller: Labeller::default(),
            detections: Detections::default(),
            tracker: Tracker::default(),
            outline_px: Vec::new(),
            spare_px: Vec::new(),
            report: Report {
                stamp_s: 0.0,
                sight: Sight::Learning { frames_left: 0 },
                obstacles: Vec::new(),
                foreground: 0.0,
                lights: Vec::new(),
                timings: Timings::default(),
            },
        })
    }

    /// The camera.
    pub fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The report of the last frame.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Foreground of the last frame, one byte per pixel, for pictures: 1 where something is.
    pub fn foreground(&self) -> &[u8] {
        &self.foreground
    }

    /// Forgets the background: the next frames must show the empty cell. Obstacles are kept where they are meanwhile.
    pub fn learn_again(&mut self) {
        self.learnt = 0;
    }

    /// Takes in a frame. `arm` are the pixels that the arm covers in it, see [`PixelMask::hide_arm`]; also while the
    /// background is learnt, where a pixel that the arm covers in every frame is then taken for an obstacle.
    ///
    /// # Errors
    /// Frames of the wrong size or kind, or out of order. What is known stays as it was.
    pub fn process(&mut self, frame: &Frame, arm: Option<&PixelMask>) -> Result<&Report, VisionError> {
        check::frame(frame, arm, (self.width, self.height), self.channels, self.last_s)?;
        self.last_s = Some(frame.stamp_s);
        self.report.stamp_s = frame.stamp_s;
        self.report.timings = Timings::default();
        self.frames += 1;
        let mut clock = Clock::start();
        self.split(frame);
        self.report.timings.convert = clock.lap();
        // Taken out so that the mask may be the caller's or ours.
        let no_mask = std::mem::take(&mut self.no_mask);
        let mask = arm.unwrap_or(&no_mask);
        if self.learnt < self.settings.learning_frames {
            self.learn(frame, mask);
            self.report.timings.adapt = clock.lap();
        } else if let Err(blindness) = self.see(frame, mask, &mut clock) {
            self.report.sight = Sight::Blind(blindness);
            self.tracker.repeat(&mut self.report.obstacles);
        }
        self.no_mask = no_mask;
        Ok(&self.report)
    }

    /// One plane per colour.
    fn split(&mut self, frame: &Frame) {
        if self.channels.is_none() {
            self.channels = Some(frame.channels());
            self.planes.resize_with(frame.channels().count(), Plane::default);
            self.report.lights.resize(self.planes.len(), Light::default());
        }
        if frame.channels() == Channels::Rgb {
            let pixels = self.width * self.height;
            self.split.resize(3 * pixels, 0);
            let (red, rest) = self.split.split_at_mut(pixels);
            let (green, blue) = rest.split_at_mut(pixels);
            let (triples, _) = frame.pixels().as_chunks::<3>();
            for (i, &[r, g, b]) in triples.iter().enumerate().take(pixels) {
                (red[i], green[i], blue[i]) = (r, g, b);
            }
        }
    }

    fn learn(&mut self, frame: &Frame, mask: &PixelMask) {
        let pixels = self.width * self.height;
        if self.learnt == 0 {
            self.planes.iter_mut().for_each(|plane| plane.forget(pixels));
            self.report.lights.fill(Light::default());
            self.in_sight.fill(0);
        }
        self.learnt += 1;
        for (count, &hidden) in self.in_sight.iter_mut().zip(mask.plane()) {
            *count += u16::from(hidden == 0);
        }
        let planes = planes_of(frame, &self.split);
        for (plane, pixels) in self.planes.iter_mut().zip(planes.chunks_exact(pixels)) {
            plane.learn(pixels, &self.in_sight, mask.plane());
        }
        self.some_never_seen = self.in_sight.contains(&0);
        for (held, &count) in self.held.iter_mut().zip(&self.in_sight) {
            *held = u8::from(count == 0);
        }
        self.report.sight = Sight::Learning { frames_left: self.settings.learning_frames - self.learnt };
        self.tracker.repeat(&mut self.report.obstacles);
    }

    fn see(&mut self, frame: &Frame, mask: &PixelMask, clock: &mut Clock) -> Result<(), Blindness> {
        self.find_light(frame)?;
        self.report.timings.light = clock.lap();
        self.classify(frame, mask);
        self.report.timings.classify = clock.lap();
        self.resolve_shadows(frame);
        self.report.timings.shadows = clock.lap();
        self.clean(mask)?;
        self.report.timings.clean = clock.lap();
        self.label(frame, mask, clock);
        self.follow(frame.stamp_s, mask);
        self.report.timings.track = clock.lap();
        let eye = self.calibration.eye_in_world().map(|eye| eye - Vec3::Z * self.settings.floor_z_m);
        self.tracker.tell(&self.settings, eye, &mut self.report.obstacles);
        self.report.timings.tell = clock.lap();
        self.adapt(frame);
        self.report.timings.adapt = clock.lap();
        self.report.sight = Sight::Clear;
        Ok(())
    }

    fn find_light(&mut self, frame: &Frame) -> Result<(), Blindness> {
        let planes = planes_of(frame, &self.split).chunks_exact(self.width * self.height);
        for ((plane, pixels), light) in self.planes.iter().zip(planes).zip(&mut self.report.lights) {
            let found = self.estimator.estimate(plane, pixels, &self.held, self.width, light);
            let found = found.ok_or(Blindness::Unrecognized { agreeing: 0.0 })?;
            if found.agreeing < 0.5 {
                return Err(Blindness::Unrecognized { agreeing: found.agreeing });
            }
            if !GAINS.contains(&found.gain) || found.offset.abs() > MOST_OFFSET {
                return Err(Blindness::Light(found));
            }
            *light = found;
        }
        Ok(())
    }

    fn limits(&self) -> Limits {
        let shadow = self.settings.shadows.map_or((2.0, 1.0), |s| (s.darkest, s.faintest));
        Limits { least: self.settings.least_difference, factor: self.settings.deviations, shadow }
    }

    fn classify(&mut self, frame: &Frame, mask: &PixelMask) {
        let limits = self.limits();
        self.class.fill(0);
        let planes = planes_of(frame, &self.split).chunks_exact(self.width * self.height);
        for ((plane, pixels), light) in self.planes.iter().zip(planes).zip(&self.report.lights) {
            plane.classify(&Kernel::new(light, &limits), pixels, &mut self.class);
        }
        if self.some_never_seen {
            for (class, &count) in self.class.iter_mut().zip(&self.in_sight) {
                *class |= if count == 0 { OBJECT } else { 0 };
            }
        }
        apply_mask(&mut self.class, mask);
    }

    fn resolve_shadows(&mut self, frame: &Frame) {
        let scene = shadow::Scene {
            pixels: planes_of(frame, &self.split),
            planes: &self.planes,
            lights: &self.report.lights,
            width: self.width,
            height: self.height,
        };
        shadow::resolve(&scene, &self.class, self.settings.shadows.as_ref(), &mut self.foreground);
    }

    fn clean(&mut self, mask: &PixelMask) -> Result<(), Blindness> {
        self.morphology.open_and_restore(&mut self.foreground, self.width, self.settings.open_px);
        self.morphology.close(&mut self.foreground, self.width, self.settings.close_px);
        apply_mask(&mut self.foreground, mask);
        let covered: usize = self.foreground.chunks(255).map(|c| usize::from(c.iter().sum::<u8>())).sum();
        self.report.foreground = covered as f64 / self.foreground.len() as f64;
        if self.report.foreground > self.settings.most_foreground {
            return Err(Blindness::Covered { share: self.report.foreground });
        }
        Ok(())
    }

    fn label(&mut self, frame: &Frame, mask: &PixelMask, clock: &mut Clock) {
        let blobs = self.labeller.blobs(&self.foreground, self.width, self.settings.least_area_px);
        self.report.timings.label = clock.lap();
        let is_empty = mask.is_empty();
        let hidden = Hidden { plane: mask.plane(), width: self.width, height: self.height, is_empty };
        // The first plane is enough to tell dark from light.
        let pixels = planes_of(frame, &self.split);
        self.detections.place(blobs, pixels, hidden, &self.calibration, &self.settings);
        self.held.copy_from_slice(mask.plane());
        for blob in blobs {
            polygon::grown(&blob.outline_px, HELD_PX, &mut self.outline_px, &mut self.spare_px);
            raster::fill_convex(&mut self.held, self.width, &self.outline_px, 1);
        }
        self.report.timings.place = clock.lap();
    }

    /// Tells tracks whether the arm hides them, and updates them.
    fn follow(&mut self, stamp_s: f64, mask: &PixelMask) {
        let is_empty = mask.is_empty();
        let hidden = Hidden { plane: mask.plane(), width: self.width, height: self.height, is_empty };
        for track in &mut self.tracker.tracks {
            track.is_hidden = false;
            if !is_empty {
                let floor_z_m = self.settings.floor_z_m;
                self.spare_px.clear();
                let seen = track.outline_m.iter().filter_map(|&p| self.calibration.floor_to_pixel(p, floor_z_m));
                self.spare_px.extend(seen);
                polygon::convex_hull(&mut self.spare_px, &mut self.outline_px);
                track.is_hidden = hidden.touches(&self.outline_px);
                // Behind the arm the background must not follow what stands there either.
                raster::fill_convex(&mut self.held, self.width, &self.outline_px, 1);
            }
        }
        let dt_s = stamp_s - self.seen_s;
        self.seen_s = stamp_s;
        self.tracker.update(self.detections.list(), dt_s, &self.settings);
    }

    fn adapt(&mut self, frame: &Frame) {
        let limits = self.limits();
        let (width, height) = (self.width, self.height);
        let rows = Rows { width, height, first: (self.frames % ROWS_IN_TURN as u64) as usize, each: ROWS_IN_TURN };
        let shift = (f64::from(self.settings.adaptation_frames) / ROWS_IN_TURN as f64).log2().round().clamp(1.0, 10.0);
        let planes = planes_of(frame, &self.split).chunks_exact(width * height);
        for ((plane, pixels), light) in self.planes.iter_mut().zip(planes).zip(&self.report.lights) {
            plane.adapt(&Kernel::new(light, &limits), pixels, &self.held, rows, shift as u32);
        }
    }
}

/// Grey frames are a plane already; colours were split.
fn planes_of<'a>(frame: &'a Frame, split: &'a [u8]) -> &'a [u8] {
    if frame.channels() == Channels::Grey { frame.pixels() } else { split }
}

fn apply_mask(plane: &mut [u8], mask: &PixelMask) {
    if !mask.is_empty() {
        for (pixel, &hidden) in plane.iter_mut().zip(mask.plane()) {
            *pixel &= hidden.wrapping_sub(1);
        }
    }
}

struct Clock(Instant);

impl Clock {
    fn start() -> Self {
        Self(Instant::now())
    }

    fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.0, now)
    }
}
