//! Plots of avoidance over time, and of the control surfaces.

use elbowroom_avoidance::{AvoiderState, fuzzy};
use elbowroom_sim::{AvoidanceTrack, Recording, RobotTrack};
use serde_json::json;

use super::figure::{Drawing, Figure, bars, curve_name, round};
use super::plot::{Plot, axis, layout, line, stroke, with};
use crate::downsample::{MAX_POINTS, pick};
use crate::spans::runs as equal_runs;

/// States of avoidance, with their colours.
const STATES: [(AvoiderState, &str); 5] = [
    (AvoiderState::Evading, "#d62728"),
    (AvoiderState::Waiting, "#7f7f7f"),
    (AvoiderState::Returning, "#1f77b4"),
    (AvoiderState::Detouring, "#9467bd"),
    (AvoiderState::Halted, "#000000"),
];

/// Curves and control surfaces of every robot with avoidance in a run.
pub fn all(runs: &[(&str, &Recording)], run: usize) -> Vec<Figure> {
    let (label, recording) = runs[run];
    let mut figures = Vec::new();
    for robot in &recording.robots {
        let Some(track) = &robot.avoidance else { continue };
        let name = curve_name(label, recording, robot);
        figures.push(curves(robot, track, recording, &name, run));
        figures.extend(track.surfaces.iter().map(|s| surface(s, &name, run)));
    }
    figures
}

fn curves(robot: &RobotTrack, track: &AvoidanceTrack, recording: &Recording, name: &str, run: usize) -> Figure {
    let mut plot = Plot::new(with(
        layout(
            with(axis("time (s)"), json!({ "anchor": "y3" })),
            with(axis("nearest (mm)"), json!({ "domain": [0.6, 1.0], "rangemode": "tozero" })),
        ),
        json!({
            "yaxis2": with(axis("%"), json!({ "domain": [0.14, 0.54], "range": [-4, 104] })),
            "yaxis3": with(
                axis(""),
                json!({ "domain": [0.0, 0.08], "range": [-0.5, 0.5], "showticklabels": false, "showgrid": false }),
            ),
        }),
    ));
    let time = |i: usize| robot.samples.get(i).map_or(f64::NAN, |s| s.t_s);
    let s = &track.samples;
    let mut add = |what: &str, color: &str, y_axis: &str, at: &dyn Fn(usize) -> f64| {
        let kept = pick(s.len(), MAX_POINTS, &[at]);
        let (x, y) = kept.iter().map(|&i| (round(time(i)), round(at(i)))).unzip();
        plot.add(with(line(x, y, what, stroke(color, 2.0)), json!({ "yaxis": y_axis })));
    };
    let millimetres = |i: usize| if s[i].nearest_m.is_finite() { 1e3 * s[i].nearest_m } else { f64::NAN };
    add("nearest (mm)", "#2ca02c", "y", &millimetres);
    add("size of the correction (%)", "#d62728", "y2", &|i| 100.0 * s[i].size);
    add("path rate (%)", "#1f77b4", "y2", &|i| 100.0 * s[i].rate);
    let found = equal_runs(s.iter().map(|s| (s.state != AvoiderState::Following).then_some(s.state)));
    for (state, color) in STATES {
        let of = found.iter().filter(|(d, ..)| *d == state);
        let spans: Vec<(f64, f64)> = of.map(|&(_, from, to)| (time(from), time(to - 1) + recording.tick_s)).collect();
        if !spans.is_empty() {
            let strip = bars(&spans, 0.0, 10.0, state.name(), color, state.name());
            plot.add(with(strip, json!({ "yaxis": "y3" })));
        }
    }
    Figure {
        title: format!("Avoidance: {name}"),
        note: "Distance to the nearest obstacle, size of the correction, path rate. The strip shows the state.".into(),
        over_time: true,
        run: Some(run),
        height: 460,
        wide: true,
        drawing: plot.into(),
    }
}

fn surface(s: &fuzzy::Surface, name: &str, run: usize) -> Figure {
    Figure {
        title: format!("Rules of {name}: {}", s.z_name),
        note: "Control surface: output of the rules over proximity and approach speed.".into(),
        over_time: false,
        run: Some(run),
        height: 420,
        wide: false,
        drawing: Drawing::Picture(s.to_svg()),
    }
}
