//! What the documents and the code are written in: no retired word, no line too long for a reader, no link that leads
//! nowhere, no name that nothing has.
//!
//! `docs/retired-terms.toml` lists the words that have a standard term in their place; `docs/glossary.md` defines the
//! terms.

mod lines;
mod links;
mod names;
mod retired;

use std::path::{Path, PathBuf};

/// Checks every source and document of the workspace and prints the result.
pub fn run(root: &Path) -> Result<(), String> {
    let terms = retired::read(&root.join(retired::LIST))?;
    let files = files(root)?;
    let mut known = names::KnownNames::default();
    let mut texts = Vec::new();
    for path in &files {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let name = path.strip_prefix(root).unwrap_or(path).display().to_string();
        known.add(&name, &text);
        texts.push((name, text));
    }
    let mut problems = Vec::new();
    for (name, text) in &texts {
        problems.extend(retired::problems(&terms, name, text));
        if is_document(name) {
            problems.extend(lines::problems(name, text));
            problems.extend(links::problems(root, name, text));
            problems.extend(known.problems(root, name, text));
        }
    }
    if problems.is_empty() {
        println!(
            "terms: {} retired words in none of {} files; no long line, no broken link, no unknown name",
            terms.len(),
            files.len()
        );
        return Ok(());
    }
    Err(format!("{} places\n  {}", problems.len(), problems.join("\n  ")))
}

/// Rust sources, documents, cell files, scripts, pages and pictures that the project wrote itself.
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
    found.retain(|path| !path.ends_with(retired::LIST));
    found.sort();
    Ok(found)
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), String> {
    const ENDINGS: [&str; 10] = ["rs", "md", "toml", "py", "cpp", "hpp", "js", "html", "css", "svg"];
    // Programs of others, as they were published.
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

fn is_document(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending == "md")
}
