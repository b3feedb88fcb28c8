//! A cell that was read from other numbers than those of the text is found.

use std::path::Path;

use elbowroom_cell::Cell;
use elbowroom_sim::{RunOptions, simulate};

use super::check;
use crate::fuzz_cells::oracle::{Finding, Findings};

const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.a]
base = { at = [100, 0, 0], rpy = [10, 20, 30] }
dh = [{ a = 300, alpha = 90, d = 40, theta = 5, min = -90, max = 90, speed = 90 }, { kind = "prismatic", min = -500, max = 500, speed = 400 }]
links = [{ box = { at = [1, 2, 3], rpy = [4, 5, 6], size = [70, 80, 90] } }, { sphere = { radius = 30 } }]
speed = 80
start = [15, 25]
[robot.a.tools.one]
tcp = { at = [0, 0, 11], quaternion = [0, 0, 0.6, 0.8] }
box = { at = [0, 0, 12], size = [13, 14, 15] }
flange = "link_1"
[object.o]
shape = "cylinder"
radius = 55
height = 66
at = [0, 0, 3000]
quaternion = [0.5, 0.5, 0.5, 0.5]
[region.box]
shape = "box"
base = [3100, 0, 0]
rpy = [7, 8, 9]
size = [210, 220, 230]
warning = 31
[region.corners]
shape = "box"
from = [3200, 0, 0]
to = [3300, 500, 32]
[region.plane]
shape = "plane"
origin = [0, 0, -4000]
x = [1, 0, -4000]
y = [0, 1, -4001]
[grid.g]
from = [-2000, -2000, -2000]
to = [2000, 2100, 2200]
rpy = [0, 0, 33]
cells = [2, 2, 2]
output = 1
[camera.eye]
pose = { at = [0, 0, 6000], rpy = [180, 0, 10] }
size = [64, 48]
focal_px = [60, 61]
uncertainty = 50
area = [[-1000, -1000], [1000, -1000], [0, 900]]
templates = [{ name = "crate", size = [600, 400], height = 300 }, { name = "drum", diameter = 500, height = 900 }]
robots = []
[cloud.mast]
pose = { at = [0, 0, 5000], rpy = [180, 0, 20] }
depth = { size = [64, 48], focal_px = 62, step = 2 }
floor = -100
voxel = 45
ceiling = 2500
to_floor = false
latency_ms = 70
robots = []
[program.a]
steps = [{ move = "joint", to = [30, 100] }]
"#;

/// The findings if the cell has been read from the text with this change.
fn findings(from: &str, to: &str) -> Vec<Finding> {
    assert!(CELL.contains(from), "{from}");
    let cell = Cell::parse(Path::new("test.toml"), &CELL.replace(from, to)).unwrap();
    let recording = simulate(&cell, &RunOptions::default()).unwrap().recording;
    let mut findings = Findings::default();
    check(CELL, &cell, &recording, &mut findings);
    findings.list
}

#[test]
fn a_cell_as_written_has_no_findings() {
    assert_eq!(findings("", ""), []);
}

