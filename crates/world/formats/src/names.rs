//! Unique names, and lists of names.

use std::collections::{HashMap, HashSet};

/// Makes names unique.
#[derive(Debug, Default)]
pub(crate) struct UniqueNames {
    taken: HashSet<String>,
    /// Next suffix of each name. Counting from 2 every time would take quadratic time.
    next: HashMap<String, usize>,
}

impl UniqueNames {
    /// The name, with the first numeric suffix that makes it unique, if necessary.
    pub(crate) fn unique(&mut self, name: &str) -> String {
        if self.taken.insert(name.to_owned()) {
            return name.to_owned();
        }
        let number = self.next.entry(name.to_owned()).or_insert(2);
        loop {
            let numbered = format!("{name}_{number}");
            *number += 1;
            if self.taken.insert(numbered.clone()) {
                return numbered;
            }
        }
    }
}

/// Largest number of listed names.
const MAX_LISTED: usize = 40;

/// The first names in backticks, and the number of further names.
pub(crate) fn list_names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.map(|n| format!("`{n}`")).collect();
    let more = names.len().saturating_sub(MAX_LISTED);
    let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{tail}", names[..names.len() - more].join(", "))
}

#[cfg(test)]
mod tests {
    use super::UniqueNames;

    #[test]
    fn repeated_names_are_numbered_past_existing_ones() {
        let mut names = UniqueNames::default();
        let given = ["a", "a_3", "a", "a", "a", "a_2", "b"].map(|n| names.unique(n));
        assert_eq!(given, ["a", "a_3", "a_2", "a_4", "a_5", "a_2_2", "b"]);
    }

    #[test]
    fn a_hundred_thousand_equal_names_are_numbered_quickly() {
        let mut names = UniqueNames::default();
        let start = std::time::Instant::now();
        let last = (0..100_000).map(|_| names.unique("link")).last();
        assert_eq!(last.as_deref(), Some("link_100000"));
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    }
}
