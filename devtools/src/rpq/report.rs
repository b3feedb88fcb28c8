//! Report of the measured times as tables, JSON lines and figures.

use std::fmt::Write as _;

use elbowroom_scene::Level;

use super::measure::{Query, Run, Setting, TOLERANCE_M};
use super::spacing::Spacing;
use crate::figures::svg::{Axis, Curve, Dash, Plot};

/// Formats all tables for the terminal.
pub fn tables(spacings: &[Spacing], triangles: usize, states: usize) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "Two RX60B of {triangles} triangles each, {states} equidistributed states; µs per query\n");
    line(&mut out, "between the bases (m)", spacings, |p| format!("{:.1}", p.distance_m));
    line(&mut out, "states in contact (%)", spacings, |p| format!("{:.1}", 100.0 * p.contact_share()));
    line(&mut out, "pairs of links", spacings, |p| p.pairs.0.to_string());
    line(&mut out, "out of reach (matrix)", spacings, |p| p.pairs.1.to_string());
    for query in Query::ALL {
        let more = if query == Query::Tolerance { format!(" ({TOLERANCE_M} m)") } else { String::new() };
        let _ = writeln!(out, "\n{}{more}\nlevels    matrix weights   mean (p50, p99)", query.name());
        for setting in Setting::all() {
            let on = |yes| if yes { "yes" } else { "no" };
            let head = format!("{:<9} {:<6} {:<7}", setting.levels(), on(setting.matrix), on(setting.weights));
            line(&mut out, &head, spacings, |p| p.run(query, setting).map_or_else(String::new, cell));
        }
    }
    out.push_str("\nwhat answered, all three levels, matrix and weights on: questions by L1, L2, L3 (%); exact tests per question\n");
    for query in Query::ALL {
        line(&mut out, query.name(), spacings, |p| p.run(query, Setting::FULL).map_or_else(String::new, levels));
    }
    out
}

fn line(out: &mut String, head: &str, spacings: &[Spacing], cell: impl Fn(&Spacing) -> String) {
    let _ = write!(out, "{head:<24}");
    for spacing in spacings {
        let _ = write!(out, " {:>21}", cell(spacing));
    }
    out.push('\n');
}

fn cell(run: &Run) -> String {
    let t = run.times;
    format!("{} ({}, {})", short(t.mean), short(t.p50), short(t.p99))
}

/// Formats a number with three digits.
fn short(v: f64) -> String {
    let digits = if v < 10.0 { 2 } else { usize::from(v < 100.0) };
    format!("{v:.digits$}")
}

fn levels(run: &Run) -> String {
    let counts = &run.counts;
    let total = counts.answered.total().max(1) as f64;
    let share = |level| 100.0 * counts.answered.get(level) as f64 / total;
    let tests = counts.pairs_tested.l3 as f64 / run.answers.len().max(1) as f64;
    let [l1, l2, l3] = [Level::L1, Level::L2, Level::L3].map(share);
    format!("{l1:.0} {l2:.0} {l3:.0}; {tests:.2}")
}

/// Formats one JSON object per line and run.
pub fn json(spacings: &[Spacing]) -> String {
    let mut out = String::new();
    for spacing in spacings {
        for run in &spacing.runs {
            let (s, t, c) = (run.setting, run.times, &run.counts);
            let per_level = |p: &elbowroom_scene::PerLevel| {
                format!(r#"{{"l1":{},"l2":{},"capsule":{},"hull":{},"l3":{}}}"#, p.l1, p.l2, p.capsule, p.hull, p.l3)
            };
            let _ = writeln!(
                out,
                r#"{{"distance_m":{},"contact_share":{},"pairs":{},"pairs_out_of_reach":{},"query":"{}","levels":"{}","matrix":{},"weights":{},"states":{},"mean_us":{},"p50_us":{},"p99_us":{},"answered":{},"pairs_cleared":{},"pairs_tested":{},"pairs_skipped":{}}}"#,
                spacing.distance_m,
                spacing.contact_share(),
                spacing.pairs.0,
                spacing.pairs.1,
                run.query.name(),
                s.levels(),
                s.matrix,
                s.weights,
                run.answers.len(),
                t.mean,
                t.p50,
                t.p99,
                per_level(&c.answered),
                per_level(&c.pairs_cleared),
                per_level(&c.pairs_tested),
                c.pairs_skipped,
            );
        }
    }
    out
}

/// Draws the two halves of the paper's figure 3; returns them by file name.
pub fn figures(spacings: &[Spacing]) -> Vec<(&'static str, String)> {
    let setting = |start, matrix, weights| Setting { start, matrix, weights };
    let matrix = [
        ("L3, no matrix", 0, Dash::Solid, setting(Level::L3, false, false)),
        ("L3, matrix", 0, Dash::Dashed, setting(Level::L3, true, false)),
        ("L2+L3, no matrix", 1, Dash::Solid, setting(Level::L2, false, false)),
        ("L2+L3, matrix", 1, Dash::Dashed, setting(Level::L2, true, false)),
    ];
    let levels = [
        ("L3", 0, Dash::Solid, setting(Level::L3, false, false)),
        ("L2+L3", 1, Dash::Solid, setting(Level::L2, false, false)),
        ("L1+L2+L3", 2, Dash::Solid, setting(Level::L1, false, false)),
        ("L1+L2+L3, all on", 2, Dash::Dashed, Setting::FULL),
    ];
    vec![
        (
            "rpq-matrix.svg",
            plot("Collision query: with and without the allowed collision matrix", spacings, &matrix).svg(),
        ),
        ("rpq-levels.svg", plot("Collision query: resolution levels", spacings, &levels).svg()),
    ]
}

fn plot(title: &'static str, spacings: &[Spacing], lines: &[(&str, usize, Dash, Setting)]) -> Plot {
    let point =
        |spacing: &Spacing, s: Setting| Some((spacing.distance_m, spacing.run(Query::Collision, s)?.times.mean));
    let curves: Vec<Curve> = lines
        .iter()
        .map(|&(label, colour, dash, s)| {
            let points = spacings.iter().filter_map(|spacing| point(spacing, s)).collect();
            Curve { label: label.to_owned(), colour, dash, points }
        })
        .collect();
    let most = curves.iter().flat_map(|curve| &curve.points).map(|p| p.1).fold(0.0, f64::max);
    let step = tick(most);
    let ends = (spacings.first().map_or(0.0, |p| p.distance_m), spacings.last().map_or(1.0, |p| p.distance_m));
    let x = Axis { title: "distance between the bases (m)", from: ends.0, to: ends.1, step: 0.2 };
    let y = Axis { title: "mean time per query (µs)", from: 0.0, to: (most / step).ceil().max(1.0) * step, step };
    Plot { title, x, y, curves }
}

/// Returns a distance of ticks, 1, 2 or 5 times a power of ten, for four to ten ticks.
fn tick(most: f64) -> f64 {
    let rough = (most / 8.0).max(1e-3);
    let power = 10_f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|k| k * power).find(|step| *step >= rough).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        for most in [0.03, 0.9, 7.0, 55.0, 1234.0] {
            let step = tick(most);
            let count = most / step;
            assert!((2.0..=10.0).contains(&count), "{most}: {step}");
        }
    }
}
