//! The report is one well-formed, offline page for any names; the summary fits its width.

use crate::report_demo;
use elbowroom_report::{HtmlReport, TextSummary, summary, write_html};
use elbowroom_sim::{Collision, RecordedRegionKind, Recording};
use serde_json::Value;

use crate::page_data::block;

const HOSTILE: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\"'\u{2028}\u{1b}[31m";

fn page(on: &Recording, off: &Recording) -> String {
    let mut out = Vec::new();
    write_html(&mut out, &report_demo::scene(), &[("monitor on", on), ("monitor off", off)]).unwrap();
    String::from_utf8(out).unwrap()
}

/// The part of the page below the scene: regions, plots, tables.
fn below_scene(html: &str) -> &str {
    html.split_once("id=\"distances\"").unwrap().1
}

/// The result above the scene.
fn result(html: &str) -> &str {
    let to = html.find("id=\"stage\"").unwrap();
    &html[html.find("<main>").unwrap()..to]
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
    assert_eq!(
        markup.matches("<script").count(),
        6,
        "three blocks of data, two of libraries, and the scripts of the page"
    );
    assert!(html.len() < 1_300_000, "{} bytes", html.len());
}

#[test]
fn names_are_text_and_data_is_json() {
    let mut on = report_demo::recording(true, 500, HOSTILE);
    on.cell = HOSTILE.into();
    on.robots[0].name = HOSTILE.into();
    let html = page(&on, &report_demo::recording(false, 500, HOSTILE));
    let markup = markup(&html);
    assert!(!markup.contains("<img") && !markup.contains("alert(1)</script>"));
    assert_eq!(markup.matches("<script").count(), 6);
    assert_eq!(block(&html, "scene-data")["regions"][0]["name"], HOSTILE);
    let names = block(&html, "plot-data").to_string();
    assert!(names.contains("&lt;img") && !names.contains("<img"), "plotly reads markup in names");
}

