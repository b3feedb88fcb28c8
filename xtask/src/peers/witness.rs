//! Decision between two differing answers: by the distance, measured by elbowroom and by the reference.

use std::path::Path;

use super::agreement::same_distance;
use super::groups::{Entry, Group};
use super::runner::Runner;

/// Distance from the border between yes and no, relative to the size, within which both answers are right.
const BORDER: f64 = 1e-9;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Classification {
    /// The distance is at the border: both yes and no are right.
    Either,
    /// Both measure the same distance, off the border: it decides for this answer.
    Is(f64),
    /// The distances differ, or are missing.
    Open,
}

/// The two queries that measure the distance, for one yes-or-no query.
pub struct Witnesses<'a> {
    entries: [&'a Entry; 2],
    border: f64,
    runners: &'a mut [Runner],
    folder: &'a Path,
}

impl<'a> Witnesses<'a> {
    /// Finds the two; `None` for a distance query, or if one of the two is missing.
    pub fn of(group: &Group, all: &'a [Group], runners: &'a mut [Runner], folder: &'a Path) -> Option<Self> {
        if group.query == "distance" {
            return None;
        }
        let distances = all.iter().find(|other| other.set == group.set && other.query == "distance")?;
        let entries = [distances.ours()?, distances.reference()?].map(|k| &distances.entries[k]);
        let border = if group.query == "tolerance" { entries[0].cell.tolerance } else { 0.0 };
        Some(Self { entries, border, runners, folder })
    }

    /// Classifies a record by the distances; returns them also as text.
    pub fn classify(&mut self, record: usize) -> (Classification, String) {
        let Self { entries, border, runners, folder } = self;
        let [ours, theirs] = entries.map(|entry| {
            let answer = runners[entry.runner].answers(entry.number, record, 1, folder);
            answer.and_then(|answers| answers.first().copied()).unwrap_or(f64::NAN)
        });
        let distances = format!("distances {ours:e} m, {theirs:e} m: ");
        (classification(ours, theirs, *border, entries[0].cell.size), distances)
    }
}

fn classification(ours: f64, theirs: f64, border: f64, size: f64) -> Classification {
    // Without a tolerance every overlap, however deep, measures 0, which is then not a border.
    if border == 0.0 && ours <= 0.0 && theirs <= 0.0 {
        return Classification::Is(1.0);
    }
    let near = |d: f64| (d.max(0.0) - border).abs() <= BORDER * size && !d.is_nan();
    if near(ours) && near(theirs) {
        return Classification::Either;
    }
    if same_distance(ours, theirs, size) {
        return Classification::Is(f64::from(u8::from(theirs <= border)));
    }
    Classification::Open
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distances_decide_only_where_they_agree() {
        assert_eq!(classification(0.0, 5e-10, 0.0, 1.0), Classification::Either);
        assert_eq!(classification(0.0, -0.1, 0.0, 1.0), Classification::Is(1.0));
        assert_eq!(classification(6e-7, 6e-7, 0.0, 1.0), Classification::Is(0.0));
        assert_eq!(classification(0.04, 0.04, 0.05, 1.0), Classification::Is(1.0));
        assert_eq!(classification(0.0, 0.0, 0.05, 1.0), Classification::Is(1.0));
        assert_eq!(classification(0.0, 6e-7, 0.0, 1.0), Classification::Open);
        assert_eq!(classification(f64::NAN, 0.0, 0.0, 1.0), Classification::Open);
    }
}
