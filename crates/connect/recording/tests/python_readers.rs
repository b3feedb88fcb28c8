//! Comparison of recordings and messages with `mcap`, `mcap-ros2-support` and `rosbags` from PyPI.
//!
//! Needs a Python with these packages, named by `ELBOWROOM_PYTHON` (default `python3`); without it the tests pass with
//! a message.
#![allow(clippy::print_stdout)]

use std::path::Path;
use std::process::Command;

use elbowroom_cell::Cell;
use elbowroom_recording::{BagReader, CellWriter, RunRecorder};
use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::diagnostic_msgs::DiagnosticArray;
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::msgs::std_msgs::Text;
use elbowroom_ros2::msgs::tf2_msgs::TFMessage;
use elbowroom_ros2::msgs::visualization_msgs::MarkerArray;
use elbowroom_sim::run::simulate_observed;
use elbowroom_sim::{PlannedPaths, RunOptions};
use elbowroom_testkit::python::with_modules;
use serde_json::Value;

fn python() -> Option<String> {
    with_modules("mcap_ros2.decoder, rosbags.typesys", "`mcap-ros2-support` and `rosbags`")
}

fn script(python: &str, arguments: &[&str]) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/read_bag.py");
    let output = Command::new(python).arg(script).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn cell(example: &str) -> Cell {
    let examples = elbowroom_testkit::folder::examples();
    Cell::load(examples.join(example).join("cell.toml")).unwrap()
}

/// Counts the messages on each topic with elbowroom's reader.
fn counted(file: &Path) -> std::collections::BTreeMap<String, u64> {
    let mut reader = BagReader::new(std::fs::File::open(file).unwrap());
    let mut counts = std::collections::BTreeMap::new();
    while let Some(message) = reader.next_message().unwrap() {
        *counts.entry(message.topic).or_default() += 1;
    }
    counts
}

#[test]
fn recordings_are_read_by_three_other_readers() {
    let Some(python) = python() else { return };
    let dir = tempfile::tempdir().unwrap();
    for example in ["exchange", "conveyor"] {
        let cell = cell(example);
        let file = dir.path().join(format!("{example}.mcap"));
        let mut recorder = RunRecorder::new(CellWriter::create(&file, &cell, 0).unwrap(), &cell);
        let outcome =
            simulate_observed(&PlannedPaths::new(&cell), &RunOptions::default(), &mut |_| {}, Some(&mut recorder))
                .unwrap();
        recorder.finish().unwrap();
        let found: Value = serde_json::from_str(&script(&python, &[&file.to_string_lossy()])).unwrap();
        println!("{example}: {found:#}");
        let counts = counted(&file);
        for (topic, count) in &counts {
            assert_eq!(found["topics"][topic]["count"], *count, "{topic}");
            assert_eq!(found["topics"][topic]["schema"], "ros2msg");
            assert_eq!(found["topics"][topic]["encoding"], "cdr");
        }
        assert_eq!(found["topics"].as_object().unwrap().len(), counts.len());
        assert_eq!(found["same_bytes"], counts.values().sum::<u64>());
        assert_eq!(found["indexed_messages"], found["same_bytes"]);
        // Types that the tools of Jazzy have, with equal hashes there.
        assert!(found["hashes"].as_u64().unwrap() >= 5);
        assert_eq!(found["profile"], "ros2");
        let recording = &outcome.recording;
        let samples: usize = recording.robots.iter().map(|r| r.samples.len()).sum();
        let before_the_first = if example == "exchange" { cell.robots.len() } else { 0 };
        assert_eq!(counts["/elbowroom/tick"], (samples + before_the_first) as u64);
        assert_eq!(found["metadata"]["elbowroom"]["checksum"], cell.approval.checksum);
        let text = std::fs::read(&cell.file).unwrap();
        assert_eq!(found["attachments"]["cell.toml"], text.len());
        urdf_beside(&file, &cell, &found);
    }
}

/// Checks the URDF beside the recording: elbowroom's reader reads it with its meshes, and it has a link for every frame
/// that never moves.
fn urdf_beside(file: &Path, cell: &Cell, found: &Value) {
    let urdf = file.with_extension("urdf");
    let loaded = elbowroom_formats::robot::load(&urdf, &elbowroom_formats::LoadOptions::default()).unwrap();
    let links = loaded.robot.chain.links();
    for frame in found["static_frames"].as_array().unwrap() {
        assert!(links.iter().any(|l| l == frame.as_str().unwrap()), "{frame}");
    }
    let solids: usize = cell.robots.iter().flat_map(|r| &r.robot.colliders).map(Vec::len).sum();
    let written: usize = loaded.robot.colliders.iter().map(Vec::len).sum();
    assert!(written >= solids + cell.objects.len(), "{written} solids of {solids}");
    assert!(found["description_bytes"].as_u64().unwrap() as usize >= std::fs::read(&urdf).unwrap().len());
}

fn same<M: Message>(bytes: &[u8]) {
    let message = M::decode(bytes).unwrap_or_else(|e| panic!("{}: {e}", M::NAME));
    assert_eq!(message.encode(), bytes, "{}", M::NAME);
}

#[test]
fn messages_that_rosbags_writes_are_read() {
    let Some(python) = python() else { return };
    let mut count = 0;
    for line in script(&python, &["--write", "200"]).lines() {
        let (name, hex) = line.split_once(' ').unwrap();
        let digit = |i: usize| u8::from_str_radix(&hex[i..i + 2], 16).unwrap();
        let bytes: Vec<u8> = (0..hex.len()).step_by(2).map(digit).collect();
        match name {
            JointState::NAME => same::<JointState>(&bytes),
            TFMessage::NAME => same::<TFMessage>(&bytes),
            MarkerArray::NAME => same::<MarkerArray>(&bytes),
            DiagnosticArray::NAME => same::<DiagnosticArray>(&bytes),
            Text::NAME => same::<Text>(&bytes),
            other => panic!("{other} is none of ours"),
        }
        count += 1;
    }
    assert_eq!(count, 1000);
}
