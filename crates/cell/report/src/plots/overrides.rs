//! Override with the governing region.

use elbowroom_cell::CellRegionId;
use elbowroom_monitor::OverrideReason;
use elbowroom_sim::{Recording, RobotTrack, Sample};
use serde_json::json;

use super::figure::{Figure, bars, curve_name, plain, round, tracks};
use super::plot::{Plot, axis, layout, line, stroke, with};
use crate::downsample::{MAX_POINTS, pick};
use crate::explanation::{collision_text, reason_text};
use crate::palette;
use crate::spans::runs as equal_runs;

/// Largest number of bands, which bounds the size of the file.
const MAX_BANDS: usize = 1000;

pub fn all(runs: &[(&str, &Recording)]) -> Vec<Figure> {
    vec![overrides(runs)]
}

fn overrides(runs: &[(&str, &Recording)]) -> Figure {
    let mut plot = Plot::default();
    let mut rows = Vec::new();
    for (label, recording, robot, track) in tracks(runs) {
        let name = curve_name(label, recording, track);
        let at = |i: usize| 100.0 * track.samples[i].speed_override;
        let kept = pick(track.samples.len(), MAX_POINTS, &[&at]);
        let t = kept.iter().map(|&i| round(track.samples[i].t_s)).collect();
        let y = kept.iter().map(|&i| round(at(i))).collect();
        let style = stroke(palette::of_run(robot, recording.monitored), 2.0);
        plot.add(line(t, y, &name, style));
        add_bands(&mut plot, recording, &track.samples, rows.len(), &name);
        add_collisions(&mut plot, recording, track, rows.len(), &name);
        rows.push(name);
    }
    let strip = (0.06 * rows.len() as f64).clamp(0.08, 0.4);
    let ticks: Vec<usize> = (0..rows.len()).collect();
    let last = rows.len().max(1) as f64 - 0.5;
    let names = json!({
        "domain": [0.0, strip], "range": [last, -0.5], "tickvals": ticks, "ticktext": rows, "showgrid": false,
    });
    plot.layout = with(
        layout(
            with(axis("time (s)"), json!({ "anchor": "y2" })),
            with(axis("override (%)"), json!({ "domain": [strip + 0.05, 1.0], "range": [-4, 104] })),
        ),
        json!({ "yaxis2": with(axis(""), names) }),
    );
    Figure {
        title: "Override and the region that governs".into(),
        note: "The strip below names the cause of the override, and collisions in red: hover over it. With the monitor off, the override is not \
               applied."
            .into(),
        over_time: true,
        run: None,
        height: 360,
        wide: true,
        drawing: plot.into(),
    }
}

/// Cause of a band: the governing region, or another reason.
fn cause(sample: &Sample) -> Option<Result<CellRegionId, OverrideReason>> {
    match (sample.region, sample.reason) {
        (_, reason @ OverrideReason::Fault(_)) => Some(Err(reason)),
        (Some(region), _) => Some(Ok(region)),
        (None, reason) => reason.region().map(|r| Ok(CellRegionId(r.0))),
    }
}

fn add_bands(plot: &mut Plot, recording: &Recording, samples: &[Sample], row: usize, who: &str) {
    let mut found = equal_runs(samples.iter().map(cause));
    found.truncate(MAX_BANDS);
    let mut causes: Vec<Result<CellRegionId, OverrideReason>> = Vec::new();
    for (cause, ..) in &found {
        if !causes.contains(cause) {
            causes.push(*cause);
        }
    }
    for cause in causes {
        let spans: Vec<(f64, f64)> = found
            .iter()
            .filter(|(c, ..)| *c == cause)
            .map(|&(_, from, to)| (samples[from].t_s, samples[to - 1].t_s + recording.tick_s))
            .collect();
        let (text, color) = match cause {
            Ok(region) => (
                recording.regions.get(region.0).map_or_else(|| "?".into(), |r| r.name.clone()),
                palette::of_region(region.0),
            ),
            Err(reason) => (reason_text(reason, recording), "#000000"),
        };
        let text = plain(&text);
        let band = bars(&spans, row as f64, 10.0, &text, color, &format!("{who}<br>governed by {text}"));
        plot.add(with(band, json!({ "yaxis": "y2", "showlegend": row == 0, "legendgroup": text })));
    }
}

/// Marks first contacts; their duration is not recorded.
fn add_collisions(plot: &mut Plot, recording: &Recording, track: &RobotTrack, row: usize, who: &str) {
    let wide = recording.tick_s.max(recording.duration_s / 200.0);
    for collision in track.collisions.iter().take(MAX_BANDS) {
        let text = plain(&collision_text(collision, track));
        let span = [(collision.t_s, collision.t_s + wide)];
        let mark = bars(&span, row as f64, 18.0, &text, "#d62728", &format!("{who}<br>{text}"));
        plot.add(with(mark, json!({ "yaxis": "y2", "showlegend": false })));
    }
}
