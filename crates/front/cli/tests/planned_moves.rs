//! Goals of planned moves: poses in the cell's units, named states, and planned moves as steps of a program.

use crate::common::{Answer, elbowroom, with_cell};

/// An arm of two links and a wrist, and a post between its ends.
const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }, { a = 100, min = -170, max = 170, speed = 180 }]
links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }, []]
start = [-60, 0, 0]
states = { left = [60, 0, 0], right = [-60, 0, 0] }
[object.post]
shape = "cylinder"
at = [650, 0, 0]
radius = 60
height = 400
"#;

fn plan(args: &[&str]) -> Answer {
    let dir = with_cell(CELL);
    elbowroom(dir.path(), &[&["plan", "cell.toml"], args].concat())
}

fn last(answer: &Answer) -> Vec<f64> {
    let json = answer.json();
    let waypoints = json["waypoints"].as_array().unwrap();
    waypoints.last().unwrap().as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn goals_are_states_values_in_cell_units_or_poses() {
    let sixty = 60.0_f64.to_radians();
    for args in [
        &["--to", "left", "--json"][..],
        &["--to", "60,0,0", "--cell-units", "--json"],
        &["--to", "60 0 0", "--cell-units", "--from", "right", "--json"],
        &["--to", "1.0471975511965976,0,0", "--json"],
    ] {
        let answer = plan(args).expect(0);
        let q = last(&answer);
        assert!((q[0] - sixty).abs() < 1e-9 && q[1..] == [0.0, 0.0], "{args:?}: {q:?}");
        assert!(answer.json()["waypoints"].as_array().unwrap().len() > 2, "around the post");
    }
    // The tip is 800 mm from the base at the left state: 400, 692.8 mm, turned by 60 degrees.
    for pose in ["400,692.8203230275509,0,0,0,60", "400 692.8203230275509 0 0 0 0.5 0.8660254037844386"] {
        let q = last(&plan(&["--to-pose", pose, "--json"]).expect(0));
        let (x, y) = (0..3).fold((0.0, 0.0), |(x, y), i| {
            let (sum, length) = (q[..=i].iter().sum::<f64>(), [0.4, 0.3, 0.1][i]);
            (x + length * sum.cos(), y + length * sum.sin())
        });
        assert!((x - 0.4).abs() < 1e-6 && (y - 0.692_820_323).abs() < 1e-6, "{pose}: {q:?}");
    }
}

#[test]
fn a_robot_starts_in_a_named_state() {
    let cell = CELL.replace("start = [-60, 0, 0]", "start = \"left\"");
    let answer = elbowroom(with_cell(&cell).path(), &["plan", "cell.toml", "--to", "right", "--json"]).expect(0);
    let first = answer.json()["waypoints"][0][0].as_f64().unwrap();
    assert!((first - 60.0_f64.to_radians()).abs() < 1e-12);
}

#[test]
fn wrong_goals_are_refused_with_what_to_write() {
    for (args, expected) in [
        (&["--to", "lefft"][..], "left"),
        (&["--to-pose", "1,2,3"][..], "x,y,z,roll,pitch,yaw"),
        (&["--to-pose", "1,2"][..], "x,y,z,roll,pitch,yaw"),
        (&["--to-pose", "1,2,3,0,0,0,0"][..], "length 0"),
        (&["--to-pose", "1,2,3,0,0,1,1"][..], "length 1.41"),
        (&["--to-pose", "1,2,3,4,5,6,7,8"][..], "x,y,z,qx,qy,qz,qw"),
        (&["--to-pose", "5000,0,0,0,0,0"][..], "the goal of robot \"arm\""),
        (&["--to-pose", "0.4,0.6928,0,0,0,60"][..], "400,692.8,0,…   (in mm, the cell's unit; m seem to be meant)"),
        (&["--to-pose", "1,2,x,0,0,0"][..], "no finite number"),
        (&["--to", "60,0", "--cell-units"][..], "2 values for 3 joints"),
        (&["--to", "200,0,0", "--cell-units"][..], "joint_1"),
        (&["--to", "60,0,0", "--from", "0,0", "--cell-units"][..], "2 values for 3 joints"),
        (&["--urdf", "arm.urdf", "--cell-units"][..], "cannot be used with"),
        (&["--to", "left", "--to-pose", "1,2,3,0,0,0"][..], "cannot be used with"),
        (&[][..], "--to"),
    ] {
        let answer = plan(args).expect(2);
        assert!(answer.stderr.contains(expected), "{args:?}: {}", answer.stderr);
    }
}

/// The stretched arm ends 800 mm from its base; the start is far from all of the targets.
#[test]
fn a_target_out_of_reach_is_told_with_the_distance_that_is_missing_in_the_units_of_the_cell() {
    let target = "{ at = [3800, 0, 0], rpy = [0, 0, 0] }";
    let messages = [
        plan(&["--to-pose", "3800,0,0,0,0,0"]).expect(2).stderr,
        run(&format!("{{ move = \"joint\", to = {target} }}")).expect(2).stderr,
    ];
    for message in messages {
        let rest = message.split("out of reach: the closest found is ").nth(1).unwrap_or_else(|| panic!("{message}"));
        let words: Vec<&str> = rest.split_whitespace().collect();
        assert_eq!([words[1], words[2], words[4], words[5]], ["mm", "and", "deg", "away"], "{message}");
        let missing: f64 = words[0].parse().unwrap();
        assert!((missing - 3000.0).abs() < 5.0, "{message}");
    }
    let line = run(&format!("{{ move = \"linear\", to = {target}, speed = 100 }}")).expect(2).stderr;
    assert!(line.contains(" mm and ") && !line.contains(" rad "), "{line}");
}

fn run(steps: &str) -> Answer {
    let dir = with_cell(&format!("{CELL}[program.arm]\nsteps = [{steps}]\n"));
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "out", "--json"])
}

