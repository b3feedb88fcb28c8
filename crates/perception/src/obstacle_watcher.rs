//! Camera frames to the joint-space map of any robot.

use elbowroom_cspace::{CoverMapBuilder, LayerMap, MapReader};
use elbowroom_kinematics::ChainState;
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;
use elbowroom_vision::{
    Calibration, CameraTracker, CameraTrackerSettings, Frame, FrameStatus, ObstacleId, PixelMask, Point2, Stopwatch,
};

use crate::error::PerceptionError;
use crate::map_updater::{Changed, MapUpdater, PrismMap, PrismSettings};
use crate::mapped_arm::append_parts;
use crate::observation::observe;
use crate::obstacle_update::{ObstacleUpdate, Prism};
use crate::pipeline::PerceptionSettings;
use crate::prism_boxes::prism_boxes;

/// A robot that the camera sees.
#[derive(Debug, Clone)]
pub struct WatchedRobot {
    /// Links, joints, colliders.
    pub robot: Robot,
    /// Pose of the root link in the world.
    pub base_in_world: Pose,
}

/// Turns camera frames into obstacles and keeps the joint-space map of a robot up to date: of any robot, on sphere covers of its
/// links. ([`PerceptionPipeline`](crate::PerceptionPipeline) is for arms in a plane, and faster.)
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
    robots: Vec<WatchedRobot>,
    states: Vec<ChainState>,
    settings: PerceptionSettings,
    tracker: CameraTracker,
    mask: PixelMask,
    map: RobotPrisms,
    map_updater: MapUpdater,
}

impl ObstacleWatcher {
    /// For the map that `builder` fills; all robots are masked in the frames. The first
    /// [`CameraTrackerSettings::learning_frames`] frames must show the empty cell.
    ///
    /// # Errors
    /// Settings out of range, a camera without calibration.
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
        Ok(Self {
            states: robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
            robots,
            settings,
            tracker: CameraTracker::new(camera, tracker_settings)?,
            mask: PixelMask::new(width, height),
            map: RobotPrisms { map: LayerMap::new(builder.grid()), builder, parts: Vec::new() },
            map_updater: MapUpdater::default(),
        })
    }

    /// The joint-space map.
    pub fn map(&self) -> &LayerMap {
        &self.map.map
    }

    /// The obstacles in the map.
    pub fn prisms(&self) -> &[Prism] {
        self.map_updater.prisms()
    }

    /// A lock-free reader of the published map, for this or another thread.
    pub fn reader(&self) -> MapReader {
        self.map.map.reader()
    }

    /// The camera tracker: settings, foreground, detailed timings.
    pub fn tracker(&self) -> &CameraTracker {
        &self.tracker
    }

    /// Processes a frame; `q` are the joint values of each robot at that time, rad or m.
    ///
    /// # Errors
    /// A frame of the wrong size or out of order, joint values that do not match the robots. The map is unchanged: unknown is
    /// not free. Where an obstacle has no volume its cells are unchanged; the others are updated.
    pub fn process_frame(&mut self, frame: &Frame, q: &[&[f64]]) -> Result<ObstacleUpdate, PerceptionError> {
        self.validate(q)?;
        let mut stopwatch = Stopwatch::start();
        let mut parts = Vec::new();
        for ((robot, state), q) in self.robots.iter().zip(&mut self.states).zip(q) {
            append_parts(&robot.robot, robot.base_in_world, state, q, &mut parts);
        }
        self.mask.clear();
        self.mask.mask_arm(self.tracker.calibration(), &parts, self.settings.mask_margin_m)?;
        let mut update = observe(&mut self.tracker, frame, &self.mask, stopwatch.lap())?;
        stopwatch.lap();
        if update.status == FrameStatus::Accepted {
            let slack_m = self.tracker.settings().hysteresis_m;
            let settings = PrismSettings { prediction_s: self.settings.prediction_s, slack_m };
            self.map_updater.update(&self.tracker.report().obstacles, &settings, &mut self.map, &mut update)?;
            update.times.map = stopwatch.lap();
            self.map.map.publish();
            update.times.publish = stopwatch.lap();
        }
        update.prisms.clone_from(self.map_updater.prisms());
        Ok(update)
    }

    fn validate(&self, q: &[&[f64]]) -> Result<(), PerceptionError> {
        let dof: usize = self.robots.iter().map(|r| r.robot.chain.dof()).sum();
        let fits = q.len() == self.robots.len()
            && self.robots.iter().zip(q).all(|(r, q)| q.len() == r.robot.chain.dof())
            && q.iter().copied().flatten().all(|value| value.is_finite());
        if fits { Ok(()) } else { Err(PerceptionError::Values { found: q.iter().map(|q| q.len()).sum(), dof }) }
    }
}

/// Prisms as boxes in the map of any robot.
#[derive(Debug)]
struct RobotPrisms {
    map: LayerMap,
    builder: CoverMapBuilder,
    /// Number of boxes of each obstacle.
    parts: Vec<(ObstacleId, usize)>,
}

impl PrismMap for RobotPrisms {
    fn set(&mut self, id: ObstacleId, footprint_m: &[Point2], heights_m: [f64; 2]) -> Result<Changed, PerceptionError> {
        let boxes = prism_boxes(footprint_m, heights_m);
        if boxes.is_empty() || !(heights_m[1] > heights_m[0]) {
            return Err(PerceptionError::Obstacle(format!("{id} has no volume")));
        }
        let layer = |(shape, in_world)| self.builder.layer(&self.builder.obstacle(shape)?, in_world);
        let layers = boxes.iter().map(|(shape, pose)| layer((shape, pose)));
        let layers: Vec<_> = layers.collect::<Result<_, _>>().map_err(|e| PerceptionError::Obstacle(e.to_string()))?;
        // The new ones first, so that no cell is free in between.
        let count = layers.len();
        let mut changed = Changed::default();
        for (part, layer) in layers.into_iter().enumerate() {
            changed += Changed::of(self.map.set_layer(&part_name(id, part), layer));
        }
        let before = self.parts.iter().position(|(known, _)| *known == id).map(|at| self.parts.swap_remove(at).1);
        for part in count..before.unwrap_or(0) {
            changed += self.map.remove(&part_name(id, part)).map_or_else(Changed::default, Changed::of);
        }
        self.parts.push((id, count));
        Ok(changed)
    }

    fn remove(&mut self, id: ObstacleId) -> Option<Changed> {
        let at = self.parts.iter().position(|(known, _)| *known == id)?;
        let mut changed = Changed::default();
        for part in 0..self.parts.swap_remove(at).1 {
            changed += self.map.remove(&part_name(id, part)).map_or_else(Changed::default, Changed::of);
        }
        Some(changed)
    }
}

fn part_name(id: ObstacleId, part: usize) -> String {
    format!("{id}.{part}")
}
