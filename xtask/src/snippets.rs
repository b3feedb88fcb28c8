//! Runs the commands of the documents.
//!
//! They run with the command that the tests compiled: a program `cargo` earlier on the search path starts it for
//! `cargo run`, and `elbowroom` is it. A release build would compile the workspace once more.
//!
//! A ```` ```sh ```` block that follows the line `<!-- run -->` must end with exit status 0 when bash runs it in the
//! workspace root; `<!-- run: 1 -->` names another status. A block that is not run says why: `<!-- not run: it never
//! ends -->`. A ```` ```text ```` block that follows `<!-- shows: COMMAND -->` has the output of the command, or some
//! lines of it in their order; in lines with µs, times may differ.

use std::path::{Path, PathBuf};

use xtask::shell;

use crate::workspace::program;

/// One block to run.
#[derive(Debug, PartialEq)]
struct Snippet {
    line: usize,
    expected: i32,
    text: String,
    /// Lines that it must print.
    shows: Vec<String>,
}

/// Runs every marked block of `README.md`, `CONTRIBUTING.md` and `docs/**/*.md`. They may leave no file in the repository.
pub fn run(root: &Path) -> Result<(), String> {
    let search_path = search_path(root)?;
    let (mut ran, before) = (0, untracked(root));
    for path in documents(root)? {
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let name = path.strip_prefix(root).unwrap_or(&path).display().to_string();
        for snippet in parse(&text).map_err(|e| format!("{name}:{e}"))? {
            println!("{name}:{}", snippet.line);
            snippet.check(root, &search_path).map_err(|e| format!("{name}:{}: {e}", snippet.line))?;
            ran += 1;
        }
    }
    // A file that appears makes every test run again next time: tests may read any file of the repository.
    if let Some(left) = untracked(root).iter().find(|file| !before.contains(file)) {
        return Err(format!(
            "a command left `{left}` in the repository\n  write: its output below target/ or my-cell/"
        ));
    }
    println!("snippets: {ran} blocks do what the documents say");
    Ok(())
}

/// Files of the folder that git neither has nor ignores; none without git.
fn untracked(root: &Path) -> Vec<String> {
    let files = shell::output(root, "git", &["ls-files", "--others", "--exclude-standard"]);
    files.unwrap_or_default().lines().map(str::to_owned).collect()
}

impl Snippet {
    fn check(&self, root: &Path, search_path: &str) -> Result<(), String> {
        let words = ["-euo", "pipefail", "-c", &self.text];
        if !self.shows.is_empty() {
            let printed = shell::output_with(root, "bash", &words, &[("PATH", search_path)])?;
            return missing_line(&self.shows, &printed).map_or(Ok(()), |missing| {
                Err(format!("`{}` does not print, or not in this place:\n{missing}\nIt prints:\n{printed}", self.text))
            });
        }
        let status = shell::status(root, "bash", &words, &[("PATH", search_path)])?;
        if status == self.expected {
            return Ok(());
        }
        Err(format!("the commands ended with {status}, the document says {}", self.expected))
    }
}

/// Finds the first line of the document that is missing in the output of a command, in the same order.
fn missing_line<'a>(shown: &'a [String], printed: &str) -> Option<&'a String> {
    let mut printed = printed.lines();
    // `…` stands for omitted lines.
    let mut shown = shown.iter().filter(|line| line.trim() != "…");
    shown.find(|line| !printed.by_ref().any(|found| is_shown(line, found)))
}

/// Whether a printed line matches a line of the document. If the document shows times in µs, the times before a bracket
/// may differ, as may their units: a busy machine prints some of them in ms or s.
fn is_shown(shown: &str, printed: &str) -> bool {
    let (shown, printed) = (shown.trim_end(), printed.trim_end());
    let has_times = shown.split_whitespace().any(|word| word.trim_end_matches(',') == "µs");
    if has_times { without_times(shown) == without_times(printed) } else { shown == printed }
}

/// Returns the words of a line up to a bracket, without numbers and their units of time, and the rest unchanged.
fn without_times(line: &str) -> Vec<&str> {
    let (before, rest) = line.split_at(line.find('(').unwrap_or(line.len()));
    let mut words: Vec<&str> = Vec::new();
    for word in before.split_whitespace() {
        let is_unit = ["µs", "ms", "s"].contains(&word.trim_end_matches(','));
        if is_unit && words.last().is_some_and(|number| number.parse::<f64>().is_ok()) {
            words.pop();
        } else {
            words.push(word);
        }
    }
    words.push(rest);
    words
}

