//! Where frames come from: a folder, a list of files, a callback.

use std::path::{Path, PathBuf};

use elbowroom_formats::FormatError;

use crate::decode::{self, RawLayout};
use crate::{Frame, VisionError};

/// A stream of frames.
pub trait Source {
    /// Writes the next frame into `frame`, reusing its memory; false when there are no more.
    ///
    /// # Errors
    /// A frame that cannot be read. The stream goes on: the next call gives the frame after it.
    fn next_frame(&mut self, frame: &mut Frame) -> Result<bool, VisionError>;
}

/// Picture files in a given order, a fixed time apart.
///
/// ```
/// use elbowroom_vision::{Files, Frame, Source};
/// let mut files = Files::list(["one.png", "two.png"], 0.04);
/// let error = files.next_frame(&mut Frame::default()).unwrap_err();
/// assert!(error.to_string().starts_with("one.png: cannot be read"), "{error}");
/// ```
#[derive(Debug, Clone)]
pub struct Files {
    paths: Vec<PathBuf>,
    next: usize,
    period_s: f64,
    raw: Option<RawLayout>,
}

impl Files {
    /// These files in this order, `period_s` seconds apart, the first at 0 s.
    pub fn list(files: impl IntoIterator<Item = impl AsRef<Path>>, period_s: f64) -> Self {
        let paths = files.into_iter().map(|file| file.as_ref().to_owned()).collect();
        Self { paths, next: 0, period_s, raw: None }
    }

    /// The pictures of a folder in the order of their names (byte by byte: number them with leading zeros); other
    /// files in it are passed over.
    ///
    /// # Errors
    /// A folder that cannot be read or holds no picture.
    pub fn folder(folder: &Path, period_s: f64) -> Result<Self, VisionError> {
        let cannot = |e: std::io::Error| FormatError::new(folder, None, format!("cannot be read: {e}"));
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(cannot)? {
            let path = entry.map_err(cannot)?.path();
            if is_picture(&path) {
                files.push(path);
            }
        }
        if files.is_empty() {
            return Err(FormatError::new(folder, None, "holds no picture")
                .hint("a folder with .png, .pgm, .ppm, .pnm, .raw, .gray or .grey files")
                .into());
        }
        files.sort();
        Ok(Self::list(files, period_s))
    }

    /// The same files, with what raw ones among them mean.
    #[must_use]
    pub fn raw(mut self, layout: RawLayout) -> Self {
        self.raw = Some(layout);
        self
    }

    /// The files, in order.
    pub fn paths(&self) -> &[PathBuf] {
        &self.paths
    }
}

fn is_picture(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    ["png", "pgm", "ppm", "pnm", "raw", "gray", "grey"].iter().any(|&e| extension == e)
}

impl Source for Files {
    fn next_frame(&mut self, frame: &mut Frame) -> Result<bool, VisionError> {
        let Some(file) = self.paths.get(self.next) else { return Ok(false) };
        frame.stamp_s = self.next as f64 * self.period_s;
        self.next += 1;
        decode::read(file, self.raw, frame)?;
        Ok(true)
    }
}

/// Any function that fills frames, such as the driver of a camera.
///
/// ```
/// use elbowroom_vision::{Channels, Frame, Source};
/// let mut left = 2;
/// let mut camera = |frame: &mut Frame| {
///     left -= 1;
///     frame.stamp_s += 0.04;
///     frame.fill(4, 3, Channels::Grey, |pixels| pixels.resize(12, 80))?;
///     Ok(left >= 0)
/// };
/// let mut frame = Frame::default();
/// assert!(camera.next_frame(&mut frame)?);
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
impl<F: FnMut(&mut Frame) -> Result<bool, VisionError>> Source for F {
    fn next_frame(&mut self, frame: &mut Frame) -> Result<bool, VisionError> {
        self(frame)
    }
}
