//! A robot does not begin a move while its path is blocked, or while nothing is seen, however late its overrides take effect.

use std::fmt::Write as _;
use std::path::Path;

use elbowroom_cell::Cell;
use elbowroom_sim::{Recording, RunOptions, simulate};

/// Overrides take effect late. The robot waits, moves up by 0.2 m, and moves on.
const GANTRY: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
tick_ms = 4
[robot.r]
dh = [
  { kind = "prismatic", alpha = 90, theta = 90, min = -1000, max = 1000, speed = 1000, acceleration = 5000 },
  { kind = "prismatic", alpha = 90, theta = 90, min = -1000, max = 1000, speed = 1000 },
  { kind = "prismatic", min = -1000, max = 1000, speed = 1000 },
]
links = [[], [], [{ sphere = { radius = 50 } }]]
start = [-800, 0, 0]
[monitor]
reaction_ms = REACTION
[map.r]
step = 200
[cloud.above]
pose = { at = [0, 0, 4000], rpy = [180, 0, 0] }
floor = -1500
ceiling = 4000
to_floor = false
clouds = "clouds"
latency_ms = 10
stale_ms = 150
[program.r]
steps = [{ wait = 0.6005 }, { move = "joint", to = [-600, 0, 0] }, { move = "joint", to = [800, 0, 0] }]
"#;

/// The second one ends within a tick: a step could begin there without being asked.
const REACTIONS_MS: [u32; 2] = [200, 202];

/// Height of the plate, m: 70 mm above the ball after its first move.
const PLATE_M: f64 = -0.48;

/// A cloud of a plate at a height, m, if it is there.
fn write_cloud(folder: &Path, index: usize, height: Option<f64>) {
    let mut points = vec![[0.0, 0.0, -1.5]];
    if let Some(height) = height {
        points.extend((0..400).map(|i| [f64::from(i % 20) * 0.02 - 0.2, f64::from(i / 20) * 0.02 - 0.2, height]));
    }
    let head = "ply\nformat ascii 1.0\nelement vertex COUNT\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let mut text = head.replace("COUNT", &points.len().to_string());
    for [x, y, z] in points {
        // The sensor looks down from a height of 4 m.
        let _ = writeln!(text, "{x} {} {}", -y, 4.0 - z);
    }
    std::fs::write(folder.join(format!("{index:03}.ply")), text).unwrap();
}

/// Runs the gantry; a plate is there from a time on, and there are clouds up to another one, s.
fn run(plate_from_s: f64, clouds_to_s: f64, reaction_ms: u32) -> Recording {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("clouds");
    std::fs::create_dir(&folder).unwrap();
    let mut times = "file,t_s\n".to_owned();
    for index in 0..100 {
        let t_s = 0.05 * index as f64 - 0.1;
        if t_s <= clouds_to_s {
            write_cloud(&folder, index, (t_s >= plate_from_s).then_some(PLATE_M));
            let _ = writeln!(times, "{index:03}.ply,{t_s}");
        }
    }
    std::fs::write(folder.join("times.csv"), times).unwrap();
    let cell = Cell::parse(dir.path().join("cell.toml"), &GANTRY.replace("REACTION", &reaction_ms.to_string()))
        .unwrap_or_else(|e| panic!("{e}"));
    simulate(&cell, &RunOptions::default()).unwrap_or_else(|e| panic!("{e}")).recording
}

/// The first joint at the end, and the time of its last motion, s.
fn end(recording: &Recording) -> (f64, f64) {
    let samples = &recording.robots[0].samples;
    let last = samples.windows(2).rev().find(|w| w[0].q != w[1].q).map_or(0.0, |w| w[1].t_s);
    (samples.last().unwrap().q[0], last)
}

#[test]
fn a_move_whose_path_is_blocked_does_not_begin() {
    for reaction_ms in REACTIONS_MS {
        let (free, _) = end(&run(f64::INFINITY, 5.0, reaction_ms));
        assert!((free - 0.8).abs() < 1e-9, "{free}");
        let (blocked, _) = end(&run(-1.0, 5.0, reaction_ms));
        assert!((blocked + 0.6).abs() < 1e-9, "{blocked}");
    }
}

#[test]
fn a_robot_that_waits_without_pictures_does_not_begin_to_move() {
    for reaction_ms in REACTIONS_MS {
        let (at, last_s) = end(&run(f64::INFINITY, 0.1, reaction_ms));
        assert!(at == -0.8 && last_s == 0.0, "{at} at {last_s} s");
    }
}
