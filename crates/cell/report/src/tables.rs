//! Tables of the page, and HTML escaping.

use std::fmt::Write as _;

use elbowroom_monitor::Life;
use elbowroom_sim::{Recording, Stop};

use crate::palette;
use crate::summary::{entry, millimetres};

/// Rows of the event table; `events.csv` has all events.
const MAX_EVENTS: usize = 500;

/// Text as HTML, with all markup escaped.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(c),
        }
    }
    out
}

/// One row per robot: its outcome and the effect of the monitor.
pub fn robots(recording: &Recording) -> String {
    let names = ["robot", "outcome", "time stopped", "smallest override", "collisions"];
    let mut table = HtmlTable::new("How the programs ended", &names);
    for robot in &recording.robots {
        let outcome = crate::summary::outcome(robot, recording);
        let hits = match robot.collisions.first() {
            None => "none".into(),
            Some(c) => format!("{}: first {} with {} at {:.3} s", robot.collisions.len(), c.a, c.b, c.t_s),
        };
        let cells = [
            robot.name.clone(),
            outcome,
            format!("{:.2} s", robot.stopped_s),
            format!("{:.1} %", 100.0 * robot.min_override),
            hits,
        ];
        table.row(&cells, if robot.collisions.is_empty() { "" } else { "bad" });
    }
    table.end()
}

/// One row per region: its colour, distance and times, with the values without the monitor if they are known.
pub fn regions(recording: &Recording, planned: Option<&Recording>) -> String {
    let planned = planned.filter(|p| recording.monitored && p.regions.len() == recording.regions.len());
    let mut names = vec!["region", "kind", "warning zone", "least distance", "entered", "in warning zone"];
    if planned.is_some() {
        names.push("without monitor");
    }
    let mut table = HtmlTable::new("How close the robots came", &names);
    for (index, region) in recording.regions.iter().enumerate() {
        let life = if region.life == Life::Temporary { ", temporary" } else { "" };
        let mut cells = vec![
            chip(palette::of_region(index), &region.name),
            escape(&format!("{}{life}", region.kind.name())),
            format!("{:.0} mm", 1e3 * region.warning_m),
            millimetres(region.min_distance_m),
            entry(region).into(),
            format!("{:.2} s", region.warned_s),
        ];
        if let Some(other) = planned.map(|p| &p.regions[index]) {
            let entered = match entry(other) {
                "no" => "not entered",
                "yes" => "entered",
                other => other,
            };
            cells.push(format!("{}, {entered}", millimetres(other.min_distance_m)));
        }
        table.row_of_html(&cells, if region.is_violated() { "bad" } else { "" });
    }
    table.end()
}

/// A name with its colour.
fn chip(color: &str, name: &str) -> String {
    format!("<i class=\"chip\" style=\"background:{color}\"></i>{}", escape(name))
}

/// One row per stop of any robot.
pub fn stops(recording: &Recording) -> Option<String> {
    let names = ["robot", "from", "to", "stood", "before", "distance", "closest part", "its point (m)"];
    let mut table = HtmlTable::new("Where the monitor held a robot", &names);
    let all: Vec<(&str, &Stop)> =
        recording.robots.iter().flat_map(|r| r.stops.iter().map(|s| (r.name.as_str(), s))).collect();
    for (robot, stop) in all.iter().take(MAX_EVENTS) {
        let point = stop.point.map_or_else(|| "–".into(), |p| format!("{:.3}, {:.3}, {:.3}", p.x, p.y, p.z));
        let text = |t: &Option<String>| t.clone().unwrap_or_else(|| "–".into());
        let cells = [
            (*robot).to_owned(),
            format!("{:.3} s", stop.from_s),
            format!("{:.3} s", stop.to_s),
            format!("{:.2} s", stop.to_s - stop.from_s),
            text(&stop.by),
            millimetres(stop.distance_m),
            text(&stop.part),
            point,
        ];
        table.row(&cells, "");
    }
    (!all.is_empty()).then(|| table.end())
}

/// One row per event, the first [`MAX_EVENTS`].
pub fn events(recording: &Recording) -> String {
    let mut table = HtmlTable::new("In order of time", &["time", "robot", "region", "event"]);
    for e in recording.events.iter().take(MAX_EVENTS) {
        table.row(&[format!("{:.3} s", e.t_s), e.robot.clone(), e.region.clone(), e.event.name().into()], "");
    }
    let mut out = table.end();
    if recording.events.len() > MAX_EVENTS {
        let _ = write!(
            out,
            "<p class=\"note\">The first {MAX_EVENTS} of {}: events.csv has all.</p>",
            recording.events.len()
        );
    }
    out
}

/// A table in HTML. Each cell has the name of its column, because narrow screens show a row as a list.
struct HtmlTable<'a> {
    names: &'a [&'a str],
    html: String,
}

impl<'a> HtmlTable<'a> {
    /// Creates a table with a caption and the names of its columns.
    fn new(caption: &str, names: &'a [&'a str]) -> Self {
        let heads = names.join("</th><th scope=\"col\">");
        let html =
            format!("<table><caption>{caption}</caption><thead><tr><th scope=\"col\">{heads}</th></tr></thead><tbody>");
        Self { names, html }
    }

    /// Adds a row of plain texts, with a class.
    fn row(&mut self, cells: &[String], class: &str) {
        let cells: Vec<String> = cells.iter().map(|c| escape(c)).collect();
        self.row_of_html(&cells, class);
    }

    fn row_of_html(&mut self, cells: &[String], class: &str) {
        let _ = write!(self.html, "<tr class=\"{class}\">");
        for (name, cell) in self.names.iter().zip(cells) {
            let _ = write!(self.html, "<td data-name=\"{name}\"><div>{cell}</div></td>");
        }
        self.html.push_str("</tr>\n");
    }

    /// Completes the table and returns it.
    fn end(self) -> String {
        self.html + "</tbody></table>"
    }
}
