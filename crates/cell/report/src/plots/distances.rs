//! Distances of one robot to every region over time, with the monitor and without it.

use elbowroom_robot::RobotId;
use elbowroom_sim::{Recording, RobotTrack};
use serde_json::{Value, json};

use super::figure::{Figure, plain, round};
use super::plot::{Plot, axis, layout, line, markers, stroke, with};
use crate::downsample::{MAX_POINTS, every};
use crate::palette;
use crate::region_distances::curves;
use crate::run_data::frames;
use crate::scene::ReportScene;

/// Largest number of regions in a plot.
const MAX_REGIONS: usize = 24;

/// The plot of a robot in one run; `planned` is the run without the monitor, whose curves are dotted.
pub fn chart(scene: &ReportScene, run: &Recording, planned: Option<&Recording>, robot: RobotId) -> Option<Figure> {
    let track = run.robots.get(robot.0)?;
    let mut plot = Plot::new(layout(axis("time (s)"), with(axis("distance (mm)"), json!({ "rangemode": "tozero" }))));
    if let Some(planned) = planned {
        add_curves(&mut plot, scene, planned, robot, true);
    }
    add_curves(&mut plot, scene, run, robot, false);
    if plot.traces.is_empty() {
        return None;
    }
    add_stops(&mut plot, run, track);
    if planned.is_some() {
        let nothing = vec![None];
        let style = with(stroke("#888888", 1.5), json!({ "dash": "dot" }));
        plot.add(line(nothing.clone(), nothing, "dotted: as programmed, without the monitor", style));
    }
    let who = if run.robots.len() > 1 { format!(": {}", track.name) } else { String::new() };
    let stops = if track.stops.is_empty() { "" } else { " Grey: stopped by the monitor; ✕: where." };
    Some(Figure {
        title: format!("Distance to every region{who}"),
        note: format!("From the guarded volumes; a gap while a region is off.{stops}"),
        over_time: true,
        run: None,
        height: 380,
        wide: true,
        drawing: plot.into(),
    })
}

fn add_curves(plot: &mut Plot, scene: &ReportScene, run: &Recording, robot: RobotId, planned: bool) {
    let all = frames(run);
    let ticks: Vec<usize> = every(all.len(), MAX_POINTS).into_iter().map(|i| all[i]).collect();
    let Some(samples) = run.robots.get(robot.0).map(|r| &r.samples) else { return };
    let t: Vec<Option<f64>> = ticks.iter().map(|&i| samples.get(i).and_then(|s| round(s.t_s))).collect();
    for curve in curves(scene, run, robot, &ticks).iter().take(MAX_REGIONS) {
        let region = &run.regions[curve.region.0];
        let name = plain(&region.name);
        let color = palette::of_region(curve.region.0);
        let style = if planned { with(stroke(color, 1.3), json!({ "dash": "dot" })) } else { stroke(color, 2.2) };
        let warning = format!("{name} (warning {:.0} mm)", 1e3 * region.warning_m);
        let mode = if planned { " without the monitor" } else { "" };
        let hover = format!("{name}{mode}<br>%{{y:.2f}} mm at %{{x:.3f}} s<extra></extra>");
        let y = curve.metres.iter().map(|d| round(1e3 * d)).collect();
        let entry = json!({ "legendgroup": name, "showlegend": !planned, "hovertemplate": hover });
        plot.add(with(line(t.clone(), y, &warning, style), entry));
    }
}

/// Shades the times of stops, and marks the region and its distance at their start.
fn add_stops(plot: &mut Plot, run: &Recording, track: &RobotTrack) {
    let shade = |from: f64, to: f64| {
        json!({
            "type": "rect", "xref": "x", "yref": "paper", "x0": from, "x1": to, "y0": 0, "y1": 1,
            "fillcolor": "#808080", "opacity": 0.18, "line": { "width": 0 },
        })
    };
    let shapes: Vec<Value> = track.stops.iter().map(|s| shade(s.from_s, s.to_s)).collect();
    plot.layout = with(std::mem::take(&mut plot.layout), json!({ "shapes": shapes }));
    for stop in &track.stops {
        let (Some(by), Some(distance)) = (&stop.by, stop.distance_m) else { continue };
        let index = run.regions.iter().position(|r| r.name == *by).unwrap_or(0);
        let style = json!({ "color": palette::of_region(index), "size": 11, "symbol": "x" });
        let part = stop.part.as_deref().unwrap_or("the robot");
        let text = plain(&format!("stopped at {:.3} s by {by}, closest {part}", stop.from_s));
        let mark = markers(vec![round(stop.from_s)], vec![round(1e3 * distance)], &plain(by), style);
        let hover = format!("{text}<br>%{{y:.2f}} mm<extra></extra>");
        plot.add(with(
            mark,
            json!({ "legendgroup": plain(by), "showlegend": false, "hovertemplate": hover, "cliponaxis": false }),
        ));
    }
}
