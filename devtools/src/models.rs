//! Generated models under `examples/models`: written, or compared with the committed files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::robots::{self, File};

const FOLDER: &str = "examples/models";

/// Writes every file.
pub fn write(root: &Path) -> Result<(), String> {
    for (name, bytes) in files()? {
        let path = root.join(FOLDER).join(&name);
        let folder = path.parent().unwrap_or(root);
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        std::fs::write(&path, &bytes).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("{FOLDER}/{name}: {}", size(&name, bytes.len()));
    }
    Ok(())
}

/// Compares with the existing files; a missing, differing or superfluous file is an error.
pub fn check(root: &Path) -> Result<(), String> {
    let files = files()?;
    let mut wrong = Vec::new();
    for (name, bytes) in &files {
        match std::fs::read(root.join(FOLDER).join(name)) {
            Ok(there) if there == *bytes => {}
            Ok(_) => wrong.push(format!("{FOLDER}/{name} differs")),
            Err(e) => wrong.push(format!("{FOLDER}/{name}: {e}")),
        }
    }
    wrong.extend(left_over(root, &files));
    if wrong.is_empty() {
        println!("models: {} files are what the generator writes", files.len());
        return Ok(());
    }
    Err(format!(
        "the committed models are not what the generator writes; run `cargo xtask models`\n  {}",
        wrong.join("\n  ")
    ))
}

fn files() -> Result<Vec<File>, String> {
    let mut files = robots::tools::files()?;
    files.extend(robots::work_pieces::files()?);
    for robot in robots::all() {
        files.extend(robot.files()?);
    }
    files.sort();
    Ok(files)
}

/// Lists meshes in a generated folder that are no longer generated.
fn left_over(root: &Path, files: &[File]) -> Vec<String> {
    let paths: BTreeSet<PathBuf> = files.iter().map(|(name, _)| root.join(FOLDER).join(name)).collect();
    let folders: BTreeSet<&Path> = paths.iter().filter_map(|path| path.parent()).collect();
    let entries = folders.into_iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    let stl = entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "stl"));
    stl.filter(|path| !paths.contains(path)).map(|path| format!("{} is left over", path.display())).collect()
}

fn size(name: &str, bytes: usize) -> String {
    let is_mesh = Path::new(name).extension().is_some_and(|extension| extension == "stl");
    // A binary STL has a head of 84 bytes, then 50 bytes per triangle.
    if is_mesh { format!("{} triangles", (bytes - 84) / 50) } else { format!("{bytes} bytes") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generation_is_deterministic() {
        assert_eq!(files().unwrap(), files().unwrap());
    }

    #[test]
    fn meshes_are_neither_crude_nor_heavy() {
        for (name, bytes) in files().unwrap() {
            if name.contains("/meshes/") {
                let triangles = (bytes.len() - 84) / 50;
                assert!((300..=6000).contains(&triangles), "{name}: {triangles} triangles");
            }
        }
    }
}
