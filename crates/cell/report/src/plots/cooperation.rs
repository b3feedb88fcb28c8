//! Plots of robots that act as one over time: who holds the work-piece, how fast it moves, how near the robots are to each
//! other and to singularities.

use elbowroom_sim::{Recording, VirtualRobotSample, VirtualRobotTrack};
use serde_json::json;

use super::figure::{Figure, round};
use super::plot::{Plot, axis, layout, line, stroke, with};
use crate::downsample::{MAX_POINTS, pick};

/// Curves of every virtual robot in a run.
pub fn all(runs: &[(&str, &Recording)], run: usize) -> Vec<Figure> {
    let (label, recording) = runs[run];
    let name = |track: &VirtualRobotTrack| {
        if runs.len() > 1 { format!("{} · {label}", track.name) } else { track.name.clone() }
    };
    recording.virtual_robots.iter().map(|track| curves(track, &name(track), run)).collect()
}

fn curves(track: &VirtualRobotTrack, name: &str, run: usize) -> Figure {
    let s = &track.samples;
    let axis_at = |title: &str, domain: [f64; 2]| with(axis(title), json!({ "domain": domain }));
    let robots: Vec<usize> = (0..track.robots.len()).collect();
    let holder = with(axis_at("holder", [0.79, 1.0]), json!({ "tickvals": robots, "ticktext": track.robots }));
    let axes = json!({
        "yaxis2": with(axis_at("%", [0.53, 0.74]), json!({ "rangemode": "tozero" })),
        "yaxis3": with(axis_at("mm", [0.265, 0.475]), json!({ "rangemode": "tozero" })),
        "yaxis4": with(axis_at("singular value", [0.0, 0.21]), json!({ "rangemode": "tozero" })),
    });
    let mut plot = Plot::new(with(layout(with(axis("time (s)"), json!({ "anchor": "y4" })), holder), axes));
    let mut add = |what: &str, color: &str, y_axis: &str, at: &dyn Fn(&VirtualRobotSample) -> f64| {
        let value = |i: usize| at(&s[i]);
        let kept = pick(s.len(), MAX_POINTS, &[&value]);
        let (x, y) = kept.iter().map(|&i| (round(s[i].t_s), round(value(i)))).unzip();
        plot.add(with(line(x, y, what, stroke(color, 2.0)), json!({ "yaxis": y_axis })));
    };
    add("robot that holds", "#1f77b4", "y", &|s| s.holder as f64);
    add("share of the desired speed (%)", "#2ca02c", "y2", &|s| 100.0 * s.rate);
    if let Some(view) = &track.view {
        let hidden = |s: &VirtualRobotSample| s.hidden_share.map_or(f64::NAN, |share| 100.0 * share);
        add(&format!("hidden from camera {} (%)", view.camera), "#9467bd", "y2", &hidden);
    }
    let gap = |s: &VirtualRobotSample| finite_or_nan(1e3 * s.gap_m);
    add("least distance between two robots (mm)", "#d62728", "y3", &gap);
    let manipulability = |s: &VirtualRobotSample| finite_or_nan(s.singular_value);
    add("least singular value of the robot that holds", "#ff7f0e", "y4", &manipulability);
    add("the least with which it plans to hold", "#7f7f7f", "y4", &|_| track.least_singular_value);
    Figure {
        title: format!("Robots that act as one: {name}"),
        note: note(track),
        over_time: true,
        run: Some(run),
        height: 560,
        wide: true,
        drawing: plot.into(),
    }
}

/// NaN leaves a gap in the curve.
fn finite_or_nan(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

fn note(track: &VirtualRobotTrack) -> String {
    let seen = track.view.as_ref().map_or_else(String::new, |view| {
        let (percent, camera) = (100.0 * view.allowed_share, &view.camera);
        format!(
            " Hidden: the part of its surface in view of camera {camera} that the robots hide; a robot that will hide more \
             than {percent:.0} % hands the work-piece over before."
        )
    });
    format!(
        "The robot that holds the work-piece, its speed as a share of the desired one, the least distance between two of the \
         robots, as far as it is below 100 mm, and how far the robot that holds is from a singularity, where the least \
         singular value of its Jacobian is 0.{seen}"
    )
}
