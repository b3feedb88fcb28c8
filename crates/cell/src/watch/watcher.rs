//! Frames to blocked cells.

use std::path::Path;
use std::sync::Arc;

use elbowroom_cspace::{FillError, JointMap, ObstacleError, Reader};
use elbowroom_kinematics::ChainState;
use elbowroom_proximity::HullError;
use elbowroom_vision::{
    self as vision, ArmPart, Calibration, Frame, PixelMask, RawLayout, Settings, Sight, Vision, VisionError,
};

use super::known::{Known, Sweep};
use super::times::Clock;
use super::{SeeTimes, Sighting, WatchedArm};

/// Why a watch cannot be set up, or a frame cannot be used. What was known stays as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WatchError {
    /// A joint that the robot does not have.
    #[error("joint value {index} is to be one of the map's joints, but the robot has {dof}: count them from 0")]
    Joint {
        /// Where it was said to be.
        index: usize,
        /// How many there are.
        dof: usize,
    },
    /// The grid cannot be made.
    #[error("{0}")]
    Grid(String),
    /// The arm's dimensions, or a step that is too coarse.
    #[error(transparent)]
    Fill(#[from] FillError),
    /// A time that is negative or not finite.
    #[error("the setting `{name}` is {value}: write a finite number, 0 or more")]
    Setting {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The number of joint values is not the robot's, or one is not finite.
    #[error(
        "{found} joint values were given, the robot has {dof}: all of them, finite, as they were when the frame was taken"
    )]
    Values {
        /// How many came.
        found: usize,
        /// How many there are.
        dof: usize,
    },
    /// The frame, the calibration or a setting.
    #[error(transparent)]
    Vision(#[from] VisionError),
    /// An obstacle that is no solid of this world.
    #[error("an obstacle that was seen cannot be put into the map: {0}")]
    Obstacle(String),
}

impl From<ObstacleError> for WatchError {
    fn from(error: ObstacleError) -> Self {
        Self::Obstacle(error.to_string())
    }
}

impl From<HullError> for WatchError {
    fn from(error: HullError) -> Self {
        Self::Obstacle(error.to_string())
    }
}

/// What a [`Watch`] goes by, beside [`Settings`] of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WatchSettings {
    /// An obstacle that moves also blocks where it will be until so long after the frame, seconds.
    pub ahead_s: f64,
    /// By how much the arm's silhouette is grown, metres: error of the calibration, and the way that the arm goes
    /// between the frame and its joint values.
    pub mask_margin_m: f64,
    /// What bare bytes mean, for cameras that send them.
    pub raw: Option<RawLayout>,
}

impl Default for WatchSettings {
    /// Half a second ahead, 3 cm around the arm.
    fn default() -> Self {
        Self { ahead_s: 0.5, mask_margin_m: 0.03, raw: None }
    }
}

/// Watches a cell through a camera and keeps the joint map of an arm.
#[derive(Debug)]
pub struct Watch {
    arm: Arc<WatchedArm>,
    settings: WatchSettings,
    vision: Vision,
    map: JointMap,
    frame: Frame,
    mask: PixelMask,
    parts: Vec<ArmPart>,
    chain: ChainState,
    known: Known,
}

