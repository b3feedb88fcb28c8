//! Growth of times and memory with triangles, obstacles, robots, regions and rows, measured, fitted and drawn: the figures
//! of `docs/measurements/growth.md`.

mod pictures;
mod table;

use std::path::Path;

use pictures::PICTURES;
use table::Table;
use xtask::shell;

/// Package and name of each bench that prints tables of growth.
const BENCHES: [(&str, &str); 5] = [
    ("elbowroom-proximity", "scaling"),
    ("elbowroom-validity", "growth"),
    ("elbowroom-query", "growth"),
    ("elbowroom-monitor", "growth"),
    ("elbowroom-planner", "growth"),
];

/// Runs the benches, prints their tables with the exponent of each column and, with a folder, draws them.
pub fn run(root: &Path, out: Option<&Path>) -> Result<(), String> {
    let mut tables = Vec::new();
    for (package, bench) in BENCHES {
        let text = shell::output(root, "cargo", &["bench", "--quiet", "-p", package, "--bench", bench])?;
        print!("{text}");
        let found = Table::parse_all(&text)?;
        for table in &found {
            println!("\n{}", table.exponents());
        }
        tables.extend(found);
    }
    let Some(out) = out else { return Ok(()) };
    for picture in &PICTURES {
        let path = out.join(picture.file);
        std::fs::write(&path, picture.plot(&tables)?.svg()).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("wrote {}", path.display());
    }
    Ok(())
}
