//! Frames from and to files: PNG, PNM (PGM, PPM, PBM) and raw bytes. Hostile input is rejected here.

use std::path::Path;

use elbowroom_formats::image::{ImageHeader, PixelFormat};
use elbowroom_formats::{Diagnostic, png, pnm, read_file};

use crate::{Channels, Frame, VisionError};

/// Largest accepted file, bytes.
const MAX_BYTES: u64 = 1 << 28;

/// Size and channels of raw files (`.raw`, `.gray`, `.grey`), which do not contain them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawLayout {
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Grey or RGB.
    pub channels: Channels,
}

/// Reads an image into `frame`, whose memory is reused; the frame is named after the path. The format is determined by
/// the content (PNG, PNM) or by the name (`.raw`, `.gray`, `.grey`, which need a layout). Opacity is dropped; 16-bit
/// samples are scaled to 8 bits.
///
/// # Errors
/// The file is missing, truncated, too large or of another format. The message states the file, the fault, and what to
/// write instead.
pub fn read(path: &Path, raw: Option<RawLayout>, frame: &mut Frame) -> Result<(), VisionError> {
    frame.clear();
    let bytes = read_bytes(path)?;
    decode(&bytes, path, raw, frame)
}

/// Like [`read`], from bytes; `file` is the name in messages.
///
/// # Errors
/// The errors of [`read`]; the frame is then empty.
pub fn decode(bytes: &[u8], file: &Path, raw: Option<RawLayout>, frame: &mut Frame) -> Result<(), VisionError> {
    frame.name.clear();
    frame.name.push_str(&file.to_string_lossy());
    let result = decode_any(bytes, file, raw, frame);
    if result.is_err() {
        frame.clear();
    }
    result
}

fn decode_any(bytes: &[u8], file: &Path, raw: Option<RawLayout>, frame: &mut Frame) -> Result<(), VisionError> {
    if bytes.is_empty() {
        return Err(Diagnostic::new(file, None, "is empty").hint("a PNG, PGM or PPM picture, or raw bytes").into());
    }
    if !png::is_png(bytes) && is_raw(file) {
        let layout = raw.ok_or_else(|| {
            Diagnostic::new(file, None, "is raw bytes, which do not say how wide the picture is")
                .hint("width, height and channels of raw frames; or pictures as PNG, PGM or PPM")
        })?;
        return frame.fill(layout.width, layout.height, layout.channels, |pixels| {
            pixels.clear();
            pixels.extend_from_slice(bytes);
        });
    }
    let mut pixels = frame.take_pixels();
    let header = decode_image(bytes, file, &mut pixels)?.reduce_to_8_bit(&mut pixels);
    let channels = if header.format == PixelFormat::Rgb8 { Channels::Rgb } else { Channels::Grey };
    frame.fill(header.width, header.height, channels, |frame_pixels| *frame_pixels = pixels)
}

fn is_raw(file: &Path) -> bool {
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    ["raw", "gray", "grey"].iter().any(|&e| extension == e)
}

/// Decodes PNG or PNM, depending on the content.
fn decode_image(bytes: &[u8], file: &Path, pixels: &mut Vec<u8>) -> Result<ImageHeader, Diagnostic> {
    if png::is_png(bytes) {
        png::read(bytes, file, pixels)
    } else if pnm::is_pnm(bytes) {
        pnm::read(bytes, file, pixels)
    } else {
        Err(Diagnostic::new(file, None, "is no picture that can be read").hint("PNG, PGM, PPM or raw bytes"))
    }
}

/// Reads the bytes of an image or point cloud file.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, Diagnostic> {
    read_file(path, MAX_BYTES, "a smaller picture or a thinner cloud")
}

/// Reads a 16-bit grey PNG or PGM as (width, height, values): the format in which depth cameras save images.
///
/// # Errors
/// The errors of [`read`]; or the image is not 16-bit grey.
pub fn read_grey16(path: &Path) -> Result<(usize, usize, Vec<u16>), VisionError> {
    decode_grey16(&read_bytes(path)?, path)
}

/// Like [`read_grey16`], from bytes.
///
/// # Errors
/// The errors of [`read_grey16`].
pub fn decode_grey16(bytes: &[u8], path: &Path) -> Result<(usize, usize, Vec<u16>), VisionError> {
    let mut pixels = Vec::new();
    let header = decode_image(bytes, path, &mut pixels)?;
    if header.format != PixelFormat::Grey16 {
        let what = format!("holds {} values, not depths", header.format);
        return Err(Diagnostic::new(path, None, what)
            .hint("one grey channel of 16 bits, as depth cameras save it")
            .into());
    }
    let values = pixels.as_chunks::<2>().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect();
    Ok((header.width, header.height, values))
}

/// Encodes a frame as the bytes of a PNG file.
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
/// The frame has no pixels.
pub fn encode_png(frame: &Frame) -> Result<Vec<u8>, VisionError> {
    let (width, height) = (frame.width(), frame.height());
    if width == 0 || height == 0 {
        return Err(VisionError::Empty { frame: frame.name.clone(), width, height });
    }
    let format = match frame.channels() {
        Channels::Grey => PixelFormat::Grey8,
        Channels::Rgb => PixelFormat::Rgb8,
    };
    let mut bytes = Vec::with_capacity(frame.pixels().len());
    png::write(&mut bytes, &ImageHeader { width, height, format }, frame.pixels())
        .map_err(|e| Diagnostic::new(&frame.name, None, format!("cannot be written as PNG: {e}")))?;
    Ok(bytes)
}
