//! Generated parts of a document: each is between `<!-- generated: TITLE -->` and `<!-- end -->`.

/// Title and text of a part.
pub type Part = (&'static str, String);

const END: &str = "<!-- end -->";

/// The document with these parts in their places.
///
/// # Errors
/// A part has no place, or a place no part or no end.
pub fn filled(document: &str, parts: &[Part]) -> Result<String, String> {
    let mut filled = String::new();
    let mut found = Vec::new();
    let mut lines = document.lines();
    while let Some(line) = lines.next() {
        filled.extend([line, "\n"]);
        let Some(title) = line.strip_prefix("<!-- generated: ").and_then(|rest| rest.strip_suffix(" -->")) else {
            continue;
        };
        let part = parts.iter().find(|(known, _)| *known == title);
        let (_, text) = part.ok_or_else(|| format!("nothing is generated with the title `{title}`"))?;
        if !lines.by_ref().any(|line| line == END) {
            return Err(format!("`{title}` has no line `{END}`"));
        }
        filled.extend(["\n", text.trim_end(), "\n\n", END, "\n"]);
        found.push(title);
    }
    match parts.iter().find(|(title, _)| !found.contains(title)) {
        Some((title, _)) => Err(format!("needs the lines `<!-- generated: {title} -->` and `{END}`")),
        None => Ok(filled),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_replace_what_is_between_their_lines() {
        let parts = [("a", "1\n".to_owned()), ("b", "2".to_owned())];
        let document = "x\n<!-- generated: b -->\nold\n<!-- end -->\ny\n<!-- generated: a -->\n<!-- end -->\n";
        let expected = "x\n<!-- generated: b -->\n\n2\n\n<!-- end -->\ny\n<!-- generated: a -->\n\n1\n\n<!-- end -->\n";
        assert_eq!(filled(document, &parts).unwrap(), expected);
        assert_eq!(filled(expected, &parts).unwrap(), expected);
    }

    #[test]
    fn a_part_without_a_place_and_a_place_without_a_part_are_found() {
        let part = [("a", String::new())];
        assert!(filled("x\n", &part).unwrap_err().contains("needs the lines `<!-- generated: a -->`"));
        assert!(filled("<!-- generated: c -->\n<!-- end -->\n", &part).unwrap_err().contains("`c`"));
        assert!(filled("<!-- generated: a -->\nx\n", &part).unwrap_err().contains("no line `<!-- end -->`"));
    }
}
