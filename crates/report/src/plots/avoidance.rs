//! Plots of avoidance over time, and of the control surfaces.

use elbowroom_avoidance::{AvoiderState, fuzzy};
use elbowroom_sim::{AvoidanceTrack, Recording, RobotTrack};
use plotly::common::{ColorScale, ColorScalePalette, Line, Title};
use plotly::layout::{LayoutScene, RangeMode};
use plotly::{Plot, Surface};

use super::figure::{Figure, axis, bars, curve_name, layout, line, plain, round};
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
    let mut plot = Plot::new();
    let time = |i: usize| robot.samples.get(i).map_or(f64::NAN, |s| s.t_s);
    let s = &track.samples;
    let mut add = |what: &str, color: &'static str, second: bool, at: &dyn Fn(usize) -> f64| {
        let kept = pick(s.len(), MAX_POINTS, &[at]);
        let (x, y) = kept.iter().map(|&i| (round(time(i)), round(at(i)))).unzip();
        let curve = line(x, y, what, Line::new().color(color).width(2.0));
        plot.add_trace(if second { curve.y_axis("y2") } else { curve });
    };
    let millimetres = |i: usize| if s[i].nearest_m.is_finite() { 1e3 * s[i].nearest_m } else { f64::NAN };
    add("nearest (mm)", "#2ca02c", false, &millimetres);
    add("size of the correction (%)", "#d62728", true, &|i| 100.0 * s[i].size);
    add("path rate (%)", "#1f77b4", true, &|i| 100.0 * s[i].rate);
    let found = equal_runs(s.iter().map(|s| (s.state != AvoiderState::Following).then_some(s.state)));
    for (state, color) in STATES {
        let of = found.iter().filter(|(d, ..)| *d == state);
        let spans: Vec<(f64, f64)> = of.map(|&(_, from, to)| (time(from), time(to - 1) + recording.tick_s)).collect();
        if !spans.is_empty() {
            plot.add_trace(bars(&spans, 0.0, 10.0, state.name(), color, state.name()).y_axis("y3"));
        }
    }
    plot.set_layout(
        layout()
            .x_axis(axis("time (s)").anchor("y3"))
            .y_axis(axis("nearest (mm)").domain(&[0.6, 1.0]).range_mode(RangeMode::ToZero))
            .y_axis2(axis("%").domain(&[0.14, 0.54]).range(vec![-4.0, 104.0]))
            .y_axis3(axis("").domain(&[0.0, 0.08]).range(vec![-0.5, 0.5]).show_tick_labels(false).show_grid(false)),
    );
    Figure {
        title: format!("Avoidance: {name}"),
        note: "Distance to the nearest obstacle, size of the correction, path rate. The strip shows the state.".into(),
        over_time: true,
        run: Some(run),
        height: 460,
        wide: true,
        plot,
    }
}

fn surface(s: &fuzzy::Surface, name: &str, run: usize) -> Figure {
    let mut plot = Plot::new();
    plot.add_trace(
        Surface::new(s.z.clone())
            .x(s.x.clone())
            .y(s.y.clone())
            .color_scale(ColorScale::Palette(ColorScalePalette::Viridis))
            .show_scale(false),
    );
    let title = |text: &str| axis("").title(Title::with_text(plain(text)));
    plot.set_layout(
        layout().scene(
            LayoutScene::new()
                .x_axis(title(&format!("{} (m)", s.x_name)))
                .y_axis(title(&format!("{} (m/s)", s.y_name)))
                .z_axis(title(&s.z_name).range(s.z_range.to_vec())),
        ),
    );
    Figure {
        title: format!("Rules of {name}: {}", s.z_name),
        note: "Control surface: output of the rules over proximity and approach speed.".into(),
        over_time: false,
        run: Some(run),
        height: 420,
        wide: false,
        plot,
    }
}
