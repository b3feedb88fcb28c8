//! Generated files under `examples`, models and pictures: written, or compared with the committed files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::crate_pictures;
use crate::robots::{self, File};

const FOLDER: &str = "examples";

/// Writes every file.
pub fn write(root: &Path) -> Result<(), String> {
    for (name, bytes) in files(root)? {
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
    let files = files(root)?;
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

/// All files, by their names below `examples`.
fn files(root: &Path) -> Result<Vec<File>, String> {
    let below = |folder: &'static str| move |(name, bytes): File| (format!("{folder}/{name}"), bytes);
    let mut files: Vec<File> = models()?.into_iter().map(below("models")).collect();
    files.extend(crate_pictures::files(root)?.into_iter().map(below("crate")));
    files.sort();
    Ok(files)
}

fn models() -> Result<Vec<File>, String> {
    let mut files = robots::tools::files()?;
    files.extend(robots::work_pieces::files()?);
    for robot in robots::all() {
        files.extend(robot.files()?);
    }
    Ok(files)
}

/// Lists meshes and pictures in a generated folder that are no longer generated.
fn left_over(root: &Path, files: &[File]) -> Vec<String> {
    let paths: BTreeSet<PathBuf> = files.iter().map(|(name, _)| root.join(FOLDER).join(name)).collect();
    let folders: BTreeSet<&Path> = paths.iter().filter_map(|path| path.parent()).collect();
    let entries = folders.into_iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    let is_generated = |path: &PathBuf| path.extension().is_some_and(|e| e == "stl" || e == "png");
    entries
        .map(|entry| entry.path())
        .filter(is_generated)
        .filter(|path| !paths.contains(path))
        .map(|path| format!("{} is left over", path.display()))
        .collect()
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
        assert_eq!(models().unwrap(), models().unwrap());
    }

    #[test]
    fn meshes_are_neither_crude_nor_heavy() {
        for (name, bytes) in models().unwrap() {
            if name.contains("/meshes/") {
                let triangles = (bytes.len() - 84) / 50;
                assert!((300..=6000).contains(&triangles), "{name}: {triangles} triangles");
            }
        }
    }
}
