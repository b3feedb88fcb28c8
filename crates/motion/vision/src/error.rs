//! Errors of images, calibrations and settings.

use elbowroom_formats::FormatError;

use crate::Channels;

/// Why a frame, a calibration or a setting was refused. Tracked obstacles are not affected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VisionError {
    /// A file that is missing, truncated or of another format. The message names the file and what to write instead.
    #[error(transparent)]
    File(#[from] FormatError),
    /// A frame without pixels.
    #[error("{frame}: the frame is empty: {width} x {height} pixels")]
    Empty {
        /// The frame's name.
        frame: String,
        /// Its columns.
        width: usize,
        /// Its rows.
        height: usize,
    },
    /// The number of bytes does not match the size of the image.
    #[error(
        "{frame}: {width} x {height} pixels of {bytes_per_pixel} byte(s) need {expected} bytes, but there are {found}"
    )]
    WrongLength {
        /// The frame's name.
        frame: String,
        /// Its announced columns.
        width: usize,
        /// Its announced rows.
        height: usize,
        /// 1 for grey, 3 for RGB.
        bytes_per_pixel: usize,
        /// `width * height * bytes_per_pixel`.
        expected: usize,
        /// Number of bytes present.
        found: usize,
    },
    /// A frame of another size than the camera was calibrated for.
    #[error(
        "{frame}: the frame has {found_width} x {found_height} pixels, but the camera was calibrated for {width} x \
         {height}; set the camera back to that size, or calibrate it again"
    )]
    WrongSize {
        /// The frame's name.
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
        /// The frame's name.
        frame: String,
        /// Channels of the first frame.
        expected: Channels,
        /// Channels of this one.
        found: Channels,
    },
    /// A frame that is not later than the one before it.
    #[error(
        "{frame}: its time {stamp_s} s is not after {last_s} s, the time of the frame before; send frames in order"
    )]
    OutOfOrder {
        /// The frame's name.
        frame: String,
        /// Its time stamp, seconds.
        stamp_s: f64,
        /// The stamp of the frame before, seconds.
        last_s: f64,
    },
    /// No calibration was given.
    #[error(
        "the camera is not calibrated, so pixels have no positions; give four or more points of the floor with their \
         pixels (FloorHomography::from_points), or intrinsics and a pose (Camera::new)"
    )]
    NotCalibrated,
    /// Heights are needed, which a floor homography does not determine.
    #[error(
        "a floor homography does not determine where a point above the floor appears; calibrate with intrinsics and a \
         pose (Camera::new), or draw the silhouette in pixels (PixelMask::mask_polygon)"
    )]
    NeedsCamera,
    /// A calibration that does not determine positions.
    #[error("the camera's calibration is not usable: {0}")]
    Calibration(String),
    /// A setting out of its range.
    #[error("the setting `{name}` is {value}; {expected}")]
    Setting {
        /// The field's name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What to write instead.
        expected: &'static str,
    },
}
