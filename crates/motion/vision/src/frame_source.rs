//! Sources of frames: a folder, a list of files, a callback.

use std::path::{Path, PathBuf};

use elbowroom_formats::Diagnostic;

use crate::image_file::{self, RawLayout};
use crate::{Frame, VisionError};

/// A stream of frames.
pub trait FrameSource {
    /// Writes the next frame to `frame`, whose memory is reused; returns false at the end of the stream.
    ///
    /// # Errors
    /// A frame cannot be read. The stream continues: the next call returns the following frame.
    fn next_frame(&mut self, frame: &mut Frame) -> Result<bool, VisionError>;
}

/// Image files in a given order, at constant intervals.
///
/// ```
/// use elbowroom_vision::{ImageFiles, Frame, FrameSource};
/// let mut files = ImageFiles::list(["one.png", "two.png"], 0.04);
/// let error = files.next_frame(&mut Frame::default()).unwrap_err();
/// assert!(error.to_string().starts_with("one.png: cannot be read"), "{error}");
/// ```
#[derive(Debug, Clone)]
pub struct ImageFiles {
    paths: Vec<PathBuf>,
    next: usize,
    period_s: f64,
    raw: Option<RawLayout>,
}

impl ImageFiles {
    /// Creates a source of these files in this order, `period_s` seconds apart, the first at 0 s.
    pub fn list(files: impl IntoIterator<Item = impl AsRef<Path>>, period_s: f64) -> Self {
        let paths = files.into_iter().map(|file| file.as_ref().to_owned()).collect();
        Self { paths, next: 0, period_s, raw: None }
    }

    /// Creates a source of the images in a folder in the order of their names (byte by byte: number them with leading
    /// zeros); skips other files.
    ///
    /// # Errors
    /// The folder cannot be read or contains no images.
    pub fn folder(folder: &Path, period_s: f64) -> Result<Self, VisionError> {
        let cannot = |e: std::io::Error| Diagnostic::new(folder, None, format!("cannot be read: {e}"));
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(cannot)? {
            let path = entry.map_err(cannot)?.path();
            if is_image(&path) {
                files.push(path);
            }
        }
        if files.is_empty() {
            return Err(Diagnostic::new(folder, None, "holds no picture")
                .hint("a folder with .png, .pgm, .ppm, .pnm, .raw, .gray or .grey files")
                .into());
        }
        files.sort();
        Ok(Self::list(files, period_s))
    }

    /// Sets the layout of raw files among the files.
    ///
    /// ```
    /// use elbowroom_vision::{Channels, Frame, FrameSource, ImageFiles, RawLayout};
    /// let file = std::env::temp_dir().join(format!("elbowroom-{}.raw", std::process::id()));
    /// std::fs::write(&file, [10, 20, 30, 40, 50, 60])?;
    /// let layout = RawLayout { width: 3, height: 2, channels: Channels::Grey };
    /// let mut frame = Frame::default();
    /// assert!(ImageFiles::list([&file], 0.04).with_raw_layout(layout).next_frame(&mut frame)?);
    /// assert_eq!(frame.width(), 3);
    /// std::fs::remove_file(file)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_raw_layout(mut self, layout: RawLayout) -> Self {
        self.raw = Some(layout);
        self
    }

    /// The files, in order.
    pub fn paths(&self) -> &[PathBuf] {
        &self.paths
    }
}

fn is_image(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    ["png", "pgm", "ppm", "pnm", "raw", "gray", "grey"].iter().any(|&e| extension == e)
}

impl FrameSource for ImageFiles {
    fn next_frame(&mut self, frame: &mut Frame) -> Result<bool, VisionError> {
        let Some(file) = self.paths.get(self.next) else { return Ok(false) };
        frame.stamp_s = self.next as f64 * self.period_s;
        self.next += 1;
        image_file::read(file, self.raw, frame)?;
        Ok(true)
    }
}

/// Any function that fills frames is a source, for example the driver of a camera.
///
/// ```
/// use elbowroom_vision::{Channels, Frame, FrameSource};
/// let mut frames_left = 2;
/// let mut camera = |frame: &mut Frame| {
///     frames_left -= 1;
///     frame.stamp_s += 0.04;
///     frame.fill(4, 3, Channels::Grey, |pixels| pixels.resize(12, 80))?;
///     Ok(frames_left >= 0)
/// };
/// let mut frame = Frame::default();
/// assert!(camera.next_frame(&mut frame)?);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
impl<F: FnMut(&mut Frame) -> Result<bool, VisionError>> FrameSource for F {
    fn next_frame(&mut self, frame: &mut Frame) -> Result<bool, VisionError> {
        self(frame)
    }
}
