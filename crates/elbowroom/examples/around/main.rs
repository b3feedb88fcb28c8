//! A camera above a KR125: what enters is seen, becomes blocked cells of joint space, and the arm goes around.
//!
//! `cargo run --release -p elbowroom --example around` writes `elbowroom-out/around/report.html`, frames and slices of the
//! map as PNG, and prints a summary. Everything goes through the real path: rendered pictures are sent as PNG files,
//! decoded, looked at, tracked, turned into cells, planned around and timed; the truth is only known to a judge.
#![expect(clippy::print_stdout, reason = "a program for people")]

mod album;
mod judge;
mod run;
mod station;
mod things;

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use elbowroom::cell::report::{stage_table, write_watch_html};
use elbowroom::cell::watch::{Doing, Reason};

use station::Failure;

/// How long the run is, seconds.
const END_S: f64 = 37.0;

fn main() -> Result<(), Failure> {
    let out = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "elbowroom-out/around".into()));
    let mut station = station::build()?;
    let mut album = album::Album::new(out.join("frames"))?;
    let things = things::things();
    let mut record = run::run(&mut station, &things, END_S, &mut album)?;
    record.log.pictures = album.pictures;
    record.log.facts = facts(&record, &station);
    let page = out.join("report.html");
    write_watch_html(BufWriter::new(File::create(&page)?), &station.arm, &record.log)?;
    println!("{}\n", record.log.title);
    record.log.facts.iter().for_each(|line| println!("  {line}"));
    println!("\n{}\nReport:  {}   (open it in a browser)", stage_table(&record.log), page.display());
    if record.hits.is_empty() { Ok(()) } else { Err(format!("something was hit: {:?}", record.hits.first()).into()) }
}

fn facts(record: &run::Record, station: &station::Station) -> Vec<String> {
    let log = &record.log;
    let told = || log.frames.iter().filter_map(|f| f.told.as_ref().ok());
    let over = told().filter(|(_, o)| o.in_motion).count();
    let set_out = told().filter(|(_, o)| !o.in_motion && o.how == Some(elbowroom::planner::How::Anew)).count();
    let seconds =
        |is: &dyn Fn(&Doing) -> bool| log.ticks.iter().filter(|tick| is(&tick.step.doing)).count() as f64 * log.tick_s;
    let no_picture = |d: &Doing| matches!(d.reason(), Some(Reason::NoPicture { .. }));
    let (least, when) = log.least_distance().unwrap_or((f64::NAN, f64::NAN));
    let cells = station.watch.map().grid().cells();
    let settings = station.watch.vision().settings();
    vec![
        format!(
            "{:.0} s, {} frames of 640 x 480, {} refused; map of {:.2} million cells of {}°",
            log.ticks.last().map_or(0.0, |t| t.t_s),
            log.frames.len(),
            log.frames.iter().filter(|f| f.told.is_err()).count(),
            cells as f64 * 1e-6,
            station::STEP_DEG
        ),
        format!("{} stations reached; {over} changes of path while moving, {set_out} paths from rest", record.arrivals),
        format!(
            "slowed for {:.2} s, waited for {:.2} s, of that {:.2} s without a picture",
            seconds(&|d| matches!(d, Doing::Slowing(_))),
            seconds(&|d| matches!(d, Doing::Waiting(_))),
            seconds(&no_picture)
        ),
        match record.hits.first() {
            None => "nothing was hit at any instant (proven between ticks too, against the true solids)".into(),
            Some((t, what)) => format!("HIT at {t:.3} s: {what}"),
        },
        format!("least true distance {:.0} mm, at {when:.2} s", least * 1e3),
        format!(
            "prisms held the true thing until the next frame in {} of {} frames; grown by {:.0} mm: 15 mm and 0.8 m/s × {:.0} ms",
            record.held.1,
            record.held.0,
            settings.uncertainty_m * 1e3,
            (station::PERIOD_S + station::LATENCY_S) * 1e3
        ),
    ]
}
