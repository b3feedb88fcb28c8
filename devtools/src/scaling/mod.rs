//! Growth of a mesh's cost with its triangles, measured and drawn: the figures of `docs/measurements/benchmarks.md`.

use std::path::Path;

use crate::figures::svg::{Axis, Curve, Dash, Plot};
use xtask::shell;

/// Columns of the bench's table.
const TRIANGLES: usize = 0;
const BUILD_MS: usize = 1;
const NEAR_US: usize = 3;
const TOUCH_US: usize = 4;
const WITHIN_US: usize = 5;
const DISTANCE_US: usize = 6;

/// Runs the bench, prints its table and, with a folder, draws it.
pub fn run(root: &Path, out: Option<&Path>) -> Result<(), String> {
    let bench = ["bench", "--quiet", "-p", "elbowroom-proximity", "--bench", "scaling"];
    let text = shell::output(root, "cargo", &bench)?;
    print!("{text}");
    let Some(out) = out else { return Ok(()) };
    let rows = text.lines().skip(1).map(row).collect::<Result<Vec<_>, _>>()?;
    for (name, plot) in [("scaling-build.svg", build(&rows)), ("scaling-query.svg", query(&rows))] {
        let path = out.join(name);
        std::fs::write(&path, plot.svg()).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("wrote {}", path.display());
    }
    Ok(())
}

fn row(line: &str) -> Result<Vec<f64>, String> {
    let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
    match numbers {
        Ok(row) if row.len() == 7 => Ok(row),
        _ => Err(format!("the bench printed a row that is not seven numbers: {line:?}")),
    }
}

fn curve(rows: &[Vec<f64>], label: &str, colour: usize, column: usize) -> Curve {
    let point = |row: &Vec<f64>| (row[TRIANGLES].log10(), row[column].log10());
    Curve { label: label.to_owned(), colour, dash: Dash::Solid, points: rows.iter().map(point).collect() }
}

fn triangles() -> Axis {
    Axis { title: "triangles, power of ten", from: 2.5, to: 6.5, step: 0.5 }
}

fn build(rows: &[Vec<f64>]) -> Plot {
    let y = Axis { title: "milliseconds, power of ten", from: -1.0, to: 4.0, step: 1.0 };
    let curves = vec![curve(rows, "build, with all checks", 0, BUILD_MS)];
    Plot { title: "Time to build", x: triangles(), y, curves }
}

fn query(rows: &[Vec<f64>]) -> Plot {
    let y = Axis { title: "microseconds, power of ten", from: -0.5, to: 3.0, step: 0.5 };
    let curves = vec![
        curve(rows, "collide, near", 0, NEAR_US),
        curve(rows, "collide, touching", 1, TOUCH_US),
        curve(rows, "within 5 %", 2, WITHIN_US),
        curve(rows, "distance", 3, DISTANCE_US),
    ];
    Plot { title: "Time of a query", x: triangles(), y, curves }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_seven_numbers() {
        assert_eq!(row("  960  0.39  47.3  1.86  0.79  4.16  10.52").map(|r| r[DISTANCE_US]), Ok(10.52));
        assert!(row("triangles").is_err() && row("1 2 3").is_err());
    }
}
