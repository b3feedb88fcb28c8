//! Report: the lines, and the table of ratios.

use std::fmt::Write;

use super::install::Ready;
use super::targets::asked;
use crate::machine;

/// Result of one library for one query on one set.
#[derive(Debug, Clone)]
pub struct Line {
    pub lib: String,
    pub set: String,
    pub query: String,
    /// Nanoseconds per record, median of the rounds.
    pub mean_ns: f64,
    /// Number of timed records.
    pub n: usize,
    pub answers_checked: usize,
    pub disagreements: usize,
    /// Whether the answers were compared with Coal's; not in the JSON.
    pub compared_with_coal: bool,
}

impl Line {
    pub fn is_ours(&self) -> bool {
        self.lib.starts_with("elbowroom")
    }

    /// Whether it keeps state from step to step.
    fn is_warm(&self) -> bool {
        self.lib.contains("warm")
    }

    pub fn json(&self) -> String {
        let Self { lib, set, query, mean_ns, n, answers_checked, disagreements, .. } = self;
        format!(
            "{{\"lib\":\"{lib}\",\"set\":\"{set}\",\"query\":\"{query}\",\"mean_ns\":{mean_ns:.2},\"n\":{n},\
             \"answers_checked\":{answers_checked},\"disagreements\":{disagreements}}}"
        )
    }
}

/// Formats the table for a terminal of a hundred columns.
pub fn table(lines: &[Line], peers: &[Ready], notes: &[String], missing: &[String]) -> String {
    let mut out = String::new();
    row(&mut out, ["set", "query", "elbowroom ns", "best peer", "ns", "ratio", "asked", ""]);
    row(&mut out, ["---", "---", "---", "---", "---", "---", "---", "---"]);
    let (mut met, mut rows_asked) = (0, 0);
    for line in lines.iter().filter(|line| line.is_ours()) {
        let best = best_peer(lines, line, line.is_warm());
        let target = best.and_then(|_| asked(&line.lib, &line.set, &line.query));
        rows_asked += usize::from(target.is_some());
        met += usize::from(compare(&mut out, line, best, target));
        // The peers of a warm line may be warm too; the best cold peer is shown beside them.
        let cold = best_peer(lines, line, false).filter(|_| best.is_some_and(Line::is_warm) && line.is_warm());
        if cold.is_some() {
            compare(&mut out, line, cold, None);
        }
    }
    let _ = writeln!(out, "\n{met} of {rows_asked} ratios asked for are met.");
    agreement(&mut out, lines, notes);
    let versions: Vec<String> = peers.iter().map(|peer| format!("{} {}", peer.name, peer.version)).collect();
    let _ = writeln!(out, "One core of {}; {}.", machine::processor(), versions.join(", "));
    for reason in missing {
        let _ = writeln!(out, "{reason}");
    }
    out
}

/// Formats a row; true if the ratio is reached.
fn compare(out: &mut String, line: &Line, best: Option<&Line>, target: Option<f64>) -> bool {
    let query = format!("{}{}", line.query, if line.is_warm() { " warm" } else { "" });
    let ratio = best.map_or(f64::NAN, |best| best.mean_ns / line.mean_ns);
    let met = line.disagreements == 0 && target.is_some_and(|target| ratio >= target);
    let result = match target {
        _ if line.disagreements > 0 => "WRONG",
        None => "",
        Some(_) if met => "met",
        Some(_) => "missed",
    };
    let (name, time) = best.map_or(("none", String::new()), |best| (&best.lib, grouped(best.mean_ns)));
    let ratio = best.map_or(String::new(), |_| format!("{ratio:.1}"));
    let target = target.map_or(String::new(), |target| format!("{target:.0}"));
    row(out, [&line.set, &query, &grouped(line.mean_ns), name, &time, &ratio, &target, result]);
    met
}

/// Finds the fastest peer whose answers are right.
fn best_peer<'a>(lines: &'a [Line], ours: &Line, warm_too: bool) -> Option<&'a Line> {
    let rivals = lines.iter().filter(|line| {
        let same = line.set == ours.set && line.query == ours.query;
        same && !line.is_ours() && line.disagreements == 0 && (warm_too || !line.is_warm())
    });
    rivals.min_by(|a, b| a.mean_ns.total_cmp(&b.mean_ns))
}