impl Watch {
    /// A watch that has seen nothing: its first [`Settings::learning_frames`] frames must show the empty cell.
    ///
    /// # Errors
    /// Settings out of range, a camera that was never calibrated or has no lens and pose, an arm or a step that is no use.
    pub fn new(
        arm: Arc<WatchedArm>,
        step_rad: f64,
        camera: Calibration,
        seeing: Settings,
        settings: WatchSettings,
    ) -> Result<Self, WatchError> {
        for (name, value) in [("ahead_s", settings.ahead_s), ("mask_margin_m", settings.mask_margin_m)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(WatchError::Setting { name, value });
            }
        }
        camera.camera()?;
        let (width, height) = camera.size()?;
        Ok(Self {
            settings,
            vision: Vision::new(camera, seeing)?,
            map: JointMap::new(arm.planar, &arm.grid(step_rad)?)?,
            frame: Frame::default(),
            mask: PixelMask::new(width, height),
            parts: Vec::new(),
            chain: ChainState::new(&arm.robot.chain),
            known: Known::default(),
            arm,
        })
    }

    /// The arm.
    pub fn arm(&self) -> &Arc<WatchedArm> {
        &self.arm
    }

    /// The joint map: its table, its grid. What stands in the cell for good is put into it by [`Watch::map_mut`].
    pub fn map(&self) -> &JointMap {
        &self.map
    }

    /// The joint map, for fixtures. Names that begin with `#` are those of obstacles that are seen.
    pub fn map_mut(&mut self) -> &mut JointMap {
        &mut self.map
    }

    /// The camera's side: settings, foreground, times in detail.
    pub fn vision(&self) -> &Vision {
        &self.vision
    }

    /// The pixels that the arm covered in the last frame.
    pub fn mask(&self) -> &PixelMask {
        &self.mask
    }

    /// Pixels of the last frame.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The map as it is published, without locks, for another thread or this one.
    pub fn reader(&self) -> Reader {
        self.map.reader()
    }

    /// Takes in a frame as the camera sent it: PNG, PGM, PPM, or bare bytes (a name that ends in `.raw`, and
    /// [`WatchSettings::raw`]). `q` are all joint values of the robot at that time.
    ///
    /// # Errors
    /// Bytes that are no picture, or one of the wrong size, or out of order; joint values that are not the robot's. The map
    /// stays as it was: unknown is not free. An obstacle that is no solid of this world: it stays where it was, the others
    /// are followed, and readers see none of it before a frame that is all right.
    pub fn see(&mut self, bytes: &[u8], name: &Path, stamp_s: f64, q: &[f64]) -> Result<Sighting, WatchError> {
        let mut clock = Clock::start();
        let mut frame = std::mem::take(&mut self.frame);
        let decoded = vision::decode(bytes, name, self.settings.raw, &mut frame);
        frame.stamp_s = stamp_s;
        let decode = clock.lap();
        let seen = decoded.map_err(WatchError::from).and_then(|()| self.see_frame(&frame, q));
        self.frame = frame;
        let mut sighting = seen?;
        sighting.times.decode = decode;
        Ok(sighting)
    }

    /// The same with pixels.
    ///
    /// # Errors
    /// As [`Watch::see`].
    pub fn see_frame(&mut self, frame: &Frame, q: &[f64]) -> Result<Sighting, WatchError> {
        let dof = self.arm.robot.chain.dof();
        if q.len() != dof || q.iter().any(|value| !value.is_finite()) {
            return Err(WatchError::Values { found: q.len(), dof });
        }
        let mut clock = Clock::start();
        self.arm.parts_in_world(&mut self.chain, q, &mut self.parts);
        self.mask.clear();
        self.mask.hide_arm(self.vision.calibration(), &self.parts, self.settings.mask_margin_m)?;
        let mut times = SeeTimes { mask: clock.lap(), ..SeeTimes::default() };
        let report = self.vision.process(frame, Some(&self.mask))?;
        let t = &report.timings;
        times.tracks = t.label + t.place + t.track + t.tell;
        times.background = t.total().saturating_sub(times.tracks);
        clock.lap();
        let mut sighting = Sighting {
            stamp_s: report.stamp_s,
            sight: report.sight,
            prisms: Vec::new(),
            entered: Vec::new(),
            left: Vec::new(),
            blocked: 0,
            freed: 0,
            times,
        };
        if sighting.sight == Sight::Clear {
            let sweep = Sweep {
                world_in_base: self.arm.base_in_world.inverse(),
                ahead_s: self.settings.ahead_s,
                slack_m: self.vision.settings().slack_m,
            };
            self.known.follow(&self.vision.report().obstacles, &sweep, &mut self.map, &mut sighting)?;
            sighting.times.fill = clock.lap();
            self.map.publish();
            sighting.times.publish = clock.lap();
        }
        sighting.prisms.clone_from(self.known.prisms());
        Ok(sighting)
    }
}
