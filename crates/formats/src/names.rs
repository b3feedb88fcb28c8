//! Names that nothing else bears.

use std::collections::{HashMap, HashSet};

/// Gives out names, each only once.
#[derive(Debug, Default)]
pub(crate) struct Names {
    taken: HashSet<String>,
    /// The number that is tried next behind a name: counting from 2 again each time would take quadratic time.
    next: HashMap<String, usize>,
}

impl Names {
    /// The name itself, or with the first number behind it that makes it new.
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

#[cfg(test)]
mod tests {
    use super::Names;

    #[test]
    fn names_that_repeat_are_numbered_past_those_that_are_there() {
        let mut names = Names::default();
        let given = ["a", "a_3", "a", "a", "a", "a_2", "b"].map(|n| names.unique(n));
        assert_eq!(given, ["a", "a_3", "a_2", "a_4", "a_5", "a_2_2", "b"]);
    }

    #[test]
    fn a_hundred_thousand_of_one_name_are_no_trouble() {
        let mut names = Names::default();
        let start = std::time::Instant::now();
        let last = (0..100_000).map(|_| names.unique("link")).last();
        assert_eq!(last.as_deref(), Some("link_100000"));
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    }
}
