//! Mechanisms in a run: robots slow down for them, nothing slows them down, and they decide no exit status.

use crate::common::{HEAD, rail};
use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;
use elbowroom_sim::{
    InputFault, InputFaultKind, Outcome, RobotTrack, RunEnd, RunOptions, RunOutcome, RunSummary, simulate,
};

const LAWS: &str = "[monitor]\nstopping_distance = true\ndirection_aware = true\n";
const PROGRAM: &str = "[program.a]\nsteps = [{ move = \"joint\", to = [1500] }]\n";
const BALL: &str = "links = [{ sphere = { radius = 300 } }]\n";
const LEAF: &str = "[region.leaf]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 300\n\
                    follow = { robot = \"door\", frame = \"link_1\" }\n";

/// A carriage that passes x = 0, and a sliding door that is beside its path at 0 and on its path at 1500.
fn cell(keys: &str, more: &str) -> String {
    format!("{HEAD}{}start = [-1500]\n{}{more}{LAWS}{PROGRAM}", rail("a", 0.0), door("door", keys))
}

fn door(name: &str, keys: &str) -> String {
    format!(
        "[robot.{name}]\nkind = \"mechanism\"\nbase = {{ at = [0, -1500, 0], rpy = [-90, 0, 0] }}\n\
         dh = [{{ kind = \"prismatic\", min = 0, max = 3000, speed = 800, acceleration = 2000 }}]\n{BALL}{keys}\n"
    )
}

/// The cell with a carriage that starts after some seconds.
fn after(wait_s: &str, cell: &str) -> String {
    cell.replace(
        "steps = [{ move = \"joint\", to = [1500] }]\n",
        &format!("steps = [{{ wait = {wait_s} }}, {{ move = \"joint\", to = [1500] }}]\n"),
    )
}

