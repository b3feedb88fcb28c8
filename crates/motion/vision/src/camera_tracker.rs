//! Camera frames to obstacles.

use elbowroom_spatial::Vec3;

use crate::background::{BackgroundPlane, FOREGROUND, PixelClassifier, RowSubset, Thresholds};
use crate::detector::{Detector, OcclusionMask};
use crate::illumination_estimator::IlluminationEstimator;
use crate::morphology::Morphology;
use crate::object_tracker::ObjectTracker;
use crate::report::{FrameReport, FrameStatus, RejectReason, StageTimings};
use crate::stopwatch::Stopwatch;
use crate::{
    Calibration, CameraTrackerSettings, Channels, ConnectedComponents, Frame, HiddenFloor, Illumination, PixelMask,
    Point2, VisionError,
};
use crate::{frame_check, polygon, raster, shadow};

/// One in so many rows adapts in each frame, in turn.
const ROW_STRIDE: usize = 4;
/// Frames with a gain outside this range are rejected, and those whose floor is brighter or darker by a factor outside it, unless
/// it is by a few grey levels only.
const GAINS: std::ops::RangeInclusive<f64> = 0.4..=2.5;
const SMALL_CHANGE: f64 = 60.0;
/// Frames in which a smaller fraction of the samples follows the line of the illumination show something else: rejected.
const MIN_INLIER_RATIO: f64 = 0.5;
/// The background does not adapt up to this distance from an obstacle, pixels.
const FROZEN_MARGIN_PX: f64 = 4.0;

/// Tracks obstacles with one camera: background subtraction, shadow detection, connected components, projection to the
/// floor, tracking.
///
/// The example learns an empty floor and detects a box of 0.4 × 0.4 m that enters.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::{Camera, CameraTracker, CameraTrackerSettings, Channels, Frame, FrameStatus, Intrinsics};
/// use elbowroom_vision::ObstacleChange;
/// let lens = Intrinsics::pinhole(160, 120, 1.2);
/// let camera = Camera::look_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?;
/// let settings = CameraTrackerSettings { learning_frames: 5, ..CameraTrackerSettings::default() };
/// let mut tracker = CameraTracker::new(camera.clone().into(), settings)?;
/// let mut frame = Frame::new("empty", 160, 120, Channels::Grey, vec![90; 160 * 120])?;
/// for i in 0..5 {
///     frame.stamp_s = f64::from(i) * 0.04;
///     tracker.process(&frame, None)?;
/// }
/// let corner = camera.world_to_pixel(Vec3::new(0.2, 0.4, 0.0)).unwrap();
/// let opposite = camera.world_to_pixel(Vec3::new(0.6, 0.0, 0.0)).unwrap();
/// for y in corner.y.round() as usize..opposite.y.round() as usize {
///     for x in corner.x.round() as usize..opposite.x.round() as usize {
///         frame.pixels_mut()[y * 160 + x] = 200;
///     }
/// }
/// frame.stamp_s = 0.2;
/// let report = tracker.process(&frame, None)?;
/// assert_eq!((report.status, report.obstacles.len()), (FrameStatus::Accepted, 1));
/// let obstacle = &report.obstacles[0];
/// assert!(obstacle.change == ObstacleChange::Entered && (obstacle.centre_m.x - 0.4).abs() < 0.02);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CameraTracker {
    calibration: Calibration,
    settings: CameraTrackerSettings,
    width: usize,
    height: usize,
    channels: Option<Channels>,
    frames: u64,
    frames_learnt: u32,
    last_s: Option<f64>,
    /// When tracks were last updated.
    updated_s: f64,
    planes: Vec<BackgroundPlane>,
    /// One plane after the other; empty for grey frames.
    colour_planes: Vec<u8>,
    class: Vec<u8>,
    foreground: Vec<u8>,
    /// Pixels in which the background does not adapt.
    frozen: Vec<u8>,
    /// Number of images of the empty cell in which each pixel was not masked.
    learning_counts: Vec<u16>,
    /// Some pixels were always masked: they are unknown, so not free.
    has_unlearnt_pixels: bool,
    empty_mask: PixelMask,
    estimator: IlluminationEstimator,
    morphology: Morphology,
    components: ConnectedComponents,
    detector: Detector,
    tracker: ObjectTracker,
    outline_px: Vec<Point2>,
    workspace_px: Vec<Point2>,
    report: FrameReport,
}

