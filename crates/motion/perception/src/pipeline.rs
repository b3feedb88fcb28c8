//! The perception pipeline: camera frames to occupied cells of the joint-space map.

use std::path::Path;
use std::sync::Arc;

use elbowroom_cspace::{JointMap, MapReader};
use elbowroom_kinematics::ChainState;
use elbowroom_vision::{
    self as vision, ArmPart, Calibration, CameraTracker, CameraTrackerSettings, Frame, FrameStatus, PixelMask,
    RawLayout, Stopwatch,
};

use crate::error::PerceptionError;
use crate::map_updater::{MapUpdater, PlanarPrisms, PrismSettings};
use crate::mapped_arm::MappedArm;
use crate::observation::observe;
use crate::obstacle_update::ObstacleUpdate;

/// Settings of a [`PerceptionPipeline`], beside the [`CameraTrackerSettings`] of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerceptionSettings {
    /// Prediction horizon, seconds: a moving obstacle also blocks its predicted positions until this time after the
    /// frame.
    pub prediction_s: f64,
    /// Margin by which the arm's silhouette is dilated, metres: calibration error, and the motion of the arm between
    /// the frame and its joint values.
    pub mask_margin_m: f64,
    /// Layout of raw frames, for cameras that send them.
    pub raw: Option<RawLayout>,
}

impl PerceptionSettings {
    /// An error for a setting that is negative or not finite.
    pub(super) fn validate(&self) -> Result<(), PerceptionError> {
        let all = [("prediction_s", self.prediction_s), ("mask_margin_m", self.mask_margin_m)];
        match all.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            Some((name, value)) => Err(PerceptionError::Setting { name, value }),
            None => Ok(()),
        }
    }
}

impl Default for PerceptionSettings {
    /// Half a second of prediction, 3 cm around the arm.
    fn default() -> Self {
        Self { prediction_s: 0.5, mask_margin_m: 0.03, raw: None }
    }
}

/// Turns camera frames into obstacles and keeps the joint-space map of an arm up to date.
#[derive(Debug)]
pub struct PerceptionPipeline {
    arm: Arc<MappedArm>,
    settings: PerceptionSettings,
    tracker: CameraTracker,
    map: JointMap,
    frame: Frame,
    mask: PixelMask,
    parts: Vec<ArmPart>,
    chain: ChainState,
    map_updater: MapUpdater,
}

impl PerceptionPipeline {
    /// Creates a pipeline. Its first [`CameraTrackerSettings::learning_frames`] frames must show the empty cell.
    ///
    /// # Errors
    /// Settings out of range, a camera without calibration, an arm or a step that is not usable.
    pub fn new(
        arm: Arc<MappedArm>,
        step_rad: f64,
        camera: Calibration,
        tracker_settings: CameraTrackerSettings,
        settings: PerceptionSettings,
    ) -> Result<Self, PerceptionError> {
        settings.validate()?;
        camera.camera()?;
        let (width, height) = camera.size()?;
        Ok(Self {
            settings,
            tracker: CameraTracker::new(camera, tracker_settings)?,
            map: JointMap::new(arm.planar, &arm.grid(step_rad)?)?,
            frame: Frame::default(),
            mask: PixelMask::new(width, height),
            parts: Vec::new(),
            chain: ChainState::new(&arm.robot.chain),
            map_updater: MapUpdater::default(),
            arm,
        })
    }

    /// The arm.
    pub fn arm(&self) -> &Arc<MappedArm> {
        &self.arm
    }

    /// The joint-space map of the observed obstacles.
    pub fn map(&self) -> &JointMap {
        &self.map
    }

    /// The camera tracker: settings, foreground, detailed timings.
    pub fn tracker(&self) -> &CameraTracker {
        &self.tracker
    }

    /// Pixels that the arm covered in the last frame.
    pub fn mask(&self) -> &PixelMask {
        &self.mask
    }

    /// The last frame.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// A lock-free reader of the published map, for this or another thread.
    pub fn reader(&self) -> MapReader {
        self.map.reader()
    }

    /// Processes a frame as the camera sent it: PNG, PGM, PPM, or raw bytes (a name that ends in `.raw`, see
    /// [`PerceptionSettings::raw`]). `q` are the joint values of the robot at that time.
    ///
    /// # Errors
    /// An image that cannot be decoded, has the wrong size or is out of order; joint values that do not match the
    /// robot. The map is unchanged: unknown is not free. Where an obstacle has no valid hull, its cells are unchanged,
    /// the other obstacles are updated, and readers see the change after the next accepted frame.
    pub fn process_image(
        &mut self,
        bytes: &[u8],
        name: &Path,
        stamp_s: f64,
        q: &[f64],
    ) -> Result<ObstacleUpdate, PerceptionError> {
        let mut stopwatch = Stopwatch::start();
        let mut frame = std::mem::take(&mut self.frame);
        let decoded = vision::decode(bytes, name, self.settings.raw, &mut frame);
        frame.stamp_s = stamp_s;
        let decode = stopwatch.lap();
        let processed = decoded.map_err(PerceptionError::from).and_then(|()| self.process_frame(&frame, q));
        self.frame = frame;
        let mut update = processed?;
        update.times.decode = decode;
        Ok(update)
    }

    /// As [`PerceptionPipeline::process_image`], for a decoded frame.
    ///
    /// # Errors
    /// As [`PerceptionPipeline::process_image`].
    pub fn process_frame(&mut self, frame: &Frame, q: &[f64]) -> Result<ObstacleUpdate, PerceptionError> {
        let dof = self.arm.robot.chain.dof();
        if q.len() != dof || q.iter().any(|value| !value.is_finite()) {
            return Err(PerceptionError::Values { found: q.len(), dof });
        }
        let mut stopwatch = Stopwatch::start();
        self.arm.parts_in_world(&mut self.chain, q, &mut self.parts);
        self.mask.clear();
        self.mask.mask_arm(self.tracker.calibration(), &self.parts, self.settings.mask_margin_m)?;
        let mut update = observe(&mut self.tracker, frame, &self.mask, stopwatch.lap())?;
        stopwatch.lap();
        if update.status == FrameStatus::Accepted {
            let settings = PrismSettings {
                prediction_s: self.settings.prediction_s,
                slack_m: self.tracker.settings().hysteresis_m,
            };
            let world_in_base = self.arm.base_in_world.inverse();
            let mut prisms = PlanarPrisms { map: &mut self.map, world_in_base };
            self.map_updater.update(&self.tracker.report().obstacles, &settings, &mut prisms, &mut update)?;
            update.times.map = stopwatch.lap();
            self.map.publish();
            update.times.publish = stopwatch.lap();
        }
        update.prisms.clone_from(self.map_updater.prisms());
        Ok(update)
    }
}
