//! Writes a report of a synthetic run: `cargo run -p elbowroom-report --example report_demo [FILE]`.

use std::fs::File;
use std::io::BufWriter;

use elbowroom_report::{TextSummary, write_html};

#[path = "../tests/report_demo/mod.rs"]
mod report_demo;

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "target/report_demo.html".into());
    let (on, off) = (report_demo::recording(true, 3000, "column"), report_demo::recording(false, 3000, "column"));
    let out = BufWriter::new(File::create(&path)?);
    write_html(out, &report_demo::scene(), &[("monitor on", &on), ("monitor off", &off)])?;
    for run in [&on, &off] {
        eprint!("{}", TextSummary::new(run).file("report", &path));
    }
    Ok(())
}
