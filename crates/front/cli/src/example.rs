//! The built-in examples, and the command without arguments.

use std::path::{Path, PathBuf};

use elbowroom::cell::Cell;
use elbowroom::sim::RunOptions;
use include_dir::{Dir, include_dir};

use crate::args::ExampleArgs;
use crate::output::{ExitStatus, Failure, cannot_write, myself, note, print, summary};
use crate::output_file::write_bytes;
use crate::run::write_files;
use crate::simulation::Simulation;

static EXAMPLES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/built_in");
/// Default output folder.
const OUT: &str = "elbowroom-out";

/// Runs the cell of figure 12 of Romanelli 2011 with the monitor on and off.
pub(crate) fn figure_12() -> Result<ExitStatus, Failure> {
    let out = PathBuf::from(OUT);
    extract(&out)?;
    let dir = out.join("figure12");
    let file = dir.join("cell.toml");
    let cell = Cell::load(&file)?;
    let simulation = Simulation::of(&cell);
    simulation.warn_of_overruns()?;
    let on = simulation.run(&RunOptions::default())?;
    let off = simulation.run(&RunOptions { apply_override: false, ..RunOptions::default() })?;
    on.notes.iter().for_each(note);
    write_files(&dir, &cell, &on.recording, Some(&off.recording), true)?;
    print(&summary(&on.recording))?;
    let passes =
        if off.recording.regions.iter().any(|r| r.entered) { "passes through it" } else { "stays out as well" };
    let report = dir.join("report.html");
    print(&format!(
        "\nWithout the monitor the same program {passes}; the report shows both.\n\
         Report:  {}   (open it in a browser)\n\
         Cell:    {}\n\
         Change the cell, then: {} run {1} --out {}\n",
        report.display(),
        file.display(),
        myself(),
        dir.display(),
    ))?;
    Ok(if on.has_violation() { ExitStatus::NegativeResult } else { ExitStatus::Success })
}

/// Lists the examples or copies them.
pub(crate) fn copy(args: &ExampleArgs) -> Result<ExitStatus, Failure> {
    if let Some(dir) = &args.dir {
        extract(dir)?;
        print(&format!(
            "Copied to {}; try: {} run {}\n",
            dir.display(),
            myself(),
            dir.join("figure12/cell.toml").display()
        ))?;
        return Ok(ExitStatus::Success);
    }
    for example in cells() {
        let text = example.get_file(example.path().join("cell.toml")).and_then(|f| f.contents_utf8()).unwrap_or("");
        let first = text.lines().next().unwrap_or("").trim_start_matches(['#', ' ']);
        print(&format!("{:14} {first}\n", example.path().display()))?;
    }
    print(&format!("\n{} example DIR copies them.\n", myself()))?;
    Ok(ExitStatus::Success)
}

fn cells() -> impl Iterator<Item = &'static Dir<'static>> {
    EXAMPLES.dirs().filter(|d| d.get_file(d.path().join("cell.toml")).is_some())
}

/// Writes the examples; existing files that differ belong to the user and are kept.
fn extract(to: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(to).map_err(cannot_write(to))?;
    let mut dirs = vec![&EXAMPLES];
    while let Some(dir) = dirs.pop() {
        for file in dir.files() {
            let path = to.join(file.path());
            if let Some(parent) = path.parent() {
                std::fs::create_dir_all(parent).map_err(cannot_write(parent))?;
            }
            match std::fs::read(&path) {
                Ok(there) if there == file.contents() => {}
                Ok(_) => note(format!("{}: kept, it is not the example's any more", path.display())),
                Err(_) => write_bytes(&path, file.contents())?,
            }
        }
        dirs.extend(dir.dirs());
    }
    Ok(())
}
