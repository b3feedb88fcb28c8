//! Tables of the page, and HTML escaping.

use std::fmt::Write as _;

use elbowroom_sim::Recording;

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

/// JSON for use inside `<script>`: no `</script`, no `<!--`, no line separators.
pub fn json_in_script(json: &str) -> String {
    json.replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

/// One row per robot: its outcome and the effect of the monitor.
pub fn robots(recording: &Recording) -> String {
    let mut out = header(&["robot", "outcome", "time stopped", "smallest override", "collisions"]);
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
        row(&mut out, &cells, if robot.collisions.is_empty() { "" } else { "bad" });
    }
    out + "</tbody></table>"
}

/// One row per region: distance and time.
pub fn regions(recording: &Recording) -> String {
    let mut out = header(&["region", "kind", "life", "warning zone", "closest", "entered", "in warning zone"]);
    for region in &recording.regions {
        let bad = region.is_violated();
        let cells = [
            region.name.clone(),
            region.kind.name().into(),
            region.life.name().into(),
            format!("{:.0} mm", 1e3 * region.warning_m),
            crate::summary::millimetres(region.min_distance_m),
            if region.entered { "yes" } else { "no" }.into(),
            format!("{:.2} s", region.warned_s),
        ];
        row(&mut out, &cells, if bad { "bad" } else { "" });
    }
    out + "</tbody></table>"
}

/// One row per event, the first [`MAX_EVENTS`].
pub fn events(recording: &Recording) -> String {
    let mut out = header(&["time", "robot", "region", "event"]);
    for e in recording.events.iter().take(MAX_EVENTS) {
        row(&mut out, &[format!("{:.3} s", e.t_s), e.robot.clone(), e.region.clone(), e.event.name().into()], "");
    }
    out.push_str("</tbody></table>");
    if recording.events.len() > MAX_EVENTS {
        let _ = write!(
            out,
            "<p class=\"note\">The first {MAX_EVENTS} of {}: events.csv has all.</p>",
            recording.events.len()
        );
    }
    out
}

fn header(names: &[&str]) -> String {
    format!("<table><thead><tr><th>{}</th></tr></thead><tbody>", names.join("</th><th>"))
}

fn row(out: &mut String, cells: &[String], class: &str) {
    let cells: Vec<String> = cells.iter().map(|c| escape(c)).collect();
    let _ = writeln!(out, "<tr class=\"{class}\"><td>{}</td></tr>", cells.join("</td><td>"));
}
