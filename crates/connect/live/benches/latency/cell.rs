//! Cell of the bench: arms in a row, each with a table, a post and a column, and an exchange region between neighbours.

use std::fmt::Write as _;

use elbowroom_cell::Cell;

/// Amplitudes of the joints' swings, rad, and their speeds at override 1, rad/s of phase.
pub const SWINGS: [(f64, f64); 6] = [(0.9, 0.7), (0.25, 1.1), (0.25, 1.3), (0.6, 0.9), (0.5, 1.7), (1.2, 0.5)];
/// Centres of the joints' swings, rad.
pub const MIDDLE: [f64; 6] = [0.0, 0.6, 0.5, 0.0, 0.9, 0.0];

/// Name of a robot.
pub fn name(robot: usize) -> String {
    format!("robot_{}", robot + 1)
}

/// Makes a cell of this many robots.
pub fn cell(robots: usize) -> Result<Cell, Box<dyn std::error::Error>> {
    let mut text =
        "version = 1\nname = \"latency\"\nunits = { length = \"mm\", angle = \"deg\" }\ntick_ms = 2\n".to_owned();
    for robot in 0..robots {
        write!(text, "{}", arm(robot))?;
    }
    for left in 1..robots {
        write!(text, "{}", exchange(left))?;
    }
    text += "[monitor]\nstopping_distance = true\ndirection_aware = true\n";
    Ok(Cell::parse("latency.toml", &text)?)
}

fn arm(robot: usize) -> String {
    let (name, y) = (name(robot), 2_400 * robot);
    let post_y = y as f64 - 900.0;
    format!(
        r#"
[robot.{name}]
base = {{ at = [0, {y}, 0] }}
dh = [
  {{ d = 450, a = 150, alpha = 90, min = -170, max = 170, speed = 170 }},
  {{ a = 600, min = -120, max = 155, speed = 165 }},
  {{ a = 120, alpha = 90, min = -170, max = 190, speed = 170 }},
  {{ d = 620, alpha = -90, min = -190, max = 190, speed = 360 }},
  {{ alpha = 90, min = -130, max = 130, speed = 360 }},
  {{ d = 100, min = -360, max = 360, speed = 550 }},
]
links = [
  {{ capsule = {{ from = [-150, -400, 0], to = [0, 0, 0], radius = 120 }} }},
  {{ capsule = {{ from = [-600, 0, 0], to = [0, 0, 0], radius = 90 }} }},
  {{ sphere = {{ radius = 110 }} }},
  {{ capsule = {{ from = [0, 0, 0], to = [0, -500, 0], radius = 70 }} }},
  {{ sphere = {{ radius = 60 }} }},
  {{ sphere = {{ radius = 50 }} }},
]
[robot.{name}.tool]
tcp = {{ at = [0, 0, 220], rpy = [0, 0, 0] }}
box = {{ at = [0, 0, 110], size = [80, 80, 220] }}
[region.{name}_table]
shape = "box"
base = [900, {y}, 0]
size = [500, 700, 300]
warning = 200
robots = ["{name}"]
[region.{name}_post]
shape = "cylinder"
base = [700, {post_y}, 0]
radius = 60
height = 1500
warning = 200
robots = ["{name}"]
[region.{name}_people]
shape = "box"
base = [1700, {y}, 0]
size = [400, 1600, 2000]
kind = "monitored"
slow_to = 30
warning = 200
robots = ["{name}"]
"#
    )
}

fn exchange(left: usize) -> String {
    let (a, b, y) = (name(left - 1), name(left), 2_400 * left - 1_200);
    format!(
        r#"
[region.between_{a}_{b}]
shape = "box"
base = [300, {y}, 400]
size = [600, 500, 900]
kind = "exchange"
warning = 250
guards = ["tool"]
robots = ["{a}", "{b}"]
"#
    )
}
