//! Cloud to obstacles.

use std::time::{Duration, Instant};

use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::clusters::Clusters;
use super::voxels::Voxels;
use super::{Cloud, CloudSettings};
use crate::associate::Detection;
use crate::tracker::Tracker;
use crate::{ArmPart, Obstacle, Point2, Settings, VisionError, polygon};

/// Whether a cloud can be believed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CloudSight {
    /// All is well: where no obstacle is told, none was measured.
    Clear,
    /// Nothing was measured, or too little: the obstacles are those of the last cloud that was clear. Not free: how long
    /// that is good enough is the caller's decision, see [`CloudReport::age_s`].
    Empty {
        /// Points that were measured.
        points: usize,
        /// Points that were none.
        dropped: usize,
    },
}

/// Time per stage of one cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CloudTimings {
    /// Points to the world, floor and arm removed, counted in cubes.
    pub filter: Duration,
    /// Cubes to clusters.
    pub cluster: Duration,
    /// Outlines, identities and prisms.
    pub track: Duration,
}

impl CloudTimings {
    /// Cloud to obstacles.
    pub fn total(&self) -> Duration {
        self.filter + self.cluster + self.track
    }
}

/// What one cloud told. Borrowed from the [`CloudVision`], which reuses it.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudReport {
    /// When the cloud was measured, seconds.
    pub stamp_s: f64,
    /// Whether it can be believed.
    pub sight: CloudSight,
    /// Seconds since the last cloud that was clear; infinite where there was none. 0 for a clear one.
    pub age_s: f64,
    /// All obstacles, in the order of their identities; those that left are told once.
    pub obstacles: Vec<Obstacle>,
    /// Points taken for the arm's.
    pub of_arm: usize,
    /// Points of the floor, above the ceiling, outside of the cell or beyond all measure.
    pub outside: usize,
    /// Points of things that were too few in their cube or cluster to count. Many of them mean that the cubes are too small
    /// for the sensor, and that things may be missed.
    pub noise: usize,
    /// Cubes with points of things.
    pub voxels: usize,
    /// Time per stage.
    pub timings: CloudTimings,
}

/// Watches a cell through a sensor of points.
///
/// ```
/// use elbowroom_spatial::Vec3;
/// use elbowroom_vision::cloud::{Cloud, CloudSettings, CloudSight, CloudVision};
/// let mut vision = CloudVision::new(CloudSettings::default())?;
/// let mut cloud = Cloud { stamp_s: 1.0, ..Cloud::default() };
/// // The top of a box of 0.2 × 0.2 × 0.5 m.
/// cloud.fill((0..400).map(|i| Vec3::new(f64::from(i % 20) * 0.01, f64::from(i / 20) * 0.01, 0.5)));
/// let report = vision.process(&cloud, &[])?;
/// assert_eq!((report.sight, report.obstacles.len()), (CloudSight::Clear, 1));
/// assert!(report.obstacles[0].z_from_m == 0.0 && report.obstacles[0].z_to_m > 0.5);
/// cloud.fill([]);
/// cloud.stamp_s = 1.5;
/// let report = vision.process(&cloud, &[])?;
/// assert_eq!((report.obstacles.len(), report.age_s), (1, 0.5)); // nothing measured is not free
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CloudVision {
    settings: CloudSettings,
    for_tracks: Settings,
    arm: Arm,
    voxels: Voxels,
    clusters: Clusters,
    /// The first `found` of them are this cloud's.
    detections: Vec<Detection>,
    found: usize,
    corners: Vec<Point2>,
    tracker: Tracker,
    last_s: Option<f64>,
    clear_s: Option<f64>,
    report: CloudReport,
}

impl CloudVision {
    /// A watcher that has seen nothing yet.
    ///
    /// # Errors
    /// Settings out of range.
    pub fn new(settings: CloudSettings) -> Result<Self, VisionError> {
        settings.check()?;
        Ok(Self {
            for_tracks: settings.for_tracks(),
            settings,
            arm: Arm::default(),
            voxels: Voxels::default(),
            clusters: Clusters::default(),
            detections: Vec::new(),
            found: 0,
            corners: Vec::new(),
            tracker: Tracker::default(),
            last_s: None,
            clear_s: None,
            report: CloudReport {
                stamp_s: 0.0,
                sight: CloudSight::Empty { points: 0, dropped: 0 },
                age_s: f64::INFINITY,
                obstacles: Vec::new(),
                of_arm: 0,
                outside: 0,
                noise: 0,
                voxels: 0,
                timings: CloudTimings::default(),
            },
        })
    }

    /// The settings.
    pub fn settings(&self) -> &CloudSettings {
        &self.settings
    }

    /// The report of the last cloud.
    pub fn report(&self) -> &CloudReport {
        &self.report
    }

