//! Recordings in builds with the feature `live`: a recorded run is played again as a trajectory.

#![cfg(feature = "live")]

use crate::common::{elbowroom, with_cell};

const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000, acceleration = 4000 }]
links = [{ sphere = { radius = 50 } }]
"#;
const STEPS: &str = "[program.rail]\nsteps = [{ move = \"joint\", to = [1500] }]\n";
const PLAYED: &str = "[program.rail]\ntrajectory = \"log.csv\"\n";

#[test]
fn a_recording_becomes_a_trajectory() {
    let dir = with_cell(&format!("{CELL}{STEPS}"));
    elbowroom(dir.path(), &["run", "cell.toml", "--mcap", "log.mcap"]).expect(0);
    let several = elbowroom(dir.path(), &["convert", "log.mcap", "log.csv"]).expect(2).stderr;
    assert!(several.contains("--topic /rail/joint_states or --topic /joint_states"), "{several}");
    let table = elbowroom(dir.path(), &["convert", "log.mcap", "log.csv", "--topic", "/rail/joint_states"]).expect(0);
    assert!(table.stdout.contains("of 1 joints") && table.stdout.contains("/rail/joint_states"), "{}", table.stdout);
    std::fs::write(dir.path().join("played.toml"), format!("{CELL}{PLAYED}")).unwrap();
    let played = elbowroom(dir.path(), &["run", "played.toml", "--json", "--out", "out"]).expect(0).json();
    assert_eq!(played["robots"][0]["outcome"], "finished");
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let end: f64 = trace.lines().next_back().unwrap().split(',').nth(2).unwrap().parse().unwrap();
    assert!((end - 1.5).abs() < 1e-3, "{end}");
}

#[test]
fn wrong_calls_say_what_to_write() {
    let dir = with_cell(CELL);
    std::fs::write(dir.path().join("log.mcap"), "t_s,joint_1\n0,1\n").unwrap();
    for (args, expected) in [
        (&["log.mcap", "log.csv"][..], "ros2 bag record"),
        (&["log.mcap", "log.txt"][..], "convert log.mcap log.csv"),
        (&["log.mcap", "--out", "folder"][..], "convert log.mcap log.csv"),
        (&["missing.mcap", "log.csv"][..], "missing.mcap"),
        (&["cell.toml", "arm.srdf", "--topic", "/joint_states"][..], "is for recordings"),
    ] {
        let stderr = elbowroom(dir.path(), &[&["convert"], args].concat()).expect(2).stderr;
        assert!(stderr.contains(expected), "{args:?}: {stderr}");
    }
}
