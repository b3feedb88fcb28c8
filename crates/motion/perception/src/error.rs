//! Errors of perception.

use elbowroom_vision::VisionError;

/// Why a watcher cannot be created or a frame cannot be used. The map is unchanged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PerceptionError {
    /// A setting that is negative or not finite.
    #[error("the setting `{name}` is {value}: write a finite number, 0 or more")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Value of the setting.
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
    /// The frame, the calibration or a setting of the camera is invalid.
    #[error(transparent)]
    Vision(#[from] VisionError),
    /// An obstacle has no volume or is too far away.
    #[error("an observed obstacle cannot be put into the map: {0}")]
    Obstacle(String),
}
