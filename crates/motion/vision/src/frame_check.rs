//! Checks of a camera and its frames before use.

use crate::{Calibration, CameraTrackerSettings, Channels, Frame, PixelMask, Point2, VisionError};

/// Checks that a frame and its mask have the camera's size and channels, and that the frame is later than the last one.
pub(crate) fn frame(
    frame: &Frame,
    arm: Option<&PixelMask>,
    width: usize,
    height: usize,
    channels: Option<Channels>,
    last_s: Option<f64>,
) -> Result<(), VisionError> {
    let name = || frame.name.clone();
    let (found_width, found_height) = (frame.width(), frame.height());
    if found_width == 0 || found_height == 0 {
        return Err(VisionError::Empty { frame: name(), width: found_width, height: found_height });
    }
    if (found_width, found_height) != (width, height) {
        return Err(VisionError::WrongSize { frame: name(), width, height, found_width, found_height });
    }
    if let Some(mask) = arm
        && mask.size() != (width, height)
    {
        let (found_width, found_height) = mask.size();
        let frame = format!("{}, mask of the arm", frame.name);
        return Err(VisionError::WrongSize { frame, width, height, found_width, found_height });
    }
    if let Some(expected) = channels.filter(|&channels| channels != frame.channels()) {
        return Err(VisionError::WrongChannels { frame: name(), expected, found: frame.channels() });
    }
    let stamp_s = frame.stamp_s;
    match last_s {
        _ if !stamp_s.is_finite() => Err(VisionError::OutOfOrder { frame: name(), stamp_s, last_s: stamp_s }),
        Some(last_s) if stamp_s <= last_s => Err(VisionError::OutOfOrder { frame: name(), stamp_s, last_s }),
        _ => Ok(()),
    }
}

/// Checks that the whole image shows floor: pixels above the horizon have no position.
pub(crate) fn floor_visible(
    calibration: &Calibration,
    settings: &CameraTrackerSettings,
    width: usize,
    height: usize,
) -> Result<(), VisionError> {
    let (w, h) = (width as f64, height as f64);
    let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)];
    let shows_floor =
        |&(x, y): &(f64, f64)| calibration.pixel_to_floor(Point2::new(x, y), settings.track.floor_z_m).is_some();
    if corners.iter().all(shows_floor) {
        return Ok(());
    }
    Err(VisionError::Calibration(
        "a corner of its picture shows no floor (the horizon is visible, or the floor's height is wrong); tilt the \
         camera down, crop the picture, or check floor_z_m"
            .into(),
    ))
}
