//! One image of the camera.

use crate::{Channels, VisionError};

/// An image: rows from the top, pixels from the left, one byte per sample, no padding.
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
    /// Name of the frame in messages: a file or a number.
    pub name: String,
    /// Time at which the frame was taken, seconds; increases from frame to frame.
    pub stamp_s: f64,
    width: usize,
    height: usize,
    channels: Channels,
    pixels: Vec<u8>,
}

impl Frame {
    /// Creates a frame taken at 0 s.
    ///
    /// # Errors
    /// The frame has no pixels, or the number of bytes is not width × height × channels.
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

    /// Sets the time at which the frame was taken, seconds.
    #[must_use]
    pub fn with_stamp(mut self, stamp_s: f64) -> Self {
        self.stamp_s = stamp_s;
        self
    }

    /// Replaces the image and reuses its memory: `write` receives the old bytes and must leave the new ones.
    ///
    /// # Errors
    /// The errors of [`Frame::new`]; the frame is then empty.
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

    /// Removes the image but keeps its memory.
    pub(crate) fn clear(&mut self) {
        (self.width, self.height) = (0, 0);
    }

    /// Moves the memory of the pixels out; the frame is then empty.
    pub(crate) fn take_pixels(&mut self) -> Vec<u8> {
        self.clear();
        std::mem::take(&mut self.pixels)
    }

    /// Number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
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

    /// All bytes, mutable.
    pub fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// The bytes of one row, from the top.
    ///
    /// # Panics
    /// The row does not exist.
    pub fn row(&self, y: usize) -> &[u8] {
        let length = self.width * self.channels.count();
        &self.pixels[y * length..(y + 1) * length]
    }
}
