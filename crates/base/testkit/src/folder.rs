//! Folders that tests read: the workspace, its examples, and the robots, meshes and recordings outside the
//! workspace.

use std::path::{Path, PathBuf};

/// The root of the workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(3).map(Path::to_owned).unwrap_or_default()
}

/// The examples of the workspace.
pub fn examples() -> PathBuf {
    workspace().join("examples")
}

/// The URDF of an example robot, such as `kr125`.
pub fn model(name: &str) -> PathBuf {
    examples().join("models").join(name).join(name).with_extension("urdf")
}

/// The data on real robots: `$ELBOWROOM_DATA`, or `../shared/data` beside the workspace. If that folder is missing,
/// prints one line on standard error and returns `None`; then the test proves nothing.
pub fn data() -> Option<PathBuf> {
    found(data_place())
}

/// A folder of the data, such as `urdf`; like [`data`], prints a line and returns `None` if it is missing.
pub fn data_part(part: &str) -> Option<PathBuf> {
    found(data_place().join(part))
}

/// The robots in folders of the data, such as `urdf` and `cell`: every `NAME/NAME.urdf`, in the order of the names.
/// Like [`data`], prints a line if a folder is missing.
pub fn robots(parts: &[&str]) -> Vec<PathBuf> {
    let urdf = |folder: PathBuf| {
        let file = folder.join(folder.file_name()?).with_added_extension("urdf");
        file.is_file().then_some(file)
    };
    let mut robots: Vec<PathBuf> =
        parts.iter().filter_map(|part| data_part(part)).flat_map(|part| entries(&part)).filter_map(urdf).collect();
    robots.sort_by(|a, b| a.file_stem().cmp(&b.file_stem()));
    robots
}

/// All files below a folder, sorted; empty if the folder does not exist.
pub fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut waiting = vec![folder.to_owned()];
    while let Some(folder) = waiting.pop() {
        for path in entries(&folder) {
            if path.is_dir() { waiting.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    files
}

fn data_place() -> PathBuf {
    std::env::var_os("ELBOWROOM_DATA").map_or_else(|| workspace().join("../shared/data"), PathBuf::from)
}

fn found(folder: PathBuf) -> Option<PathBuf> {
    if folder.is_dir() {
        return Some(folder.canonicalize().unwrap_or(folder));
    }
    eprintln!("skipped: no data at {}", folder.display());
    None
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_workspace_is_found_from_this_crate() {
        assert!(workspace().join("Cargo.lock").is_file());
        assert!(model("kr125").is_file());
    }

    #[test]
    fn files_of_all_folders_below_are_found() {
        let files = files_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
        assert!(files.is_sorted() && files.iter().any(|f| f.ends_with("src/folder.rs")));
        assert!(files_below(Path::new("no such folder")).is_empty());
        assert!(files_below(&workspace().join("crates/base")).iter().any(|f| f.ends_with("testkit/src/lib.rs")));
    }

    #[test]
    fn robots_of_the_data_have_one_file_each() {
        let robots = robots(&["urdf", "cell"]);
        assert!(robots.is_empty() || robots.len() > 30, "only {}", robots.len());
        assert!(robots.iter().all(|file| file.file_stem() == file.parent().unwrap().file_name()));
    }
}
