//! Files that the ratchet reads.

use std::path::Path;

use xtask::crates;

/// One file of the workspace.
#[derive(Debug, Default)]
pub struct SourceFile {
    /// Its path below the root of the workspace.
    pub path: String,
    /// Its text.
    pub text: String,
    /// Whether it is measured: a source of a crate that is not a test.
    pub is_measured: bool,
}

/// Reads Rust sources of all crates with their tests, examples and benches; documents; programs in other languages.
pub fn read(root: &Path) -> Result<Vec<SourceFile>, String> {
    let mut packages: Vec<_> = crates::find(root)?.into_iter().map(|found| found.folder).collect();
    packages.extend(["devtools", "xtask"].map(|name| root.join(name)));
    let mut found = Vec::new();
    for package in packages {
        for folder in ["src", "tests", "examples", "benches"] {
            collect(root, &package.join(folder), folder == "src", &mut found)?;
        }
    }
    for folder in ["docs", "clients", "examples"] {
        collect(root, &root.join(folder), false, &mut found)?;
    }
    add(root, &root.join("README.md"), false, &mut found)?;
    Ok(found)
}

fn collect(root: &Path, folder: &Path, is_source: bool, found: &mut Vec<SourceFile>) -> Result<(), String> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
    let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let is_source = is_source && stem != "tests" && !stem.ends_with("_tests");
        if path.is_dir() {
            collect(root, &path, is_source, found)?;
        } else if path.extension().is_some_and(|ending| ["rs", "md", "py", "c"].iter().any(|known| ending == *known)) {
            add(root, &path, is_source && path.extension().is_some_and(|ending| ending == "rs"), found)?;
        }
    }
    Ok(())
}

fn add(root: &Path, path: &Path, is_measured: bool, found: &mut Vec<SourceFile>) -> Result<(), String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let path = path.strip_prefix(root).unwrap_or(path).display().to_string().replace('\\', "/");
    found.push(SourceFile { path, text, is_measured });
    Ok(())
}
