//! Raster images: the types shared by the readers and writers of [`png`](crate::png) and [`pnm`](crate::pnm).

use std::fmt;
use std::path::Path;

use crate::Diagnostic;

/// Largest number of columns or rows of an image, which bounds memory.
const MAX_SIDE: usize = 16_384;

/// Upper bound on the bytes to which one byte of a file can decode; deflate reaches 1032.
const MAX_EXPANSION: usize = 1100;

/// Channels and bits per sample of an image.
///
/// Samples of 16 bits are stored as two bytes, the most significant first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelFormat {
    /// One 8-bit sample.
    Grey8,
    /// Grey and opacity, 8 bits each.
    GreyAlpha8,
    /// Red, green, blue, 8 bits each.
    Rgb8,
    /// Red, green, blue, opacity, 8 bits each.
    Rgba8,
    /// One 16-bit sample.
    Grey16,
    /// Grey and opacity, 16 bits each.
    GreyAlpha16,
    /// Red, green, blue, 16 bits each.
    Rgb16,
    /// Red, green, blue, opacity, 16 bits each.
    Rgba16,
}

impl PixelFormat {
    /// Number of samples per pixel, 1 to 4.
    pub fn channels(self) -> usize {
        match self {
            Self::Grey8 | Self::Grey16 => 1,
            Self::GreyAlpha8 | Self::GreyAlpha16 => 2,
            Self::Rgb8 | Self::Rgb16 => 3,
            Self::Rgba8 | Self::Rgba16 => 4,
        }
    }

    /// Number of bytes per sample, 1 or 2.
    pub fn bytes_per_sample(self) -> usize {
        match self {
            Self::Grey8 | Self::GreyAlpha8 | Self::Rgb8 | Self::Rgba8 => 1,
            Self::Grey16 | Self::GreyAlpha16 | Self::Rgb16 | Self::Rgba16 => 2,
        }
    }
}

impl fmt::Display for PixelFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let channels = ["grey", "grey and alpha", "RGB", "RGBA"][self.channels() - 1];
        write!(f, "{}-bit {channels}", 8 * self.bytes_per_sample())
    }
}

/// Size and pixel format of an image.
///
/// The pixels are stored separately: rows from the top, pixels from the left, without padding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageHeader {
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Channels and bits per sample.
    pub format: PixelFormat,
}

impl ImageHeader {
    /// Number of bytes of the pixels; `usize::MAX` on overflow.
    pub fn byte_count(&self) -> usize {
        let per_pixel = self.format.channels() * self.format.bytes_per_sample();
        self.width.saturating_mul(self.height).saturating_mul(per_pixel)
    }

    /// Converts pixels in place to [`PixelFormat::Grey8`] or [`PixelFormat::Rgb8`], and returns the new header.
    ///
    /// Opacity is dropped; 16-bit samples are scaled to 8 bits and rounded.
    ///
    /// ```
    /// use elbowroom_formats::image::{ImageHeader, PixelFormat};
    /// let header = ImageHeader { width: 2, height: 1, format: PixelFormat::GreyAlpha16 };
    /// let mut pixels = vec![0xff, 0xff, 0, 0, 0x80, 0x80, 0, 0];
    /// assert_eq!(header.reduce_to_8_bit(&mut pixels).format, PixelFormat::Grey8);
    /// assert_eq!(pixels, [255, 128]);
    /// ```
    #[must_use]
    pub fn reduce_to_8_bit(self, pixels: &mut Vec<u8>) -> Self {
        let (channels, bytes) = (self.format.channels(), self.format.bytes_per_sample());
        let (format, kept) = if channels < 3 { (PixelFormat::Grey8, 1) } else { (PixelFormat::Rgb8, 3) };
        if format != self.format {
            let mut end = 0;
            for pixel in (0..pixels.len()).step_by(channels * bytes) {
                for sample in (pixel..).step_by(bytes).take(kept) {
                    pixels[end] = match bytes {
                        1 => pixels[sample],
                        _ => to_8_bit(u16::from_be_bytes([pixels[sample], pixels[sample + 1]])),
                    };
                    end += 1;
                }
            }
            pixels.truncate(end);
        }
        Self { format, ..self }
    }
}

fn to_8_bit(sample: u16) -> u8 {
    ((u32::from(sample) + 128) / 257) as u8
}

/// Refuses images without pixels, with a side above 16,384 pixels, or larger than `file_bytes` bytes can encode.
pub(crate) fn check_size(header: &ImageHeader, file_bytes: usize, file: &Path) -> Result<(), Diagnostic> {
    let ImageHeader { width, height, .. } = *header;
    if width == 0 || height == 0 {
        let what = format!("announces {width} x {height} pixels");
        return Err(Diagnostic::new(file, None, what).hint("a picture with at least one pixel"));
    }
    if width > MAX_SIDE || height > MAX_SIDE {
        let what = format!("announces {width} x {height} pixels, more than {MAX_SIDE} a side");
        return Err(Diagnostic::new(file, None, what).hint("a smaller picture"));
    }
    if header.byte_count() > file_bytes.saturating_mul(MAX_EXPANSION) {
        let what = format!("announces {width} x {height} pixels, but has only {file_bytes} bytes");
        return Err(Diagnostic::new(file, None, what).hint("the whole picture: the file is damaged or cut off"));
    }
    Ok(())
}

/// The error of a decoder that failed.
pub(crate) fn undecodable(file: &Path, why: impl fmt::Display) -> Diagnostic {
    Diagnostic::new(file, None, format!("cannot be decoded: {why}"))
        .hint("the whole picture: the file is damaged or was cut off while it was written")
}

/// Clears `pixels`, decodes into it, and clears it again on failure.
pub(crate) fn cleared_on_error<T, E>(
    pixels: &mut Vec<u8>,
    decode: impl FnOnce(&mut Vec<u8>) -> Result<T, E>,
) -> Result<T, E> {
    pixels.clear();
    let result = decode(pixels);
    if result.is_err() {
        pixels.clear();
    }
    result
}
