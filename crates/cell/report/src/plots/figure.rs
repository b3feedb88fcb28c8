//! Parts shared by all plots.

use elbowroom_sim::{Recording, RobotTrack};
use serde_json::{Value, json};

use super::plot::{Plot, line, stroke, with};
use crate::tables::escape;

/// One plot of the page.
pub struct Figure {
    /// Heading; plain text.
    pub title: String,
    /// One line under the heading; plain text.
    pub note: String,
    /// True if the x axis is time: hovering moves the animation.
    pub over_time: bool,
    /// Visible only while this run is selected.
    pub run: Option<usize>,
    /// Height of a plot in CSS pixels.
    pub height: usize,
    /// True if it has the full width of the page.
    pub wide: bool,
    pub drawing: Drawing,
}

/// Contents of a figure.
pub enum Drawing {
    /// Drawn by the page.
    Plot(Plot),
    /// An SVG document.
    Picture(String),
}

impl From<Plot> for Drawing {
    fn from(plot: Plot) -> Self {
        Self::Plot(plot)
    }
}

/// Rounds to a micrometre (or a millionth), which is finer than a pixel: shorter numbers make a smaller file.
pub fn round(v: f64) -> Option<f64> {
    v.is_finite().then(|| (v * 1e6).round() / 1e6)
}

/// Horizontal bars at `row`, one per interval, with a hover text.
pub fn bars(spans: &[(f64, f64)], row: f64, width: f64, name: &str, color: &str, text: &str) -> Value {
    let x = spans.iter().flat_map(|&(from, to)| [round(from), round(to), None]).collect();
    let y = spans.iter().flat_map(|_| [Some(row), Some(row), None]).collect();
    let hover = format!("{text}<br>t = %{{x:.3f}} s<extra></extra>");
    with(line(x, y, name, stroke(color, width)), json!({ "hoverinfo": "all", "hovertemplate": hover }))
}

/// Each robot of each run: label, recording, index of the robot, robot.
///
/// Runs with control come last, so that their curves are on top.
pub fn tracks<'a>(
    runs: &'a [(&'a str, &'a Recording)],
) -> impl Iterator<Item = (&'a str, &'a Recording, usize, &'a RobotTrack)> + 'a {
    let with = |monitored: bool| runs.iter().filter(move |(_, rec)| rec.monitored == monitored);
    let ordered = with(false).chain(with(true));
    ordered.flat_map(|&(label, rec)| rec.robots.iter().enumerate().map(move |(i, robot)| (label, rec, i, robot)))
}

/// Name of a robot's curve in legends.
pub fn curve_name(label: &str, recording: &Recording, robot: &RobotTrack) -> String {
    let name = match (label.is_empty(), recording.robots.len() > 1) {
        (true, _) => robot.name.clone(),
        (false, true) => format!("{} · {label}", robot.name),
        (false, false) => label.to_owned(),
    };
    plain(&name)
}

/// Escapes a text, because Plotly interprets some HTML in texts.
pub fn plain(text: &str) -> String {
    let short: String =
        if text.chars().count() > 60 { text.chars().take(59).chain(['…']).collect() } else { text.into() };
    escape(&short)
}
