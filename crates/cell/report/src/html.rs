//! The HTML page: one self-contained file.

use std::fmt::Write as _;
use std::io::{self, Write};

use elbowroom_sim::Recording;
use serde_json::{Value, json};

use crate::packing::deflated;
use crate::plots::Drawing;
use crate::results::{Grade, ResultLine, results};
use crate::scene::ReportScene;
use crate::scene_data::PageData;
use crate::summary::duration;
use crate::tables::{self, escape};
use crate::{page_template, plots, scene_data, shared_assets};

const PLOTLY: &str = include_str!("../assets/plotly/plotly-basic.min.js");
const PAGE: &str = include_str!("../assets/report/page.html");
/// Scripts in order: each uses earlier ones.
const SCRIPTS: [&str; 13] = [
    shared_assets::DOM,
    shared_assets::INFLATE,
    shared_assets::PACKING,
    include_str!("../assets/report/data.js"),
    shared_assets::KINEMATICS,
    include_str!("../assets/report/distance.js"),
    include_str!("../assets/report/cell.js"),
    include_str!("../assets/report/figures.js"),
    shared_assets::STAGE,
    include_str!("../assets/report/perceived.js"),
    include_str!("../assets/report/scene.js"),
    include_str!("../assets/report/panel.js"),
    include_str!("../assets/report/player.js"),
];

/// Contents of the page.
pub(super) struct PageContent<'a> {
    /// Title, plain text.
    pub title: &'a str,
    /// Results of the run: above the scene, HTML.
    pub result: String,
    /// Distances of the robots to the regions: below the scene, HTML.
    pub regions: String,
    /// Below the tables, HTML.
    pub facts: String,
    /// Options of the run selector, HTML.
    pub options: String,
    pub figures: &'a [plots::Figure],
    /// Below the figures, HTML.
    pub tables: String,
    pub data: PageData,
}

/// A page of one or several runs of the same cell, each with a label (`"monitor on"`).
#[derive(Debug, Clone, Copy)]
pub struct HtmlReport<'a> {
    scene: &'a ReportScene,
    runs: &'a [(&'a str, &'a Recording)],
    planned: Option<&'a Recording>,
}

impl<'a> HtmlReport<'a> {
    /// Creates a page of these runs.
    ///
    /// The curves of all runs share their plots. The 3-D scene shows the selected run, initially the first one, and the
    /// outlines of the regions of the first run. A run without the monitor serves as the planned one.
    pub fn new(scene: &'a ReportScene, runs: &'a [(&'a str, &'a Recording)]) -> Self {
        Self { scene, runs, planned: runs.iter().map(|(_, rec)| *rec).find(|rec| !rec.monitored) }
    }

    /// Adds the planned motion, a run without the monitor. Only its distances are shown, beside the distances of the
    /// first run.
    #[must_use]
    pub fn planned(mut self, run: &'a Recording) -> Self {
        self.planned = Some(run);
        self
    }

    /// Writes the page.
    ///
    /// # Errors
    ///
    /// Errors of `out`.
    pub fn write(&self, out: impl Write) -> io::Result<()> {
        let Self { scene, runs, planned } = *self;
        let content = PageContent {
            title: match runs.first() {
                Some((_, recording)) if scene.title.is_empty() => &recording.cell,
                Some(_) => &scene.title,
                None => "no run",
            },
            result: result_section(runs),
            regions: region_section(runs, planned),
            facts: facts(runs),
            options: options(runs),
            figures: &plots::all(scene, runs, planned),
            tables: run_tables(runs),
            data: scene_data::data(scene, runs),
        };
        write_page(out, &content)
    }
}

/// [`HtmlReport::write`] without a planned run.
///
/// # Errors
///
/// Errors of `out`.
pub fn write_html(out: impl Write, scene: &ReportScene, runs: &[(&str, &Recording)]) -> io::Result<()> {
    HtmlReport::new(scene, runs).write(out)
}

/// Fills in the page template.
pub(super) fn write_page(out: impl Write, content: &PageContent<'_>) -> io::Result<()> {
    let plot_data = Value::from(content.figures.iter().map(figure_data).collect::<Vec<_>>());
    page_template::fill(out, PAGE, |part, out| {
        match part {
            "title" => out.write_all(escape(content.title).as_bytes())?,
            "style" => out.write_all(shared_assets::STYLE.as_bytes())?,
            "result" => out.write_all(content.result.as_bytes())?,
            "regions" => out.write_all(content.regions.as_bytes())?,
            "facts" => out.write_all(content.facts.as_bytes())?,
            "options" => out.write_all(content.options.as_bytes())?,
            "figures" => out.write_all(placeholders(content.figures).as_bytes())?,
            "tables" => out.write_all(content.tables.as_bytes())?,
            "plot_data" => out.write_all(deflated(plot_data.to_string().as_bytes())?.as_bytes())?,
            "scene_data" => out.write_all(deflated(content.data.json.to_string().as_bytes())?.as_bytes())?,
            "arrays" => out.write_all(deflated(&content.data.arrays)?.as_bytes())?,
            "plotly" => out.write_all(deflated(PLOTLY.as_bytes())?.as_bytes())?,
            "three" => out.write_all(deflated(shared_assets::THREE.as_bytes())?.as_bytes())?,
            "scripts" => SCRIPTS.iter().try_for_each(|s| out.write_all(s.as_bytes()))?,
            _ => return Ok(false),
        }
        Ok(true)
    })
}