    /// Takes in a cloud. `arm` is where the arm's parts are: its points are removed, and things behind it are kept.
    /// Hulls are built anew for each cloud: capsules are faster.
    ///
    /// # Errors
    /// A cloud that is not later than the one before it. What is known stays as it was.
    pub fn process(&mut self, cloud: &Cloud, arm: &[ArmPart]) -> Result<&CloudReport, VisionError> {
        let (stamp_s, last_s) = (cloud.stamp_s, self.last_s.unwrap_or(f64::NEG_INFINITY));
        if !(stamp_s > last_s) || !stamp_s.is_finite() {
            let frame = if cloud.name.is_empty() { "cloud".into() } else { cloud.name.clone() };
            return Err(VisionError::OutOfOrder { frame, stamp_s, last_s });
        }
        self.last_s = Some(stamp_s);
        self.report.stamp_s = stamp_s;
        self.report.timings = CloudTimings::default();
        let (points, dropped) = (cloud.points.len(), cloud.dropped);
        let most_dropped = self.settings.most_dropped * (points + dropped) as f64;
        if points == 0 || dropped as f64 > most_dropped {
            self.report.sight = CloudSight::Empty { points, dropped };
            self.report.age_s = self.clear_s.map_or(f64::INFINITY, |clear_s| stamp_s - clear_s);
            self.tracker.repeat(&mut self.report.obstacles);
            return Ok(&self.report);
        }
        self.see(cloud, arm);
        self.report.sight = CloudSight::Clear;
        self.report.age_s = 0.0;
        self.clear_s = Some(stamp_s);
        Ok(&self.report)
    }

    fn see(&mut self, cloud: &Cloud, arm: &[ArmPart]) {
        let began = Instant::now();
        self.arm.place(arm, self.settings.arm_margin_m);
        self.filter(&cloud.points);
        let filtered = Instant::now();
        self.clusters.find(&self.voxels, self.settings.least_points, self.settings.least_voxels);
        let clustered = Instant::now();
        self.detect();
        self.mark_hidden();
        let dt_s = self.clear_s.map_or(0.0, |clear_s| cloud.stamp_s - clear_s);
        self.tracker.update(&self.detections[..self.found], dt_s, &self.for_tracks);
        self.tracker.tell(&self.for_tracks, None, &mut self.report.obstacles);
        self.report.timings =
            CloudTimings { filter: filtered - began, cluster: clustered - filtered, track: clustered.elapsed() };
    }

    /// Points of things, counted in cubes.
    fn filter(&mut self, points: &[Vec3]) {
        let settings = &self.settings;
        let heights = settings.floor_z_m + settings.floor_thickness_m..=settings.floor_z_m + settings.ceiling_m;
        self.voxels.clear();
        let (mut of_arm, mut outside) = (0, 0);
        for &p in points {
            let p = settings.sensor_in_world.transform_point(p);
            let is_inside = heights.contains(&p.z)
                && (settings.cell.is_empty() || polygon::contains(&settings.cell, Point2::new(p.x, p.y)));
            if !is_inside {
                outside += 1;
            } else if self.arm.has(p, settings.arm_margin_m) {
                of_arm += 1;
            } else if !self.voxels.add(p, settings.voxel_m) {
                outside += 1;
            }
        }
        (self.report.of_arm, self.report.outside, self.report.voxels) = (of_arm, outside, self.voxels.list.len());
    }

    /// Clusters to outlines on the floor with heights.
    fn detect(&mut self) {
        let mut found = 0;
        let all: usize = self.voxels.list.iter().map(|voxel| voxel.points as usize).sum();
        let of_things = self.clusters.members.iter().map(|&place| self.voxels.list[place as usize].points as usize);
        self.report.noise = all - of_things.sum::<usize>();
        for members in self.clusters.iter() {
            if found == self.detections.len() {
                self.detections.push(Detection::default());
            }
            let detection = &mut self.detections[found];
            self.corners.clear();
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for &place in members {
                let voxel = &self.voxels.list[place as usize];
                let ([x0, y0, z0], [x1, y1, z1]) = (voxel.min.map(f64::from), voxel.max.map(f64::from));
                self.corners.extend([(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| Point2::new(x, y)));
                (low, high) = (low.min(z0), high.max(z1));
            }
            polygon::convex_hull(&mut self.corners, &mut detection.outline_m);
            if detection.outline_m.len() < 3 {
                // A wall seen edge on: as thin as a hair is still a thing.
                let thickness = 0.5 * self.settings.voxel_m;
                polygon::grown(&detection.outline_m.clone(), thickness, &mut detection.outline_m, &mut self.corners);
            }
            detection.centre_m = polygon::centroid(&detection.outline_m);
            detection.area = polygon::area(&detection.outline_m);
            let down_to = if self.settings.down_to_floor { self.settings.floor_z_m } else { low };
            (detection.z_from_m, detection.z_to_m) = (down_to, high + self.settings.uncertainty_m);
            if !self.settings.down_to_floor {
                detection.z_from_m -= self.settings.uncertainty_m;
            }
            found += 1;
        }
        self.found = found;
    }

    /// Things that the arm stands before, or in, cannot have been seen to leave, or to end where they seem to.
    fn mark_hidden(&mut self) {
        let sensor = self.settings.sensor_in_world.translation;
        let (arm, margin_m) = (&self.arm, self.settings.arm_margin_m);
        let hides = |outline_m: &[Point2], z_from_m: f64, z_to_m: f64| {
            let places = || outline_m.iter().copied().chain([polygon::centroid(outline_m)]);
            let heights = [z_from_m, f64::midpoint(z_from_m, z_to_m), z_to_m];
            let mut ends = places().flat_map(|p| heights.map(|z| Vec3::new(p.x, p.y, z)));
            !arm.is_empty() && ends.any(|end| arm.hides(sensor, end, margin_m))
        };
        for track in &mut self.tracker.tracks {
            track.is_hidden = hides(&track.outline_m, track.z_from_m, track.z_to_m);
        }
        for detection in &mut self.detections[..self.found] {
            detection.is_cut_by_arm = hides(&detection.outline_m, detection.z_from_m, detection.z_to_m);
        }
    }
}
