//! Conversion of depth images to points.

use elbowroom_spatial::Vec3;

use super::point_cloud::PointCloud;
use crate::{Camera, Point2, VisionError};

impl PointCloud {
    /// Replaces the points by the points of a depth image: depths along the camera's optical axis in metres, row by
    /// row. Depths that are 0, negative or not finite are invalid: they are dropped and counted. The points are in the
    /// camera's frame, so [`CloudTrackerSettings::sensor_in_world`](super::CloudTrackerSettings::sensor_in_world) is
    /// the camera's pose.
    ///
    /// # Errors
    /// The number of depths differs from the camera's number of pixels.
    ///
    /// ```
    /// use elbowroom_spatial::Vec3;
    /// use elbowroom_vision::cloud::PointCloud;
    /// use elbowroom_vision::{Camera, Intrinsics};
    /// let lens = Intrinsics::pinhole(2, 2, 1.0);
    /// let camera = Camera::look_at(lens, Vec3::Z * 3.0, Vec3::ZERO, Vec3::Y)?;
    /// let mut cloud = PointCloud::default();
    /// cloud.fill_from_depths(&camera, &[2.0, 0.0, f32::NAN, 2.5])?;
    /// assert_eq!((cloud.points.len(), cloud.dropped, cloud.points[1].z), (2, 2, 2.5));
    /// assert!(cloud.fill_from_depths(&camera, &[1.0; 3]).is_err());
    /// # Ok::<(), elbowroom_vision::VisionError>(())
    /// ```
    pub fn fill_from_depths(&mut self, camera: &Camera, depths_m: &[f32]) -> Result<(), VisionError> {
        self.fill_from(camera, depths_m.len(), |i| f64::from(depths_m[i]))
    }

    /// Like [`PointCloud::fill_from_depths`], for whole multiples of `unit_m` metres (0.001 for most cameras) as
    /// returned by [`read_grey16`](crate::read_grey16).
    ///
    /// # Errors
    /// The errors of [`PointCloud::fill_from_depths`]; or the unit is not positive.
    pub fn fill_from_grey16(&mut self, camera: &Camera, depths: &[u16], unit_m: f64) -> Result<(), VisionError> {
        if !(unit_m > 0.0 && unit_m.is_finite()) {
            let expected = "a positive number of metres per step of depth, mostly 0.001";
            return Err(VisionError::Setting { name: "unit_m", value: unit_m, expected });
        }
        self.fill_from(camera, depths.len(), |i| f64::from(depths[i]) * unit_m)
    }

    fn fill_from(&mut self, camera: &Camera, found: usize, depth_m: impl Fn(usize) -> f64) -> Result<(), VisionError> {
        let (width, height) = (camera.intrinsics().width, camera.intrinsics().height);
        let expected = width * height;
        if expected != found {
            self.fill([]);
            let frame = if self.name.is_empty() { "depth picture".into() } else { self.name.clone() };
            return Err(VisionError::WrongLength { frame, width, height, bytes_per_pixel: 1, expected, found });
        }
        self.fill((0..found).map(|i| {
            let depth_m = depth_m(i);
            if !(depth_m > 0.0) {
                return Vec3::splat(f64::NAN);
            }
            let centre_px = Point2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            camera.pixel_to_ray(centre_px) * depth_m
        }));
        Ok(())
    }
}
