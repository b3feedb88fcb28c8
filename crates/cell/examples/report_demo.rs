//! Writes a report of a made-up run, to look at: `cargo run -p elbowroom-cell --example report_demo [FILE]`.

use std::fs::File;
use std::io::BufWriter;

use elbowroom_cell::report::{Summary, write_html};

#[path = "../tests/report_demo/mod.rs"]
mod report_demo;

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "target/report_demo.html".into());
    let (on, off) = (report_demo::recording(true, 3000, "column"), report_demo::recording(false, 3000, "column"));
    let out = BufWriter::new(File::create(&path)?);
    write_html(out, &report_demo::scene(), &[("control on", &on), ("control off", &off)])?;
    for run in [&on, &off] {
        eprint!("{}", Summary::new(run).file("report", &path));
    }
    Ok(())
}
