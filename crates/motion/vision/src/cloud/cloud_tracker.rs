//! From point clouds to obstacles.

use std::time::{Duration, Instant};

use elbowroom_spatial::Vec3;

use super::arm_filter::ArmFilter;
use super::clusters::Clusters;
use super::point_cloud::PointCloud;
use super::settings::CloudTrackerSettings;
use super::voxel_grid::VoxelGrid;
use crate::detection::Detection;
use crate::object_tracker::ObjectTracker;
use crate::{ArmPart, Obstacle, Point2, VisionError, polygon};

/// Whether the obstacles of a cloud can be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CloudStatus {
    /// The background is being learnt; nothing is known yet.
    Learning {
        /// Number of missing clouds of the cell without obstacles.
        clouds_left: u32,
    },
    /// The cloud was evaluated: where no obstacle is reported, none was measured.
    Valid,
    /// Too few points are valid: the obstacles are those of the last valid cloud. Unknown is not free: the caller
    /// decides how long these obstacles can be used, see [`CloudReport::age_s`].
    Empty {
        /// Number of valid points.
        points: usize,
        /// Number of invalid points.
        dropped: usize,
    },
}

/// Times per stage of one cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CloudTimings {
    /// Transformation of points to the world, removal of floor and arm, voxel grid.
    pub filter: Duration,
    /// Clustering of voxels.
    pub cluster: Duration,
    /// Outlines, tracks and prisms.
    pub track: Duration,
}

impl CloudTimings {
    /// Total time from cloud to obstacles.
    pub fn total(&self) -> Duration {
        self.filter + self.cluster + self.track
    }
}

/// The result of one cloud. Borrowed from the [`CloudTracker`], which reuses it.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudReport {
    /// Time of the measurement, seconds.
    pub stamp_s: f64,
    /// Whether the obstacles can be used.
    pub status: CloudStatus,
    /// Seconds since the last valid cloud: 0 for a valid cloud, infinite if there was none.
    pub age_s: f64,
    /// All obstacles in the order of their identities; an obstacle that left is reported once more.
    pub obstacles: Vec<Obstacle>,
    /// Number of points on the arm.
    pub arm_points: usize,
    /// Number of points of the background.
    pub background_points: usize,
    /// Number of points of the floor, above the ceiling, outside the monitored area or outside the voxel grid.
    pub outside_points: usize,
    /// Number of points in voxels or clusters with too few points. If this number is large, the voxels are too small
    /// for the sensor and objects may be missed.
    pub noise_points: usize,
    /// Number of voxels that contain points of objects.
    pub voxels: usize,
    /// Time per stage.
    pub timings: CloudTimings,
}

/// Tracks obstacles with a sensor of points: voxel grid, Euclidean clustering, tracking.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::cloud::{CloudStatus, CloudTracker, CloudTrackerSettings, PointCloud};
/// let mut tracker = CloudTracker::new(CloudTrackerSettings::default())?;
/// let mut cloud = PointCloud { stamp_s: 1.0, ..PointCloud::default() };
/// // The top of a box of 0.2 × 0.2 × 0.5 m.
/// cloud.fill((0..400).map(|i| Vec3::new(f64::from(i % 20) * 0.01, f64::from(i / 20) * 0.01, 0.5)));
/// let report = tracker.process(&cloud, &[])?;
/// assert_eq!((report.status, report.obstacles.len()), (CloudStatus::Valid, 1));
/// assert!(report.obstacles[0].z_from_m == 0.0 && report.obstacles[0].z_to_m > 0.5);
/// cloud.fill([]);
/// cloud.stamp_s = 1.5;
/// let report = tracker.process(&cloud, &[])?;
/// assert_eq!((report.obstacles.len(), report.age_s), (1, 0.5)); // nothing measured does not mean free
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CloudTracker {
    settings: CloudTrackerSettings,
    arm: ArmFilter,
    voxels: VoxelGrid,
    background: VoxelGrid,
    /// Number of missing clouds of the background.
    clouds_left: u32,
    clusters: Clusters,
    /// Detections; the first `detection_count` belong to this cloud.
    detections: Vec<Detection>,
    detection_count: usize,
    corners: Vec<Point2>,
    tracker: ObjectTracker,
    last_s: Option<f64>,
    last_valid_s: Option<f64>,
    report: CloudReport,
}

