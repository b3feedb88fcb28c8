//! Frames to files.

use elbowroom_formats::FormatError;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use crate::{Channels, Frame, VisionError};

/// A frame as the bytes of a PNG file, packed for speed rather than for size.
///
/// ```
/// use elbowroom_vision::{Channels, Frame, decode, encode_png};
/// use std::path::Path;
/// let frame = Frame::new("camera", 2, 2, Channels::Grey, vec![0, 50, 100, 150])?;
/// let mut back = Frame::default();
/// decode(&encode_png(&frame)?, Path::new("frame.png"), None, &mut back)?;
/// assert_eq!(back.pixels(), frame.pixels());
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
///
/// # Errors
/// A frame without pixels.
pub fn encode_png(frame: &Frame) -> Result<Vec<u8>, VisionError> {
    let (width, height) = (frame.width(), frame.height());
    if width == 0 || height == 0 {
        return Err(VisionError::Empty { frame: frame.name.clone(), width, height });
    }
    let color = match frame.channels() {
        Channels::Grey => ExtendedColorType::L8,
        Channels::Rgb => ExtendedColorType::Rgb8,
    };
    let mut bytes = Vec::with_capacity(frame.pixels().len());
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Sub);
    let written = encoder.write_image(frame.pixels(), width as u32, height as u32, color);
    written.map_err(|e| FormatError::new(&frame.name, None, format!("cannot be written as PNG: {e}")))?;
    Ok(bytes)
}
