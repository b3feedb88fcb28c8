//! The report is one well-formed, offline page for any names; the summary fits its width.

use elbowroom_report::{TextSummary, summary, write_html};
use elbowroom_sim::Recording;
use serde_json::Value;

mod report_demo;

const HOSTILE: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\"'\u{2028}\u{1b}[31m";

fn page(on: &Recording, off: &Recording) -> String {
    let mut out = Vec::new();
    write_html(&mut out, &report_demo::scene(), &[("monitor on", on), ("monitor off", off)]).unwrap();
    String::from_utf8(out).unwrap()
}

/// The text of the JSON block with this id.
fn block(html: &str, id: &str) -> Value {
    let open = format!("<script type=\"application/json\" id=\"{id}\">");
    let from = html.find(&open).unwrap() + open.len();
    let to = from + html[from..].find("</script>").unwrap();
    serde_json::from_str(&html[from..to]).unwrap()
}

/// The page without its scripts: the markup that the HTML parser sees.
fn markup(html: &str) -> String {
    let mut out = String::new();
    let mut rest = html;
    while let Some(from) = rest.find("<script") {
        let body = from + rest[from..].find('>').unwrap() + 1;
        out += &rest[..body];
        rest = &rest[body + rest[body..].find("</script>").unwrap()..];
    }
    out + rest
}

#[test]
fn the_page_loads_no_external_resource() {
    let html = page(&report_demo::recording(true, 500, "column"), &report_demo::recording(false, 500, "column"));
    let markup = markup(&html);
    for fetch in ["http://", "https://", "src=", "<link", "@import", "url("] {
        assert!(!markup.contains(fetch), "{fetch}");
    }
    assert_eq!(markup.matches("<script").count(), 5, "two data blocks and three scripts");
}

#[test]
fn names_are_text_and_data_is_json() {
    let mut on = report_demo::recording(true, 500, HOSTILE);
    on.cell = HOSTILE.into();
    on.robots[0].name = HOSTILE.into();
    let html = page(&on, &report_demo::recording(false, 500, HOSTILE));
    let markup = markup(&html);
    assert!(!markup.contains("<img") && !markup.contains("alert(1)</script>"));
    assert_eq!(markup.matches("<script").count(), 5);
    assert_eq!(block(&html, "scene-data")["regions"][0]["name"], HOSTILE);
    let names = block(&html, "plot-data").to_string();
    assert!(names.contains("&lt;img") && !names.contains("<img"), "plotly reads markup in names");
}

/// plotly.js ignores attributes that it does not know.
#[test]
fn plots_use_attributes_of_plotly_alone() {
    const KNOWN: &str = "anchor autorange automargin b color colorscale connectgaps dash data domain fill fillcolor \
        hoverinfo hovermode hovertemplate hovertext l layout legend legendgroup line margin marker mode name opacity \
        orientation r range rangemode scaleanchor scaleratio scene showgrid showlegend showscale showticklabels size \
        symbol t text textposition ticktext tickvals time title type width x xaxis y yanchor yaxis yaxis2 yaxis3 z zaxis \
        zeroline";
    fn check(value: &Value) {
        match value {
            Value::Array(items) => items.iter().for_each(check),
            Value::Object(fields) => {
                for (name, value) in fields {
                    assert!(KNOWN.split_whitespace().any(|known| known == name), "{name}");
                    check(value);
                }
            }
            _ => {}
        }
    }
    let html = page(&report_demo::recording(true, 500, "column"), &report_demo::recording(false, 500, "column"));
    check(&block(&html, "plot-data"));
}

#[test]
fn a_long_run_is_bounded() {
    let ticks = 60_000;
    let html = page(&report_demo::recording(true, ticks, "column"), &report_demo::recording(false, ticks, "column"));
    assert!(html.len() < 8_000_000, "{} bytes", html.len());
    for figure in block(&html, "plot-data").as_array().unwrap() {
        for trace in figure["data"].as_array().unwrap() {
            assert!(trace["x"].as_array().unwrap().len() <= 2000, "{}", trace["name"]);
        }
    }
    assert_eq!(block(&html, "scene-data")["runs"][0]["frames"], 1500);
}

#[test]
fn empty_recordings_make_a_page_too() {
    let mut empty = report_demo::recording(true, 0, "column");
    empty.regions.clear();
    let html = page(&empty, &empty);
    assert_eq!(block(&html, "scene-data")["runs"].as_array().unwrap().len(), 2);
    let mut out = Vec::new();
    write_html(&mut out, &elbowroom_report::ReportScene::new(), &[]).unwrap();
    assert!(out.ends_with(b"</html>\n"));
}

