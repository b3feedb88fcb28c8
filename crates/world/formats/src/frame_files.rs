//! Folders of camera pictures or point clouds with their times.
//!
//! A folder holds pictures (`*.png`, `*.pgm`, `*.ppm`) or point clouds (`*.pcd`, `*.ply`), in the order of their names.
//! Its `times.csv` has the columns `file` and `t_s`, the time of each frame in seconds.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::Diagnostic;
use crate::csv::{self, CsvLines};

type Result<T> = std::result::Result<T, Diagnostic>;

const TIMES: &str = "times.csv";
const HEADER: &str = "the header file,t_s and a row per picture: frame_0000.png,0.0";

/// Kind of the files of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameKind {
    /// Pictures of brightness, colour or depth.
    Picture,
    /// Point clouds.
    Cloud,
}

impl FrameKind {
    /// File name extensions of the kind.
    fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Picture => &["png", "pgm", "ppm", "pnm"],
            Self::Cloud => &["pcd", "ply"],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Cloud => "point cloud",
        }
    }

    fn instead(self) -> &'static str {
        match self {
            Self::Picture => "a folder of pictures (*.png, *.pgm, *.ppm) with times.csv",
            Self::Cloud => "a folder of point clouds (*.pcd, *.ply) with times.csv",
        }
    }
}

/// A picture or cloud with its time.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFile {
    /// Path of the file.
    pub path: PathBuf,
    /// Time of the picture or cloud, seconds.
    pub t_s: f64,
}

/// Reads the list of pictures or clouds of a folder, in the order of their names, which must be the order of their times.
///
/// ```
/// use elbowroom_formats::frame_files::FrameKind;
/// let dir = tempfile::tempdir()?;
/// for name in ["b.png", "a.png"] {
///     std::fs::write(dir.path().join(name), "")?;
/// }
/// std::fs::write(dir.path().join("times.csv"), "file,t_s\na.png,0\nb.png,0.04\n")?;
/// let (frames, warnings) = elbowroom_formats::frame_files::read(dir.path(), FrameKind::Picture)?;
/// assert!(frames[1].path.ends_with("b.png") && frames[1].t_s == 0.04 && warnings.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Diagnostic`] if the folder has no file of this kind, or if the times are missing, incomplete or do not increase.
pub fn read(folder: &Path, kind: FrameKind) -> Result<(Vec<FrameFile>, Vec<Diagnostic>)> {
    let pictures = files(folder, kind)?;
    let file = folder.join(TIMES);
    let mut times = times(&file)?;
    let mut frames: Vec<FrameFile> = Vec::with_capacity(pictures.len());
    for path in pictures {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let Some((line, t_s)) = times.remove(&name) else {
            return Err(Diagnostic::new(&file, None, format!("has no time for {name}")).hint(format!("{name},0.0")));
        };
        if let Some(last) = frames.last().filter(|last| !(t_s > last.t_s)) {
            let what =
                format!("{name} has the time {t_s} after {}, and pictures are in the order of their names", last.t_s);
            return Err(Diagnostic::new(&file, line, what).hint("names and times that rise together"));
        }
        frames.push(FrameFile { path, t_s });
    }
    let mut missing: Vec<_> = times.into_iter().map(|(name, (line, _))| (line, name)).collect();
    missing.sort();
    let warning = |(line, name): &(usize, String)| {
        Diagnostic::new(&file, *line, format!("names {name}, which is not in the folder"))
            .hint("the pictures that are there")
    };
    Ok((frames, missing.first().map(warning).into_iter().collect()))
}

/// All files of a kind in a folder, sorted.
fn files(folder: &Path, kind: FrameKind) -> Result<Vec<PathBuf>> {
    let unreadable =
        |e: std::io::Error| Diagnostic::new(folder, None, format!("cannot be read: {e}")).hint(kind.instead());
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if kind.endings().contains(&ending.as_str()) {
            found.push(path);
        }
    }
    if found.is_empty() {
        return Err(Diagnostic::new(folder, None, format!("has no {}", kind.name())).hint(kind.instead()));
    }
    found.sort();
    Ok(found)
}

/// Line number and time of each file.
fn times(file: &Path) -> Result<HashMap<String, (usize, f64)>> {
    let mut lines = CsvLines::open(file, csv::MAX_BYTES).map_err(|e| e.hint(HEADER))?;
    let Some((at, header)) = lines.next()? else {
        return Err(Diagnostic::new(file, 1, "is empty").hint(HEADER));
    };
    let columns: Vec<String> = csv::cells(header).map(str::to_owned).collect();
    let position = |name: &str| {
        let found = columns.iter().position(|column| column == name);
        found.ok_or_else(|| at.diagnostic(format!("has no column `{name}`")).hint(HEADER))
    };
    let (name_at, time_at) = (position("file")?, position("t_s")?);
    let mut times = HashMap::new();
    while let Some((at, text)) = lines.next()? {
        let cells: Vec<&str> = csv::cells(text).collect();
        if cells.len() != columns.len() {
            return Err(csv::wrong_length(text, &columns, at));
        }
        let t_s = csv::finite(cells[time_at], "t_s", at, "seconds, such as 0.04")?;
        if times.insert(cells[name_at].to_owned(), (at.line, t_s)).is_some() {
            return Err(at
                .diagnostic(format!("names {} for the second time", cells[name_at]))
                .hint("each picture once"));
        }
    }
    Ok(times)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(pictures: &[&str], times: Option<&str>) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        for name in pictures {
            std::fs::write(dir.path().join(name), "").unwrap();
        }
        if let Some(text) = times {
            std::fs::write(dir.path().join("times.csv"), text).unwrap();
        }
        dir
    }

    #[test]
    fn what_is_missing_is_said_with_the_line() {
        for (pictures, times, expected) in [
            (&[][..], Some("file,t_s\n"), "has no picture"),
            (&["a.png"][..], None, "times.csv"),
            (&["a.png"][..], Some(""), "file,t_s"),
            (&["a.png"][..], Some("name,t_s\na.png,0\n"), "no column `file`"),
            (&["a.png"][..], Some("file,t_s\n"), "no time for a.png"),
            (&["a.png"][..], Some("file,t_s\na.png,soon\n"), ":2:"),
            (&["a.png"][..], Some("file,t_s\na.png,0\na.png,1\n"), "second time"),
            (&["a.png", "b.png"][..], Some("file,t_s\na.png,1\nb.png,0\n"), "order of their names"),
            (&["a.png", "b.png"][..], Some("file,t_s\na.png,1\nb.png,1\n"), ":3:"),
        ] {
            let dir = folder(pictures, times);
            let message = read(dir.path(), FrameKind::Picture).unwrap_err().to_string();
            assert!(message.contains(expected), "{expected}: {message}");
        }
        let dir = folder(&["a.PNG", "note.txt"], Some("t_s,file\n0.5,a.PNG\n0.6,lost.png\n"));
        let (frames, warnings) = read(dir.path(), FrameKind::Picture).unwrap();
        assert_eq!((frames.len(), frames[0].t_s, warnings.len()), (1, 0.5, 1));
        assert!(read(dir.path(), FrameKind::Cloud).unwrap_err().to_string().contains("has no point cloud"));
    }
}