fn agreement(out: &mut String, lines: &[Line], notes: &[String]) {
    let ours = |yes_or_no: bool| {
        let some =
            move |line: &&Line| line.is_ours() && line.compared_with_coal && (line.query != "distance") == yes_or_no;
        let checked: usize = lines.iter().filter(some).map(|line| line.answers_checked).sum();
        let wrong: usize = lines.iter().filter(some).map(|line| line.disagreements).sum();
        (checked, wrong)
    };
    for (kind, (checked, wrong)) in [("yes-or-no answers", ours(true)), ("distances", ours(false))] {
        let (checked, wrong) = (grouped(checked as f64), grouped(wrong as f64));
        let _ = writeln!(out, "elbowroom and Coal: {checked} {kind} compared, {wrong} differ unexplained.");
    }
    for note in notes {
        let _ = writeln!(out, "differs: {note}");
    }
    for line in lines.iter().filter(|line| !line.is_ours() && line.disagreements > 0) {
        let Line { lib, set, query, disagreements, answers_checked, .. } = line;
        let _ = writeln!(out, "no rival: {lib} {set} {query}: {disagreements} of {answers_checked} answers wrong.");
    }
}

fn row(out: &mut String, [set, query, ours, peer, ns, ratio, target, result]: [&str; 8]) {
    let text = format!("{set:15} {query:13} {ours:>12}  {peer:21} {ns:>12} {ratio:>7} {target:>5} {result}");
    let _ = writeln!(out, "{}", text.trim_end());
}

/// Formats a number with commas, and a decimal below a hundred.
fn grouped(value: f64) -> String {
    if value < 100.0 && value.fract() != 0.0 {
        return format!("{value:.1}");
    }
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(lib: &str, mean_ns: f64, disagreements: usize) -> Line {
        let (set, query) = ("m4k_near".into(), "collide".into());
        Line {
            lib: lib.into(),
            set,
            query,
            mean_ns,
            n: 9,
            answers_checked: 90,
            disagreements,
            compared_with_coal: true,
        }
    }

    #[test]
    fn the_best_peer_is_the_quickest_that_is_right() {
        let lines =
            [line("elbowroom", 10.0, 0), line("coal", 200.0, 0), line("fcl", 100.0, 1), line("parry", 150.0, 0)];
        let table = table(&lines, &[], &[], &["fcl is ill".into()]);
        let row = table.lines().find(|row| row.starts_with("m4k_near")).unwrap();
        assert!(row.contains("parry") && row.contains("15.0") && row.ends_with("met"), "{row}");
        assert!(table.contains("90 yes-or-no answers") && table.contains("1 of 90 answers wrong"), "{table}");
        assert!(table.contains("fcl is ill") && table.lines().all(|row| row.chars().count() <= 100), "{table}");
    }

    #[test]
    fn warm_peers_are_no_rivals_of_a_cold_line() {
        let lines = [
            line("elbowroom", 10.0, 0),
            line("elbowroom+warm", 5.0, 0),
            line("coal", 200.0, 0),
            line("coal+warm", 50.0, 0),
        ];
        let table = table(&lines, &[], &[], &[]);
        assert!(table.lines().nth(2).unwrap().contains(" 20.0 "), "{table}");
        assert!(table.lines().nth(3).unwrap().contains(" 10.0 "), "{table}");
        assert!(table.lines().nth(4).unwrap().contains(" 40.0"), "{table}");
    }

    #[test]
    fn json_is_exactly_what_was_agreed() {
        let expected = r#"{"lib":"coal","set":"m4k_near","query":"collide","mean_ns":1234.57,"n":9,"answers_checked":90,"disagreements":2}"#;
        assert_eq!(line("coal", 1234.567, 2).json(), expected);
    }

    #[test]
    fn numbers_are_grouped_by_threes() {
        assert_eq!([5.25, 99.0, 1234.5, 1_234_567.0].map(grouped), ["5.2", "99", "1,234", "1,234,567"]);
    }
}
