//! How pixels become places.

use elbowroom_spatial::Vec3;

use crate::{Camera, FloorHomography, Point2, VisionError};

/// What is known about a camera.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Calibration {
    /// Nothing: [`Vision::new`](crate::Vision::new) refuses it and says what to do.
    #[default]
    Missing,
    /// Only where pixels lie on the floor.
    Floor(FloorHomography),
    /// Lens and place: also what lies above the floor can be put into the picture.
    Camera(Camera),
}

impl Calibration {
    /// Columns and rows of the picture.
    ///
    /// # Errors
    /// [`VisionError::NotCalibrated`].
    pub fn size(&self) -> Result<(usize, usize), VisionError> {
        match self {
            Self::Missing => Err(VisionError::NotCalibrated),
            Self::Floor(map) => Ok(map.size()),
            Self::Camera(camera) => Ok((camera.intrinsics().width, camera.intrinsics().height)),
        }
    }

    /// The place of the floor (at height `floor_z_m`) seen at a pixel; `None` where no floor is seen, or none is known.
    pub fn pixel_to_floor(&self, seen_px: Point2, floor_z_m: f64) -> Option<Point2> {
        match self {
            Self::Missing => None,
            Self::Floor(map) => map.pixel_to_floor(seen_px),
            Self::Camera(camera) => camera.pixel_to_plane(seen_px, floor_z_m),
        }
    }

    /// Where a place of the floor (at height `floor_z_m`) is seen; `None` behind the camera, or where nothing is known.
    pub fn floor_to_pixel(&self, at_m: Point2, floor_z_m: f64) -> Option<Point2> {
        match self {
            Self::Missing => None,
            Self::Floor(map) => map.floor_to_pixel(at_m),
            Self::Camera(camera) => camera.world_to_pixel(Vec3::new(at_m.x, at_m.y, floor_z_m)),
        }
    }

    /// The camera's place in the world, where it is known.
    pub fn eye_in_world(&self) -> Option<Vec3> {
        match self {
            Self::Missing => None,
            Self::Floor(map) => map.eye_in_world(),
            Self::Camera(camera) => Some(camera.eye_in_world()),
        }
    }

    /// The camera, where lens and place are known.
    ///
    /// # Errors
    /// [`VisionError::NotCalibrated`], [`VisionError::NeedsCamera`].
    pub fn camera(&self) -> Result<&Camera, VisionError> {
        match self {
            Self::Missing => Err(VisionError::NotCalibrated),
            Self::Floor(_) => Err(VisionError::NeedsCamera),
            Self::Camera(camera) => Ok(camera),
        }
    }

    /// Whether lines of the picture are bent lines of the floor.
    pub(crate) fn bends_lines(&self) -> bool {
        matches!(self, Self::Camera(camera) if camera.intrinsics().radial != [0.0; 3])
    }
}

impl From<Camera> for Calibration {
    fn from(camera: Camera) -> Self {
        Self::Camera(camera)
    }
}

impl From<FloorHomography> for Calibration {
    fn from(map: FloorHomography) -> Self {
        Self::Floor(map)
    }
}
