//! Cells for tests: small robots of our own.
#![allow(dead_code)]

use elbowroom_cell::{Cell, RunOptions, RunOutcome, simulate};

/// A six-axis arm of the NS16's proportions, with capsules for links.
pub const ARM: &str = r"
dh = [
  { a = 300, alpha = 90, d = 600, theta = 0, min = -180, max = 180, speed = 155 },
  { a = 700, alpha = 0, d = 0, theta = 90, min = -95, max = 95, speed = 155 },
  { a = 185, alpha = 90, d = 0, theta = 0, min = -170, max = 110, speed = 170 },
  { a = 0, alpha = -90, d = 624, theta = 0, min = -200, max = 200, speed = 360 },
  { a = 0, alpha = 90, d = 0, theta = 0, min = -120, max = 120, speed = 350 },
  { a = 0, alpha = 0, d = 120, theta = 0, min = -360, max = 360, speed = 550 },
]
links = [
  { capsule = { from = [0, 0, 0], to = [-300, -200, 0], radius = 110 } },
  { capsule = { from = [0, 0, 0], to = [-700, 0, 0], radius = 80 } },
  { capsule = { from = [0, 0, 0], to = [-185, 0, 0], radius = 80 } },
  { capsule = { from = [0, 0, 0], to = [0, 400, 0], radius = 60 } },
  [],
  { cylinder = { from = [0, 0, -40], to = [0, 0, 0], radius = 40 } },
]
";

pub const HEAD: &str = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\ntick_ms = 4\n";

/// A carriage on a rail along world x that carries a ball; `y` shifts it.
pub fn rail(name: &str, y: f64) -> String {
    format!(
        "[robot.{name}]\nbase = {{ at = [0, {y}, 0], rpy = [0, 90, 0] }}\n\
         dh = [{{ kind = \"prismatic\", min = -2000, max = 2000, speed = 1000, acceleration = 4000 }}]\n\
         links = [{{ sphere = {{ radius = 50 }} }}]\n"
    )
}

pub fn parse(text: &str) -> Cell {
    Cell::parse("test.toml", text).unwrap_or_else(|e| panic!("{e}"))
}

pub fn run(text: &str) -> RunOutcome {
    simulate(&parse(text), &RunOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

pub fn run_free(text: &str) -> RunOutcome {
    let options = RunOptions { monitored: false, ..RunOptions::default() };
    simulate(&parse(text), &options).unwrap_or_else(|e| panic!("{e}"))
}