fn run(text: &str) -> RunOutcome {
    let cell = Cell::parse("cell.toml", text).unwrap_or_else(|e| panic!("{e}"));
    simulate(&cell, &RunOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn tracks(outcome: &RunOutcome) -> [&RobotTrack; 2] {
    [&outcome.recording.robots[0], &outcome.recording.robots[1]]
}

#[test]
fn an_open_door_stops_a_robot_and_a_closed_one_does_not() {
    let closed = run(&cell("start = [0]", LEAF));
    let [robot, door] = tracks(&closed);
    assert!(robot.finished && robot.ending.outcome == Outcome::Finished && robot.min_override == 1.0);
    assert_eq!((door.ending.outcome, door.ending.stopped_at_s), (Outcome::Mechanism, Some(0.0)));
    assert!(!closed.has_violation() && closed.recording.end == RunEnd::Finished);
    let open = run(&cell("start = [1500]", LEAF));
    let [robot, door] = tracks(&open);
    assert_eq!((robot.ending.outcome, robot.ending.by.as_deref()), (Outcome::Stopped, Some("leaf")));
    // Ball of 50 mm before a ball of 300 mm.
    let x = robot.samples.last().unwrap().q[0];
    assert!((-0.36..-0.35).contains(&x), "{x}");
    assert!(robot.ending.release.as_ref().unwrap().contains("door moves away"), "{:?}", robot.ending);
    assert_eq!((door.ending.outcome, door.min_override), (Outcome::Mechanism, 1.0));
    assert!(!open.has_violation());
}

#[test]
fn a_robot_waits_for_a_door_that_swings_and_the_door_for_nobody() {
    let program = "[program.door]\nsteps = [{ wait = 0.2 }, { move = \"joint\", to = [1500] }, { wait = 1 }, \
                   { move = \"joint\", to = [0] }]\n";
    let outcome = run(&after("1.2", &cell("", &format!("{LEAF}{program}"))));
    let [robot, leaf] = tracks(&outcome);
    assert!(robot.finished && robot.min_override < 0.05, "{}", robot.min_override);
    assert!(outcome.recording.regions[0].min_distance_m.unwrap() > 0.0 && !outcome.has_violation());
    let until_s = leaf.ending.stopped_at_s.unwrap();
    assert!(leaf.ending.outcome == Outcome::Mechanism && (5.0..7.0).contains(&until_s), "{until_s}");
    // It moves as it does alone.
    let alone = format!("{HEAD}{}{program}{LAWS}", door("door", ""));
    let alone = run(&alone).recording.robots.remove(0);
    assert!(alone.is_mechanism());
    for (beside, alone) in leaf.samples.iter().zip(&alone.samples) {
        assert_eq!((&beside.q, beside.speed_override), (&alone.q, 1.0), "at {} s", beside.t_s);
    }
    // Nor does it stop if its monitor has no input.
    let fault = InputFault { robot: RobotId(1), from_s: 0.5, to_s: 9.0, kind: InputFaultKind::NotANumber };
    let options = RunOptions { faults: vec![fault], ..RunOptions::default() };
    let text = after("1.2", &cell("", &format!("{LEAF}{program}")));
    let blind = simulate(&Cell::parse("cell.toml", &text).unwrap(), &options).unwrap();
    let [_, unread] = tracks(&blind);
    assert!(unread.samples.iter().zip(&leaf.samples).all(|(a, b)| a.q == b.q) && unread.samples.len() > 1000);
    let json = serde_json::to_value(RunSummary::from(&outcome.recording)).unwrap();
    assert_eq!(json["robots"][1]["outcome"], "mechanism");
    assert_eq!(json["robots"][1]["flange"], "");
    assert!((json["robots"][1]["stopped_at_s"].as_f64().unwrap() - until_s).abs() < 1e-12);
}

/// The same motion, once of a door and once of an object: 400 mm/s across the path, from 0.5 s on.
#[test]
fn a_robot_slows_down_for_a_door_as_for_an_object() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("door.csv"), "t_s,joint_1\n0,0\n0.5,0\n8,3\n").unwrap();
    let of_door = cell("", &format!("{LEAF}[program.door]\ntrajectory = \"door.csv\"\n"));
    let object = "[object.cart]\nshape = \"sphere\"\nat = [0, -1500, 0]\nradius = 300\n\
                  motion = { via = [[0, 1500, 0]], speed = 400, start = 0.5 }\n";
    let of_object = format!(
        "{HEAD}{}start = [-1500]\n{object}{}{LAWS}{PROGRAM}",
        rail("a", 0.0),
        LEAF.replace("robot = \"door\", frame = \"link_1\"", "object = \"cart\"")
    );
    let run = |text: &str| {
        let cell = Cell::parse(dir.path().join("cell.toml"), text).unwrap_or_else(|e| panic!("{e}"));
        simulate(&cell, &RunOptions::default()).unwrap_or_else(|e| panic!("{e}")).recording.robots.remove(0)
    };
    let (door, object) = (run(&after("2", &of_door)), run(&after("2", &of_object)));
    assert!(door.finished && door.min_override < 0.2, "it is slowed down: {}", door.min_override);
    let apart = door.samples.iter().zip(&object.samples).map(|(a, b)| (a.q[0] - b.q[0]).abs()).fold(0.0, f64::max);
    // The recorded velocity steps from one row to the next; that of the object at once.
    assert!(apart < 0.005, "{apart} m");
}

#[test]
fn a_door_that_hits_a_robot_counts_and_one_that_hits_a_box_does_not() {
    let swings = "[program.door]\nsteps = [{ move = \"joint\", to = [1500] }]\n";
    let rests = PROGRAM.replace("to = [1500]", "to = [0]");
    // Nothing guards the robot against the door.
    let hit = run(&cell("", swings).replace(PROGRAM, &rests));
    let [robot, door] = tracks(&hit);
    assert_eq!((robot.ending.outcome, robot.ending.by.as_deref()), (Outcome::Collided, Some("door/link_1")));
    assert_eq!(door.ending.outcome, Outcome::Mechanism);
    assert!(hit.has_violation() && !door.collisions.is_empty());
    // The box stands where only the door comes.
    let object = "[object.box]\nshape = \"box\"\nat = [0, -700, 0]\nsize = [100, 100, 100]\n";
    let only_box = run(&cell("", &format!("{object}{}", swings.replace("to = [1500]", "to = [600]"))));
    let [robot, door] = tracks(&only_box);
    assert!(robot.finished && door.collisions.iter().any(|c| c.a == "box" || c.b == "box"), "{:?}", door.collisions);
    assert!(!only_box.has_violation());
}
