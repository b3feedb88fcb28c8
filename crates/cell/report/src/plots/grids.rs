//! Occupied cells of grids over time.

use elbowroom_sim::Recording;
use serde_json::json;

use super::figure::{Figure, plain, round};
use super::plot::{Plot, axis, layout, line, stroke, with};
use super::timing;
use crate::downsample::{MAX_POINTS, pick};
use crate::palette;

/// The number of the cell that each robot occupies in each of its grids; `None` for a cell without grids.
pub fn chart(runs: &[(&str, &Recording)], run: usize) -> Option<Figure> {
    let (label, recording) = runs.get(run)?;
    if recording.grids.is_empty() {
        return None;
    }
    let mut plot = Plot::new(layout(axis("time (s)"), with(axis("occupied cell"), json!({ "rangemode": "tozero" }))));
    for (index, of_robot) in recording.grids.iter().enumerate() {
        let Some(track) = recording.robots.get(of_robot.robot.0) else { continue };
        let at = |i: usize| f64::from(of_robot.grid.number_in(track.samples[i].outputs));
        let kept = pick(track.samples.len(), MAX_POINTS, &[&at]);
        let t = kept.iter().map(|&i| round(track.samples[i].t_s)).collect();
        let y = kept.iter().map(|&i| round(at(i))).collect();
        let style = with(stroke(palette::of_index(index), 1.6), json!({ "shape": "hv" }));
        plot.add(line(t, y, &plain(&format!("{} · {}", track.name, of_robot.grid.name)), style));
    }
    Some(Figure {
        title: timing::title("Grids of the working area", label, runs.len()),
        note: "The number of the cell in which the robot is; 0 is outside of the grid.".into(),
        over_time: true,
        run: Some(run),
        height: 300,
        wide: true,
        drawing: plot.into(),
    })
}