#[test]
fn the_summary_fits_its_columns() {
    for name in ["column", HOSTILE, &"very long name ".repeat(20)] {
        let mut run = report_demo::recording(true, 2000, name);
        run.cell = name.into();
        run.robots[0].name = name.into();
        for width in [40, 80, 120] {
            let text = summary(&run, width, false);
            for line in text.lines() {
                assert!(line.chars().count() <= width, "{width}: {line}");
            }
            assert!(!text.contains('\u{1b}') && text.lines().count() < 24);
        }
    }
}

#[test]
fn the_summary_names_place_and_cause_and_colours_only_terminals() {
    let run = report_demo::recording(true, 3000, "column");
    let text = TextSummary::new(&run).file("report", "out/report.html").to_string();
    for part in ["ns16", "before column", "forbidden", "out/report.html", "median 2.9 µs", "Not a certified", "▁"] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    assert!(summary(&run, 80, true).contains("\u{1b}["));
}

/// Without the monitor nothing holds a robot back, and "free" alone would hide a collision.
#[test]
fn after_a_collision_the_report_shows_it_instead_of_free() {
    let mut run = report_demo::recording(false, 3000, "column");
    let robot = &mut run.robots[0];
    let hit_s = robot.collisions[0].t_s;
    let (before, after): (Vec<_>, Vec<_>) = (0..robot.samples.len()).partition(|&i| robot.samples[i].t_s < hit_s);
    assert!(!before.is_empty() && !after.is_empty());
    for sample in &mut robot.samples {
        sample.region = None;
        sample.distance_m = None;
        sample.reason = elbowroom_monitor::OverrideReason::Free;
        sample.tcp_speed = if sample.t_s < hit_s { 0.5 } else { 0.0 };
    }
    robot.finished = false;
    let scene = |run: &Recording| block(&page(run, run), "scene-data")["runs"][0]["robots"][0].clone();
    let shown = scene(&run);
    let frames = shown["reason"].as_array().unwrap();
    let text = |frame: usize| shown["reasons"][frames[frame].as_u64().unwrap() as usize].as_str().unwrap();
    assert_eq!(text(0), "free");
    assert_eq!(text(frames.len() - 1), "fore hit table at 3.100 s");
    let outcome = shown["outcome"].as_str().unwrap();
    assert!(outcome.contains("fore hit table at 3.100 s") && !outcome.contains("free"), "{outcome}");
    let wide = summary(&run, 200, false);
    assert!(wide.contains("fore hit table at 3.100 s") && !wide.contains("free"), "{wide}");
    assert!(block(&page(&run, &run), "plot-data").to_string().contains("<br>fore hit table at 3.100 s"));

    // An avoidance state is reported, and so is a region that holds the robot back.
    let evading = elbowroom_sim::AvoidanceSample {
        state: elbowroom_avoidance::AvoiderState::Waiting,
        nearest_m: 0.0,
        size: 0.0,
        path_deviation_s: 0.1,
        rate: 0.0,
        escape: elbowroom_avoidance::EscapeState::Free,
    };
    let samples = vec![evading; run.robots[0].samples.len()];
    run.robots[0].avoidance = Some(elbowroom_sim::AvoidanceTrack { samples, ..Default::default() });
    let last = run.robots[0].samples.last_mut().unwrap();
    last.reason = elbowroom_monitor::OverrideReason::Region(elbowroom_monitor::RegionId(0));
    assert!(summary(&run, 200, false).contains("fore hit table at 3.100 s; waiting; near column"));
    run.robots[0].collisions.clear();
    assert_eq!(scene(&run)["reasons"][0], "waiting");
    // A robot that moves at the end of the run has not stopped.
    run.robots[0].samples.last_mut().unwrap().tcp_speed = 0.5;
    assert!(summary(&run, 200, false).contains("still moving at 6.00 s"));
}

#[test]
fn the_summary_names_a_deadlock() {
    let mut run = report_demo::recording(true, 400, "column");
    let robots = vec!["a".to_owned(), "b".to_owned()];
    run.deadlocks.push(elbowroom_sim::Deadlock { t_s: 1.0, robots, regions: vec!["column".into()] });
    let text = summary(&run, 80, false);
    assert!(text.contains("deadlock since") && text.contains("a, b wait for each other"), "{text}");
}
