//! A picture file.

use std::io::{self, Write};

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

/// Writes rows of red, green, blue.
pub(crate) fn write(mut out: impl Write, width: usize, height: usize, rgb: &[u8]) -> io::Result<()> {
    let size = |n: usize| u32::try_from(n).map_err(io::Error::other);
    let encoder = PngEncoder::new(&mut out);
    encoder.write_image(rgb, size(width)?, size(height)?, ExtendedColorType::Rgb8).map_err(io::Error::other)?;
    out.flush()
}