#[test]
fn a_planned_step_goes_around_what_a_joint_move_hits() {
    let hits = run("{ move = \"joint\", to = \"left\" }").expect(1).json();
    assert!(!hits["robots"][0]["collisions"].as_array().unwrap().is_empty());
    let around = run("{ move = \"planned\", to = \"left\" }, { wait = 0.1 }, { move = \"planned\", to = \"right\" }")
        .expect(0)
        .json();
    let robot = &around["robots"][0];
    assert!(robot["outcome"] == "finished" && robot["collisions"].as_array().unwrap().is_empty(), "{robot}");
    // A move to a pose at half speed takes longer.
    let pose = "{ at = [400, 692.8203230275509, 0], rpy = [0, 0, 60] }";
    let fast = run(&format!("{{ move = \"planned\", to = {pose} }}")).expect(0).json();
    let slow = run(&format!("{{ move = \"planned\", to = {pose}, speed = 50 }}")).expect(0).json();
    assert!(slow["duration_s"].as_f64().unwrap() > 1.4 * fast["duration_s"].as_f64().unwrap());
}

#[test]
fn a_planned_step_without_a_path_names_its_line() {
    for (steps, expected) in [
        ("{ move = \"planned\", to = \"lefft\" }", "names the state \"lefft\""),
        ("{ move = \"planned\", to = [0, 0, 0] }", "in collision"),
        ("{ move = \"planned\", to = { at = [5000, 0, 0] } }", "step 1"),
        ("{ move = \"planed\", to = \"left\" }", "planned"),
        ("{ move = \"planned\", to = true }", "nor the name of a state"),
    ] {
        let answer = run(steps).expect(2);
        assert!(
            answer.stderr.contains(expected) && answer.stderr.contains("cell.toml:1"),
            "{steps}: {}",
            answer.stderr
        );
    }
    let dir = with_cell(&CELL.replace("left = [60, 0, 0]", "left = [60, 0]"));
    let answer = elbowroom(dir.path(), &["check", "cell.toml"]).expect(2);
    assert!(answer.stderr.contains("cell.toml:7"), "{}", answer.stderr);
}

