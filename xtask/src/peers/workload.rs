//! Workload of meshes and poses: given, or generated.

use std::path::{Path, PathBuf};

use crate::{artifacts, native};

/// Paths of the workload's files.
pub struct Workload {
    /// Meshes, poses and tolerances in the shared format.
    pub data: PathBuf,
    /// Paths and random poses that were generated for them.
    pub extra: PathBuf,
    /// elbowroom's runner, which has generated them.
    pub elbowroom: PathBuf,
}

/// Builds elbowroom's runner; generates the workload if none is given, and the extra files for any workload.
pub fn prepare(root: &Path, folder: &Path, given: Option<&Path>) -> Result<Workload, String> {
    let elbowroom = artifacts::bench(root, "elbowroom-proximity", "peers")?;
    let data = match given {
        Some(given) => readable(given)?,
        None => own(root, &elbowroom, &folder.join("data"))?,
    };
    let extra = folder.join("extra");
    // Files of an earlier workload must not be mistaken for files of this one.
    let _ = std::fs::remove_dir_all(&extra);
    xtask::shell::make_folder(&extra)?;
    ours(root, &elbowroom, "extend", &[&data, &extra])?;
    Ok(Workload { data, extra, elbowroom })
}

fn readable(given: &Path) -> Result<PathBuf, String> {
    let data = given.canonicalize().map_err(|e| format!("--data {}: {e}", given.display()))?;
    let any = ["m4k.meta", "m23k.meta", "robot_link0.stl"].iter().any(|name| data.join(name).is_file());
    let missing = "none of m4k.meta, m23k.meta, robot_link0.stl is there; xtask/peers/README.md has the format";
    if any { Ok(data) } else { Err(format!("--data {}: {missing}", data.display())) }
}

/// Generates the workload once; the last file written marks it as complete.
fn own(root: &Path, elbowroom: &Path, data: &Path) -> Result<PathBuf, String> {
    let done = data.join("complete");
    if !done.is_file() {
        eprintln!("making the workload in {}", data.display());
        xtask::shell::make_folder(data)?;
        ours(root, elbowroom, "generate", &[data])?;
        std::fs::write(&done, "").map_err(|e| format!("{}: {e}", done.display()))?;
    }
    Ok(data.to_owned())
}

fn ours(root: &Path, elbowroom: &Path, verb: &str, folders: &[&Path]) -> Result<(), String> {
    let mut words = vec![elbowroom.display().to_string(), verb.to_owned()];
    words.extend(folders.iter().map(|folder| folder.display().to_string()));
    native::run(root, &words.iter().map(String::as_str).collect::<Vec<_>>(), &[])
}
