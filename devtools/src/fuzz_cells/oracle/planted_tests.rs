//! Tests of the oracle by planted violations: readings beyond limits, slowed mechanisms, speed zones, held parts, recordings.

use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;
use elbowroom_sim::{InputFault, InputFaultKind, Recording, RunOptions, simulate};

use super::{
    Arm, Finding, Findings, Guarded, Promises, check, mechanisms, motion::OracleMotion, planned_paths, readings,
    recorded, while_inside,
};
use crate::fuzz_cells::spec::{RecordingLayout, RecordingSpec};

const CELL: &str = r#"
version = 1
units = { length = "m", angle = "rad" }
[robot.a]
dh = [{ kind = "prismatic", min = -1, max = 1, speed = 1 }]
links = [{ sphere = { radius = 0.02 } }]
overshoot = 0.01
[robot.door]
kind = "mechanism"
base = { at = [0, 3, 0] }
dh = [{ kind = "prismatic", min = 0, max = 1, speed = 1 }]
links = [{ sphere = { radius = 0.02 } }]
[program.a]
steps = [{ move = "joint", to = [0.5] }]
[program.door]
steps = [{ move = "joint", to = [1] }]
"#;

/// A reading of 1 m and `beyond`, from the start on.
fn findings(beyond: f64, monitored: bool) -> Vec<Finding> {
    let cell = Cell::parse("test.toml", CELL).unwrap();
    let kind = InputFaultKind::Jump { joint: 0, by: 1.0 + beyond };
    let faults = [InputFault { robot: RobotId(0), from_s: 0.0, to_s: 0.3, kind }];
    let options = RunOptions { faults: faults.to_vec(), apply_override: monitored, ..RunOptions::default() };
    let mut findings = Findings::default();
    readings::check(&cell, &simulate(&cell, &options).unwrap().recording, &faults, &mut findings);
    findings.list
}

#[test]
fn a_reading_beyond_its_tolerance_that_does_not_stop_is_found() {
    assert_eq!(findings(0.02, true), []);
    let ignored = Finding::MisreadLimits { robot: 0, joint: 0, t_s: 0.0, stopped: false };
    assert_eq!(findings(0.02, false), [ignored]);
    // A tolerance of the cell file that only the oracle knows.
    let cell = Cell::parse("test.toml", &CELL.replace("overshoot = 0.01", "overshoot = 0.1")).unwrap();
    let kind = InputFaultKind::Jump { joint: 0, by: 1.02 };
    let faults = [InputFault { robot: RobotId(0), from_s: 0.0, to_s: 0.3, kind }];
    let options = RunOptions { faults: faults.to_vec(), ..RunOptions::default() };
    let stopped = simulate(&Cell::parse("test.toml", CELL).unwrap(), &options).unwrap().recording;
    let mut invented = Findings::default();
    readings::check(&cell, &stopped, &faults, &mut invented);
    assert_eq!(invented.list, [Finding::MisreadLimits { robot: 0, joint: 0, t_s: 0.0, stopped: true }]);
}

#[test]
fn a_mechanism_that_is_slowed_down_is_found() {
    let cell = Cell::parse("test.toml", CELL).unwrap();
    let mut recording = simulate(&cell, &RunOptions::default()).unwrap().recording;
    let found = |recording: &Recording| {
        let mut findings = Findings::default();
        mechanisms::check(&cell, recording, &mut findings);
        findings.list
    };
    assert_eq!(found(&recording), []);
    let sample = &mut recording.robots[1].samples[7];
    sample.speed_override = 0.9;
    let t_s = sample.t_s;
    assert_eq!(found(&recording), [Finding::Slowed { robot: 1, t_s }]);
    // A robot may be slowed down.
    recording.robots[1].samples[7].speed_override = 1.0;
    recording.robots[0].samples[7].speed_override = 0.1;
    assert_eq!(found(&recording), []);
}

/// A ball that goes through a speed zone, with outputs.
const ZONE: &str = r#"
version = 1
units = { length = "m", angle = "rad" }
[robot.a]
dh = [{ kind = "prismatic", min = -1, max = 2, speed = 1 }]
links = [{ sphere = { radius = 0.02 } }]
[region.zone]
shape = "box"
base = [0, 0, 1]
size = [0.4, 0.4, 0.4]
kind = "monitored"
slow_to = 30
warning = 0.1
output = 3
warning_output = 7
[program.a]
steps = [{ move = "joint", to = [2] }]
"#;

#[test]
fn a_speed_zone_that_does_not_slow_and_an_output_that_is_off_are_found() {
    let cell = Cell::parse("test.toml", ZONE).unwrap();
    let found = |recording: &Recording| {
        let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
        let guarded: Vec<Vec<Guarded>> = cell.robots.iter().map(Guarded::all).collect();
        let mut findings = Findings::default();
        while_inside::check(&OracleMotion::new(&cell, recording, &arms), &guarded, &mut findings);
        findings.list
    };
    let right = simulate(&cell, &RunOptions::default()).unwrap().recording;
    assert_eq!(found(&right), []);
    let fast = simulate(&cell, &RunOptions { apply_override: false, ..RunOptions::default() }).unwrap().recording;
    assert!(matches!(found(&fast)[..], [Finding::TooFastInZone { robot: 0, region: 0, most: 0.3, .. }]));
    for output in [3, 7] {
        let mut dark = right.clone();
        dark.robots[0].samples.iter_mut().for_each(|sample| sample.outputs &= !(1 << output));
        assert!(matches!(found(&dark)[..], [Finding::OutputOff { output: o, .. }] if o == output));
    }
    // One tick is enough.
    let mut late = right.clone();
    let middle = late.robots[0].samples.iter().position(|sample| sample.q[0] > 1.0).unwrap();
    late.robots[0].samples[middle].speed_override = 0.4;
    assert_eq!(found(&late).len(), 1);
}

