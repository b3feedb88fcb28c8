//! Depth pictures to points.

use elbowroom_spatial::Vec3;

use super::Cloud;
use crate::{Camera, Point2, VisionError};

impl Cloud {
    /// Takes a depth picture of a camera: depths along its optical axis in metres, row by row. Depths that are 0, negative
    /// or not finite were not measured: dropped and counted. The points are in the camera's frame, so
    /// [`CloudSettings::sensor_in_world`](super::CloudSettings::sensor_in_world) is the camera's pose.
    ///
    /// # Errors
    /// Another number of depths than the camera has pixels.
    ///
    /// ```
    /// use elbowroom_spatial::Vec3;
    /// use elbowroom_vision::cloud::Cloud;
    /// use elbowroom_vision::{Camera, Intrinsics};
    /// let lens = Intrinsics::ideal(2, 2, 1.0);
    /// let camera = Camera::looking_at(lens, Vec3::Z * 3.0, Vec3::ZERO, Vec3::Y)?;
    /// let mut cloud = Cloud::default();
    /// cloud.fill_from_depths(&camera, &[2.0, 0.0, f32::NAN, 2.5])?;
    /// assert_eq!((cloud.points.len(), cloud.dropped, cloud.points[1].z), (2, 2, 2.5));
    /// assert!(cloud.fill_from_depths(&camera, &[1.0; 3]).is_err());
    /// # Ok::<(), elbowroom_vision::VisionError>(())
    /// ```
    pub fn fill_from_depths(&mut self, camera: &Camera, depths_m: &[f32]) -> Result<(), VisionError> {
        self.fill_from(camera, depths_m.len(), |i| f64::from(depths_m[i]))
    }

    /// As [`Cloud::fill_from_depths`], for whole numbers of `unit_m` metres (0.001 for most cameras), such as
    /// [`read_grey16`](crate::read_grey16) reads them.
    ///
    /// # Errors
    /// As [`Cloud::fill_from_depths`]; and a unit that is not positive.
    pub fn fill_from_grey16(&mut self, camera: &Camera, depths: &[u16], unit_m: f64) -> Result<(), VisionError> {
        if !(unit_m > 0.0 && unit_m.is_finite()) {
            let expected = "a positive number of metres per step of depth, mostly 0.001";
            return Err(VisionError::Setting { name: "unit_m", value: unit_m, expected });
        }
        self.fill_from(camera, depths.len(), |i| f64::from(depths[i]) * unit_m)
    }

    fn fill_from(&mut self, camera: &Camera, found: usize, depth: impl Fn(usize) -> f64) -> Result<(), VisionError> {
        let (width, height) = (camera.intrinsics().width, camera.intrinsics().height);
        let expected = width * height;
        if expected != found {
            self.fill([]);
            let frame = if self.name.is_empty() { "depth picture".into() } else { self.name.clone() };
            return Err(VisionError::WrongLength { frame, width, height, bytes_per_pixel: 1, expected, found });
        }
        self.fill((0..found).map(|i| {
            let along = depth(i);
            if !(along > 0.0) {
                return Vec3::splat(f64::NAN);
            }
            let pixel = Point2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            camera.pixel_to_ray(pixel) * along
        }));
        Ok(())
    }
}
