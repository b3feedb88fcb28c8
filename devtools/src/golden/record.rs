//! File of hashes: sorted lines `part group hash count`.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use super::hashed_group::HashedGroup;
use super::part::Part;

/// The lines of a file.
#[derive(Debug, Default, PartialEq)]
pub struct Record(Vec<(String, HashedGroup)>);

impl Record {
    pub fn read(file: &Path) -> Result<Self, String> {
        let text = fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
        Self::parse(&text).map_err(|e| format!("{}: {e}", file.display()))
    }

    fn parse(text: &str) -> Result<Self, String> {
        let line = |(i, line): (usize, &str)| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let wrong = || format!("line {}: `{line}` is not `part group hash count`", i + 1);
            let &[part, name, hash, count] = &words[..] else { return Err(wrong()) };
            let count = count.parse().map_err(|_| wrong())?;
            Ok((part.to_owned(), HashedGroup { name: name.to_owned(), hash: hash.to_owned(), count }))
        };
        text.lines().enumerate().map(line).collect::<Result<_, _>>().map(Self)
    }

    /// Replaces the lines of one part and keeps all others: an interrupted run keeps the parts that it completed.
    pub fn add_to_file(file: &Path, part: Part, groups: &[HashedGroup]) -> Result<(), String> {
        let mut record = if file.exists() { Self::read(file)? } else { Self::default() };
        record.replace(part, groups);
        fs::write(file, record.text()).map_err(|e| format!("{}: {e}", file.display()))
    }

    fn replace(&mut self, part: Part, groups: &[HashedGroup]) {
        self.0.retain(|(of, _)| of != part.name());
        self.0.extend(groups.iter().map(|group| (part.name().to_owned(), group.clone())));
        self.0.sort();
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for (part, group) in &self.0 {
            let _ = writeln!(text, "{part} {group}");
        }
        text
    }

    /// Names each group of a part that differs from the record, or is only in one of the two.
    pub fn differences(&self, part: Part, groups: &[HashedGroup]) -> Vec<String> {
        let recorded: Vec<&HashedGroup> =
            self.0.iter().filter(|(of, _)| of == part.name()).map(|(_, group)| group).collect();
        let mut found = Vec::new();
        for group in groups {
            let HashedGroup { name, hash, count } = group;
            let why = match recorded.iter().find(|before| before.name == *name) {
                None => "is not in the record".to_owned(),
                Some(before) if before.count != *count => {
                    format!("recorded with {} answers, now {count}", before.count)
                }
                Some(before) if before.hash != *hash => format!("recorded {}, now {hash}", before.hash),
                Some(_) => continue,
            };
            found.push(format!("{} {name}: {why}", part.name()));
        }
        let is_missing = |before: &&&HashedGroup| !groups.iter().any(|group| group.name == before.name);
        let missing = recorded.iter().filter(is_missing);
        found.extend(missing.map(|before| format!("{} {}: is in the record alone", part.name(), before.name)));
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(name: &str, hash: &str, count: usize) -> HashedGroup {
        HashedGroup { name: name.into(), hash: hash.into(), count }
    }

    #[test]
    fn a_record_is_read_as_written_and_keeps_other_parts() {
        let mut record = Record::default();
        record.replace(Part::Queries, &[group("ur5e", "12", 3), group("panda", "ab", 3)]);
        record.replace(Part::Plans, &[group("box", "ff", 5)]);
        let text = "plans box ff 5\nqueries panda ab 3\nqueries ur5e 12 3\n";
        assert_eq!(record.text(), text);
        assert_eq!(Record::parse(text).unwrap(), record);
        record.replace(Part::Queries, &[group("ur5e", "34", 4)]);
        assert_eq!(record.text(), "plans box ff 5\nqueries ur5e 34 4\n");
        for text in ["queries ur5e 12", "queries ur5e 12 many", "\n"] {
            assert!(Record::parse(text).unwrap_err().starts_with("line 1: "), "{text}");
        }
    }

    #[test]
    fn what_differs_is_named() {
        let record = Record::parse("plans box ff 5\nqueries a 1 3\nqueries b 1 3\nqueries c 1 3\n").unwrap();
        assert_eq!(record.differences(Part::Plans, &[group("box", "ff", 5)]), Vec::<String>::new());
        let now = [group("a", "2", 3), group("b", "1", 4), group("d", "1", 3)];
        let expected = [
            "queries a: recorded 1, now 2",
            "queries b: recorded with 3 answers, now 4",
            "queries d: is not in the record",
            "queries c: is in the record alone",
        ];
        assert_eq!(record.differences(Part::Queries, &now), expected);
    }
}
