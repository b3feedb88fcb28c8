//! Comparison of answers: the distance must explain each difference.

use std::path::Path;

use super::agreement::same_distance;
use super::groups::{Entry, Group};
use super::measure::{Time, budget_ns};
use super::report::Line;
use super::runner::Runner;
use super::witness::{Classification, Witnesses};

/// Number of differences per line up to which each is explained; more are only counted.
const EXAMINED: usize = 50;

/// A group's lines, and notes on differences.
#[derive(Default)]
pub struct Checked {
    pub lines: Vec<Line>,
    pub notes: Vec<String>,
}

/// Collects times, and the comparison of the answers.
pub fn check(group: &Group, all: &[Group], times: &[Option<Time>], runners: &mut [Runner], folder: &Path) -> Checked {
    let mut checked = Checked::default();
    if group.entries.iter().all(|entry| !entry.timed) {
        return checked;
    }
    let reference = group.reference();
    let mut given = Vec::new();
    for (k, (entry, time)) in group.entries.iter().zip(times).enumerate() {
        let count = wanted(entry, *time, reference == Some(k));
        given.push(runners[entry.runner].answers(entry.number, 0, count, folder).unwrap_or_default());
    }
    let mut witnesses = Witnesses::of(group, all, runners, folder);
    let truth = reference.map(|reference| settle(group, &given, reference, &mut witnesses, &mut checked.notes));
    for (k, (entry, time)) in group.entries.iter().zip(times).enumerate() {
        let Some(time) = time else { continue };
        let (mut compared, mut disagreements) = (0, 0);
        if let Some(truth) = &truth {
            // The reference counts the answers that elbowroom was compared on.
            let other = if Some(k) == reference { group.ours().unwrap_or(k) } else { k };
            compared = given[other].len().min(truth.len());
            let differing = differing(group, &given[k], truth);
            disagreements = differing.len();
            if !entry.cell.lib.starts_with("elbowroom") {
                let border =
                    |i: &&usize| witnesses.as_mut().is_some_and(|w| w.classify(**i).0 == Classification::Either);
                disagreements -= differing.iter().take(EXAMINED).filter(border).count();
            }
        }
        checked.lines.push(Line {
            lib: entry.cell.lib.clone(),
            set: group.set.clone(),
            query: group.query.clone(),
            mean_ns: time.mean_ns,
            n: time.records,
            answers_checked: compared,
            disagreements,
            compared_with_coal: reference.is_some_and(|r| group.entries[r].cell.lib.starts_with("coal")),
        });
    }
    checked
}

/// Returns the true answers: those of the reference; if elbowroom's answer differs and the distances of both decide it,
/// the decided answer; `None` if both answers are right.
fn settle(
    group: &Group,
    given: &[Vec<f64>],
    reference: usize,
    witnesses: &mut Option<Witnesses>,
    notes: &mut Vec<String>,
) -> Vec<Option<f64>> {
    let mut truth: Vec<Option<f64>> = given[reference].iter().copied().map(Some).collect();
    let Some(ours) = group.ours() else { return truth };
    for (n, i) in differing(group, &given[ours], &truth).into_iter().enumerate() {
        let (mut classification, mut explanation) = (Classification::Open, String::new());
        if let Some(witnesses) = witnesses.as_mut().filter(|_| n < EXAMINED) {
            (classification, explanation) = witnesses.classify(i);
        }
        let conclusion = match classification {
            Classification::Either => "at the border, both are right".to_owned(),
            Classification::Is(answer) if answer == given[ours][i] => {
                format!("{} contradicts its own distance", group.entries[reference].cell.lib)
            }
            Classification::Is(_) => "elbowroom contradicts its own distance".to_owned(),
            Classification::Open => "unexplained".to_owned(),
        };
        let [mine, its] = [ours, reference].map(|k| format!("{} {:?}", group.entries[k].cell.lib, given[k][i]));
        notes.push(format!("{} {} record {i}: {mine}, {its};\n  {explanation}{conclusion}.", group.set, group.query));
        match classification {
            Classification::Either => truth[i] = None,
            Classification::Is(answer) => truth[i] = Some(answer),
            Classification::Open => {}
        }
    }
    truth
}

/// Number of answers to compare: all yes-or-no answers of elbowroom and of the reference; of others as many as the time
/// allows.
fn wanted(entry: &Entry, time: Option<Time>, is_reference: bool) -> usize {
    let all = entry.cell.records;
    let ours = entry.cell.lib.starts_with("elbowroom");
    if entry.cell.query != "distance" && (ours || is_reference) {
        return all;
    }
    if !entry.timed && !is_reference {
        return 0;
    }
    let affordable = time.map_or(0, |t| (3.0 * budget_ns() / t.mean_ns) as usize);
    affordable.max(if ours || is_reference { 500 } else { 12 }).min(all)
}

/// Returns the records whose answers differ from the truth; a NaN always differs.
fn differing(group: &Group, given: &[f64], truth: &[Option<f64>]) -> Vec<usize> {
    let size = group.entries.first().map_or(0.0, |entry| entry.cell.size);
    let right = |x: f64, y: f64| if group.query == "distance" { same_distance(x, y, size) } else { x == y };
    let pairs = given.iter().zip(truth).enumerate();
    pairs.filter(|(_, (x, y))| y.is_some_and(|y| !right(**x, y))).map(|(i, _)| i).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_answers_are_found_and_open_ones_let_pass() {
        let group = Group { set: "s".into(), query: "collide".into(), entries: Vec::new() };
        let truth = [Some(1.0), Some(0.0), None, Some(1.0)];
        assert_eq!(differing(&group, &[1.0, 1.0, 1.0, f64::NAN], &truth), [1, 3]);
        assert_eq!(differing(&group, &[1.0, 0.0], &truth), [0_usize; 0]);
    }
}