impl CameraTracker {
    /// A tracker without a background model.
    ///
    /// # Errors
    /// A missing calibration, a camera that sees the horizon, settings out of range.
    pub fn new(calibration: Calibration, settings: CameraTrackerSettings) -> Result<Self, VisionError> {
        settings.check()?;
        let (width, height) = calibration.size()?;
        frame_check::floor_visible(&calibration, &settings, width, height)?;
        let pixels = width * height;
        Ok(Self {
            calibration,
            settings,
            width,
            height,
            channels: None,
            frames: 0,
            frames_learnt: 0,
            last_s: None,
            updated_s: 0.0,
            planes: Vec::new(),
            colour_planes: Vec::new(),
            class: vec![0; pixels],
            foreground: vec![0; pixels],
            frozen: vec![0; pixels],
            learning_counts: vec![0; pixels],
            has_unlearnt_pixels: false,
            empty_mask: PixelMask::new(width, height),
            estimator: IlluminationEstimator::default(),
            morphology: Morphology::default(),
            components: ConnectedComponents::default(),
            detector: Detector::default(),
            tracker: ObjectTracker::default(),
            outline_px: Vec::new(),
            workspace_px: Vec::new(),
            report: FrameReport {
                stamp_s: 0.0,
                status: FrameStatus::Learning { frames_left: 0 },
                obstacles: Vec::new(),
                foreground_ratio: 0.0,
                illumination: Vec::new(),
                timings: StageTimings::default(),
            },
        })
    }

    /// The camera's calibration.
    pub fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// The settings.
    pub fn settings(&self) -> &CameraTrackerSettings {
        &self.settings
    }

    /// The report of the last frame.
    pub fn report(&self) -> &FrameReport {
        &self.report
    }

    /// The foreground of the last frame, one byte per pixel: 1 where there is an object.
    pub fn foreground(&self) -> &[u8] {
        &self.foreground
    }

    /// The floor of the area that was masked in every picture of the empty cell so far; `None` where all of it was seen.
    pub fn hidden_floor(&self) -> Option<HiddenFloor> {
        HiddenFloor::of(&self.learning_counts, self.width, &self.calibration, &self.settings)
    }

    /// Discards the background model: the next frames must show the empty cell. Obstacles are kept meanwhile.
    pub fn relearn(&mut self) {
        self.frames_learnt = 0;
    }

    /// Processes a frame. `arm` masks the pixels that the arm covers in it, see [`PixelMask::mask_arm`]; also while the
    /// background is learnt, where a pixel that is masked in every frame becomes an obstacle.
    ///
    /// # Errors
    /// Frames of the wrong size or kind, or out of order. The state does not change.
    pub fn process(&mut self, frame: &Frame, arm: Option<&PixelMask>) -> Result<&FrameReport, VisionError> {
        frame_check::frame(frame, arm, self.width, self.height, self.channels, self.last_s)?;
        self.last_s = Some(frame.stamp_s);
        self.report.stamp_s = frame.stamp_s;
        self.report.timings = StageTimings::default();
        self.frames += 1;
        let mut stopwatch = Stopwatch::start();
        self.split_colours(frame);
        self.report.timings.convert = stopwatch.lap();
        // Moved out of `self`, as the mask is borrowed while `self` is mutated.
        let empty_mask = std::mem::take(&mut self.empty_mask);
        let mask = arm.unwrap_or(&empty_mask);
        if self.frames_learnt < self.settings.learning_frames {
            self.learn(frame, mask);
            self.report.timings.adapt = stopwatch.lap();
        } else if let Err(reason) = self.detect_and_track(frame, mask, &mut stopwatch) {
            self.report.status = FrameStatus::Rejected(reason);
            self.tracker.write_unobserved(&mut self.report.obstacles);
        }
        self.empty_mask = empty_mask;
        Ok(&self.report)
    }

    /// Separates the colours of a frame into planes.
    fn split_colours(&mut self, frame: &Frame) {
        if self.channels.is_none() {
            self.channels = Some(frame.channels());
            self.planes.resize_with(frame.channels().count(), BackgroundPlane::default);
            self.report.illumination.resize(self.planes.len(), Illumination::default());
        }
        if frame.channels() == Channels::Rgb {
            let pixels = self.width * self.height;
            self.colour_planes.resize(3 * pixels, 0);
            let (red, rest) = self.colour_planes.split_at_mut(pixels);
            let (green, blue) = rest.split_at_mut(pixels);
            let (triples, _) = frame.pixels().as_chunks::<3>();
            for (i, &[r, g, b]) in triples.iter().enumerate().take(pixels) {
                (red[i], green[i], blue[i]) = (r, g, b);
            }
        }
    }

