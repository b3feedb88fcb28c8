//! Check of the links of documents to files and headings of the workspace.

use std::path::Path;

/// Lists every link of this document to a file or heading that does not exist.
pub fn problems(root: &Path, name: &str, text: &str) -> Vec<String> {
    let folder = Path::new(name).parent().unwrap_or(Path::new(""));
    let mut found = Vec::new();
    for (line, target) in links(text) {
        if target.contains("://") || target.starts_with("mailto:") {
            continue;
        }
        let (file, heading) = target.split_once('#').map_or((target, None), |(file, heading)| (file, Some(heading)));
        let path = if file.is_empty() { root.join(name) } else { root.join(folder).join(file) };
        if !path.exists() {
            found.push(format!("{name}:{line}: no file for the link `{target}`"));
        } else if let Some(heading) = heading
            && file.rsplit('.').next().is_none_or(|ending| file.is_empty() || ending == "md")
            && !std::fs::read_to_string(&path).is_ok_and(|text| headings(&text).any(|known| known == heading))
        {
            found.push(format!("{name}:{line}: no heading for the link `{target}`"));
        }
    }
    found
}

/// Returns the targets of `[text](target)` with their lines; code is skipped.
fn links(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut in_code = false;
    for (i, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code {
            continue;
        }
        for (at, _) in line.match_indices("](") {
            let in_span = line[..at].matches('`').count() % 2 == 1;
            let target = line[at + 2..].split([')', ' ']).next().unwrap_or_default();
            if !in_span && !target.is_empty() {
                found.push((i + 1, target));
            }
        }
    }
    found
}

/// Returns the anchors of a document's headings, as the usual viewers make them.
fn headings(text: &str) -> impl Iterator<Item = String> {
    let lines = text.lines().filter(|line| line.starts_with('#'));
    lines.map(|line| {
        let title = line.trim_start_matches('#').trim().to_lowercase();
        title
            .chars()
            .filter(|c| c.is_alphanumeric() || "-_ ".contains(*c))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_in_code_do_not_count() {
        assert_eq!(links("[a](b.md)\n`[c](d)` [e](f#g)\n```\n[h](i)\n```"), [(1, "b.md"), (2, "f#g")]);
    }

    #[test]
    fn anchors_are_made_of_the_words_of_a_heading() {
        assert_eq!(headings("# One, two\ntext\n## `three` 4\n").collect::<Vec<_>>(), ["one-two", "three-4"]);
    }

    #[test]
    fn a_link_to_nothing_is_found() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let found = problems(root, "Cargo.toml", "[a](src/main.rs)\n[b](no.md) [c](https://example.org/x)");
        assert_eq!(found, ["Cargo.toml:2: no file for the link `no.md`"]);
    }
}
