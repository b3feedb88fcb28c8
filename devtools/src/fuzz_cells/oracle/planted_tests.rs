//! Tests of the oracle: planted readings beyond limits, and mechanisms that are slowed down.

use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;
use elbowroom_sim::{InputFault, InputFaultKind, Recording, RunOptions, simulate};

use super::{Arm, Finding, Findings, Guarded, mechanisms, motion::OracleMotion, readings, while_inside};

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
        while_inside::check(&OracleMotion::new(&cell, recording, &arms).unwrap(), &guarded, &mut findings);
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
