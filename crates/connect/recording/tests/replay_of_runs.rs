//! Recordings of runs replay to the bit: all example cells, and a cell with all features for two minutes, ten with
//! `ELBOWROOM_LONG=1`.
#![allow(clippy::print_stdout)]

use std::io::Cursor;

use elbowroom_cell::Cell;
use elbowroom_recording::{CellWriter, Replay, RunRecorder, replay};
use elbowroom_robot::RobotId;
use elbowroom_sim::run::simulate_observed;
use elbowroom_sim::{InputFault, InputFaultKind, PlannedPaths, Recording, RunOptions};
use elbowroom_testkit::extent::{amount, is_long_run};
use elbowroom_testkit::folder::examples;

fn recorded(cell: &Cell, options: &RunOptions) -> (Vec<u8>, Recording) {
    let mut file = Cursor::new(Vec::new());
    let mut recorder = RunRecorder::new(CellWriter::new(&mut file, cell, 0).unwrap(), cell);
    let outcome = simulate_observed(&PlannedPaths::new(cell), options, &mut |_| {}, Some(&mut recorder)).unwrap();
    recorder.finish().unwrap();
    (file.into_inner(), outcome.recording)
}

fn replayed(cell: &Cell, options: &RunOptions) -> Replay {
    let (bytes, _) = recorded(cell, options);
    replayed_bytes(cell, &bytes)
}

fn replayed_bytes(cell: &Cell, bytes: &[u8]) -> Replay {
    let found = replay(bytes).unwrap();
    println!("{}: {} bytes, {} messages, {} ticks", found.cell, bytes.len(), found.messages, found.ticks);
    assert_eq!(found.checksum, cell.approval.checksum);
    assert!(!found.cut_off);
    assert_eq!(found.robots.len(), cell.robots.len());
    found
}

/// Loads an example. Those with slow ticks are shortened: after 8 s a cart was evaded and a carton gripped, after 10 s a bar was
/// handed over, after 5 s a hand was at the shield.
fn loaded(example: &str) -> Cell {
    let file = examples().join(example).join("cell.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let shortened = [("pallet", 4, 8), ("inspection", 4, 10), ("guided", 2, 5)];
    let text = match shortened.iter().find(|(name, ..)| *name == example && !is_long_run()) {
        Some((_, tick_ms, max_s)) => {
            text.replace(&format!("tick_ms = {tick_ms}"), &format!("tick_ms = 8\nmax_s = {max_s}"))
        }
        None => text,
    };
    Cell::parse(file, &text).unwrap()
}

#[test]
fn every_example_replays_to_the_bit() {
    for example in
        ["conveyor", "exchange", "fence", "figure12", "full_speed", "guided", "inspection", "pallet", "tool_box"]
    {
        let cell = loaded(example);
        let found = replayed(&cell, &RunOptions::default());
        assert_eq!(found.differences, 0, "{example}: {:?}", found.robots);
        assert!(found.ticks > 500, "{example}: {} ticks", found.ticks);
    }
}

#[test]
fn runs_without_the_override_and_with_faulty_input_replay_to_the_bit() {
    let mut cell = Cell::load(examples().join("exchange/cell.toml")).unwrap();
    // The faults end at 1.5 s.
    cell.timing.max_s = 4.0;
    let free = RunOptions { apply_override: false, ..RunOptions::default() };
    assert_eq!(replayed(&cell, &free).differences, 0);
    let kinds = [InputFaultKind::NotANumber, InputFaultKind::Frozen];
    for kind in kinds {
        let fault = InputFault { robot: RobotId(0), from_s: 1.0, to_s: 1.5, kind };
        let found = replayed(&cell, &RunOptions { faults: vec![fault], ..RunOptions::default() });
        assert_eq!(found.differences, 0, "{:?}", found.robots);
    }
}

/// Two arms, exchange regions, a region on a conveyor, one on a robot, switched regions, gripped objects, every law.
const EVERYTHING: &str = r#"
version = 1
name = "everything"
units = { length = "mm", angle = "deg" }
tick_ms = 4
max_s = 600
[robot.left]
dh = [
  { a = 0, alpha = 0, d = 400, theta = 0, min = -180, max = 180, speed = 120 },
  { a = 500, alpha = 0, d = 0, theta = 0, min = -180, max = 180, speed = 120 },
  { a = 400, alpha = 0, d = 0, theta = 0, min = -180, max = 180, speed = 160 },
]
links = [
  { capsule = { from = [0, 0, -350], to = [0, 0, 0], radius = 80 } },
  { capsule = { from = [-500, 0, 0], to = [0, 0, 0], radius = 60 } },
  { capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 50 } },
]
base = { at = [0, 0, 0], rpy = [0, 0, 0] }
start = [90, 0, 0]
[robot.right]
dh = [
  { a = 0, alpha = 0, d = 400, theta = 0, min = -180, max = 180, speed = 120 },
  { a = 500, alpha = 0, d = 0, theta = 0, min = -180, max = 180, speed = 120 },
  { a = 400, alpha = 0, d = 0, theta = 0, min = -180, max = 180, speed = 160 },
]
links = [
  { capsule = { from = [0, 0, -350], to = [0, 0, 0], radius = 80 } },
  { capsule = { from = [-500, 0, 0], to = [0, 0, 0], radius = 60 } },
  { capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 50 } },
]
base = { at = [1500, 0, 0], rpy = [0, 0, 180] }
start = [-90, 0, 0]
[encoder.belt]
direction = [0, 1, 0]
speed = 20
[region.shared]
shape = "box"
from = [600, -250, 0]
to = [900, 250, 900]
kind = "exchange"
warning = 150
[region.cart]
shape = "sphere"
centre = [700, -4000, 400]
radius = 100
kind = "monitored"
slow_to = 40
warning = 300
follow = { encoder = "belt" }
[region.hand]
shape = "sphere"
centre = [0, 0, 0]
radius = 120
kind = "monitored"
slow_to = 30
output = 5
warning = 150
follow = { robot = "right", frame = "flange" }
robots = ["left"]
[region.gate]
shape = "cylinder"
base = [0, -1000, 0]
radius = 50
height = 1000
life = "temporary"
warning = 200
robots = ["left"]
[monitor]
direction_aware = true
stopping_distance = true
override_rate = 4
[program.left]
override = 80
repeat = 400
steps = [
  { move = "joint", to = [0, 0, 0], speed = 60 },
  { region = "gate", active = true },
  { wait = 0.2 },
  { move = "joint", to = [-70, 20, 0], speed = 80 },
  { region = "gate", active = false },
  { move = "joint", to = [90, 0, 0], speed = 60 },
]
[program.right]
repeat = 400
steps = [
  { move = "joint", to = [0, 0, 0], speed = 50 },
  { move = "joint", to = [60, 20, 0], speed = 70 },
  { move = "joint", to = [-90, 0, 0], speed = 60 },
]
"#;

