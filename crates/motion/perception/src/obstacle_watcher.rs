//! From camera frames to the joint-space map of any robot.

use elbowroom_cspace::{CoverMapBuilder, LayerMap, MapReader};
use elbowroom_vision::{Calibration, CameraTracker, CameraTrackerSettings, Frame, FrameStatus, PixelMask, Stopwatch};

use crate::error::PerceptionError;
use crate::map_updater::PrismSettings;
use crate::observation::observe;
use crate::obstacle_update::{ObstacleUpdate, Prism};
use crate::robot_map::RobotMap;
use crate::settings::PerceptionSettings;
use crate::watched_robots::{WatchedRobot, WatchedRobots};

/// Turns camera frames into obstacles and keeps the joint-space map of any robot up to date, on sphere covers of its
/// links.
///
/// ```
/// use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, RemainingJoints};
/// use elbowroom_perception::{ObstacleWatcher, PerceptionSettings, WatchedRobot};
/// use elbowroom_robot::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// use elbowroom_vision::{Camera, CameraTrackerSettings, Channels, Frame, FrameStatus, Intrinsics};
/// let (robot, base_in_world) = (example::arm()?, Pose::IDENTITY);
/// let grid = Grid::new(["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 6.0).unwrap()))?;
/// let settings = CoverMapSettings::default();
/// let builder = CoverMapBuilder::new(&robot, base_in_world, &grid, [0, 1, 2], RemainingJoints::Swept, settings)?;
/// let lens = Intrinsics::pinhole(160, 120, 0.6);
/// let camera = Camera::look_at(lens, Vec3::new(2.0, 0.0, 2.0), Vec3::new(2.0, 0.0, 0.0), Vec3::Y)?;
/// let vision = CameraTrackerSettings { learning_frames: 5, ..CameraTrackerSettings::default() };
/// let robots = vec![WatchedRobot { robot, base_in_world }];
/// let mut watcher = ObstacleWatcher::new(robots, builder, camera.into(), vision, PerceptionSettings::default())?;
/// let mut frame = Frame::new("camera", 160, 120, Channels::Grey, vec![90; 160 * 120])?;
/// for i in 0..6 {
///     frame.stamp_s = f64::from(i) * 0.04;
///     let update = watcher.process_frame(&frame, &[&[0.0, 0.0, 0.0]])?;
///     assert_eq!(update.status == FrameStatus::Accepted, i == 5);
/// }
/// assert_eq!(watcher.map().occupancy().blocked(), 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ObstacleWatcher {
    robots: WatchedRobots,
    settings: PerceptionSettings,
    tracker: CameraTracker,
    mask: PixelMask,
    map: RobotMap,
}

impl ObstacleWatcher {
    /// Creates a watcher for the map that `builder` fills; all robots are masked in the frames. The first
    /// [`CameraTrackerSettings::learning_frames`] frames must show the empty cell.
    ///
    /// # Errors
    /// A setting is out of range, or the camera has no calibration.
    pub fn new(
        robots: Vec<WatchedRobot>,
        builder: CoverMapBuilder,
        camera: Calibration,
        tracker_settings: CameraTrackerSettings,
        settings: PerceptionSettings,
    ) -> Result<Self, PerceptionError> {
        settings.validate()?;
        camera.camera()?;
        let (width, height) = camera.size()?;
        let tracker = CameraTracker::new(camera, tracker_settings)?;
        let of_prisms =
            PrismSettings { prediction_s: settings.prediction_s, slack_m: tracker.settings().track.hysteresis_m };
        Ok(Self {
            robots: WatchedRobots::new(robots),
            settings,
            tracker,
            mask: PixelMask::new(width, height),
            map: RobotMap::new(builder, of_prisms),
        })
    }

    /// The joint-space map.
    pub fn map(&self) -> &LayerMap {
        self.map.map()
    }

    /// The obstacles in the map.
    pub fn prisms(&self) -> &[Prism] {
        self.map.prisms()
    }

    /// A lock-free reader of the published map, for this or another thread.
    pub fn reader(&self) -> MapReader {
        self.map.map().reader()
    }

    /// The camera tracker, with its settings, foreground and detailed timings.
    pub fn tracker(&self) -> &CameraTracker {
        &self.tracker
    }

    /// Processes a frame; `q` holds the joint values of each robot at that time, rad or m.
    ///
    /// # Errors
    /// The frame has the wrong size or is out of order, or the joint values do not match the robots: the map is
    /// unchanged, because unknown is not free. If an obstacle has no volume, its cells are unchanged and the other
    /// obstacles are updated.
    pub fn process_frame(&mut self, frame: &Frame, q: &[&[f64]]) -> Result<ObstacleUpdate, PerceptionError> {
        let mut stopwatch = Stopwatch::start();
        let parts = self.robots.parts(q)?;
        self.mask.clear();
        self.mask.mask_arm(self.tracker.calibration(), &parts, self.settings.mask_margin_m)?;
        let mut update = observe(&mut self.tracker, frame, &self.mask, stopwatch.lap())?;
        if update.status == FrameStatus::Accepted {
            self.map.take_over(&self.tracker.report().obstacles, &mut update)?;
        }
        update.prisms = self.map.prisms().to_vec();
        Ok(update)
    }
}
