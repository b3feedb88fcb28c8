//! The points that a sensor measured at one time.

use std::path::Path;

use elbowroom_formats::{Diagnostic, pcd, ply};
use elbowroom_spatial::Vec3;

use crate::VisionError;
use crate::image_file::read_bytes;

/// The points that a sensor measured at one time, in the sensor's frame, metres.
///
/// ```
/// use elbowroom_vision::cloud::PointCloud;
/// use std::path::Path;
/// let text = b"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3\nnan 0 0\n";
/// let mut cloud = PointCloud::default();
/// cloud.decode(text, Path::new("two.pcd"))?;
/// assert_eq!((cloud.points.len(), cloud.dropped), (1, 1));
/// # Ok::<(), elbowroom_vision::VisionError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointCloud {
    /// Name of the cloud in messages.
    pub name: String,
    /// Time of the measurement, seconds.
    pub stamp_s: f64,
    /// Finite points in the sensor's frame, metres.
    pub points: Vec<Vec3>,
    /// Number of invalid points: NaN, infinite, or without a depth. Nothing was measured there, but the space may be
    /// occupied.
    pub dropped: usize,
}

impl PointCloud {
    /// Replaces the points (sensor's frame, metres); drops and counts points that are not finite.
    pub fn fill(&mut self, points: impl IntoIterator<Item = Vec3>) {
        self.points.clear();
        self.dropped = 0;
        for p in points {
            if p.is_finite() {
                self.points.push(p);
            } else {
                self.dropped += 1;
            }
        }
    }

    /// Reads a `.pcd` (ASCII, binary, compressed) or `.ply` file; the cloud is named after the path.
    ///
    /// # Errors
    /// The file is missing, truncated or of another format. The error states the file, the line, the fault, and what to
    /// write instead. The cloud is then empty.
    pub fn read(&mut self, path: &Path) -> Result<(), VisionError> {
        self.fill([]);
        let bytes = read_bytes(path)?;
        self.decode(&bytes, path)
    }

    /// Like [`PointCloud::read`], from bytes.
    ///
    /// # Errors
    /// The errors of [`PointCloud::read`].
    pub fn decode(&mut self, bytes: &[u8], file: &Path) -> Result<(), VisionError> {
        self.fill([]);
        self.name = file.to_string_lossy().into_owned();
        if bytes.starts_with(b"ply") {
            self.fill(ply::parse_points(bytes, file)?);
            return Ok(());
        }
        let is_pcd = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("pcd"));
        if is_pcd || bytes.starts_with(b"# .PCD") || bytes.starts_with(b"VERSION") {
            self.fill(pcd::parse_points(bytes, file)?);
            return Ok(());
        }
        Err(Diagnostic::new(file, None, "is no point cloud that can be read").hint("a .pcd or a .ply file").into())
    }
}