#[test]
fn other_numbers_are_found() {
    let changes = [
        ("at = [100, 0, 0]", "at = [100, 0, 0.001]", "robot.a.base"),
        ("rpy = [10, 20, 30]", "rpy = [10, 20, 30.001]", "robot.a.base"),
        ("alpha = 90", "alpha = 89", "robot.a: joints"),
        ("d = 40", "d = 41", "robot.a: joints"),
        ("rpy = [4, 5, 6]", "rpy = [4, 6, 5]", "robot.a.links[0][0].box"),
        ("size = [70, 80, 90]", "size = [70, 80, 91]", "robot.a.links[0][0]: box"),
        ("start = [15, 25]", "start = [15, 26]", "robot.a: start"),
        ("[0, 0, 0.6, 0.8]", "[0, 0, 0.8, 0.6]", "robot.a.tools.one.tcp"),
        ("at = [0, 0, 12]", "at = [0, 0, 13]", "robot.a.tools.one.box"),
        ("flange = \"link_1\"", "flange = \"link_2\"", "robot.a.tools.one.flange"),
        ("radius = 55", "radius = 56", "object.o: cylinder"),
        ("[0.5, 0.5, 0.5, 0.5]", "[0.5, 0.5, 0.5, -0.5]", "object.o"),
        ("rpy = [7, 8, 9]", "rpy = [9, 8, 7]", "region.box"),
        ("size = [210, 220, 230]", "size = [210, 220, 240]", "region.box"),
        ("warning = 31", "warning = 32", "region.box: warning"),
        ("to = [3300, 500, 32]", "to = [3300, 500, 33]", "region.corners"),
        ("y = [0, 1, -4001]", "y = [0, 1, -4000]", "region.plane"),
        ("to = [2000, 2100, 2200]", "to = [2000, 2101, 2200]", "grid.g"),
        ("rpy = [0, 0, 33]", "rpy = [0, 0, 34]", "grid.g"),
        ("rpy = [180, 0, 10]", "rpy = [180, 0, 11]", "camera.eye.pose"),
        ("focal_px = [60, 61]", "focal_px = [61, 60]", "camera.eye.size"),
        ("uncertainty = 50", "uncertainty = 51", "camera.eye.uncertainty"),
        ("[0, 900]", "[0, 901]", "camera.eye.area"),
        ("size = [600, 400]", "size = [600, 401]", "camera.eye.templates"),
        ("diameter = 500", "diameter = 501", "camera.eye.templates"),
        ("rpy = [180, 0, 20]", "rpy = [180, 20, 0]", "cloud.mast.pose"),
        ("focal_px = 62", "focal_px = 63", "cloud.mast.depth"),
        ("step = 2", "step = 3", "cloud.mast.step"),
        ("floor = -100", "floor = 100", "cloud.mast.floor"),
        ("voxel = 45", "voxel = 46", "cloud.mast.voxel"),
        ("ceiling = 2500", "ceiling = 2501", "cloud.mast.ceiling"),
        ("to_floor = false", "to_floor = true", "cloud.mast.to_floor"),
        ("latency_ms = 70", "latency_ms = 71", "cloud.mast.latency_ms"),
    ];
    for (from, to, expected) in changes {
        let found = findings(from, to);
        let is_expected = |f: &Finding| matches!(f, Finding::Misread { table, .. } if *table == expected);
        assert!(found.iter().any(is_expected), "{from} → {to}: {found:?}");
    }
}

#[test]
fn a_robot_that_is_faster_than_its_speed_is_found() {
    let found = findings("speed = 80", "speed = 85");
    assert!(found.iter().any(|f| matches!(f, Finding::TooFast { robot: 0, .. })), "{found:?}");
}

const GOAL: &str = r#"
version = 1
units = { length = "m", angle = "rad" }
[robot.a]
dh = [
  { a = 0.4, min = -3, max = 3, speed = 2 }, { a = 0.3, alpha = 1.57, min = -3, max = 3, speed = 2 },
  { d = 0.2, alpha = -1.57, min = -3, max = 3, speed = 2 }, { d = 0.3, alpha = 1.57, min = -3, max = 3, speed = 2 },
  { alpha = -1.57, min = -3, max = 3, speed = 2 }, { d = 0.1, min = -3, max = 3, speed = 2 },
]
[program.a]
steps = [{ move = "joint", to = [0.3, 0.2, 0.1, 0.4, 0.5, 0.6] }]
"#;

#[test]
fn a_move_that_misses_the_goal_of_its_text_is_found() {
    let cell = Cell::parse(Path::new("test.toml"), GOAL).unwrap();
    let recording = simulate(&cell, &RunOptions::default()).unwrap().recording;
    let tcp = cell.robots[0].tcp_in_root(&[0.3, 0.2, 0.1, 0.4, 0.5, 0.6]);
    let findings = |by: f64, choice: &str| {
        let [x, y, z] = tcp.translation.to_array();
        let [a, b, c, d] = tcp.rotation.to_quaternion_xyzw();
        let to = format!("{{ at = [{x}, {y}, {}], quaternion = [{a}, {b}, {c}, {d}]{choice} }}", z + by);
        let text = GOAL.replace("[0.3, 0.2, 0.1, 0.4, 0.5, 0.6]", &to);
        let mut findings = Findings::default();
        check(&text, &cell, &recording, &mut findings);
        findings.list.len()
    };
    assert_eq!(findings(0.0, ""), 0);
    assert_eq!(findings(1e-4, ""), 1);
    assert_eq!(
        (findings(0.0, ", configuration = [\"no_flip\"]"), findings(0.0, ", configuration = [\"flip\"]")),
        (0, 1)
    );
    // The end, and the whole way to it.
    assert_eq!(findings(0.0, ", near = [0.3, 0.2, 0.1, 0.4, 0.5, 0.6]"), 0);
    assert_eq!(findings(0.0, ", near = [0.3, 0.2, 0.1, 0.4, 0.5, 0.7]"), 2);
}
