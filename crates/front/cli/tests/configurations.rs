//! Choice between solutions of inverse kinematics for a pose: `configuration` and `near`.

use crate::common::{Answer, elbowroom, with_cell};

/// Six axes with a spherical wrist; the upper arm is upright and the forearm level at zero.
const ROBOT: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [
  { a = 300, alpha = 90, d = 600, min = -170, max = 170, speed = 100 },
  { a = 700, theta = 90, min = -180, max = 120, speed = 100 },
  { alpha = 90, min = -170, max = 220, speed = 100 },
  { alpha = -90, d = 620, min = -350, max = 350, speed = 200 },
  { alpha = 90, min = -150, max = 150, speed = 200 },
  { d = 120, min = -350, max = 350, speed = 300 },
]
start = [0, 0, 0, 0, 30, 0]
states = { turned = [0, 0, 0, 180, 30, 180] }
"#;

const POSE: &str = "900,100,1200,0,120,0";

fn plan(args: &[&str]) -> Answer {
    elbowroom(with_cell(ROBOT).path(), &[&["plan", "cell.toml", "--to-pose", POSE], args].concat())
}

fn end(answer: &Answer) -> Vec<f64> {
    let json = answer.json();
    let waypoints = json["waypoints"].as_array().unwrap();
    waypoints.last().unwrap().as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn a_plan_ends_in_the_configuration_that_is_asked_for() {
    let any = plan(&["--json"]).expect(0).json()["configuration"].as_str().unwrap().to_owned();
    assert!(any.starts_with("front up "), "{any}");
    for wanted in ["front up no_flip", "front up flip", "front down flip", "front down no_flip"] {
        let answer = plan(&["--json", "--configuration", &wanted.replace(' ', ",")]).expect(0);
        assert_eq!(answer.json()["configuration"], wanted);
        assert_eq!(end(&answer)[4] >= 0.0, wanted.ends_with("no_flip"), "{:?}", end(&answer));
    }
    let table = plan(&["--configuration", "down"]).expect(0).stdout;
    assert!(table.contains("ends in the configuration front down "), "{table}");
}

#[test]
fn near_chooses_the_turns_as_well() {
    let plain = end(&plan(&["--json", "--configuration", "up,no_flip"]).expect(0));
    let degrees = |q: &[f64], i: usize, by: f64| {
        let mut near = q.to_vec();
        near[i] += by.to_radians();
        near.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
    };
    let turned = if plain[5] > 0.0 { -300.0 } else { 300.0 };
    let other = end(&plan(&["--json", "--near", &degrees(&plain, 5, turned)]).expect(0));
    let difference = (other[5] - plain[5]).to_degrees().abs();
    assert!((difference - 360.0).abs() < 1e-6 && (other[4] - plain[4]).abs() < 1e-9, "{plain:?} {other:?}");
    let turned = plan(&["--json", "--near", "turned"]).expect(0).json();
    assert_eq!(turned["configuration"], "front up no_flip");
}

#[test]
fn wrong_choices_are_refused_with_what_to_write() {
    for (args, expected) in [
        (&["--configuration", "upwards"][..], "no word of a configuration"),
        (&["--configuration", "up,down"][..], "contradicts or repeats"),
        (&["--configuration", "back"][..], "not reached in the configuration back, but in front "),
        (&["--near", "1,2"][..], "2 values for 6 joints"),
        (&["--near", "nowhere"][..], "no state \"nowhere\""),
        (&["--near", "a,b"][..], "--near"),
    ] {
        let answer = plan(args).expect(2);
        assert!(answer.stderr.contains(expected), "{args:?}: {}", answer.stderr);
    }
    for option in [["--configuration", "up"], ["--near", "turned"]] {
        let dir = with_cell(ROBOT);
        let answer = elbowroom(dir.path(), &[&["plan", "cell.toml", "--to", "turned"], &option[..]].concat()).expect(2);
        assert!(answer.stderr.contains("cannot be used with"), "{}", answer.stderr);
    }
}

fn run(step: &str) -> Answer {
    let dir = with_cell(&format!("{ROBOT}[program.arm]\nsteps = [{step}]\n"));
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "out", "--json"])
}

/// Returns the last value of joint 5 in the recorded run, degrees.
fn last_of_joint_5(step: &str) -> f64 {
    let dir = with_cell(&format!("{ROBOT}[program.arm]\nsteps = [{step}]\n"));
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "out", "--json"]).expect(0);
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let mut rows = trace.lines();
    let column = rows.next().unwrap().split(',').position(|c| c == "q5").expect("the column of joint 5");
    rows.next_back().unwrap().split(',').nth(column).unwrap().parse::<f64>().unwrap().to_degrees()
}

#[test]
fn steps_of_a_program_choose_it() {
    let pose = "at = [900, 100, 1200], rpy = [0, 120, 0]";
    for kind in ["joint", "planned"] {
        for (words, sign) in [("[\"no_flip\"]", 1.0), ("[\"flip\", \"up\"]", -1.0)] {
            let step = format!("{{ move = \"{kind}\", to = {{ {pose}, configuration = {words} }} }}");
            assert!(last_of_joint_5(&step) * sign > 1.0, "{step}");
        }
        let near = format!("{{ move = \"{kind}\", to = {{ {pose}, near = \"turned\" }} }}");
        assert!(last_of_joint_5(&near) > 1.0);
        let near = format!("{{ move = \"{kind}\", to = {{ {pose}, near = [0, 0, 0, 0, -30, 0] }} }}");
        assert!(last_of_joint_5(&near) < -1.0);
    }
}

#[test]
fn wrong_steps_are_refused_at_their_line() {
    let pose = "at = [900, 100, 1200], rpy = [0, 120, 0]";
    for (kind, keys, expected) in [
        ("joint", "configuration = \"up\"", "must be a list"),
        ("joint", "configuration = [3]", "must be a text"),
        ("joint", "configuration = [\"above\"]", "no word of a configuration"),
        ("joint", "configuration = [\"up\", \"up\"]", "contradicts or repeats"),
        ("joint", "configuration = [\"back\"]", "not reached in the configuration back"),
        ("linear", "configuration = [\"up\"]", "a linear move keeps the one that it begins in"),
        ("linear", "near = \"turned\"", "a linear move keeps the one that it begins in"),
        ("joint", "near = [1, 2]", "has 2 values for the 6 joints"),
        ("joint", "near = \"nowhere\"", "names the state \"nowhere\""),
        ("planned", "near = true", "neither joint values nor the name of a state"),
        ("joint", "near = [0, 0, 0, 0, 190, 0]", "outside its limits"),
    ] {
        let stderr = run(&format!("{{ move = \"{kind}\", to = {{ {pose}, {keys} }} }}")).expect(2).stderr;
        assert!(stderr.contains(expected) && stderr.contains("cell.toml:15"), "{keys}: {stderr}");
    }
    let planar = "version = 1\nunits = { length = \"m\", angle = \"rad\" }\n[robot.arm]\ndh = [{ a = 0.4, min = -2, max = 2, speed = 1 }, { a = 0.3, min = -2, max = 2, speed = 1 }]\n\
                  [program.arm]\nsteps = [{ move = \"joint\", to = { at = [0.5, 0.2, 0], configuration = [\"up\"] } }]\n";
    let stderr = elbowroom(with_cell(planar).path(), &["run", "cell.toml"]).expect(2).stderr;
    assert!(
        stderr.contains("cell.toml:6") && stderr.contains("spherical wrist") && stderr.contains("near"),
        "{stderr}"
    );
}
