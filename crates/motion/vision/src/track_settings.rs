//! Settings of tracking, whatever the sensor.

use crate::{Point2, Template, VisionError};

/// What trackers of pictures and of point clouds have in common. Lengths are metres, world frame; times are counted in
/// frames.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackSettings {
    /// The monitored area of the floor, world x and y, metres: a simple polygon. Objects entirely outside it are
    /// ignored, and so are points outside. Empty: everything visible.
    pub area_m: Vec<Point2>,
    /// Height of the floor, world z, metres.
    pub floor_z_m: f64,
    /// Inflation of obstacles, metres: covers errors of the calibration and of the measurement (for a camera a pixel or
    /// two), and the motion of an object until the next frame. Of a camera's obstacles the footprint is inflated, of a
    /// cloud's all sides.
    pub uncertainty_m: f64,
    /// Additional inflation of the reported prism, metres, so that noise and small steps do not change it. For a camera
    /// use about the size of a pixel on the floor.
    pub hysteresis_m: f64,
    /// Largest number of corners of a footprint, which is simplified outward.
    pub max_corners: usize,
    /// Speed of the fastest object, metres per second.
    pub max_speed_mps: f64,
    /// Number of frames in a row in which an object must be detected before it is reported.
    pub enter_frames: u32,
    /// Number of frames in a row without a detection after which an object that the arm does not occlude has left.
    pub leave_frames: u32,
}

impl Default for TrackSettings {
    fn default() -> Self {
        Self {
            area_m: Vec::new(),
            floor_z_m: 0.0,
            uncertainty_m: 0.03,
            hysteresis_m: 0.01,
            max_corners: 12,
            max_speed_mps: 4.0,
            enter_frames: 1,
            leave_frames: 3,
        }
    }
}

impl TrackSettings {
    /// Checks that every setting is in its range.
    pub(crate) fn check(&self) -> Result<(), VisionError> {
        let ranges = [
            ("floor_z_m", self.floor_z_m, f64::MIN..=f64::MAX, "a finite number of metres"),
            ("uncertainty_m", self.uncertainty_m, 0.0..=10.0, "0 to 10 metres"),
            ("hysteresis_m", self.hysteresis_m, 0.0..=10.0, "0 to 10 metres"),
            ("max_corners", self.max_corners as f64, 4.0..=1e3, "4 corners or more"),
            ("max_speed_mps", self.max_speed_mps, 1e-3..=1e3, "0.001 to 1000 metres per second"),
        ];
        for (name, value, range, expected) in ranges {
            if !range.contains(&value) {
                return Err(VisionError::Setting { name, value, expected });
            }
        }
        if !self.area_m.is_empty() && (self.area_m.len() < 3 || self.area_m.iter().any(|p| !p.is_finite())) {
            let (name, value) = ("area_m", self.area_m.len() as f64);
            return Err(VisionError::Setting { name, value, expected: "none, or three or more finite corners" });
        }
        Ok(())
    }
}

/// What the object tracker follows: the settings, and the known types of objects, of which a point cloud has none.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrackRules<'s> {
    pub track: &'s TrackSettings,
    pub templates: &'s [Template],
    /// See [`CameraTrackerSettings::template_frames`](crate::CameraTrackerSettings::template_frames).
    pub template_frames: u32,
}
