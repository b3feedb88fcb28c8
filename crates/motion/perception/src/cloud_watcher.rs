//! From point clouds to the joint-space map of any robot.

use elbowroom_cspace::{CoverMapBuilder, LayerMap};
use elbowroom_vision::cloud::{CloudStatus, CloudTracker, CloudTrackerSettings, PointCloud};
use elbowroom_vision::{ArmPart, FrameStatus, RejectReason};

use crate::error::PerceptionError;
use crate::map_updater::PrismSettings;
use crate::obstacle_update::{ObstacleUpdate, Prism};
use crate::robot_map::RobotMap;
use crate::settings::PerceptionSettings;
use crate::times::PerceptionTimes;
use crate::watched_robots::{WatchedRobot, WatchedRobots};

/// Turns point clouds into obstacles and keeps the joint-space map of a robot up to date, like
/// [`ObstacleWatcher`](crate::ObstacleWatcher) for camera frames.
///
/// ```
/// use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, RemainingJoints};
/// use elbowroom_perception::{CloudWatcher, PerceptionSettings, WatchedRobot};
/// use elbowroom_robot::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// use elbowroom_vision::cloud::{CloudTrackerSettings, PointCloud};
/// let (robot, base_in_world) = (example::arm()?, Pose::IDENTITY);
/// let grid = Grid::new(["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 6.0).unwrap()))?;
/// let settings = CoverMapSettings::default();
/// let builder = CoverMapBuilder::new(&robot, base_in_world, &grid, [0, 1, 2], RemainingJoints::Swept, settings)?;
/// let robots = vec![WatchedRobot { robot, base_in_world }];
/// let clouds = CloudTrackerSettings::default();
/// let mut watcher = CloudWatcher::new(robots, builder, clouds, Vec::new(), PerceptionSettings::default())?;
/// let mut cloud = PointCloud::default();
/// // The top of a box of 0.2 × 0.2 × 0.5 m, 0.6 m in front of the arm.
/// cloud.fill((0..400).map(|i| Vec3::new(0.6 + f64::from(i % 20) * 0.01, f64::from(i / 20) * 0.01, 0.5)));
/// let update = watcher.process_cloud(&cloud, &[&[0.0, 0.0, 0.0]])?;
/// assert!(update.is_accepted() && update.prisms.len() == 1);
/// assert!(watcher.map().occupancy().blocked() > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct CloudWatcher {
    robots: WatchedRobots,
    /// Known objects that do not move: points on them do not belong to obstacles.
    known: Vec<ArmPart>,
    tracker: CloudTracker,
    map: RobotMap,
}

impl CloudWatcher {
    /// Creates a watcher for the map that `builder` fills; points on the robots and on the `known` objects are removed.
    /// The first [`CloudTrackerSettings::learning_clouds`] valid clouds must show the cell without obstacles.
    ///
    /// # Errors
    /// A setting is out of range.
    pub fn new(
        robots: Vec<WatchedRobot>,
        builder: CoverMapBuilder,
        clouds: CloudTrackerSettings,
        known: Vec<ArmPart>,
        settings: PerceptionSettings,
    ) -> Result<Self, PerceptionError> {
        settings.validate()?;
        let of_prisms = PrismSettings { prediction_s: settings.prediction_s, slack_m: clouds.track.hysteresis_m };
        Ok(Self {
            robots: WatchedRobots::new(robots),
            known,
            tracker: CloudTracker::new(clouds)?,
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

    /// The tracker, with its settings and numbers of points.
    pub fn tracker(&self) -> &CloudTracker {
        &self.tracker
    }

    /// Processes a cloud; `q` holds the joint values of each robot at that time, rad or m.
    ///
    /// # Errors
    /// The cloud is out of order, or the joint values do not match the robots: the map is unchanged, because unknown is
    /// not free. If an obstacle has no volume, its cells are unchanged and the other obstacles are updated.
    pub fn process_cloud(&mut self, cloud: &PointCloud, q: &[&[f64]]) -> Result<ObstacleUpdate, PerceptionError> {
        let mut parts = self.robots.parts(q)?;
        parts.extend(self.known.iter().cloned());
        let report = self.tracker.process(cloud, &parts)?;
        let t = report.timings;
        let times = PerceptionTimes { background: t.filter, tracks: t.cluster + t.track, ..PerceptionTimes::default() };
        let mut update = ObstacleUpdate {
            stamp_s: report.stamp_s,
            status: status(report.status),
            prisms: Vec::new(),
            entered: Vec::new(),
            left: Vec::new(),
            blocked: 0,
            freed: 0,
            times,
        };
        if update.status == FrameStatus::Accepted {
            self.map.take_over(&report.obstacles, &mut update)?;
        }
        update.prisms = self.map.prisms().to_vec();
        Ok(update)
    }
}

fn status(status: CloudStatus) -> FrameStatus {
    match status {
        CloudStatus::Learning { clouds_left } => FrameStatus::Learning { frames_left: clouds_left },
        CloudStatus::Valid => FrameStatus::Accepted,
        CloudStatus::Empty { points, dropped } => FrameStatus::Rejected(RejectReason::FewPoints { points, dropped }),
    }
}
