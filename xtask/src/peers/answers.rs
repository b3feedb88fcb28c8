//! Answers against answers: what differs must be explained by the distance.

use std::path::Path;

use super::groups::{Entry, Group};
use super::measure::{Time, budget_ns};
use super::report::Line;
use super::runner::Runner;

/// Of the size: nearer to the border between yes and no than this, both are right.
const BORDER: f64 = 1e-9;
/// Distances agree to this share of themselves, and to a thousandth of it of the size.
const RELATIVE: f64 = 1e-9;
/// More differences than these in one line are counted without looking for an explanation.
const EXAMINED: usize = 50;

/// The group's lines: times, and how the answers compare.
pub fn check(group: &Group, all: &[Group], times: &[Option<Time>], runners: &mut [Runner], folder: &Path) -> Vec<Line> {
    if group.entries.iter().all(|entry| !entry.timed) {
        return Vec::new();
    }
    let reference = group.reference();
    let given: Vec<Vec<f64>> = group
        .entries
        .iter()
        .zip(times)
        .enumerate()
        .map(|(k, (entry, time))| {
            let count = wanted(entry, *time, reference == Some(k));
            runners[entry.runner].answers(entry.number, 0, count, folder).unwrap_or_default()
        })
        .collect();
    let mut lines = Vec::new();
    for (k, (entry, time)) in group.entries.iter().zip(times).enumerate() {
        let Some(time) = time else { continue };
        let (mut checked, mut disagreements) = (0, 0);
        if let Some(reference) = reference {
            // The reference itself counts what it was compared on.
            let other = if k == reference { ours(group).unwrap_or(k) } else { k };
            checked = given[other].len().min(given[reference].len());
            let differing = differing(group, &given[k], &given[reference], entry.cell.size);
            disagreements = differing.len();
            if group.query != "distance" {
                let near = differing.iter().take(EXAMINED);
                disagreements -= near.filter(|&&i| explained(group, all, entry, i, runners, folder)).count();
            }
            let who = &group.entries[reference].cell.lib;
            for &i in differing.iter().take(3) {
                let (lib, answers) = (&entry.cell.lib, (given[k][i], given[reference][i]));
                eprintln!("  {lib} on record {i}: {:?}, {who}: {:?}", answers.0, answers.1);
            }
        }
        let judged_by_coal = reference.is_some_and(|r| group.entries[r].cell.lib.starts_with("coal"));
        lines.push(Line {
            lib: entry.cell.lib.clone(),
            set: group.set.clone(),
            query: group.query.clone(),
            mean_ns: time.mean_ns,
            n: time.records,
            answers_checked: checked,
            disagreements,
            judged_by_coal,
        });
    }
    lines
}

/// How many answers: all yes-or-no of elbowroom's and of the reference's; of the rest what the time allows.
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

fn ours(group: &Group) -> Option<usize> {
    group.entries.iter().position(|entry| entry.cell.lib.starts_with("elbowroom"))
}

/// The records on which two lists differ; a NaN always does.
fn differing(group: &Group, given: &[f64], reference: &[f64], size: f64) -> Vec<usize> {
    let same = |x: f64, y: f64| {
        if group.query == "distance" {
            // Some libraries tell a penetration as a negative distance.
            let (x, y) = (x.max(0.0) + 0.0 * x, y.max(0.0) + 0.0 * y);
            (x - y).abs() <= RELATIVE * (y + 1e-3 * size)
        } else {
            x == y
        }
    };
    (0..given.len().min(reference.len())).filter(|&i| !same(given[i], reference[i])).collect()
}

/// Whether both elbowroom and the reference measure a distance at the very border between yes and no.
fn explained(
    group: &Group,
    all: &[Group],
    entry: &Entry,
    record: usize,
    runners: &mut [Runner],
    folder: &Path,
) -> bool {
    let Some(distances) = all.iter().find(|other| other.set == group.set && other.query == "distance") else {
        return false;
    };
    let witnesses: Vec<&Entry> =
        [ours(distances), distances.reference()].into_iter().flatten().map(|k| &distances.entries[k]).collect();
    let border = if group.query == "tolerance" { entry.cell.tolerance } else { 0.0 };
    let mut told = Vec::new();
    for witness in &witnesses {
        let answer = runners[witness.runner].answers(witness.number, record, 1, folder);
        let distance = answer.and_then(|a| a.first().copied()).unwrap_or(f64::NAN).max(0.0);
        told.push(format!("{} {:e}", witness.cell.lib, distance - border));
        if !((distance - border).abs() <= BORDER * entry.cell.size) {
            return false;
        }
    }
    eprintln!("  explained: {} on record {record}: distance less border, metres: {}", entry.cell.lib, told.join(", "));
    witnesses.len() == 2
}
