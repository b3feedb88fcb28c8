//! The table for the terminal.

use std::fmt::Write;

use elbowroom::query::problems::{ProblemResult, ProblemSummary, SetSummary, Statistics};

/// Most problems without a path in the list.
const MAX_LISTED: usize = 12;
/// Least terminal width, in columns, for the wide table.
const WIDE: usize = 100;

/// Formats a row per set and one for all sets, then the problems without a path.
pub(super) fn text(summary: &ProblemSummary, results: &[ProblemResult], width: usize) -> String {
    let columns = columns(width >= WIDE, summary.all.line_deviation_m.is_some());
    let fixed: usize = columns.iter().map(|c| c.width).sum();
    let longest = summary.sets.iter().map(|s| s.set.chars().count()).max().unwrap_or(0);
    let name_width = width.saturating_sub(fixed).max(12).min(longest + 1).max("all".len());
    let mut out = String::new();
    let mut row = |name: &str, cell: &dyn Fn(&Column) -> String| {
        let name: String = name.chars().take(name_width).collect();
        let _ = write!(out, "{name:name_width$}");
        for column in &columns {
            let _ = write!(out, "{:>1$}", cell(column), column.width);
        }
        out.push('\n');
    };
    row("", &|c| c.heading[0].to_owned());
    row("set", &|c| c.heading[1].to_owned());
    for set in summary.sets.iter().chain([&summary.all]) {
        row(&set.set, &|c| (c.value)(set));
    }
    list(&mut out, "not solved", results, &|r| r.valid && !r.found);
    list(&mut out, "not valid", results, &|r| !r.valid);
    out
}

/// A column: two lines of heading and the value of a set.
struct Column {
    heading: [&'static str; 2],
    width: usize,
    value: fn(&SetSummary) -> String,
}

/// Returns the columns. The narrow table omits the totals, the mean and the raw lengths; without linear motions there is no
/// deviation.
fn columns(wide: bool, with_lines: bool) -> Vec<Column> {
    let column = |heading, width, value| Column { heading, width, value };
    let mut all = vec![
        (true, column(["", "total"], 6, |s| s.total.to_string())),
        (false, column(["", "valid"], 6, |s| s.valid.to_string())),
        (false, column(["", "solved"], 7, |s| s.solved.to_string())),
        (false, column(["", "proven"], 7, |s| s.proven.to_string())),
        (false, column(["plan", "p50 ms"], 8, |s| milliseconds(s.planning_us, |t| t.p50))),
        (true, column(["plan", "mean ms"], 8, |s| milliseconds(s.planning_us, |t| t.mean))),
        (false, column(["plan", "p95 ms"], 8, |s| milliseconds(s.planning_us, |t| t.p95))),
        (false, column(["simplify", "p50 ms"], 9, |s| milliseconds(s.simplify_us, |t| t.p50))),
        (true, column(["raw", "rad"], 6, |s| number(s.cost_raw_rad))),
        (false, column(["length", "rad"], 7, |s| number(s.cost_rad))),
        (false, column(["time", "s"], 6, |s| number(s.duration_s))),
    ];
    if with_lines {
        all.push((false, column(["off", "line mm"], 8, |s| millimetres(s.line_deviation_m))));
    }
    all.into_iter().filter(|(only_wide, _)| wide || !only_wide).map(|(_, column)| column).collect()
}

fn milliseconds(of: Option<Statistics>, pick: fn(&Statistics) -> f64) -> String {
    let Some(ms) = of.map(|t| pick(&t) / 1000.0) else { return "-".into() };
    if ms < 10.0 { format!("{ms:.3}") } else { format!("{ms:.1}") }
}

fn millimetres(of: Option<f64>) -> String {
    of.map_or_else(|| "-".into(), |metres| format!("{:.3}", 1000.0 * metres))
}

fn number(of: Option<f64>) -> String {
    of.map_or_else(|| "-".into(), |v| format!("{v:.2}"))
}

/// Lists the first problems of a kind, each with its reason.
fn list(out: &mut String, heading: &str, results: &[ProblemResult], is: &dyn Fn(&ProblemResult) -> bool) {
    let listed: Vec<&ProblemResult> = results.iter().filter(|r| is(r)).collect();
    if listed.is_empty() {
        return;
    }
    let _ = writeln!(out, "\n{heading}:");
    for r in listed.iter().take(MAX_LISTED) {
        let _ = writeln!(out, "  {} {}: {}", r.set, r.id, r.reason.as_deref().unwrap_or("no path found"));
    }
    if listed.len() > MAX_LISTED {
        let _ = writeln!(out, "  and {} more; --json has all", listed.len() - MAX_LISTED);
    }
}
