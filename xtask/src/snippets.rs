//! Runs the commands that the documents promise.
//!
//! They are run with the command that the tests compiled: a `cargo` before cargo on the search path starts it for
//! `cargo run`, and `elbowroom` is it. A release build would compile the workspace once more.
//!
//! A ```` ```sh ```` block that follows the line `<!-- run -->` must end with exit status 0 when bash runs it in the
//! workspace root; `<!-- run: 1 -->` names another status.

use std::path::{Path, PathBuf};

use xtask::shell;

use crate::workspace::program;

/// One block to run.
#[derive(Debug, PartialEq)]
struct Snippet {
    line: usize,
    expected: i32,
    text: String,
}

/// Runs every marked block of `README.md`, `CONTRIBUTING.md` and `docs/**/*.md`.
pub fn run(root: &Path) -> Result<(), String> {
    let search_path = search_path(root)?;
    let mut ran = 0;
    for path in documents(root)? {
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let name = path.strip_prefix(root).unwrap_or(&path).display().to_string();
        for snippet in parse(&text).map_err(|e| format!("{name}:{e}"))? {
            println!("{name}:{}", snippet.line);
            let status =
                shell::status(root, "bash", &["-euo", "pipefail", "-c", &snippet.text], &[("PATH", &search_path)])?;
            if status != snippet.expected {
                let (line, expected) = (snippet.line, snippet.expected);
                return Err(format!("{name}:{line}: the commands ended with {status}, the document says {expected}"));
            }
            ran += 1;
        }
    }
    println!("snippets: {ran} blocks do what the documents say");
    Ok(())
}

/// The search path with the two programs that stand for the installed command.
fn search_path(root: &Path) -> Result<String, String> {
    let folder = shell::target_folder(root).join("snippets");
    shell::make_folder(&folder)?;
    let program = program(root, "elbowroom")?;
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let elbowroom = format!("#!/bin/sh\nexec '{}' \"$@\"\n", program.display());
    let stand_in = format!(
        "#!/bin/sh\ncase \"$1 $2 $3\" in\n    'run -qr --' | 'run --release --') shift 3; exec '{}' \"$@\" ;;\nesac\n\
         exec '{cargo}' \"$@\"\n",
        program.display()
    );
    for (name, text) in [("elbowroom", elbowroom), ("cargo", stand_in)] {
        let file = folder.join(name);
        std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))?;
        shell::run(root, "chmod", &["+x", &file.to_string_lossy()], &[])?;
    }
    let rest = std::env::var("PATH").unwrap_or_default();
    Ok(format!("{}:{rest}", folder.display()))
}

fn documents(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found: Vec<PathBuf> = ["README.md", "CONTRIBUTING.md"].iter().map(|name| root.join(name)).collect();
    found.retain(|path| path.is_file());
    let mut folders = vec![root.join("docs")];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        for entry in entries {
            let path = entry.map_err(|e| format!("{}: {e}", folder.display()))?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn parse(text: &str) -> Result<Vec<Snippet>, String> {
    let mut snippets = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((index, line)) = lines.next() {
        let Some(expected) = marker(line).map_err(|e| format!("{}: {e}", index + 1))? else { continue };
        if lines.next().is_none_or(|(_, next)| next.trim() != "```sh") {
            return Err(format!("{}: `<!-- run -->` must stand right above a ```sh block", index + 1));
        }
        let block: Vec<&str> = lines.by_ref().map(|(_, next)| next).take_while(|next| next.trim() != "```").collect();
        snippets.push(Snippet { line: index + 2, expected, text: block.join("\n") });
    }
    Ok(snippets)
}

/// The expected exit status, where the line is a marker.
fn marker(line: &str) -> Result<Option<i32>, String> {
    let Some(inner) = line.trim().strip_prefix("<!-- run").and_then(|rest| rest.strip_suffix("-->")) else {
        return Ok(None);
    };
    match inner.trim().strip_prefix(':') {
        None if inner.trim().is_empty() => Ok(Some(0)),
        Some(number) => number.trim().parse().map(Some).map_err(|_| format!("`{line}`: write `<!-- run: 1 -->`")),
        None => Err(format!("`{line}`: write `<!-- run -->` or `<!-- run: 1 -->`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_marked_blocks_are_taken() {
        let text =
            "# T\n```sh\nrm x\n```\n<!-- run -->\n```sh\ncargo a\ncargo b\n```\n<!-- run: 1 -->\n```sh\nc\n```\n";
        let found = parse(text).unwrap();
        assert_eq!(found.len(), 2);
        assert_eq!(found[0], Snippet { line: 6, expected: 0, text: "cargo a\ncargo b".into() });
        assert_eq!((found[1].expected, found[1].text.as_str()), (1, "c"));
    }

    #[test]
    fn a_marker_without_a_block_is_refused() {
        assert!(parse("<!-- run -->\n\n```sh\nx\n```").unwrap_err().starts_with("1:"));
        assert!(parse("<!-- run one -->\n```sh\nx\n```").is_err());
    }
}
