//! What is wrong with a picture, a calibration or a setting, and what to do about it.

use elbowroom_formats::FormatError;

/// Why a frame, a calibration or a setting was refused. Nothing that was known about obstacles is lost by it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VisionError {
    /// A file that is missing, truncated or not what its name says. The message names the file and what to write.
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
    /// The bytes do not make up the picture that was announced.
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
        /// Bytes that are there.
        found: usize,
    },
    /// A frame of another size than the camera was calibrated for.
    #[error(
        "{frame}: the frame has {found_width} x {found_height} pixels, but the camera was calibrated for {width} x \
         {height}; set the camera back to that size, or calibrate it anew"
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
        /// What the first frame was.
        expected: &'static str,
        /// What this one is.
        found: &'static str,
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
        "the camera was never calibrated, so pixels are no places; give four or more points of the floor with their \
         pixels (FloorHomography::from_points), or intrinsics and a pose (Camera::new)"
    )]
    NotCalibrated,
    /// The question needs heights, and a floor homography knows only the floor.
    #[error(
        "a floor homography cannot say where a point above the floor appears; calibrate with intrinsics and a pose \
         (Camera::new), or draw the silhouette in pixels (PixelMask::hide_polygon)"
    )]
    NeedsCamera,
    /// A calibration from which no place follows.
    #[error("the camera's calibration is no use: {0}")]
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
