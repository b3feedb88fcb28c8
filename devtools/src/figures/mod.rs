//! Figures of the documents: written, or compared with the committed files. Their curves are the laws' own functions.

mod curves;
mod forces;
mod plots;
mod rail;
pub mod svg;

use std::path::Path;

const FOLDER: &str = "docs/figures";

/// Name in the folder and text.
type Figure = (String, String);

/// Writes every figure.
pub fn write(root: &Path) -> Result<(), String> {
    let folder = root.join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|e| format!("{FOLDER}: {e}"))?;
    for (name, text) in files()? {
        std::fs::write(folder.join(&name), &text).map_err(|e| format!("{FOLDER}/{name}: {e}"))?;
        println!("{FOLDER}/{name}: {} bytes", text.len());
    }
    Ok(())
}

/// Compares with the existing files; a missing, differing or superfluous figure is an error.
pub fn check(root: &Path) -> Result<(), String> {
    let files = files()?;
    let folder = root.join(FOLDER);
    let mut wrong: Vec<String> = files.iter().filter_map(|figure| difference(&folder, figure)).collect();
    wrong.extend(left_over(&folder, &files));
    if wrong.is_empty() {
        println!("figures: {} files are what the laws give", files.len());
        return Ok(());
    }
    let list = wrong.join("\n  ");
    Err(format!("the committed figures are not what the laws give; run `cargo xtask figures`\n  {list}"))
}

fn files() -> Result<Vec<Figure>, String> {
    Ok(plots::all()?.into_iter().map(|(name, plot)| (format!("{name}.svg"), plot.svg())).collect())
}

fn difference(folder: &Path, (name, text): &Figure) -> Option<String> {
    match std::fs::read_to_string(folder.join(name)) {
        Ok(there) if there == *text => None,
        Ok(_) => Some(format!("{FOLDER}/{name} differs")),
        Err(e) => Some(format!("{FOLDER}/{name}: {e}")),
    }
}

fn left_over(folder: &Path, files: &[Figure]) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| !files.iter().any(|(known, _)| known == name));
    names.sort();
    names.into_iter().map(|name| format!("{FOLDER}/{name} is left over")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fresh_folder(name: &str) -> std::path::PathBuf {
        let root = std::env::temp_dir().join(format!("elbowroom-figures-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&root);
        root
    }

    #[test]
    fn generation_is_deterministic() {
        assert_eq!(files().unwrap(), files().unwrap());
    }

    #[test]
    fn a_changed_a_missing_and_a_left_over_figure_are_found() {
        let root = fresh_folder("check");
        assert!(check(&root).is_err());
        write(&root).unwrap();
        check(&root).unwrap();
        let (first, second) = (files().unwrap()[0].0.clone(), files().unwrap()[1].0.clone());
        let folder = root.join(FOLDER);
        std::fs::write(folder.join(&first), "other").unwrap();
        std::fs::remove_file(folder.join(&second)).unwrap();
        std::fs::write(folder.join("old.svg"), "").unwrap();
        let problems = check(&root).unwrap_err();
        for expected in [format!("{first} differs"), second, "old.svg is left over".into()] {
            assert!(problems.contains(&expected), "{problems}");
        }
        std::fs::remove_dir_all(&root).unwrap();
    }

    #[test]
    fn every_number_in_a_figure_is_finite_and_every_curve_has_a_length() {
        for (name, plot) in plots::all().unwrap() {
            for curve in &plot.curves {
                assert!(curve.points.len() > 1, "{name}: {}", curve.label);
                assert!(curve.points.iter().all(|(x, y)| x.is_finite() && y.is_finite()), "{name}: {}", curve.label);
            }
        }
    }

    #[test]
    fn the_documents_show_every_figure() {
        let root = crate::workspace_root().unwrap();
        let text = ["docs/laws.md", "docs/fixtures.md"].map(|file| std::fs::read_to_string(root.join(file)).unwrap());
        for (name, _) in files().unwrap() {
            assert!(text.iter().any(|t| t.contains(&format!("figures/{name}"))), "no document shows {name}");
        }
    }
}
