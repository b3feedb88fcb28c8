//! The plots: figure 12 of the paper, then override, distance, timing and joints.

mod avoidance;
mod figure;
mod figure12;
mod joints;
mod overrides;
mod timing;
mod watched;

use plotly::Plot;

use crate::recording::{Recording, RobotTrack};

use super::scene::ReportScene;
pub use watched::all as watched;

/// One plot of the page.
pub struct Figure {
    /// Heading; plain text.
    pub title: String,
    /// One line under the heading; plain text.
    pub note: String,
    /// True where the x axis is time: hovering moves the scene.
    pub over_time: bool,
    /// Shown only while this run is selected.
    pub run: Option<usize>,
    /// Height in CSS pixels.
    pub height: usize,
    /// True where it takes the whole width of the page.
    pub wide: bool,
    /// Traces and layout.
    pub plot: Plot,
}

/// Every plot, in the order of the page.
pub fn all(scene: &ReportScene, runs: &[(&str, &Recording)]) -> Vec<Figure> {
    let mut figures = figure12::all(scene, runs);
    figures.extend(overrides::all(runs));
    for run in 0..runs.len() {
        figures.extend(avoidance::all(runs, run));
        figures.extend(timing::chart(runs, run));
        figures.extend(joints::chart(scene, runs, run));
    }
    figures
}

/// Each robot of each run: its label, the recording, index of the robot, the robot. Runs with control come last, so
/// that their curves lie on top where both agree.
fn tracks<'a>(
    runs: &'a [(&'a str, &'a Recording)],
) -> impl Iterator<Item = (&'a str, &'a Recording, usize, &'a RobotTrack)> + 'a {
    let with = |monitored: bool| runs.iter().filter(move |(_, rec)| rec.monitored == monitored);
    let ordered = with(false).chain(with(true));
    ordered.flat_map(|&(label, rec)| rec.robots.iter().enumerate().map(move |(i, robot)| (label, rec, i, robot)))
}

/// What a legend calls a robot's curve.
fn curve_name(label: &str, recording: &Recording, robot: &RobotTrack) -> String {
    let name = match (label.is_empty(), recording.robots.len() > 1) {
        (true, _) => robot.name.clone(),
        (false, true) => format!("{} · {label}", robot.name),
        (false, false) => label.to_owned(),
    };
    plain(&name)
}

/// Plotly reads a little HTML in texts; names have none.
fn plain(text: &str) -> String {
    let short: String =
        if text.chars().count() > 60 { text.chars().take(59).chain(['…']).collect() } else { text.into() };
    super::tables::escape(&short)
}