/// A ball on a rail that grips a long part; only the part reaches the plate above the rail.
const PART: &str = r#"
version = 1
units = { length = "m", angle = "rad" }
monitor = { stopping_distance = true }
[robot.a]
dh = [{ kind = "prismatic", min = -1, max = 2, speed = 1 }]
links = [{ sphere = { radius = 0.02 } }]
[object.part]
shape = "box"
at = [0, 0.3, 0]
size = [0.02, 0.6, 0.02]
[region.plate]
shape = "box"
from = [-0.1, 0.4, 1]
to = [0.1, 0.6, 1.1]
[program.a]
steps = [{ grip = "part" }, { move = "joint", to = [0.5] }, { release = "part" }, { move = "joint", to = [2] }]
"#;

#[test]
fn a_part_that_is_carried_into_a_region_is_found_and_one_that_was_put_down_is_not() {
    let found = |text: &str, monitored: bool| {
        let cell = Cell::parse("test.toml", text).unwrap();
        let outcome = simulate(&cell, &RunOptions { apply_override: monitored, ..RunOptions::default() }).unwrap();
        check(&cell, &outcome.recording, &Promises::none(&cell), outcome.has_violation()).list
    };
    assert_eq!(found(PART, false), []);
    let carried = PART.replace("[0.5]", "[1.05]");
    assert_eq!(found(&carried, true), []);
    // Put down elsewhere, and gripped again there.
    let (cell, _) = PART.split_once("steps").unwrap();
    let again = format!(
        r#"{cell}steps = [
            {{ grip = "part" }}, {{ move = "joint", to = [0.5] }}, {{ release = "part" }}, {{ move = "joint", to = [0] }},
            {{ move = "joint", to = [0.5] }}, {{ grip = "part" }}, {{ move = "joint", to = [1.05] }}]"#
    );
    assert_eq!(found(&again, true), []);
    assert!(matches!(found(&again, false)[..], [Finding::Entry { robot: 0, region: 0, .. }]));
    let found = found(&carried, false);
    let [Finding::Entry { robot: 0, region: 0, t_s, .. }] = found[..] else { panic!("{found:?}") };
    // The part's end reaches the plate at 0.99 m.
    assert!((0.99..1.5).contains(&t_s), "{t_s}");
}

#[test]
fn a_robot_that_leaves_its_recording_or_is_ahead_of_it_is_found() {
    let cell = Cell::parse("test.toml", CELL).unwrap();
    let rows = [(0.0, vec![0.0]), (0.2, vec![0.1]), (0.4, vec![-0.1])];
    let layout = RecordingLayout { offset_s: 0.1, ..RecordingLayout::default() };
    let written = RecordingSpec { rows: rows.to_vec(), layout: Some(layout) };
    let found = |place: &dyn Fn(f64) -> f64| {
        let mut recording = simulate(&cell, &RunOptions::default()).unwrap().recording;
        recording.robots[0].samples.iter_mut().for_each(|sample| sample.q = vec![place(sample.t_s)]);
        recorded::first_off(&written, 0, &recording)
    };
    let at = |t_s: f64| if t_s < 0.2 { 0.5 * t_s.max(0.0) } else { (0.3 - t_s).max(-0.1) };
    assert_eq!(found(&|t_s| at(t_s - 0.1)), None);
    // Later and slower is right: the monitor may hold it.
    assert_eq!(found(&|t_s| at(0.7 * (t_s - 0.2))), None);
    assert!(matches!(found(&at), Some(Finding::OffRecording { robot: 0, ahead_s: Some(_), .. })));
    assert!(matches!(found(&|t_s| at(t_s - 0.09)), Some(Finding::OffRecording { ahead_s: Some(_), .. })));
    let leaves = |t_s: f64| at(t_s - 0.1) - if t_s > 0.45 { 0.2 } else { 0.0 };
    assert!(matches!(found(&leaves), Some(Finding::OffRecording { ahead_s: None, .. })));
}

#[test]
fn a_planned_path_through_an_object_is_found() {
    let text = CELL.replace("move = \"joint\", to = [0.5]", "move = \"planned\", to = [0.5]");
    let free = simulate(&Cell::parse("test.toml", &text).unwrap(), &RunOptions::default()).unwrap();
    let touched = |x: f64| {
        let object = format!("[object.post]\nshape = \"sphere\"\nradius = 0.1\nat = [{x}, 0, 0.3]\n");
        let cell = Cell::parse("test.toml", &format!("{text}{object}")).unwrap();
        let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
        let mut findings = Findings::default();
        planned_paths::check(&cell, &free.recording, &arms, &mut findings);
        matches!(findings.list[..], [Finding::Touched { robot: 0, .. }])
    };
    assert!(touched(0.0) && touched(0.11) && !touched(0.13));
}
