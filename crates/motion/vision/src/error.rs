//! Errors of images, calibrations and settings.

use elbowroom_formats::Diagnostic;

use crate::Channels;

/// Why a frame, a calibration or a setting was rejected. Tracked obstacles are not affected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VisionError {
    /// A file is missing, truncated or of another format. The message states the file and what to write instead.
    #[error(transparent)]
    File(#[from] Diagnostic),
    /// A frame has no pixels.
    #[error("{frame}: the frame is empty: {width} x {height} pixels")]
    Empty {
        /// Name of the frame.
        frame: String,
        /// Number of columns.
        width: usize,
        /// Number of rows.
        height: usize,
    },
    /// The number of bytes does not match the size of the image.
    #[error(
        "{frame}: {width} x {height} pixels of {bytes_per_pixel} byte(s) need {expected} bytes, but there are {found}"
    )]
    WrongLength {
        /// Name of the frame.
        frame: String,
        /// Announced number of columns.
        width: usize,
        /// Announced number of rows.
        height: usize,
        /// 1 for grey, 3 for RGB.
        bytes_per_pixel: usize,
        /// `width * height * bytes_per_pixel`.
        expected: usize,
        /// Number of bytes found.
        found: usize,
    },
    /// The size of a frame differs from the size in the camera's calibration.
    #[error(
        "{frame}: the frame has {found_width} x {found_height} pixels, but the camera was calibrated for {width} x \
         {height}; set the camera back to that size, or calibrate it again"
    )]
    WrongSize {
        /// Name of the frame.
        frame: String,
        /// Columns of the calibration.
        width: usize,
        /// Rows of the calibration.
        height: usize,
        /// Columns of the frame.
        found_width: usize,
        /// Rows of the frame.
        found_height: usize,
    },
    /// Grey and RGB frames were mixed.
    #[error("{frame}: the frame is {found}, but those before it were {expected}; one camera sends one kind")]
    WrongChannels {
        /// Name of the frame.
        frame: String,
        /// Channels of the first frame.
        expected: Channels,
        /// Channels of this frame.
        found: Channels,
    },
    /// A frame is not later than the previous one.
    #[error(
        "{frame}: its time {stamp_s} s is not after {last_s} s, the time of the frame before; send frames in order"
    )]
    OutOfOrder {
        /// Name of the frame.
        frame: String,
        /// Time stamp of the frame, seconds.
        stamp_s: f64,
        /// Time stamp of the previous frame, seconds.
        last_s: f64,
    },
    /// No calibration was given.
    #[error(
        "the camera is not calibrated, so pixels have no positions; give four or more points of the floor with their \
         pixels (FloorHomography::from_points), or intrinsics and a pose (Camera::new)"
    )]
    NotCalibrated,
    /// Heights are needed, but a floor homography does not determine them.
    #[error(
        "a floor homography does not determine where a point above the floor appears; calibrate with intrinsics and a \
         pose (Camera::new), or draw the silhouette in pixels (PixelMask::mask_polygon)"
    )]
    NeedsCamera,
    /// A calibration does not determine positions.
    #[error("the camera's calibration is not usable: {0}")]
    Calibration(String),
    /// A setting is out of its range.
    #[error("the setting `{name}` is {value}; {expected}")]
    Setting {
        /// Name of the field.
        name: &'static str,
        /// Value of the setting.
        value: f64,
        /// What to write instead.
        expected: &'static str,
    },
}
