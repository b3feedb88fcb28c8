//! The data set beside the repository, where it is present.

pub mod corpus;
pub mod waving;

use std::path::{Path, PathBuf};

/// `$ELBOWROOM_DATA`, or `../shared/data` beside the workspace; `None` and a message on standard error where it is missing.
pub fn data() -> Option<PathBuf> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data");
    let data = std::env::var_os("ELBOWROOM_DATA").map_or(default, PathBuf::from);
    if data.is_dir() {
        return Some(data);
    }
    eprintln!("skipped: no data at {}", data.display());
    None
}

/// All files below a directory, sorted.
pub fn files_below(directory: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut waiting = vec![directory.to_owned()];
    while let Some(directory) = waiting.pop() {
        for entry in std::fs::read_dir(&directory).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() { waiting.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    files
}
