//! Settings of the point cloud tracker.

use elbowroom_spatial::{Pose, Vec3};

use crate::track_settings::{TrackRules, TrackSettings};
use crate::{Point2, VisionError, polygon};

/// Settings of a [`CloudTracker`](super::CloudTracker). Lengths are metres, world frame.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudTrackerSettings {
    /// What trackers of all sensors have. The default uncertainty and hysteresis are 0.02 m.
    pub track: TrackSettings,
    /// Pose of the sensor.
    pub sensor_in_world: Pose,
    /// Height above the floor up to which points belong to the floor.
    pub floor_thickness_m: f64,
    /// Height above the floor beyond which points are dropped: the ceiling, or a height above everything an arm can
    /// reach.
    pub ceiling_m: f64,
    /// Side of a voxel.
    pub voxel_m: f64,
    /// Smallest number of points of a voxel; with fewer points it is noise.
    pub min_points: u32,
    /// Smallest number of voxels of a cluster; with fewer voxels it is noise.
    pub min_voxels: u32,
    /// Distance from the arm up to which points belong to the arm.
    pub arm_margin_m: f64,
    /// Whether obstacles extend down to the floor, because a sensor above does not measure undersides; otherwise they
    /// extend to their lowest point.
    pub extend_to_floor: bool,
    /// Largest fraction of invalid points (see [`PointCloud::dropped`](super::PointCloud::dropped)); clouds with more
    /// are rejected.
    pub max_dropped: f64,
    /// Number of first valid clouds that show the cell without obstacles: later points in and beside voxels with points
    /// of these clouds belong to the background. 0: no background is learnt, and everything above the floor is an
    /// obstacle.
    pub learning_clouds: u32,
}

impl Default for CloudTrackerSettings {
    fn default() -> Self {
        Self {
            track: TrackSettings { uncertainty_m: 0.02, hysteresis_m: 0.02, ..TrackSettings::default() },
            sensor_in_world: Pose::IDENTITY,
            floor_thickness_m: 0.04,
            ceiling_m: 3.0,
            voxel_m: 0.03,
            min_points: 2,
            min_voxels: 4,
            arm_margin_m: 0.04,
            extend_to_floor: true,
            max_dropped: 0.9,
            learning_clouds: 0,
        }
    }
}

impl CloudTrackerSettings {
    /// Checks that every setting is in its range.
    ///
    /// # Errors
    /// The first setting that is out of range, with its range.
    pub fn check(&self) -> Result<(), VisionError> {
        self.track.check()?;
        let ranges = [
            ("floor_thickness_m", self.floor_thickness_m, 0.0..=self.ceiling_m, "from 0 up to ceiling_m"),
            ("ceiling_m", self.ceiling_m, 1e-3..=1e3, "0.001 to 1000 metres"),
            ("voxel_m", self.voxel_m, 1e-3..=1.0, "0.001 to 1 metre"),
            ("arm_margin_m", self.arm_margin_m, 0.0..=1.0, "0 to 1 metre"),
            ("max_dropped", self.max_dropped, 0.0..=1.0, "a fraction from 0 to 1"),
        ];
        for (name, value, range, expected) in ranges {
            if !range.contains(&value) {
                return Err(VisionError::Setting { name, value, expected });
            }
        }
        if !self.sensor_in_world.is_finite() {
            let expected = "a finite pose: measure where the sensor is";
            return Err(VisionError::Setting { name: "sensor_in_world", value: f64::NAN, expected });
        }
        Ok(())
    }

    /// Whether a point (world) is above the floor, below the ceiling and over the monitored area.
    pub(super) fn is_watched(&self, p: Vec3) -> bool {
        let heights = self.track.floor_z_m + self.floor_thickness_m..=self.track.floor_z_m + self.ceiling_m;
        heights.contains(&p.z)
            && (self.track.area_m.is_empty() || polygon::contains(&self.track.area_m, Point2::new(p.x, p.y)))
    }

    pub(super) fn track_rules(&self) -> TrackRules<'_> {
        TrackRules { track: &self.track, templates: &[], template_frames: 0 }
    }
}
