//! What a user of point clouds decides.

use elbowroom_spatial::Pose;

use crate::{Point2, Settings, VisionError};

/// What [`CloudVision`](super::CloudVision) goes by. Lengths are metres, world frame.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudSettings {
    /// Where the sensor is: takes its points to the world.
    pub sensor_in_world: Pose,
    /// The cell, world x and y: a simple polygon; points outside are dropped. Empty: everything.
    pub cell: Vec<Point2>,
    /// Height of the floor, world z.
    pub floor_z_m: f64,
    /// Points up to this high above the floor are floor.
    pub floor_thickness_m: f64,
    /// Points higher above the floor than this are ceiling, or above everything an arm can reach.
    pub ceiling_m: f64,
    /// Side of the cubes in which points are counted.
    pub voxel_m: f64,
    /// A cube with fewer points is noise.
    pub least_points: u32,
    /// A cluster with fewer cubes is noise.
    pub least_voxels: u32,
    /// Points this near to the arm are the arm's.
    pub arm_margin_m: f64,
    /// Obstacles go down to the floor, as a sensor above sees no undersides. False: to their lowest point.
    pub down_to_floor: bool,
    /// By how much obstacles are grown on all sides.
    pub uncertainty_m: f64,
    /// As [`Settings::slack_m`].
    pub slack_m: f64,
    /// As [`Settings::most_corners`].
    pub most_corners: usize,
    /// Share of points without a measurement (see [`Cloud::dropped`](super::Cloud::dropped)) beyond which a cloud is not
    /// believed.
    pub most_dropped: f64,
    /// As [`Settings::most_speed_mps`].
    pub most_speed_mps: f64,
    /// As [`Settings::frames_to_enter`].
    pub frames_to_enter: u32,
    /// As [`Settings::frames_to_leave`].
    pub frames_to_leave: u32,
}

impl Default for CloudSettings {
    fn default() -> Self {
        Self {
            sensor_in_world: Pose::IDENTITY,
            cell: Vec::new(),
            floor_z_m: 0.0,
            floor_thickness_m: 0.04,
            ceiling_m: 3.0,
            voxel_m: 0.03,
            least_points: 2,
            least_voxels: 4,
            arm_margin_m: 0.04,
            down_to_floor: true,
            uncertainty_m: 0.02,
            slack_m: 0.02,
            most_corners: 12,
            most_dropped: 0.9,
            most_speed_mps: 4.0,
            frames_to_enter: 1,
            frames_to_leave: 3,
        }
    }
}

impl CloudSettings {
    /// Whether the settings make sense.
    ///
    /// # Errors
    /// The first setting that is out of its range, and its range.
    pub fn check(&self) -> Result<(), VisionError> {
        self.for_tracks().check()?;
        let ranges = [
            ("floor_thickness_m", self.floor_thickness_m, 0.0..=self.ceiling_m, "from 0 up to ceiling_m"),
            ("ceiling_m", self.ceiling_m, 1e-3..=1e3, "0.001 to 1000 metres"),
            ("voxel_m", self.voxel_m, 1e-3..=1.0, "0.001 to 1 metre"),
            ("arm_margin_m", self.arm_margin_m, 0.0..=1.0, "0 to 1 metre"),
            ("most_dropped", self.most_dropped, 0.0..=1.0, "a share from 0 to 1"),
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

    /// What the tracker goes by.
    pub(super) fn for_tracks(&self) -> Settings {
        Settings {
            cell: self.cell.clone(),
            floor_z_m: self.floor_z_m,
            uncertainty_m: self.uncertainty_m,
            slack_m: self.slack_m,
            most_corners: self.most_corners,
            most_speed_mps: self.most_speed_mps,
            frames_to_enter: self.frames_to_enter,
            frames_to_leave: self.frames_to_leave,
            ..Settings::default()
        }
    }
}
