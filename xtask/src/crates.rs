//! Crates of the workspace and their groups: each has a folder `crates/GROUP/CRATE`.

use std::path::{Path, PathBuf};

use toml::Table;

/// Lowest layer first: a crate depends only on crates listed before it. Some are planned and not built yet.
pub const GROUPS: [(&str, &[&str]); 7] = [
    ("base", &["testkit", "spatial", "proximity", "kinematics", "robot"]),
    ("world", &["diagnostic", "scene", "formats", "validity", "inspect"]),
    ("guard", &["interlock", "monitor"]),
    ("motion", &["cspace", "planner", "avoidance", "shared_control", "vision", "cooperation", "perception"]),
    ("cell", &["access", "cell", "query", "sim", "report"]),
    ("connect", &["status", "ros2", "recording", "view", "live"]),
    ("front", &["elbowroom", "capi", "cli", "python"]),
];

/// One crate of the workspace.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crate {
    /// Name of the folder above it.
    pub group: String,
    /// Name of its folder; its package is `elbowroom-` and this name.
    pub name: String,
    /// Its folder.
    pub folder: PathBuf,
}

impl Crate {
    /// Name of the package.
    #[must_use]
    pub fn package(&self) -> String {
        package(&self.name)
    }
}

/// Name of the package of the crate with this name.
#[must_use]
pub fn package(name: &str) -> String {
    if name == "elbowroom" { name.to_owned() } else { format!("elbowroom-{name}") }
}

/// Reads a `Cargo.toml`.
///
/// # Errors
/// If the file cannot be read or parsed; the message names it.
pub fn manifest(path: &Path) -> Result<Table, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    text.parse().map_err(|e| format!("{}: {e}", path.display()))
}

/// Finds every crate below `crates`, sorted by group and name.
///
/// # Errors
/// If a folder cannot be read.
pub fn find(root: &Path) -> Result<Vec<Crate>, String> {
    let mut found = Vec::new();
    for group in folders(&root.join("crates"))? {
        for folder in folders(&group)? {
            if folder.join("Cargo.toml").is_file() {
                found.push(Crate { group: name_of(&group), name: name_of(&folder), folder });
            }
        }
    }
    Ok(found)
}

fn name_of(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn folders(parent: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = std::fs::read_dir(parent).map_err(|e| format!("{}: {e}", parent.display()))?;
    let mut found: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    found.sort();
    Ok(found)
}
