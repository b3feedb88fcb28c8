//! Timing chart of region states, holders and outputs.

use elbowroom_monitor::Life;
use elbowroom_sim::{Recording, RegionTrack, Span};
use serde_json::json;

use super::figure::{Figure, bars, plain};
use super::plot::{Plot, axis, layout, with};
use crate::palette;
use crate::spans::pair;

/// Largest number of rows.
const MAX_ROWS: usize = 40;
const MAX_SPANS: usize = 500;

struct TimingRow {
    label: String,
    spans: Vec<(f64, f64)>,
    color: &'static str,
    opacity: f64,
    text: String,
}

pub fn chart(runs: &[(&str, &Recording)], run: usize) -> Option<Figure> {
    let (label, recording) = runs.get(run)?;
    let mut rows: Vec<TimingRow> =
        recording.regions.iter().enumerate().flat_map(|(i, r)| rows_of(recording, i, r)).collect();
    if rows.is_empty() {
        return None;
    }
    let all = rows.len();
    rows.truncate(MAX_ROWS);
    let mut note = String::from("Warning zone, inside, switching, holders and outputs per region.");
    if all > rows.len() {
        note = format!("{note} The first {MAX_ROWS} of {all} rows.");
    }
    let labels: Vec<&str> = rows.iter().map(|r| r.label.as_str()).collect();
    let ticks: Vec<usize> = (0..rows.len()).collect();
    let last = rows.len() as f64 - 0.5;
    let mut plot = Plot::new(layout(
        with(axis("time (s)"), json!({ "range": [0.0, recording.duration_s.max(recording.tick_s)] })),
        with(axis(""), json!({ "tickvals": ticks, "ticktext": labels, "range": [last, -0.5] })),
    ));
    for (i, row) in rows.iter().enumerate() {
        let shown = &row.spans[..row.spans.len().min(MAX_SPANS)];
        let bars = bars(shown, i as f64, 12.0, &row.label, row.color, &row.text);
        plot.add(with(bars, json!({ "showlegend": false, "opacity": row.opacity })));
    }
    Some(Figure {
        title: title("Timing", label, runs.len()),
        note,
        over_time: true,
        run: Some(run),
        height: 110 + 24 * rows.len(),
        wide: true,
        drawing: plot.into(),
    })
}

/// A title, with the run's label if there are several runs.
pub fn title(what: &str, label: &str, runs: usize) -> String {
    if runs > 1 { format!("{what}: {label}") } else { what.into() }
}

/// Rows of a region with at least one interval.
fn rows_of(recording: &Recording, index: usize, region: &RegionTrack) -> Vec<TimingRow> {
    let name = plain(&region.name);
    let mut rows = Vec::new();
    let mut add = |what: String, spans: Vec<(f64, f64)>, opacity| {
        let label = format!("{name}: {what}");
        rows.push(TimingRow { text: label.clone(), label, spans, color: palette::of_region(index), opacity });
    };
    if region.life == Life::Temporary {
        add("active".into(), pair(region.active.iter().copied(), recording.duration_s), 0.25);
    }
    for (robot, track) in recording.robots.iter().enumerate() {
        let who = if recording.robots.len() > 1 { format!(" ({})", plain(&track.name)) } else { String::new() };
        let of = |spans: &[Span]| -> Vec<(f64, f64)> {
            let mine = spans.iter().filter(|s| s.robot.0 == robot);
            mine.map(|s| (s.from_s, s.to_s.max(s.from_s + recording.tick_s))).collect()
        };
        let between = |on: &[&str], off: &[&str]| {
            let mine =
                recording.events.iter().filter(|e| e.robot == track.name && e.region == recording.regions[index].name);
            let edges = mine
                .filter(|e| on.contains(&e.event.name()) || off.contains(&e.event.name()))
                .map(|e| (e.t_s, on.contains(&e.event.name())));
            pair(edges, recording.duration_s)
        };
        let candidates = [
            ("warning", of(&region.warning_spans), 0.5),
            ("inside", of(&region.inside_spans), 1.0),
            ("waits", between(&["waiting"], &["granted", "released"]), 0.35),
            ("holds", between(&["granted"], &["released"]), 0.8),
            ("output", between(&["output_on"], &["output_off"]), 0.8),
        ];
        for (what, spans, opacity) in candidates {
            if !spans.is_empty() {
                add(format!("{what}{who}"), spans, opacity);
            }
        }
    }
    rows
}
