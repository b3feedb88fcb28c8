//! From camera frames to obstacles.

use elbowroom_spatial::Vec3;

use crate::background_subtractor::BackgroundSubtractor;
use crate::detector::{Detector, OcclusionMask};
use crate::object_tracker::ObjectTracker;
use crate::report::{FrameReport, FrameStatus, RejectReason, StageTimings};
use crate::stopwatch::Stopwatch;
use crate::{
    Calibration, CameraTrackerSettings, Channels, ConnectedComponents, Frame, HiddenFloor, Illumination, PixelMask,
    Point2, VisionError,
};
use crate::{frame_check, polygon, raster};

/// Distance from an obstacle within which the background does not adapt, pixels.
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
    channels: Option<Channels>,
    frames: u64,
    last_s: Option<f64>,
    /// Time of the last update of the tracks, seconds.
    updated_s: f64,
    background: BackgroundSubtractor,
    empty_mask: PixelMask,
    components: ConnectedComponents,
    detector: Detector,
    tracker: ObjectTracker,
    outline_px: Vec<Point2>,
    workspace_px: Vec<Point2>,
    report: FrameReport,
}

impl CameraTracker {
    /// Creates a tracker without a background model.
    ///
    /// # Errors
    /// The calibration is missing, the camera sees the horizon, or a setting is out of range.
    pub fn new(calibration: Calibration, settings: CameraTrackerSettings) -> Result<Self, VisionError> {
        settings.check()?;
        let (width, height) = calibration.size()?;
        frame_check::floor_visible(&calibration, &settings, width, height)?;
        Ok(Self {
            calibration,
            settings,
            channels: None,
            frames: 0,
            last_s: None,
            updated_s: 0.0,
            background: BackgroundSubtractor::new(width, height),
            empty_mask: PixelMask::new(width, height),
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

    /// The foreground of the last frame, one byte per pixel: 1 in pixels of objects.
    pub fn foreground(&self) -> &[u8] {
        &self.background.foreground
    }

    /// The floor of the area that was masked in every image of the empty cell so far; `None` if all of it was seen.
    pub fn hidden_floor(&self) -> Option<HiddenFloor> {
        HiddenFloor::of(&self.background.learning_counts, self.background.width, &self.calibration, &self.settings)
    }

    /// Discards the background model: the next frames must show the empty cell. Obstacles are kept.
    pub fn relearn(&mut self) {
        self.background.relearn();
    }

    /// Processes a frame. `arm` masks the pixels that the arm covers in the frame, see [`PixelMask::mask_arm`]. The
    /// mask also applies while the background is learnt; a pixel that is masked in all of these frames becomes an
    /// obstacle.
    ///
    /// # Errors
    /// The frame has the wrong size or kind, or is out of order. The state does not change.
    pub fn process(&mut self, frame: &Frame, arm: Option<&PixelMask>) -> Result<&FrameReport, VisionError> {
        let (width, height) = (self.background.width, self.background.height);
        frame_check::frame(frame, arm, width, height, self.channels, self.last_s)?;
        self.last_s = Some(frame.stamp_s);
        self.report.stamp_s = frame.stamp_s;
        self.report.timings = StageTimings::default();
        self.frames += 1;
        let mut stopwatch = Stopwatch::start();
        self.channels = Some(frame.channels());
        self.report.illumination.resize(frame.channels().count(), Illumination::default());
        self.background.begin(frame);
        self.report.timings.convert = stopwatch.lap();
        // Moved out of `self`, because the mask is borrowed while `self` is mutated.
        let empty_mask = std::mem::take(&mut self.empty_mask);
        let mask = arm.unwrap_or(&empty_mask);
        if self.background.frames_to_learn(&self.settings) > 0 {
            self.learn(frame, mask);
            self.report.timings.adapt = stopwatch.lap();
        } else if let Err(reason) = self.detect_and_track(frame, mask, &mut stopwatch) {
            self.report.status = FrameStatus::Rejected(reason);
            self.tracker.write_unobserved(&mut self.report.obstacles);
        }
        self.empty_mask = empty_mask;
        Ok(&self.report)
    }

    fn learn(&mut self, frame: &Frame, mask: &PixelMask) {
        self.background.learn(frame, mask, &mut self.report.illumination);
        let frames_left = self.background.frames_to_learn(&self.settings);
        self.report.status = FrameStatus::Learning { frames_left };
        self.tracker.write_unobserved(&mut self.report.obstacles);
    }

    fn detect_and_track(
        &mut self,
        frame: &Frame,
        mask: &PixelMask,
        stopwatch: &mut Stopwatch,
    ) -> Result<(), RejectReason> {
        self.background.estimate_illumination(frame, &mut self.report.illumination)?;
        self.report.timings.illumination = stopwatch.lap();
        self.background.classify(frame, mask, &self.settings, &self.report.illumination);
        self.report.timings.classify = stopwatch.lap();
        self.background.resolve_shadows(frame, &self.settings, &self.report.illumination);
        self.report.timings.shadows = stopwatch.lap();
        let foreground_ratio = self.background.apply_morphology(mask, &self.settings);
        self.report.foreground_ratio = foreground_ratio;
        if foreground_ratio > self.settings.max_foreground {
            return Err(RejectReason::TooMuchForeground { foreground_ratio });
        }
        self.report.timings.morphology = stopwatch.lap();
        self.detect(frame, mask, stopwatch);
        self.update_tracks(frame.stamp_s, mask);
        self.report.timings.track = stopwatch.lap();
        let eye = self.calibration.eye_in_world().map(|eye| eye - Vec3::Z * self.settings.track.floor_z_m);
        self.tracker.write_obstacles(self.settings.track_rules(), eye, &mut self.report.obstacles);
        self.report.timings.prisms = stopwatch.lap();
        self.background.adapt(frame, self.frames, &self.settings, &self.report.illumination);
        self.report.timings.adapt = stopwatch.lap();
        self.report.status = FrameStatus::Accepted;
        Ok(())
    }

    fn detect(&mut self, frame: &Frame, mask: &PixelMask, stopwatch: &mut Stopwatch) {
        let width = self.background.width;
        let blobs = self.components.label(&self.background.foreground, width, self.settings.min_area_px);
        self.report.timings.label = stopwatch.lap();
        let occluded = occlusion_mask(mask, width, self.background.height);
        // The brightness of a blob is computed from the first plane.
        let pixels = self.background.planes_of(frame);
        self.detector.project(blobs, pixels, occluded, &self.calibration, &self.settings);
        self.background.frozen.copy_from_slice(mask.plane());
        for blob in blobs {
            polygon::inflate(&blob.outline_px, FROZEN_MARGIN_PX, &mut self.outline_px, &mut self.workspace_px);
            raster::fill_convex(&mut self.background.frozen, width, &self.outline_px, 1);
        }
        self.report.timings.project = stopwatch.lap();
    }

    /// Determines the tracks that the arm occludes, and updates all tracks.
    fn update_tracks(&mut self, stamp_s: f64, mask: &PixelMask) {
        let occluded = occlusion_mask(mask, self.background.width, self.background.height);
        for track in &mut self.tracker.tracks {
            track.is_occluded = false;
            if !occluded.is_empty {
                let floor_z_m = self.settings.track.floor_z_m;
                self.workspace_px.clear();
                let corners = track.outline_m.iter().filter_map(|&p| self.calibration.floor_to_pixel(p, floor_z_m));
                self.workspace_px.extend(corners);
                polygon::convex_hull(&mut self.workspace_px, &mut self.outline_px);
                track.is_occluded = occluded.touches(&self.outline_px);
                // The background must not adapt to an object that is partly behind the arm.
                raster::fill_convex(&mut self.background.frozen, self.background.width, &self.outline_px, 1);
            }
        }
        let dt_s = stamp_s - self.updated_s;
        self.updated_s = stamp_s;
        self.tracker.update(self.detector.detections(), dt_s, self.settings.track_rules());
    }
}

fn occlusion_mask(mask: &PixelMask, width: usize, height: usize) -> OcclusionMask<'_> {
    OcclusionMask { plane: mask.plane(), width, height, is_empty: mask.is_empty() }
}
