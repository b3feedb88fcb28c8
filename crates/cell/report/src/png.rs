//! PNG files.

use std::io::{self, Write};

use elbowroom_formats::image::{ImageHeader, PixelFormat};
use elbowroom_formats::png;

/// Writes rows of RGB pixels.
pub(crate) fn write(out: impl Write, width: usize, height: usize, rgb: &[u8]) -> io::Result<()> {
    png::write(out, &ImageHeader { width, height, format: PixelFormat::Rgb8 }, rgb)
}