/// plotly.js ignores attributes that it does not know.
#[test]
fn plots_use_attributes_of_plotly_alone() {
    const KNOWN: &str = "anchor autorange automargin b cliponaxis color connectgaps dash data domain fill fillcolor \
        hoverinfo hovermode hovertemplate hovertext l layout legend legendgroup line margin marker mode name opacity \
        orientation r range rangemode scaleanchor scaleratio shape shapes showgrid showlegend showticklabels size \
        symbol t text textposition ticktext tickvals time title type width x xaxis y yanchor yaxis yaxis2 yaxis3 \
        x0 x1 xref y0 y1 yref zeroline";
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
    assert!(html.len() < 2_000_000, "{} bytes", html.len());
    for figure in block(&html, "plot-data").as_array().unwrap() {
        for trace in figure["data"].as_array().unwrap() {
            assert!(trace["x"].as_array().unwrap().len() <= 2000, "{}", trace["name"]);
        }
    }
    let frames = block(&html, "scene-data")["runs"][0]["frames"].as_u64().unwrap();
    assert!((1500..=1700).contains(&frames), "{frames}");
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

/// A holder that was inside has not entered a forbidden place: 0 mm and "no" would be a contradiction.
#[test]
fn a_region_whose_holder_was_inside_is_granted() {
    let mut run = report_demo::recording(true, 2000, "column");
    let region = &mut run.regions[0];
    (region.kind, region.entered, region.min_distance_m) = (RecordedRegionKind::Exchange, false, Some(0.0));
    let line = |run: &Recording| {
        let text = summary(run, 80, false);
        text.lines()
            .find(|line| line.contains("exchange"))
            .map(|line| line.split_whitespace().nth(4).unwrap().to_owned())
    };
    assert_eq!(line(&run).as_deref(), Some("granted"), "{}", summary(&run, 80, false));
    run.regions[0].min_distance_m = Some(0.01);
    assert_eq!(line(&run).as_deref(), Some("no"));
    run.regions[0].entered = true;
    assert_eq!(line(&run).as_deref(), Some("YES"));
}

/// The text for what a robot waits for is never cut, and a file contains no cut text. A collision comes before later
/// events.
#[test]
fn the_summary_of_a_file_is_whole_and_tells_collisions_first() {
    let mut run = report_demo::recording(true, 2000, &"a very long name ".repeat(8));
    let why = "the holder leaves it: its program is over in the region or its warning zone, and must end beyond it";
    run.robots[0].ending.release = Some(why.to_owned());
    run.robots[0].collisions.push(Collision { t_s: 0.5, a: "fore".into(), b: "table".into() });
    for width in [60, 80, 120] {
        let narrow = summary(&run, width, false);
        let words = narrow.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(&format!("continues when {why}")), "{narrow}");
        assert!(narrow.find("collision at").unwrap() < narrow.find("continues when").unwrap(), "{narrow}");
        assert!(narrow.lines().all(|line| line.chars().count() <= width));
    }
    let cut = |text: &str| text.lines().filter(|line| line.ends_with('…')).count();
    assert_eq!(cut(&TextSummary::new(&run).whole(true).to_string()), 0);
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

/// Without the monitor the robots are not held back, and "free" alone would hide a collision.
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
    assert_eq!(shown["reasons"], serde_json::json!(["free", "fore hit table at 3.100 s"]), "in order of time");
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
        governed_by: None,
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

/// The first words of the page: the result of the robot, with place, cause, duration, and what would release it.
#[test]
fn the_result_comes_first_and_names_what_governs() {
    let mut run = report_demo::recording(true, 3000, "column");
    let stop = run.robots[0].stops[0].clone();
    run.robots[0].ending = elbowroom_sim::RobotEnding {
        outcome: elbowroom_sim::Outcome::Stopped,
        stopped_at_s: Some(stop.from_s),
        by: stop.by.clone(),
        part: stop.part.clone(),
        part_kind: None,
        point: stop.point,
        release: Some("the program moves away".into()),
    };
    let html = page(&run, &report_demo::recording(false, 3000, "column"));
    let first = result(&html);
    let stood = format!("it stood still for {:.2} s until the end of the run", run.duration_s - stop.from_s);
    for part in ["ns16 stopped at", "before the forbidden region column", "closest: tcp at (0.900, ", &stood] {
        assert!(first.contains(part), "{part} in\n{first}");
    }
    assert!(first.contains("continues when the program moves away."), "{first}");
    let collided = "ns16 collided: fore hit table at 3.100 s";
    assert!(first.contains(collided) && first.contains("The forbidden region column was entered: ns16 at "), "{first}");
    // The table of the regions: colour, kind, smallest distance, entered, and the values without the monitor.
    let regions = below_scene(&html);
    assert!(regions.contains("<i class=\"chip\" style=\"background:#9a4fd6\"></i>column"), "{regions}");
    assert!(regions.contains("without monitor") && regions.contains("0.00 mm, entered"), "{regions}");

    // A robot that continued: what had stopped it.
    run.robots[0].finished = true;
    run.robots[0].stops[0].to_s = stop.from_s + 0.5;
    let html = page(&run, &run);
    let text = "before, the monitor had stopped it for 0.50 s at";
    assert!(result(&html).contains(text) && result(&html).contains("(closest: tcp)"), "{}", result(&html));
    assert!(summary(&run, 120, false).contains("before column, closest tcp"), "{}", summary(&run, 120, false));
    // A robot that was slowed down, and a robot that was not.
    run.robots[0].stops.clear();
    run.robots[0].samples.truncate(1400);
    let governed = run.robots[0].samples.iter().filter(|s| s.region.is_some());
    let least = governed.map(|s| s.speed_override).fold(1.0, f64::min);
    assert!(least > 0.011 && least < 0.9, "{least}");
    let slowed = format!("slowed down to {:.1} % at 2.", 1e2 * least);
    assert!(result(&page(&run, &run)).contains(&slowed), "{slowed}: {}", result(&page(&run, &run)));
    for sample in &mut run.robots[0].samples {
        (sample.region, sample.speed_override) = (None, 1.0);
    }
    assert!(result(&page(&run, &run)).contains("no region slowed it down"));
}

/// One colour per region: in the table, in every plot, and in the scene.
#[test]
fn a_region_has_one_colour_everywhere() {
    let (on, off) = (report_demo::recording(true, 3000, "column"), report_demo::recording(false, 3000, "column"));
    let html = page(&on, &off);
    let regions = block(&html, "scene-data")["regions"].clone();
    for (name, color) in [("column", "#9a4fd6"), ("drone", "#1f9d55")] {
        let of_scene = regions.as_array().unwrap().iter().find(|r| r["name"] == name).unwrap();
        assert_eq!(of_scene["color"], color);
        assert!(below_scene(&html).contains(&format!("background:{color}\"></i>{name}")));
        let mut curves = 0;
        for figure in block(&html, "plot-data").as_array().unwrap() {
            for trace in figure["data"].as_array().unwrap() {
                if trace["name"].as_str().is_some_and(|n| n.contains(name)) {
                    let drawn = trace["line"]["color"].as_str().or(trace["marker"]["color"].as_str());
                    assert_eq!(drawn, Some(color), "{trace}");
                    curves += 1;
                }
            }
        }
        assert!(curves > 1, "{name}: {curves} curves");
    }
}

/// The distances of every region over time: at a stop the monitor's distance.
///
/// Dotted curves show the planned motion, which may be given without a second run in the page.
#[test]
fn distances_of_regions_are_drawn_with_and_without_the_monitor() {
    let (on, off) = (report_demo::recording(true, 3000, "column"), report_demo::recording(false, 3000, "column"));
    let (scene, runs) = (report_demo::scene(), [("monitor on", &on)]);
    let html = |report: HtmlReport<'_>| {
        let mut out = Vec::new();
        report.write(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    };
    let figure = |html: &str| block(html, "plot-data")[0].clone();
    let alone = figure(&html(HtmlReport::new(&scene, &runs)));
    let both = html(HtmlReport::new(&scene, &runs).planned(&off));
    assert_eq!(block(&both, "scene-data")["runs"].as_array().unwrap().len(), 1);
    let both = figure(&both);
    let curves = |figure: &Value, dash: Option<&str>| -> Vec<Vec<f64>> {
        let traces = figure["data"].as_array().unwrap().iter();
        let mine = traces
            .filter(|t| t["mode"] == "lines" && t["line"]["dash"].as_str() == dash && t["hovertemplate"].is_string());
        mine.map(|t| t["y"].as_array().unwrap().iter().filter_map(Value::as_f64).collect()).collect()
    };
    assert_eq!((curves(&alone, None).len(), curves(&alone, Some("dot")).len()), (2, 0));
    let (with, without) = (curves(&both, None), curves(&both, Some("dot")));
    assert_eq!((with.len(), without.len()), (2, 2));
    let least = |curve: &[f64]| curve.iter().copied().fold(f64::INFINITY, f64::min);
    let stop = &on.robots[0].stops[0];
    assert!((least(&with[0]) - 1e3 * on.regions[0].min_distance_m.unwrap()).abs() < 0.01 && least(&without[0]) == 0.0);
    let marks: Vec<&Value> = both["data"].as_array().unwrap().iter().filter(|t| t["mode"] == "markers").collect();
    assert_eq!(marks.len(), 1);
    assert!((marks[0]["x"][0].as_f64().unwrap() - stop.from_s).abs() < 1e-6);
    assert_eq!(both["layout"]["shapes"].as_array().unwrap().len(), 1, "the time of the stop is shaded");
    // A region that is off has a gap.
    assert!(with[1].len() < with[0].len() && !with[1].is_empty());
}
