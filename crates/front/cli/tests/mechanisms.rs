//! Mechanisms at the command line: `run`, `check`, `query`, `plan`, with a hinged door from a URDF.

use std::fmt::Write as _;
use std::path::Path;

use crate::common::{Answer, elbowroom, with_cell};
use elbowroom_testkit::random::XorshiftStar;

/// A door on a hinge at the origin of its base; its edge is a ball of 100 mm at 800 mm.
const DOOR: &str = r#"<robot name="door">
  <link name="frame"/>
  <link name="leaf"><collision><origin xyz="0.8 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="hinge" type="revolute"><parent link="frame"/><child link="leaf"/><origin xyz="0 0 0"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1.6" velocity="1" effort="1"/></joint>
</robot>
"#;

/// A carriage along x, which passes 800 mm before the hinge; the open door reaches across its path.
const CELL: &str = r#"version = 1
name = "a door"
units = { length = "mm", angle = "deg" }
[robot.arm]
base = { at = [0, 0, 0], rpy = [0, 90, 0] }
dh = [{ name = "slide", kind = "prismatic", min = -2000, max = 2000, speed = 1000, acceleration = 4000 }]
links = [{ sphere = { radius = 50 } }]
start = [-1500]
[robot.door]
kind = "mechanism"
model = "door.urdf"
base = { at = [0, -800, 0] }
[region.edge]
shape = "sphere"
centre = [800, 0, 0]
radius = 100
warning = 300
follow = { robot = "door", frame = "leaf" }
[monitor]
stopping_distance = true
direction_aware = true
[program.arm]
steps = [{ move = "joint", to = [1500] }]
"#;

fn call(cell: &str, args: &[&str]) -> Answer {
    let dir = with_cell(cell);
    std::fs::write(dir.path().join("door.urdf"), DOOR).unwrap();
    elbowroom(dir.path(), args)
}

/// The door starts at this angle, and has these steps.
fn with_door(start_deg: f64, steps: &str) -> String {
    let cell = CELL.replace("[region.edge]", &format!("start = [{start_deg}]\n[region.edge]"));
    if steps.is_empty() { cell } else { format!("{cell}[program.door]\nsteps = [{steps}]\n") }
}

#[test]
fn run_says_what_a_mechanism_is_and_not_that_it_finished() {
    let closed = call(&with_door(0.0, ""), &["run", "cell.toml"]).expect(0).stdout;
    assert!(closed.contains("door   a mechanism, did not move") && closed.contains("arm    finished at"), "{closed}");
    assert!(!closed.contains("TCP on leaf"), "{closed}");
    let open = call(&with_door(90.0, ""), &["run", "cell.toml"]).expect(0).stdout;
    assert!(open.contains("before edge") && open.contains("continues when door moves away"), "{open}");
    let moves = with_door(90.0, "{ wait = 1 }, { move = \"joint\", to = [0] }");
    let moved = call(&moves, &["run", "cell.toml"]).expect(0).stdout;
    assert!(moved.contains("door   a mechanism, moved until ") && moved.contains("arm    finished at"), "{moved}");
    let json = call(&moves, &["run", "cell.toml", "--json"]).expect(0).json();
    let door = &json["robots"][1];
    assert_eq!((&door["outcome"], &door["by"], &door["min_override"]), (&"mechanism".into(), &().into(), &1.0.into()));
    assert!(door["stopped_at_s"].as_f64().is_some_and(|t| (2.0..6.0).contains(&t)), "{door}");
    assert_eq!(json["robots"][0]["outcome"], "finished");
    // The report in words.
    let dir = with_cell(&moves);
    std::fs::write(dir.path().join("door.urdf"), DOOR).unwrap();
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "out"]).expect(0);
    let report = std::fs::read_to_string(dir.path().join("out/report.html")).unwrap();
    assert!(report.contains("door is a mechanism, moved until"), "the result of the report");
}

