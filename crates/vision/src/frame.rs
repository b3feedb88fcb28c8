//! One picture of the camera.

use crate::VisionError;

/// Grey or colour, one byte per value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Channels {
    /// One byte per pixel.
    #[default]
    Grey,
    /// Three bytes per pixel: red, green, blue.
    Rgb,
}

impl Channels {
    /// Bytes per pixel.
    pub fn count(self) -> usize {
        match self {
            Self::Grey => 1,
            Self::Rgb => 3,
        }
    }

    /// For messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grey => "grey",
            Self::Rgb => "RGB",
        }
    }
}

/// A picture: rows from the top, pixels from the left, one byte per value, no padding.
///
/// ```
/// use elbowroom_vision::{Channels, Frame};
/// let frame = Frame::new("camera 1", 2, 2, Channels::Grey, vec![0, 50, 100, 150])?;
/// assert_eq!(frame.row(1), [100, 150]);
/// let error = Frame::new("camera 1", 2, 2, Channels::Rgb, vec![0; 4]).unwrap_err();
/// assert_eq!(error.to_string(), "camera 1: 2 x 2 pixels of 3 byte(s) need 12 bytes, but there are 4");
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frame {
    /// What messages call it: a file, or a number.
    pub name: String,
    /// When it was taken, seconds; each frame later than the one before.
    pub stamp_s: f64,
    width: usize,
    height: usize,
    channels: Channels,
    pixels: Vec<u8>,
}

impl Frame {
    /// A frame taken at 0 s.
    ///
    /// # Errors
    /// No pixels, or another number of bytes than width × height × channels.
    pub fn new(
        name: impl Into<String>,
        width: usize,
        height: usize,
        channels: Channels,
        pixels: Vec<u8>,
    ) -> Result<Self, VisionError> {
        let mut frame = Self { name: name.into(), ..Self::default() };
        frame.fill(width, height, channels, |bytes| *bytes = pixels)?;
        Ok(frame)
    }

    /// The same frame with the time it was taken, seconds.
    #[must_use]
    pub fn at(mut self, stamp_s: f64) -> Self {
        self.stamp_s = stamp_s;
        self
    }

    /// Replaces the picture, keeping the memory: `write` receives the old bytes and leaves the new ones.
    ///
    /// # Errors
    /// As [`Frame::new`]; the frame is then empty.
    pub fn fill(
        &mut self,
        width: usize,
        height: usize,
        channels: Channels,
        write: impl FnOnce(&mut Vec<u8>),
    ) -> Result<(), VisionError> {
        (self.width, self.height, self.channels) = (0, 0, channels);
        write(&mut self.pixels);
        let frame = || if self.name.is_empty() { "frame".into() } else { self.name.clone() };
        let expected = width.checked_mul(height).and_then(|n| n.checked_mul(channels.count()));
        if expected == Some(0) {
            return Err(VisionError::Empty { frame: frame(), width, height });
        }
        if expected != Some(self.pixels.len()) {
            return Err(VisionError::WrongLength {
                frame: frame(),
                width,
                height,
                bytes_per_pixel: channels.count(),
                expected: expected.unwrap_or(usize::MAX),
                found: self.pixels.len(),
            });
        }
        (self.width, self.height) = (width, height);
        Ok(())
    }

    /// No picture any more; the memory stays.
    pub(crate) fn empty(&mut self) {
        (self.width, self.height) = (0, 0);
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Grey or RGB.
    pub fn channels(&self) -> Channels {
        self.channels
    }

    /// All bytes, row by row.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// All bytes, to be drawn on.
    pub fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// The bytes of one row, from the top.
    ///
    /// # Panics
    /// On a row that is not there.
    pub fn row(&self, y: usize) -> &[u8] {
        let length = self.width * self.channels.count();
        &self.pixels[y * length..(y + 1) * length]
    }
}
