//! Checks of the documents: lengths of lines, links, and names that must exist in the sources.

mod lines;
mod links;
mod names;

use std::path::{Path, PathBuf};

/// Checks every document of the workspace and prints the result.
pub fn run(root: &Path) -> Result<(), String> {
    let mut known = names::KnownNames::default();
    let mut documents = Vec::new();
    for path in files(root)? {
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let name = path.strip_prefix(root).unwrap_or(&path).display().to_string();
        known.add(&name, &text);
        if path.extension().is_some_and(|ending| ending == "md") {
            documents.push((name, text));
        }
    }
    let mut problems = Vec::new();
    for (name, text) in &documents {
        problems.extend(lines::problems(name, text));
        problems.extend(links::problems(root, name, text));
        problems.extend(known.problems(root, name, text));
    }
    if problems.is_empty() {
        println!("documents: no long line, no broken link, no unknown name in {} documents", documents.len());
        return Ok(());
    }
    Err(format!("{} places\n  {}", problems.len(), problems.join("\n  ")))
}

/// Finds Rust sources, documents, cell files, scripts, pages and pictures of the project itself.
fn files(root: &Path) -> Result<Vec<PathBuf>, String> {
    const FOLDERS: [&str; 5] = ["crates", "devtools", "docs", "examples", "xtask"];
    let mut found: Vec<PathBuf> = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "Cargo.toml"]
        .iter()
        .map(|name| root.join(name))
        .filter(|path| path.is_file())
        .collect();
    for folder in FOLDERS {
        collect(&root.join(folder), &mut found)?;
    }
    found.sort();
    Ok(found)
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), String> {
    const ENDINGS: [&str; 10] = ["rs", "md", "toml", "py", "cpp", "hpp", "js", "html", "css", "svg"];
    // Programs of other projects, unchanged.
    const FOREIGN: [&str; 3] = ["plotly", "three", "target"];
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
    for entry in entries {
        let path = entry.map_err(|e| format!("{}: {e}", folder.display()))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            if !FOREIGN.contains(&name.as_str()) {
                collect(&path, found)?;
            }
        } else if path.extension().is_some_and(|e| ENDINGS.iter().any(|known| e == *known)) {
            found.push(path);
        }
    }
    Ok(())
}