/// Two balls: one on the carriage, one on the edge of the door.
#[test]
fn the_distance_to_a_door_is_that_of_its_part() {
    let mut random = XorshiftStar(5);
    let mut states = "arm.slide,door.hinge\n".to_owned();
    let mut expected = Vec::new();
    for _ in 0..300 {
        let (slide, hinge) = (random.between(-2.0, 2.0), random.between(0.0, 1.6));
        let _ = writeln!(states, "{slide:?},{hinge:?}");
        let edge = [0.8 * hinge.cos(), -0.8 + 0.8 * hinge.sin()];
        expected.push(((edge[0] - slide).hypot(edge[1]) - 0.15).max(0.0));
    }
    let dir = with_cell(CELL);
    std::fs::write(dir.path().join("door.urdf"), DOOR).unwrap();
    std::fs::write(dir.path().join("q.csv"), states).unwrap();
    let rows = |dir: &Path, more: &[&str]| {
        let args = [&["query", "cell.toml", "--ask", "distance", "--states", "q.csv"], more].concat();
        elbowroom(dir, &args).expect(0).stdout
    };
    let all = rows(dir.path(), &[]);
    assert_eq!(all, rows(dir.path(), &["--between", "arm,door/leaf"]));
    let mut touching = 0;
    for (line, expected) in all.lines().skip(1).zip(&expected) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells[3..5], ["arm/link_1", "door/leaf"], "{line}");
        let distance: f64 = cells[2].parse().unwrap();
        assert!((distance - expected).abs() < 1e-9, "{line}: {expected}");
        touching += usize::from(*expected == 0.0);
    }
    assert!(all.lines().count() == 301 && touching > 5, "{touching}");
}

#[test]
fn commands_that_take_one_robot_take_the_only_robot_and_keep_it_off_the_door() {
    let plan = |start_deg: f64| call(&with_door(start_deg, ""), &["plan", "cell.toml", "--to", "1.5", "--json"]);
    assert!(plan(0.0).expect(0).json()["found"].as_bool().unwrap_or(false));
    let blocked = plan(90.0);
    assert_ne!(blocked.status, 0, "the only way leads through the open door: {}", blocked.stdout);
    let check = call(&with_door(0.0, ""), &["check", "cell.toml", "--json"]).expect(0).stdout;
    assert!(check.contains("\"arm\"") && !check.contains("\"door\""), "{check}");
    let refused = call(
        &CELL.replace("model = \"door.urdf\"", "model = \"door.urdf\"\nvolumes = \"box\""),
        &["check", "cell.toml"],
    );
    let refused = refused.expect(2).stderr;
    assert!(
        refused.contains("\"door\" is a mechanism: it is not guarded") && refused.contains("cell.toml:"),
        "{refused}"
    );
}

#[test]
fn what_needs_a_guarded_robot_or_a_hand_is_refused() {
    let export = call(CELL, &["region", "export", "cell.toml", "--robot", "door", "--to", "krl"]).expect(2).stderr;
    assert!(export.contains("\"door\" is a mechanism") && export.contains("write: --robot"), "{export}");
    let kept = "{ move = \"planned\", to = [60], keep = { axis = \"z\", within = 5 } }";
    let kept = call(&with_door(0.0, kept), &["check", "cell.toml"]).expect(2).stderr;
    assert!(kept.contains("cell.toml:") && kept.contains("no tool whose axis could be kept"), "{kept}");
    let only = CELL.replace("[robot.door]\n", "[robot.door]\nstart = [0]\n");
    let (begin, end) = (only.find("[robot.arm]").unwrap(), only.find("[robot.door]").unwrap());
    let alone = [&only[..begin], &only[end..only.find("[region.edge]").unwrap()]].concat();
    let refused = call(&alone, &["plan", "cell.toml", "--to", "1"]).expect(2).stderr;
    assert!(refused.contains("has 0 robots") && !refused.contains("write: door"), "{refused}");
    // A door beyond its limits does not stop by a monitor.
    let dir = with_cell(&with_door(0.0, ""));
    std::fs::write(dir.path().join("door.urdf"), DOOR).unwrap();
    std::fs::write(dir.path().join("q.csv"), "arm.slide,door.hinge\n0,3.5\n2.5,0\n").unwrap();
    let rows = elbowroom(dir.path(), &["query", "cell.toml", "--ask", "limits", "--states", "q.csv"]).expect(0).stdout;
    let stops: Vec<&str> = rows.lines().skip(1).filter_map(|line| line.rsplit(',').next()).collect();
    assert_eq!(stops, ["0", "1"], "{rows}");
}
