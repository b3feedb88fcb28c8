//! Plots of a guided tool over time: where the hand wants it and where it is, its gap, and what the hand feels.

use elbowroom_sim::{GuidanceSample, GuidanceTrack, Recording, RobotTrack};
use elbowroom_spatial::Vec3;
use serde_json::{Value, json};

use super::figure::{Figure, curve_name, round};
use super::plot::{Plot, axis, layout, line, stroke, with};
use crate::downsample::{MAX_POINTS, pick};

/// Curves of every guided robot in a run.
pub fn all(runs: &[(&str, &Recording)], run: usize) -> Vec<Figure> {
    let (label, recording) = runs[run];
    let of_robot = |robot: &RobotTrack| {
        let track = robot.guidance.as_ref()?;
        let name = curve_name(label, recording, robot);
        Some([motions(track, &name, run), curves(track, &name, run)])
    };
    recording.robots.iter().filter_map(of_robot).flatten().collect()
}

/// Where the hand wants the tool, dotted, and where the tool is, along the axes of the world from where the tool started.
fn motions(track: &GuidanceTrack, name: &str, run: usize) -> Figure {
    let s = &track.samples;
    let start = s.first().map_or(Vec3::ZERO, |first| first.tool_in_world.translation);
    let mut plot = Plot::new(layout(axis("time (s)"), axis("mm from the start")));
    let mut add = |what: String, stroke: Value, at: &dyn Fn(&GuidanceSample) -> Option<f64>| {
        let value = |i: usize| at(&s[i]).map_or(f64::NAN, |m| 1e3 * m);
        let kept = pick(s.len(), MAX_POINTS, &[&value]);
        let (x, y) = kept.iter().map(|&i| (round(s[i].t_s), round(value(i)))).unzip();
        plot.add(line(x, y, &what, stroke));
    };
    for (axis, (name, color)) in [("x", "#d62728"), ("y", "#2ca02c"), ("z", "#1f77b4")].into_iter().enumerate() {
        add(format!("{name} of the tool"), stroke(color, 2.0), &|s| Some((s.tool_in_world.translation - start)[axis]));
        let dashed = with(stroke(color, 1.0), json!({ "dash": "dot" }));
        add(format!("{name} desired"), dashed, &|s| Some((s.wanted?.translation - start)[axis]));
    }
    Figure {
        title: format!("Desired and actual motion: {name}"),
        note: format!(
            "The desired point of {} and the tool, along the axes of the world, from where the tool started.",
            track.operator
        ),
        over_time: true,
        run: Some(run),
        height: 300,
        wide: true,
        drawing: plot.into(),
    }
}

fn curves(track: &GuidanceTrack, name: &str, run: usize) -> Figure {
    let s = &track.samples;
    let has_forces = s.iter().any(|sample| sample.force.is_some());
    let (second, third) = if has_forces { ([0.36, 0.64], [0.0, 0.28]) } else { ([0.0, 0.44], [0.0, 0.0]) };
    let first = if has_forces { [0.72, 1.0] } else { [0.56, 1.0] };
    let axis_at = |title: &str, domain: [f64; 2]| with(axis(title), json!({ "domain": domain, "rangemode": "tozero" }));
    let mut axes = json!({ "yaxis2": axis_at("mm/s", second) });
    if has_forces {
        axes = with(axes, json!({ "yaxis3": axis_at("N, J", third) }));
    }
    let anchor = if has_forces { "y3" } else { "y2" };
    let base = layout(with(axis("time (s)"), json!({ "anchor": anchor })), axis_at("mm", first));
    let mut plot = Plot::new(with(base, axes));
    let mut add = |what: &str, color: &str, y_axis: &str, at: &dyn Fn(&GuidanceSample) -> Option<f64>| {
        let value = |i: usize| at(&s[i]).unwrap_or(f64::NAN);
        let kept = pick(s.len(), MAX_POINTS, &[&value]);
        let (x, y) = kept.iter().map(|&i| (round(s[i].t_s), round(value(i)))).unzip();
        plot.add(with(line(x, y, what, stroke(color, 2.0)), json!({ "yaxis": y_axis })));
    };
    add("from the hand to the tool (mm)", "#ff7f0e", "y", &|s| {
        Some(1e3 * s.wanted?.translation.distance(s.tool_in_world.translation))
    });
    add("gap (mm)", "#2ca02c", "y", &|s| s.gap_m.map(|gap| 1e3 * gap));
    add("speed of the tool (mm/s)", "#1f77b4", "y2", &|s| Some(1e3 * s.velocity.length()));
    if has_forces {
        add("force on the hand (N)", "#d62728", "y3", &|s| Some(s.force?.on_hand_n.length()));
        add("energy not given back (J)", "#9467bd", "y3", &|s| Some(s.force?.energy_j));
    }
    let of_forces =
        if has_forces { ", the force on the hand, and the energy that it put in and did not get back" } else { "" };
    Figure {
        title: format!("Guided by {}: {name}", track.operator),
        note: format!("Distance from the desired point to the tool, gap to the nearest surface, speed{of_forces}."),
        over_time: true,
        run: Some(run),
        height: if has_forces { 480 } else { 340 },
        wide: true,
        drawing: plot.into(),
    }
}
