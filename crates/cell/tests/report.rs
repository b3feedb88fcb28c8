//! The report is one well-formed, offline page whatever the names; the summary fits its screen.

use elbowroom_cell::Recording;
use elbowroom_cell::report::{Summary, summary, write_html};
use serde_json::Value;

mod report_demo;

const HOSTILE: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\"'\u{2028}\u{1b}[31m";

fn page(on: &Recording, off: &Recording) -> String {
    let mut out = Vec::new();
    write_html(&mut out, &report_demo::scene(), &[("control on", on), ("control off", off)]).unwrap();
    String::from_utf8(out).unwrap()
}

/// The text of the JSON block with this id.
fn block(html: &str, id: &str) -> Value {
    let open = format!("<script type=\"application/json\" id=\"{id}\">");
    let from = html.find(&open).unwrap() + open.len();
    let to = from + html[from..].find("</script>").unwrap();
    serde_json::from_str(&html[from..to]).unwrap()
}

/// The page without the text of its scripts: what the HTML parser sees as markup.
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
fn the_page_fetches_nothing() {
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
    write_html(&mut out, &elbowroom_cell::report::ReportScene::new(), &[]).unwrap();
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
fn the_summary_says_where_and_why_and_colours_only_terminals() {
    let run = report_demo::recording(true, 3000, "column");
    let text = Summary::new(&run).file("report", "out/report.html").to_string();
    for part in ["ns16", "before column", "forbidden", "out/report.html", "median 2.9 µs", "Not a certified", "▁"] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    assert!(summary(&run, 80, true).contains("\u{1b}["));
}
