//! The same query on the same set, with all runners that offer it.

use super::runner::{Cell, Runner};

pub struct Group {
    pub set: String,
    pub query: String,
    pub entries: Vec<Entry>,
}

pub struct Entry {
    pub runner: usize,
    /// Its number in that runner.
    pub number: usize,
    pub cell: Cell,
    /// Whether it is timed; its answers may still be needed to check others.
    pub timed: bool,
}

impl Group {
    /// Index of elbowroom's entry; of the cold one, if there are two.
    pub fn ours(&self) -> Option<usize> {
        self.entries.iter().position(|entry| entry.cell.lib.starts_with("elbowroom"))
    }

    /// Index of the entry whose answers are the reference: Coal's exact query in f64, else FCL's, else parry's.
    pub fn reference(&self) -> Option<usize> {
        let plain = |lib: &str| !["+ub", "+bp", "+warm", "+contact"].iter().any(|way| lib.contains(way));
        let find = |name: &str| self.entries.iter().position(|e| e.cell.lib.starts_with(name) && plain(&e.cell.lib));
        ["coal-OBBRSS", "coal", "fcl-OBBRSS", "fcl", "parry-f64"].into_iter().find_map(find)
    }
}

/// Makes the groups in elbowroom's order; entries without `only` in `lib|set|query` are not timed.
pub fn of(runners: &[Runner], only: &str) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (runner, cells) in runners.iter().map(|runner| &runner.cells).enumerate() {
        for (number, cell) in cells.iter().enumerate() {
            let (set, query) = (cell.set.clone(), cell.query.clone());
            let wanted = format!("{}|{set}|{query}", cell.lib).contains(only);
            // Distances of random poses serve only to explain answers.
            let timed = wanted && !(set.ends_with("_random") && query == "distance");
            let entry = Entry { runner, number, cell: cell.clone(), timed };
            match groups.iter_mut().find(|group| group.set == set && group.query == query) {
                Some(group) => group.entries.push(entry),
                None => groups.push(Group { set, query, entries: vec![entry] }),
            }
        }
    }
    groups
}