    fn learn(&mut self, frame: &Frame, mask: &PixelMask) {
        let pixels = self.width * self.height;
        if self.frames_learnt == 0 {
            self.planes.iter_mut().for_each(|plane| plane.reset(pixels));
            self.report.illumination.fill(Illumination::default());
            self.learning_counts.fill(0);
        }
        self.frames_learnt += 1;
        for (count, &masked) in self.learning_counts.iter_mut().zip(mask.plane()) {
            *count += u16::from(masked == 0);
        }
        let planes = planes_of(frame, &self.colour_planes);
        for (plane, pixels) in self.planes.iter_mut().zip(planes.chunks_exact(pixels)) {
            plane.learn(pixels, &self.learning_counts, mask.plane());
        }
        self.has_unlearnt_pixels = self.learning_counts.contains(&0);
        for (frozen, &count) in self.frozen.iter_mut().zip(&self.learning_counts) {
            *frozen = u8::from(count == 0);
        }
        let frames_left = self.settings.learning_frames - self.frames_learnt;
        self.report.status = FrameStatus::Learning { frames_left };
        self.tracker.write_unobserved(&mut self.report.obstacles);
    }

    fn detect_and_track(
        &mut self,
        frame: &Frame,
        mask: &PixelMask,
        stopwatch: &mut Stopwatch,
    ) -> Result<(), RejectReason> {
        self.estimate_illumination(frame)?;
        self.report.timings.illumination = stopwatch.lap();
        self.classify(frame, mask);
        self.report.timings.classify = stopwatch.lap();
        self.resolve_shadows(frame);
        self.report.timings.shadows = stopwatch.lap();
        self.apply_morphology(mask)?;
        self.report.timings.morphology = stopwatch.lap();
        self.detect(frame, mask, stopwatch);
        self.update_tracks(frame.stamp_s, mask);
        self.report.timings.track = stopwatch.lap();
        let eye = self.calibration.eye_in_world().map(|eye| eye - Vec3::Z * self.settings.floor_z_m);
        self.tracker.write_obstacles(&self.settings, eye, &mut self.report.obstacles);
        self.report.timings.prisms = stopwatch.lap();
        self.adapt(frame);
        self.report.timings.adapt = stopwatch.lap();
        self.report.status = FrameStatus::Accepted;
        Ok(())
    }

    fn estimate_illumination(&mut self, frame: &Frame) -> Result<(), RejectReason> {
        let planes = planes_of(frame, &self.colour_planes).chunks_exact(self.width * self.height);
        for ((plane, pixels), illumination) in self.planes.iter().zip(planes).zip(&mut self.report.illumination) {
            let estimate = self.estimator.estimate(plane, pixels, &self.frozen, self.width, illumination);
            let (estimate, learnt_level) = estimate.ok_or(RejectReason::Unrecognized { inlier_ratio: 0.0 })?;
            if estimate.inlier_ratio < MIN_INLIER_RATIO {
                return Err(RejectReason::Unrecognized { inlier_ratio: estimate.inlier_ratio });
            }
            // Gain and offset of a floor without contrast are not determined: what they make of its level is.
            let level = estimate.gain * learnt_level + estimate.offset;
            let is_as_bright = (level - learnt_level).abs() <= SMALL_CHANGE || GAINS.contains(&(level / learnt_level));
            if !GAINS.contains(&estimate.gain) || !is_as_bright {
                return Err(RejectReason::Illumination(estimate));
            }
            *illumination = estimate;
        }
        Ok(())
    }

    fn thresholds(&self) -> Thresholds {
        let shadow_range = self.settings.shadows.map_or((2.0, 1.0), |s| (s.min_ratio, s.max_ratio));
        let (min_difference, deviation_factor) = (self.settings.min_difference, self.settings.deviation_factor);
        Thresholds { min_difference, deviation_factor, shadow_range }
    }

    fn classify(&mut self, frame: &Frame, mask: &PixelMask) {
        let thresholds = self.thresholds();
        self.class.fill(0);
        let planes = planes_of(frame, &self.colour_planes).chunks_exact(self.width * self.height);
        for ((plane, pixels), illumination) in self.planes.iter().zip(planes).zip(&self.report.illumination) {
            plane.classify(&PixelClassifier::new(illumination, &thresholds), pixels, &mut self.class);
        }
        if self.has_unlearnt_pixels {
            for (class, &count) in self.class.iter_mut().zip(&self.learning_counts) {
                *class |= if count == 0 { FOREGROUND } else { 0 };
            }
        }
        clear_masked(&mut self.class, mask);
    }

