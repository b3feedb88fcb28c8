//! The mapping between pixels and positions in the world.

use elbowroom_spatial::Vec3;

use crate::{Camera, FloorHomography, Point2, VisionError};

/// Calibration of a camera.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Calibration {
    /// No calibration: [`CameraTracker::new`](crate::CameraTracker::new) rejects it with a message that names the
    /// alternatives.
    #[default]
    Missing,
    /// A homography between the image and the floor.
    Floor(FloorHomography),
    /// Intrinsics and pose, which also determine the pixels of points above the floor.
    Camera(Camera),
}

impl Calibration {
    /// Columns and rows of the image.
    ///
    /// # Errors
    /// [`VisionError::NotCalibrated`] without a calibration.
    pub fn size(&self) -> Result<(usize, usize), VisionError> {
        match self {
            Self::Missing => Err(VisionError::NotCalibrated),
            Self::Floor(homography) => Ok(homography.size()),
            Self::Camera(camera) => Ok((camera.intrinsics().width, camera.intrinsics().height)),
        }
    }

    /// The point of the floor (at height `floor_z_m`) that a pixel shows; `None` if the pixel does not show the floor,
    /// or without calibration.
    pub fn pixel_to_floor(&self, point_px: Point2, floor_z_m: f64) -> Option<Point2> {
        match self {
            Self::Missing => None,
            Self::Floor(homography) => homography.pixel_to_floor(point_px),
            Self::Camera(camera) => camera.pixel_to_plane(point_px, floor_z_m),
        }
    }

    /// The pixel that shows a point of the floor (at height `floor_z_m`); `None` behind the camera, or without
    /// calibration.
    pub fn floor_to_pixel(&self, point_m: Point2, floor_z_m: f64) -> Option<Point2> {
        match self {
            Self::Missing => None,
            Self::Floor(homography) => homography.floor_to_pixel(point_m),
            Self::Camera(camera) => camera.world_to_pixel(Vec3::new(point_m.x, point_m.y, floor_z_m)),
        }
    }

    /// The centre of projection in the world, if it is known.
    pub fn eye_in_world(&self) -> Option<Vec3> {
        match self {
            Self::Missing => None,
            Self::Floor(homography) => homography.eye_in_world(),
            Self::Camera(camera) => Some(camera.eye_in_world()),
        }
    }

    /// The camera, if intrinsics and pose are known.
    ///
    /// # Errors
    /// [`VisionError::NotCalibrated`] or [`VisionError::NeedsCamera`].
    pub fn camera(&self) -> Result<&Camera, VisionError> {
        match self {
            Self::Missing => Err(VisionError::NotCalibrated),
            Self::Floor(_) => Err(VisionError::NeedsCamera),
            Self::Camera(camera) => Ok(camera),
        }
    }

    /// Whether straight lines in the image are curves on the floor.
    pub(crate) fn has_distortion(&self) -> bool {
        matches!(self, Self::Camera(camera) if camera.intrinsics().radial != [0.0; 3])
    }
}

impl From<Camera> for Calibration {
    fn from(camera: Camera) -> Self {
        Self::Camera(camera)
    }
}

impl From<FloorHomography> for Calibration {
    fn from(homography: FloorHomography) -> Self {
        Self::Floor(homography)
    }
}
