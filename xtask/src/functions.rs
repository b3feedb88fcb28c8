//! Lengths of the functions of a source.

/// One function of a formatted source.
#[derive(Debug, PartialEq, Eq)]
pub struct Function<'t> {
    /// Its name.
    pub name: &'t str,
    /// The line of its `fn`, from 1.
    pub line: usize,
    /// Number of its lines, the closing brace included.
    pub lines: usize,
}

/// Finds every function of a formatted source: from its `fn` to the brace that closes at the same depth.
pub fn functions(text: &str) -> Vec<Function<'_>> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (start, line) in lines.iter().enumerate() {
        let Some(name) = function_name(line) else { continue };
        let depth = line.len() - line.trim_start().len();
        let rest = lines[start..].iter();
        let end =
            rest.clone().position(|l| l.len() > depth && l[..depth].trim().is_empty() && l[depth..].starts_with('}'));
        let one_line = line.trim_end().ends_with(['}', ';']);
        let lines = if one_line { 1 } else { end.map_or(1, |lines| lines + 1) };
        found.push(Function { name, line: start + 1, lines });
    }
    found
}

fn function_name(line: &str) -> Option<&str> {
    const BEFORE: [&str; 6] = ["pub", "pub(crate)", "pub(super)", "const", "async", "unsafe"];
    let mut words = line.split_whitespace().skip_while(|word| BEFORE.contains(word));
    let name = words.next().filter(|word| *word == "fn").and_then(|_| words.next())?;
    name.split(|c: char| !c.is_alphanumeric() && c != '_').next().filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_measured_to_their_brace() {
        let text = "fn a() {\n    b();\n}\n\nimpl X {\n    pub fn c() {}\n    pub(crate) async fn d(\n        e: u8,\n    ) -> u8 {\n        e\n    }\n}\n";
        let found: Vec<_> = functions(text).iter().map(|f| (f.name, f.line, f.lines)).collect();
        assert_eq!(found, [("a", 1, 3), ("c", 6, 1), ("d", 7, 5)]);
    }
}