impl CloudTracker {
    /// Creates a tracker without obstacles.
    ///
    /// # Errors
    /// A setting is out of range.
    pub fn new(settings: CloudTrackerSettings) -> Result<Self, VisionError> {
        settings.check()?;
        let mut background = VoxelGrid::default();
        background.clear();
        Ok(Self {
            background,
            clouds_left: settings.learning_clouds,
            settings,
            arm: ArmFilter::default(),
            voxels: VoxelGrid::default(),
            clusters: Clusters::default(),
            detections: Vec::new(),
            detection_count: 0,
            corners: Vec::new(),
            tracker: ObjectTracker::default(),
            last_s: None,
            last_valid_s: None,
            report: CloudReport {
                stamp_s: 0.0,
                status: CloudStatus::Empty { points: 0, dropped: 0 },
                age_s: f64::INFINITY,
                obstacles: Vec::new(),
                arm_points: 0,
                background_points: 0,
                outside_points: 0,
                noise_points: 0,
                voxels: 0,
                timings: CloudTimings::default(),
            },
        })
    }

    /// The settings.
    pub fn settings(&self) -> &CloudTrackerSettings {
        &self.settings
    }

    /// The report of the last cloud.
    pub fn report(&self) -> &CloudReport {
        &self.report
    }

    /// Processes a cloud. `arm` holds the parts of the arm in the world: points on them are removed, and obstacles
    /// behind them are kept. Hulls are built again for each cloud; capsules are faster.
    ///
    /// # Errors
    /// The cloud is not later than the previous one. The state does not change.
    pub fn process(&mut self, cloud: &PointCloud, arm: &[ArmPart]) -> Result<&CloudReport, VisionError> {
        let (stamp_s, last_s) = (cloud.stamp_s, self.last_s.unwrap_or(f64::NEG_INFINITY));
        if !(stamp_s > last_s) || !stamp_s.is_finite() {
            let frame = if cloud.name.is_empty() { "cloud".into() } else { cloud.name.clone() };
            return Err(VisionError::OutOfOrder { frame, stamp_s, last_s });
        }
        self.last_s = Some(stamp_s);
        self.report.stamp_s = stamp_s;
        self.report.timings = CloudTimings::default();
        let (points, dropped) = (cloud.points.len(), cloud.dropped);
        let max_dropped = self.settings.max_dropped * (points + dropped) as f64;
        if points == 0 || dropped as f64 > max_dropped {
            self.report.status = CloudStatus::Empty { points, dropped };
            self.report.age_s = self.last_valid_s.map_or(f64::INFINITY, |last_valid_s| stamp_s - last_valid_s);
            self.tracker.write_unobserved(&mut self.report.obstacles);
            return Ok(&self.report);
        }
        if self.clouds_left > 0 {
            self.learn(cloud, arm);
            return Ok(&self.report);
        }
        self.detect_and_track(cloud, arm);
        self.report.status = CloudStatus::Valid;
        self.report.age_s = 0.0;
        self.last_valid_s = Some(stamp_s);
        Ok(&self.report)
    }

    /// Adds the points that are not on the arm to the background.
    fn learn(&mut self, cloud: &PointCloud, arm: &[ArmPart]) {
        let (voxel_m, margin_m) = (self.settings.voxel_m, self.settings.arm_margin_m);
        self.arm.place(arm, margin_m);
        for &p in &cloud.points {
            let p = self.settings.sensor_in_world.transform_point(p);
            if self.settings.is_watched(p) && !self.arm.contains(p, margin_m) {
                self.background.add_with_neighbours(p, voxel_m);
            }
        }
        self.clouds_left -= 1;
        self.report.status = CloudStatus::Learning { clouds_left: self.clouds_left };
    }

    fn detect_and_track(&mut self, cloud: &PointCloud, arm: &[ArmPart]) {
        let began = Instant::now();
        self.arm.place(arm, self.settings.arm_margin_m);
        self.filter(&cloud.points);
        let filtered = Instant::now();
        self.clusters.find(&self.voxels, self.settings.min_points, self.settings.min_voxels);
        let clustered = Instant::now();
        self.detect();
        self.mark_occluded();
        let dt_s = self.last_valid_s.map_or(0.0, |last_valid_s| cloud.stamp_s - last_valid_s);
        self.tracker.update(&self.detections[..self.detection_count], dt_s, self.settings.track_rules());
        self.tracker.write_obstacles(self.settings.track_rules(), None, &mut self.report.obstacles);
        self.report.timings =
            CloudTimings { filter: filtered - began, cluster: clustered - filtered, track: clustered.elapsed() };
    }