/// A sentence per robot and per region that was entered, for each run.
fn result_section(runs: &[(&str, &Recording)]) -> String {
    let mut out = String::new();
    for (i, (label, rec)) in runs.iter().enumerate() {
        let mut sentences = String::new();
        for ResultLine { grade, text } in results(rec) {
            let (class, mark) = match grade {
                Grade::Good => ("good", "✓"),
                Grade::Stopped => ("warn", "■"),
                Grade::Bad => ("bad", "✕"),
            };
            let mark = format!("<span class=\"mark\" aria-hidden=\"true\">{mark}</span>");
            let _ = write!(sentences, "<p class=\"result {class}\">{mark}<span>{}</span></p>", escape(&text));
        }
        for d in &rec.deadlocks {
            let (robots, regions) = (d.robots.join(", "), d.regions.join(", "));
            let line = format!("Deadlock since {:.2} s: {robots} wait for each other at {regions}.", d.t_s);
            let _ = write!(sentences, "<p class=\"result bad\"><span>{}</span></p>", escape(&line));
        }
        let heading = if runs.len() > 1 { format!("Result, {label}") } else { "Result".to_owned() };
        let _ = writeln!(
            out,
            "<section class=\"card wide\" data-run=\"{i}\" aria-label=\"{0}\"><h2>{0}</h2>\
             <div class=\"results\" tabindex=\"0\">{sentences}</div></section>",
            escape(&heading)
        );
    }
    out
}

/// The table of the regions, for each run.
fn region_section(runs: &[(&str, &Recording)], planned: Option<&Recording>) -> String {
    let with_regions = runs.iter().enumerate().filter(|(_, (_, rec))| !rec.regions.is_empty());
    let tables = with_regions.map(|(i, (label, rec))| {
        let heading = if runs.len() > 1 { format!("Regions, {label}") } else { "Regions".to_owned() };
        format!(
            "<section class=\"card wide\" data-run=\"{i}\"><h2>{}</h2>\
             <div class=\"scroll\" tabindex=\"0\">{}</div></section>\n",
            escape(&heading),
            tables::regions(rec, planned)
        )
    });
    tables.collect()
}

/// Data that the page draws; null for a picture.
fn figure_data(figure: &plots::Figure) -> Value {
    match &figure.drawing {
        Drawing::Plot(plot) => json!({ "data": plot.traces, "layout": plot.layout, "time": figure.over_time }),
        Drawing::Picture(_) => Value::Null,
    }
}

fn placeholders(figures: &[plots::Figure]) -> String {
    let one = |(i, f): (usize, &plots::Figure)| {
        let run = f.run.map_or(String::new(), |r| format!(" data-run=\"{r}\""));
        let class = if f.wide { "card wide" } else { "card" };
        let (title, note) = (escape(&f.title), escape(&f.note));
        let label = format!("role=\"img\" aria-label=\"{title}\"");
        let content = match &f.drawing {
            Drawing::Plot(_) => {
                format!("<div class=\"plot\" {label} data-figure=\"{i}\" style=\"height:{}px\"></div>", f.height)
            }
            Drawing::Picture(svg) => format!("<div class=\"picture\" {label}>{svg}</div>"),
        };
        format!("<section class=\"{class}\"{run}><h2>{title}</h2><p class=\"note\">{note}</p>{content}</section>\n")
    };
    figures.iter().enumerate().map(one).collect()
}

fn facts(runs: &[(&str, &Recording)]) -> String {
    let mut out = String::new();
    for (label, rec) in runs {
        let monitor = if rec.monitored { "monitor on" } else { "monitor off" };
        // A label with the same meaning is not repeated.
        let state = if *label == monitor { monitor.to_owned() } else { format!("{label}: {monitor}") };
        let t = rec.tick_ns;
        let line = format!(
            "{state} · {:.2} s simulated · tick {} ms, took {} median, {} p99, {} max ({} ticks)",
            rec.duration_s,
            1e3 * rec.tick_s,
            duration(t.p50),
            duration(t.p99),
            duration(t.max),
            t.count
        );
        let _ = write!(out, "<li>{}</li>", escape(line.trim_start_matches(": ")));
    }
    let checksum = runs.first().map_or("", |(_, r)| r.checksum.as_str());
    let list = format!("<ul class=\"facts\">{out}<li>configuration <code>{}</code></li></ul>", escape(checksum));
    format!("<section class=\"card wide\"><h2>Run</h2>{list}</section>")
}

fn options(runs: &[(&str, &Recording)]) -> String {
    let mut out = String::new();
    for (i, (label, _)) in runs.iter().enumerate() {
        let _ = write!(out, "<option value=\"{i}\">{}</option>", escape(label));
    }
    out
}

fn run_tables(runs: &[(&str, &Recording)]) -> String {
    let card = |i: usize, what: &str, label: &str, table: String| {
        let heading = if runs.len() > 1 { format!("{what}: {label}") } else { what.to_owned() };
        format!(
            "<section class=\"card wide\" data-run=\"{i}\"><h2>{}</h2><div class=\"scroll\" tabindex=\"0\">{table}</div></section>\n",
            escape(&heading)
        )
    };
    let of_run = |(i, (label, rec)): (usize, &(&str, &Recording))| {
        tables::stops(rec).map_or_else(String::new, |table| card(i, "Stops", label, table))
            + &card(i, "Robots", label, tables::robots(rec))
            + &card(i, "Events", label, tables::events(rec))
    };
    runs.iter().enumerate().map(of_run).collect()
}
