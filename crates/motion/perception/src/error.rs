//! Errors of the perception pipeline.

use elbowroom_cspace::{ConvexObstacleError, GridAxisError, PlanarMapError, TooManyCells};
use elbowroom_proximity::HullError;
use elbowroom_vision::VisionError;

/// Why a pipeline cannot be created, or a frame cannot be used. The map is unchanged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PerceptionError {
    /// A joint index beyond the robot's joints.
    #[error("joint index {index} is out of range: the robot has {dof} joints, counted from 0")]
    Joint {
        /// The given index.
        index: usize,
        /// Number of joints of the robot.
        dof: usize,
    },
    /// The grid cannot be created.
    #[error("{0}")]
    Grid(String),
    /// The dimensions of the planar arm, or a step that is too coarse.
    #[error(transparent)]
    Fill(#[from] PlanarMapError),
    /// A setting that is negative or not finite.
    #[error("the setting `{name}` is {value}: write a finite number, 0 or more")]
    Setting {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The number of joint values does not match the robot, or one is not finite.
    #[error(
        "{found} joint values were given, the robot has {dof}: all of them, finite, as they were when the frame was taken"
    )]
    Values {
        /// Number of given values.
        found: usize,
        /// Number of joints of the robot.
        dof: usize,
    },
    /// The frame, the calibration or a setting of the camera.
    #[error(transparent)]
    Vision(#[from] VisionError),
    /// An obstacle without a valid convex hull.
    #[error("an observed obstacle cannot be put into the map: {0}")]
    Obstacle(String),
}

impl From<ConvexObstacleError> for PerceptionError {
    fn from(error: ConvexObstacleError) -> Self {
        Self::Obstacle(error.to_string())
    }
}

impl From<HullError> for PerceptionError {
    fn from(error: HullError) -> Self {
        Self::Obstacle(error.to_string())
    }
}

impl From<GridAxisError> for PerceptionError {
    fn from(error: GridAxisError) -> Self {
        Self::Grid(error.to_string())
    }
}

impl From<TooManyCells> for PerceptionError {
    fn from(error: TooManyCells) -> Self {
        Self::Grid(error.to_string())
    }
}