    /// Adds the points of objects to the voxel grid.
    fn filter(&mut self, points: &[Vec3]) {
        let settings = &self.settings;
        self.voxels.clear();
        let (mut arm_points, mut background_points, mut outside_points) = (0, 0, 0);
        for &p in points {
            let p = settings.sensor_in_world.transform_point(p);
            if !settings.is_watched(p) {
                outside_points += 1;
            } else if self.arm.contains(p, settings.arm_margin_m) {
                arm_points += 1;
            } else if self.background.contains(p, settings.voxel_m) {
                background_points += 1;
            } else if !self.voxels.add(p, settings.voxel_m) {
                outside_points += 1;
            }
        }
        (self.report.arm_points, self.report.background_points) = (arm_points, background_points);
        self.report.outside_points = outside_points;
        self.report.voxels = self.voxels.list.len();
    }

    /// Converts clusters to outlines on the floor with heights.
    fn detect(&mut self) {
        let mut count = 0;
        let all: usize = self.voxels.list.iter().map(|voxel| voxel.points as usize).sum();
        let clustered = self.clusters.members.iter().map(|&voxel| self.voxels.list[voxel as usize].points as usize);
        self.report.noise_points = all - clustered.sum::<usize>();
        for members in self.clusters.iter() {
            if count == self.detections.len() {
                self.detections.push(Detection::default());
            }
            let detection = &mut self.detections[count];
            self.corners.clear();
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for &voxel in members {
                let voxel = &self.voxels.list[voxel as usize];
                let ([x0, y0, z0], [x1, y1, z1]) = (voxel.min.map(f64::from), voxel.max.map(f64::from));
                self.corners.extend([(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| Point2::new(x, y)));
                (low, high) = (low.min(z0), high.max(z1));
            }
            polygon::convex_hull(&mut self.corners, &mut detection.outline_m);
            if detection.outline_m.len() < 3 {
                // All points are in one vertical plane, for example on a wall seen edge-on: the outline gets a
                // thickness.
                let thickness = 0.5 * self.settings.voxel_m;
                polygon::inflate(&detection.outline_m.clone(), thickness, &mut detection.outline_m, &mut self.corners);
            }
            detection.centre_m = polygon::centroid(&detection.outline_m);
            detection.area = polygon::area(&detection.outline_m);
            let z_from_m = if self.settings.extend_to_floor { self.settings.track.floor_z_m } else { low };
            (detection.z_from_m, detection.z_to_m) = (z_from_m, high + self.settings.track.uncertainty_m);
            if !self.settings.extend_to_floor {
                detection.z_from_m -= self.settings.track.uncertainty_m;
            }
            count += 1;
        }
        self.detection_count = count;
    }

    /// Marks tracks and detections that the arm occludes in part or in full: their absence or their end is not
    /// observed.
    fn mark_occluded(&mut self) {
        let sensor = self.settings.sensor_in_world.translation;
        let (arm, margin_m) = (&self.arm, self.settings.arm_margin_m);
        let is_occluded = |outline_m: &[Point2], z_from_m: f64, z_to_m: f64| {
            let points = || outline_m.iter().copied().chain([polygon::centroid(outline_m)]);
            let heights = [z_from_m, f64::midpoint(z_from_m, z_to_m), z_to_m];
            let mut targets = points().flat_map(|p| heights.map(|z| Vec3::new(p.x, p.y, z)));
            !arm.is_empty() && targets.any(|target| arm.occludes(sensor, target, margin_m))
        };
        for track in &mut self.tracker.tracks {
            track.is_occluded = is_occluded(&track.outline_m, track.heights.from_m, track.heights.to_m);
        }
        for detection in &mut self.detections[..self.detection_count] {
            detection.touches_arm = is_occluded(&detection.outline_m, detection.z_from_m, detection.z_to_m);
        }
    }
}
