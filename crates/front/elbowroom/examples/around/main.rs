//! A camera above a KR125: obstacles are detected, become blocked cells of joint space, and the arm moves around them.
//!
//! `cargo run --release -p elbowroom --example around` writes `elbowroom-out/around/report.html`, frames and slices of
//! the map as PNG, and prints a summary. The whole pipeline runs: images are rendered, encoded as PNG, decoded, tracked
//! and put into the map, and paths are planned and timed. Only the ground-truth check knows the true poses.
#![expect(clippy::print_stdout, reason = "a program for people")]

mod ground_truth;
mod obstacles;
mod report_images;
mod run;
mod station;

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use elbowroom::perception::{ExecutorState, HoldReason};
use elbowroom::report::{stage_table, write_perception_html};

use station::Failure;

/// Duration of the run, seconds.
const END_S: f64 = 37.0;

fn main() -> Result<(), Failure> {
    let out = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "elbowroom-out/around".into()));
    let mut station = station::build()?;
    let mut images = report_images::ReportImages::new(out.join("frames"))?;
    let obstacles = obstacles::obstacles();
    let mut record = run::run(&mut station, &obstacles, END_S, &mut images)?;
    record.log.images = images.images;
    record.log.facts = facts(&record, &station);
    let page = out.join("report.html");
    write_perception_html(BufWriter::new(File::create(&page)?), &station.arm, &record.log)?;
    println!("{}\n", record.log.title);
    record.log.facts.iter().for_each(|line| println!("  {line}"));
    println!("\n{}\nReport:  {}   (open it in a browser)", stage_table(&record.log), page.display());
    if record.hits.is_empty() { Ok(()) } else { Err(format!("a collision occurred: {:?}", record.hits.first()).into()) }
}

fn facts(record: &run::RunResult, station: &station::Station) -> Vec<String> {
    let log = &record.log;
    let accepted = || log.frames.iter().filter_map(|f| f.result.as_ref().ok());
    let changed = accepted().filter(|(_, o)| o.in_motion).count();
    let from_rest =
        accepted().filter(|(_, o)| !o.in_motion && o.kind == Some(elbowroom::planner::ReplanKind::Replanned)).count();
    let seconds = |is: &dyn Fn(&ExecutorState) -> bool| {
        log.ticks.iter().filter(|tick| is(&tick.step.state)).count() as f64 * log.tick_s
    };
    let no_image = |d: &ExecutorState| matches!(d.reason(), Some(HoldReason::NoRecentImage { .. }));
    let (least, when) = log.least_distance().unwrap_or((f64::NAN, f64::NAN));
    let cells = station.pipeline.map().grid().cells();
    let settings = station.pipeline.tracker().settings();
    vec![
        format!(
            "{:.0} s, {} frames of 640 x 480, {} refused; map of {:.2} million cells of {}°",
            log.ticks.last().map_or(0.0, |t| t.t_s),
            log.frames.len(),
            log.frames.iter().filter(|f| f.result.is_err()).count(),
            cells as f64 * 1e-6,
            station::STEP_DEG
        ),
        format!(
            "{} stations reached; {changed} changes of path in motion, {from_rest} paths from rest",
            record.arrivals
        ),
        format!(
            "slowed for {:.2} s, waited for {:.2} s, of that {:.2} s without an image",
            seconds(&|d| matches!(d, ExecutorState::Slowing(_))),
            seconds(&|d| matches!(d, ExecutorState::Waiting(_))),
            seconds(&no_image)
        ),
        match record.hits.first() {
            None => "no collision at any instant (checked continuously, against the true solids)".into(),
            Some((t, what)) => format!("COLLISION at {t:.3} s: {what}"),
        },
        format!("least true distance {:.0} mm, at {when:.2} s", least * 1e3),
        format!(
            "prisms contained the true obstacle until the next frame in {} of {} frames; dilated by {:.0} mm: \
             15 mm and 0.8 m/s × {:.0} ms",
            record.coverage.contained,
            record.coverage.visible,
            settings.uncertainty_m * 1e3,
            (station::PERIOD_S + station::LATENCY_S) * 1e3
        ),
    ]
}