/// Returns the search path with the two programs that stand for the installed command.
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
        let shown = line.trim().strip_prefix("<!-- shows:").and_then(|rest| rest.strip_suffix("-->"));
        let status = marker(line).map_err(|e| format!("{}: {e}", index + 1))?;
        let (mark, fence) = match (shown, status) {
            (Some(_), _) => ("shows: …", "```text"),
            (None, Some(_)) => ("run", "```sh"),
            (None, None) if line.trim() == "```sh" => {
                let what =
                    "a block of commands that is not run: write `<!-- run -->` above it, or `<!-- not run: WHY -->`";
                return Err(format!("{}: {what}", index + 1));
            }
            (None, None) if is_reason(line) => {
                // The block itself.
                let _ = lines.by_ref().take_while(|(_, next)| next.trim() != "```").count();
                continue;
            }
            (None, None) => continue,
        };
        if lines.next().is_none_or(|(_, next)| next.trim() != fence) {
            return Err(format!("{}: `<!-- {mark} -->` must stand right above a {fence} block", index + 1));
        }
        let block: Vec<&str> = lines.by_ref().map(|(_, next)| next).take_while(|next| next.trim() != "```").collect();
        let (line, expected) = (index + 2, status.unwrap_or(0));
        snippets.push(match shown {
            Some(command) => {
                let shows = block.iter().map(|line| (*line).to_owned()).collect();
                Snippet { line, expected, text: command.trim().to_owned(), shows }
            }
            None => Snippet { line, expected, text: block.join("\n"), shows: Vec::new() },
        });
    }
    Ok(snippets)
}

/// Whether the line says why the following block is not run.
fn is_reason(line: &str) -> bool {
    let reason = line.trim().strip_prefix("<!-- not run:").and_then(|rest| rest.strip_suffix("-->"));
    reason.is_some_and(|reason| !reason.trim().is_empty())
}

/// Parses the expected exit status, if the line is a marker.
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
        let text = "# T\n<!-- not run: it never ends -->\n```sh\nrm x\n```\n<!-- run -->\n```sh\ncargo a\ncargo b\n```\n<!-- run: 1 -->\n```sh\nc\n```\n";
        let found = parse(text).unwrap();
        assert_eq!(found.len(), 2);
        assert_eq!(found[0], Snippet { line: 7, expected: 0, text: "cargo a\ncargo b".into(), shows: vec![] });
        assert_eq!((found[1].expected, found[1].text.as_str()), (1, "c"));
    }

    #[test]
    fn a_block_that_is_not_run_says_why() {
        for unmarked in
            ["```sh\nx\n```", "<!-- not run: -->\n```sh\nx\n```", "<!-- not run: why -->\n```sh\nx\n```\n```sh\ny\n```"]
        {
            assert!(parse(unmarked).unwrap_err().contains("write `<!-- run -->` above it"), "{unmarked}");
        }
        assert_eq!(parse("<!-- not run: why -->\n```sh\nx\n```\n```text\ny\n```"), Ok(vec![]));
    }

    #[test]
    fn a_marker_without_a_block_is_refused() {
        assert!(parse("<!-- run -->\n\n```sh\nx\n```").unwrap_err().starts_with("1:"));
        assert!(parse("<!-- run one -->\n```sh\nx\n```").is_err());
        assert!(parse("<!-- shows: ls -->\n```sh\nx\n```").is_err());
    }

    #[test]
    fn a_sample_of_output_is_what_the_command_prints_but_for_times() {
        let found = parse("<!-- shows: elbowroom x -->\n```text\na\ntick 3.6 µs, 1 of 2\n```\n").unwrap();
        assert_eq!((found[0].text.as_str(), found[0].shows.len()), ("elbowroom x", 2));
        let missing = |printed: &str| missing_line(&found[0].shows, printed).map(String::as_str);
        assert_eq!(missing("x\na  \ntick 12.25 µs, 1 of 2\n"), None);
        let line = "tick  median 3 µs, p99 6.2 µs, max 19 µs (of 2 ms)";
        assert!(is_shown(line, "tick  median 1.2 ms, p99 2 ms, max 0.1 s (of 2 ms)"));
        assert!(!is_shown(line, "tick  median 3 µs, p99 6.2 µs, max 19 µs (of 4 ms)"));
        assert!(!is_shown(line, "tick  median 3 µs, p99 6.2 µs (of 2 ms)"));
        assert!(!is_shown("moved after 60 ms", "moved after 50 ms"));
        assert_eq!(missing("tick 3.6 µs, 1 of 2\na\n"), Some("tick 3.6 µs, 1 of 2"));
        assert_eq!(missing("a\ntick 3.6 µs, 1 of 3\n"), Some("tick 3.6 µs, 1 of 2"));
    }
}