#[test]
fn recordings_of_controllers_play_as_they_are() {
    let dir = with_cell("");
    let log = "Joint_1;joint_2;A3\n-60,0;0;0\n-59,5;0,5;0\n-59;1;0,25\n";
    std::fs::write(dir.path().join("log.csv"), log).unwrap();
    let run = |trajectory: &str| {
        let cell = CELL.replace("start = [-60, 0, 0]\n", "") + &format!("[program.arm]\ntrajectory = {trajectory}\n");
        std::fs::write(dir.path().join("cell.toml"), cell).unwrap();
        elbowroom(dir.path(), &["run", "cell.toml", "--out", "out", "--json"])
    };
    let good = "{ file = \"log.csv\", angle = \"deg\", period_ms = 100, columns = { joint_3 = \"A3\" }, offset = 0.5 }";
    let answer = run(good).expect(0).json();
    assert!((answer["duration_s"].as_f64().unwrap() - 0.7).abs() < 0.05, "{answer}");
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let q = |line: &str| line.split(',').skip(2).take(3).map(|v| v.parse::<f64>().unwrap()).collect::<Vec<_>>();
    let (first, last) = (q(trace.lines().nth(1).unwrap()), q(trace.lines().last().unwrap()));
    assert!((first[0] + 60.0_f64.to_radians()).abs() < 1e-9, "{first:?}");
    assert!(
        (last[0] + 59.0_f64.to_radians()).abs() < 1e-3 && (last[2] - 0.25_f64.to_radians()).abs() < 1e-3,
        "{last:?}"
    );
    for (trajectory, expected) in [
        ("{ angle = \"deg\" }", "needs the key `file`"),
        ("{ file = \"log.csv\", angle = \"grad\" }", "known are: rad, deg"),
        ("{ file = \"log.csv\", time = \"t\", period_ms = 4 }", "one of the two"),
        ("{ file = \"log.csv\", period_ms = 4, columns = { joint_9 = \"A3\" } }", "joint_9"),
        ("{ file = \"log.csv\", columns = { joint_3 = \"A3\" } }", "no column `t_s`"),
        ("{ file = \"log.csv\", period_ms = 100 }", "joint_3"),
    ] {
        let answer = run(trajectory).expect(2);
        assert!(answer.stderr.contains(expected), "{trajectory}: {}", answer.stderr);
    }
    // The message about a plain file names the name that differs only in capitals.
    std::fs::write(dir.path().join("plain.csv"), "t_s,Joint_1,joint_2,joint_3\n0,0,0,0\n").unwrap();
    assert!(run("\"plain.csv\"").expect(2).stderr.contains("`Joint_1` differs in capitals"));
}

#[test]
fn a_start_in_which_own_links_touch_shows_the_key_that_ignores_them() {
    let cell = |last: &str| {
        CELL.replace("links = [[], ", "links = [{ sphere = { at = [0, 0, 0], radius = 120 } }, ")
            .replace("radius = 40 } }, []]", &format!("radius = 40 }} }}, {last}]"))
    };
    // In contact at their joint for all joint values: they are built so.
    let always = with_cell(&cell("{ sphere = { at = [-100, 0, 0], radius = 230 } }"));
    let planned = elbowroom(always.path(), &["plan", "cell.toml", "--to", "left"]).expect(0);
    assert!(planned.stderr.contains("link_1") && planned.stderr.contains("link_3"), "{}", planned.stderr);
    // In contact if the arm is straight.
    let dir = with_cell(&cell("{ sphere = { at = [-150, 0, 0], radius = 170 } }"));
    let refused = elbowroom(dir.path(), &["plan", "cell.toml", "--to", "left"]).expect(2);
    assert!(refused.stderr.contains("ignore = [[\"link_1\", \"link_3\"]] in [robot.arm]"), "{}", refused.stderr);
}

#[test]
fn states_of_an_srdf_are_states_of_the_robot() {
    let dir = with_cell(&CELL.replace("states = {", "srdf = \"arm.srdf\"\nstates = {"));
    let srdf = r#"<robot name="arm">
<group_state name="folded" group="wrist"><joint name="joint_3" value="2.0"/></group_state>
<group_state name="folded" group="arm"><joint name="joint_1" value="-1.0"/><joint name="joint_2" value="0.5"/></group_state>
<group_state name="left" group="arm"><joint name="joint_1" value="0"/></group_state>
<group_state name="open" group="hand"><joint name="finger" value="1"/></group_state></robot>"#;
    std::fs::write(dir.path().join("arm.srdf"), srdf).unwrap();
    let to = |name: &str| elbowroom(dir.path(), &["plan", "cell.toml", "--to", name, "--json"]);
    assert_eq!(last(&to("folded").expect(0)), [-1.0, 0.5, 0.0], "the state with more joints, others at the start");
    assert!((last(&to("left").expect(0))[0] - 60.0_f64.to_radians()).abs() < 1e-9, "the cell's own state counts");
    assert!(to("open").expect(2).stderr.contains("no state"));
    std::fs::write(dir.path().join("arm.srdf"), srdf.replace(" value=\"2.0\"", "")).unwrap();
    assert!(to("folded").expect(0).stderr.contains("<joint> has no value: ignored"));
}