    fn resolve_shadows(&mut self, frame: &Frame) {
        let input = shadow::ShadowInput {
            pixels: planes_of(frame, &self.colour_planes),
            planes: &self.planes,
            illumination: &self.report.illumination,
            width: self.width,
            height: self.height,
        };
        shadow::resolve(&input, &self.class, self.settings.shadows.as_ref(), &mut self.foreground);
    }

    fn apply_morphology(&mut self, mask: &PixelMask) -> Result<(), RejectReason> {
        self.morphology.open_and_restore(&mut self.foreground, self.width, self.settings.opening_radius_px);
        self.morphology.close(&mut self.foreground, self.width, self.settings.closing_radius_px);
        clear_masked(&mut self.foreground, mask);
        let covered: usize = self.foreground.chunks(255).map(|c| usize::from(c.iter().sum::<u8>())).sum();
        let foreground_ratio = covered as f64 / self.foreground.len() as f64;
        self.report.foreground_ratio = foreground_ratio;
        if foreground_ratio > self.settings.max_foreground {
            return Err(RejectReason::TooMuchForeground { foreground_ratio });
        }
        Ok(())
    }

    fn detect(&mut self, frame: &Frame, mask: &PixelMask, stopwatch: &mut Stopwatch) {
        let blobs = self.components.label(&self.foreground, self.width, self.settings.min_area_px);
        self.report.timings.label = stopwatch.lap();
        let occluded = occlusion_mask(mask, self.width, self.height);
        // The brightness of a blob is taken from the first plane.
        let pixels = planes_of(frame, &self.colour_planes);
        self.detector.project(blobs, pixels, occluded, &self.calibration, &self.settings);
        self.frozen.copy_from_slice(mask.plane());
        for blob in blobs {
            polygon::inflate(&blob.outline_px, FROZEN_MARGIN_PX, &mut self.outline_px, &mut self.workspace_px);
            raster::fill_convex(&mut self.frozen, self.width, &self.outline_px, 1);
        }
        self.report.timings.project = stopwatch.lap();
    }

    /// Determines which tracks the arm occludes, and updates all of them.
    fn update_tracks(&mut self, stamp_s: f64, mask: &PixelMask) {
        let occluded = occlusion_mask(mask, self.width, self.height);
        for track in &mut self.tracker.tracks {
            track.is_occluded = false;
            if !occluded.is_empty {
                let floor_z_m = self.settings.floor_z_m;
                self.workspace_px.clear();
                let corners = track.outline_m.iter().filter_map(|&p| self.calibration.floor_to_pixel(p, floor_z_m));
                self.workspace_px.extend(corners);
                polygon::convex_hull(&mut self.workspace_px, &mut self.outline_px);
                track.is_occluded = occluded.touches(&self.outline_px);
                // The background must not adapt to an object that is partly behind the arm.
                raster::fill_convex(&mut self.frozen, self.width, &self.outline_px, 1);
            }
        }
        let dt_s = stamp_s - self.updated_s;
        self.updated_s = stamp_s;
        self.tracker.update(self.detector.detections(), dt_s, &self.settings);
    }

    fn adapt(&mut self, frame: &Frame) {
        let thresholds = self.thresholds();
        let (width, height) = (self.width, self.height);
        let first = (self.frames % ROW_STRIDE as u64) as usize;
        let rows = RowSubset { width, height, first, stride: ROW_STRIDE };
        let shift = (f64::from(self.settings.adaptation_frames) / ROW_STRIDE as f64).log2().round().clamp(1.0, 10.0);
        let planes = planes_of(frame, &self.colour_planes).chunks_exact(width * height);
        for ((plane, pixels), illumination) in self.planes.iter_mut().zip(planes).zip(&self.report.illumination) {
            let classifier = PixelClassifier::new(illumination, &thresholds);
            plane.adapt(&classifier, pixels, &self.frozen, rows, shift as u32);
        }
    }
}

/// The planes of a frame, one after the other.
fn planes_of<'a>(frame: &'a Frame, colour_planes: &'a [u8]) -> &'a [u8] {
    if frame.channels() == Channels::Grey { frame.pixels() } else { colour_planes }
}

fn occlusion_mask(mask: &PixelMask, width: usize, height: usize) -> OcclusionMask<'_> {
    OcclusionMask { plane: mask.plane(), width, height, is_empty: mask.is_empty() }
}

fn clear_masked(plane: &mut [u8], mask: &PixelMask) {
    if !mask.is_empty() {
        for (pixel, &masked) in plane.iter_mut().zip(mask.plane()) {
            *pixel &= masked.wrapping_sub(1);
        }
    }
}
