//! `cargo xtask evade`: statistics of many runs with and without avoidance, with an obstacle that crosses the workspace at
//! random. Collisions are detected by continuous sweeps of the exact scene from tick to tick.
//!
//! `cargo xtask evade [RUNS] [CELL] [--noise-mm N] [--delay-ms N] [--csv FILE] [--add FILE]`
//!
//! `cargo xtask evade --robots` prints the time of a step for every robot of the data instead.
//!
//! `--add` adds the tables of a file to the cell, such as the regions of `devtools/src/evade/regions.toml`. `--csv`
//! writes a row per run: whether it hits without and with avoidance, its extra time, and the time in each state.
//!
//! Environment: `EVADE_ONLY=135,301` makes only these runs, and prints what the arm did; `EVADE_EXPLAIN=5000` searches
//! an escape with this many motions from several instants before each hit, against the true path of the obstacle.

mod comparison;
// Shared with the tests of the simulation, which make the hardest of these runs.
#[path = "../../../crates/cell/sim/tests/common/crossing.rs"]
mod crossing;
mod explain;
mod robot_steps;
mod statistics;
mod table;

use std::error::Error;
use std::path::{Path, PathBuf};

use elbowroom_cell::Cell;
use elbowroom_robot::ObjectId;
use xtask::Failure;

use statistics::Statistics;
use table::Table;

/// The cell, shared with the tests of the simulation.
const CELL: &str = "crates/cell/sim/tests/evade.toml";

/// Options of `evade`.
#[derive(Debug, PartialEq)]
struct Options {
    runs: usize,
    cell: Option<PathBuf>,
    noise_mm: Option<f64>,
    delay_ms: Option<f64>,
    add: Option<PathBuf>,
    csv: Option<PathBuf>,
}

impl Options {
    fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self { runs: 100, cell: None, noise_mm: None, delay_ms: None, add: None, csv: None };
        let (mut words, mut plain) = (words.iter(), Vec::new());
        while let Some(word) = words.next() {
            let mut value = || words.next().copied().ok_or_else(|| format!("`evade {word}` needs a value"));
            match *word {
                "--noise-mm" => options.noise_mm = Some(number(word, value()?)?),
                "--delay-ms" => options.delay_ms = Some(number(word, value()?)?),
                "--add" => options.add = Some(value()?.into()),
                "--csv" => options.csv = Some(value()?.into()),
                other if other.starts_with("--") => return Err(format!("`evade` does not know `{other}`")),
                other => plain.push(other),
            }
        }
        if let Some(runs) = plain.first() {
            options.runs = xtask::call::count("evade", runs)?;
        }
        options.cell = plain.get(1).map(PathBuf::from);
        Ok(options)
    }
}

fn number(option: &str, value: &str) -> Result<f64, String> {
    value.parse().map_err(|_| format!("`evade {option} {value}`: write a number"))
}

/// Makes the runs and prints their statistics.
pub fn run(root: &Path, words: &[&str]) -> Result<(), Failure> {
    if words == ["--robots"] {
        return robot_steps::run().map_err(|e| Failure::Check(e.to_string()));
    }
    let options = Options::parse(words).map_err(Failure::Usage)?;
    compare(root, &options).map_err(|e| Failure::Check(e.to_string()))
}

fn compare(root: &Path, options: &Options) -> Result<(), Box<dyn Error>> {
    let mut table = options.csv.as_deref().map(Table::create).transpose()?;
    let cell = load(root, options)?;
    let seen =
        cell.robots.first().and_then(|robot| robot.avoidance.as_ref()).ok_or("the first robot has no avoidance")?;
    let moves = |o: &&ObjectId| cell.moving_objects.iter().any(|m| m.object == **o);
    let object = *seen.objects.iter().find(moves).ok_or("no moving object is evaded")?;
    let free = crossing::without_obstacle(&cell)?;
    println!(
        "{}: {} robot(s), without the obstacle the program takes {:.2} s",
        cell.name,
        cell.robots.len(),
        free.duration_s
    );
    // Single runs, `EVADE_ONLY=135,301`, with the state of the robot before a collision.
    let only: Option<Vec<usize>> =
        std::env::var("EVADE_ONLY").ok().map(|o| o.split(',').filter_map(|n| n.trim().parse().ok()).collect());
    let paths = crossing::paths(&cell, object, free.duration_s, options.runs)?;
    let explain_tries: Option<usize> = std::env::var("EVADE_EXPLAIN").ok().and_then(|n| n.parse().ok());
    let mut statistics = Statistics::new(only.is_some());
    let chosen: Vec<usize> =
        only.map_or_else(|| (0..options.runs).collect(), |o| o.into_iter().filter(|n| *n < options.runs).collect());
    for some in chosen.chunks(50) {
        for run in comparison::compare(&cell, object, &paths, some)? {
            statistics.add(&cell, &run);
            if let Some(table) = &mut table {
                table.add(&run)?;
            }
            if let (Some(tries), Some(hit)) = (explain_tries, run.on.robots[0].collisions.first()) {
                explain::explain(&cell, object, &paths[run.number], &run.on, hit.t_s, tries)?;
            }
        }
        eprintln!("{}", statistics.progress());
    }
    statistics.print();
    Ok(())
}

/// Loads the cell, with the additions and changes of the options.
fn load(root: &Path, options: &Options) -> Result<Cell, Box<dyn Error>> {
    let file = options.cell.clone().unwrap_or_else(|| root.join(CELL));
    let read = |path: &Path| std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()));
    let mut text = read(&file)?;
    if let Some(add) = &options.add {
        text += &read(add)?;
    }
    let mut cell = Cell::parse(file, &text)?;
    for spec in cell.robots.iter_mut().filter_map(|robot| robot.avoidance.as_mut()) {
        spec.noise_m = options.noise_mm.map_or(spec.noise_m, |mm| 1e-3 * mm);
        spec.delay_s = options.delay_ms.map_or(spec.delay_s, |ms| 1e-3 * ms);
    }
    Ok(cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_mistakes_named() {
        let options = Options::parse(&["40", "--add", "a.toml", "--noise-mm", "5"]).unwrap();
        assert_eq!((options.runs, options.cell, options.noise_mm), (40, None, Some(5.0)));
        assert!(Options::parse(&["--noise-mm"]).unwrap_err().contains("needs a value"));
        assert!(Options::parse(&["--sound"]).is_err() && Options::parse(&["none"]).is_err());
    }
}
