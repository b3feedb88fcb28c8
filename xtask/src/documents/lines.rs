//! Check of the lengths of lines: longer lines are hard to read in a terminal or in a diff.

/// Length of the longest line, characters.
const LONGEST: usize = 200;

/// Lists every line that is too long.
pub fn problems(name: &str, text: &str) -> Vec<String> {
    let long = text.lines().map(|line| line.chars().count()).enumerate().filter(|(_, length)| *length > LONGEST);
    long.map(|(i, length)| format!("{name}:{}: {length} characters, at most {LONGEST}", i + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_count_not_bytes() {
        let fits = "é".repeat(200);
        assert!(problems("a.md", &fits).is_empty());
        assert_eq!(problems("a.md", &format!("one\n{fits}x")), ["a.md:2: 201 characters, at most 200"]);
    }
}