#[test]
fn minutes_of_everything_replay_to_the_bit() {
    let end_s = amount(120, 600);
    let text = EVERYTHING.replace("max_s = 600", &format!("max_s = {end_s}"));
    let cell = Cell::parse("everything.toml", &text).unwrap();
    let (bytes, recording) = recorded(&cell, &RunOptions::default());
    // Without these events the replay would prove little.
    for event in ["granted", "waiting", "released", "on", "off", "warn_in", "output_on", "stop", "resume"] {
        let count = recording.events.iter().filter(|e| e.event.name() == event).count();
        assert!(count > 10, "{event} happened {count} times");
    }
    let found = replayed_bytes(&cell, &bytes);
    assert_eq!(found.differences, 0, "{:?}", found.robots);
    let until_s = found.robots.iter().map(|r| r.until_s).fold(0.0, f64::max);
    assert!(until_s > f64::from(end_s) - 1.0, "it ended after {until_s} s");
}

#[test]
fn another_answer_is_found() {
    let cell = Cell::load(examples().join("figure12/cell.toml")).unwrap();
    let (bytes, _) = recorded(&cell, &RunOptions::default());
    let changed = with_another_override(&bytes);
    let found = replay(&changed[..]).unwrap();
    assert_eq!(found.differences, 1);
    let first = found.robots.iter().find_map(|r| r.first.as_ref()).unwrap();
    assert_eq!((first.what, first.sequence), ("override", 100));
    assert_eq!(first.recorded.to_bits(), first.replayed.to_bits() ^ 1);
}

/// Returns the recording with the last bit of one override changed.
fn with_another_override(bytes: &[u8]) -> Vec<u8> {
    use elbowroom_ros2::Message as _;
    use elbowroom_ros2::msgs::elbowroom_msgs::MonitorTick;
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut file).unwrap();
    for message in mcap::MessageStream::new(bytes).unwrap() {
        let mut message = message.unwrap();
        if message.channel.topic == "/elbowroom/tick" {
            let mut tick = MonitorTick::decode(&message.data).unwrap();
            if (tick.robot, tick.sequence) == (0, 100) {
                tick.speed_override = f64::from_bits(tick.speed_override.to_bits() ^ 1);
                message.data = tick.encode().into();
            }
        }
        writer.write(&message).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

#[test]
fn a_recording_that_ends_anywhere_is_read_up_to_there() {
    let cell = Cell::load(examples().join("figure12/cell.toml")).unwrap();
    let (bytes, _) = recorded(&cell, &RunOptions::default());
    let whole = replay(&bytes[..]).unwrap();
    let mut last = 0;
    for part in 1..=20 {
        let cut = bytes.len() * part / 21;
        match replay(&bytes[..cut]) {
            Ok(found) => {
                assert!(found.cut_off && found.differences == 0);
                assert!(found.ticks >= last && found.ticks <= whole.ticks);
                last = found.ticks;
            }
            Err(e) => assert!(e.to_string().contains("no ticks"), "{e}"),
        }
    }
    assert!(last > 0);
    assert!(replay(&b"not a recording"[..]).unwrap_err().to_string().contains("MCAP"));
}
