//! `query --carry` and `plan --carry`: objects that a robot holds.

use crate::common::{Answer, elbowroom, slide_arm, with_cell};

/// An arm that grips a bar at 0 degrees, and a post that only the bar reaches.
const CELL: &str = concat!(
    "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n",
    slide_arm!(),
    r#"start = [0, 0, -100]
[object.bar]
shape = "box"
at = [700, 0, 250]
size = [700, 60, 100]
[object.post]
shape = "cylinder"
at = [866, 500, 500]
radius = 40
height = 1000
"#
);
const PROGRAM: &str = r#"[program.arm]
steps = [
  { move = "joint", to = [0, 0, -270] },
  { grip = "bar" },
  { move = "joint", to = [0, 0, -100] },
  { move = "planned", to = [60, 0, -100] },
]
"#;
/// A region around the post.
const REGION: &str =
    "[region.zone]\nshape = \"cylinder\"\nbase = [866, 500, 0]\nradius = 40\nheight = 1000\nwarning = 20\n";
const STATES: &str = "joint_1,joint_2,joint_3\n0,0,-0.1\n0.5236,0,-0.1\n1.0472,0,-0.1\n";

fn cell(text: &str) -> tempfile::TempDir {
    let dir = with_cell(text);
    std::fs::write(dir.path().join("states.csv"), STATES).unwrap();
    dir
}

fn query(text: &str, more: &[&str]) -> Answer {
    let args = ["query", "cell.toml", "--ask", "distance", "--states", "states.csv", "--json"];
    elbowroom(cell(text).path(), &[&args[..], more].concat())
}

fn distances(answer: &Answer) -> Vec<(f64, String, String)> {
    let json = answer.json();
    let text = |v: &serde_json::Value| v.as_str().unwrap().to_owned();
    let rows = json["rows"].as_array().unwrap().iter();
    rows.map(|r| (r["distance_m"].as_f64().unwrap(), text(&r["a"]), text(&r["b"]))).collect()
}

#[test]
fn a_carried_part_moves_with_the_hand_in_every_row() {
    let text = format!("{CELL}{PROGRAM}");
    let with = distances(&query(&text, &["--carry", "arm=bar", "--between", "arm,post"]).expect(0));
    // The bar reaches from 0.35 m to 1.05 m, 0.06 m wide; the post is 0.04 m thick and 1 m away at 30 degrees.
    assert_eq!(with[1].0, 0.0);
    assert!(with[1].1 == "bar" || with[1].2 == "bar", "{:?}", with[1]);
    let corner = |turn: f64| {
        let (angle, (x, y)) = (std::f64::consts::FRAC_PI_6 - turn, (0.866_f64, 0.5_f64));
        let r = x.hypot(y);
        let (x, y): (f64, f64) = (r * angle.cos(), r * angle.sin());
        (x - x.clamp(0.35, 1.05)).hypot(y - y.clamp(-0.03, 0.03)) - 0.04
    };
    assert!(
        (with[0].0 - corner(0.0)).abs() < 1e-3 && (with[2].0 - corner(std::f64::consts::FRAC_PI_3)).abs() < 1e-3,
        "{with:?}"
    );
    // At its place at the start the part touches nothing.
    let without = distances(&query(&text, &["--between", "arm,post"]).expect(0));
    assert!(without.iter().all(|(metres, ..)| *metres > 0.2), "{without:?}");
    // It is a part of the robot: pairs within the robot are left out.
    let no_self = distances(&query(&text, &["--carry", "arm=bar", "--no-self"]).expect(0));
    assert!(no_self.iter().all(|(_, a, b)| (a == "bar" || a.starts_with("arm/")) && b == "post"), "{no_self:?}");
}

#[test]
fn without_a_program_the_part_must_be_within_grip_at_the_start() {
    let at_start = CELL.replace("start = [0, 0, -100]", "start = [0, 0, -270]");
    let answer = query(&at_start, &["--carry", "arm=bar", "--between", "arm,post"]).expect(0);
    assert_eq!(distances(&answer)[1].0, 0.0);
    let answer = query(CELL, &["--carry", "arm=bar"]).expect(2);
    assert!(answer.stderr.contains("180 mm") && answer.stderr.contains("grip = \"bar\""), "{}", answer.stderr);
}

#[test]
fn a_path_leads_the_part_around() {
    let text = format!("{CELL}{PROGRAM}");
    for scene in [text.clone(), text.replace(&CELL[CELL.find("[object.post]").unwrap()..], REGION)] {
        let plan = |carry: &[&str]| {
            let dir = cell(&scene);
            let args = ["plan", "cell.toml", "--from", "0,0,-0.1", "--to", "1.0472,0,-0.1", "--json"];
            let json = elbowroom(dir.path(), &[&args[..], carry].concat()).expect(0).json();
            json["waypoints"].as_array().unwrap().len()
        };
        assert_eq!(plan(&[]), 2, "the empty hand moves straight");
        assert!(plan(&["--carry", "arm=bar"]) > 2);
        // The planned move of the program does so too, without options.
        let json = elbowroom(cell(&scene).path(), &["run", "cell.toml", "--json"]).expect(0).json();
        assert_eq!(json["robots"][0]["outcome"], "finished");
    }
}

#[test]
fn wrong_calls_say_what_to_write() {
    let text = format!("{CELL}{PROGRAM}");
    for (carry, expected) in
        [("arm", "--carry ROBOT=OBJECT"), ("amr=bar", "arm"), ("arm=barr", "bar"), ("arm=post", "{ grip = \"post\" }")]
    {
        for verb in ["query", "plan"] {
            let dir = cell(&text);
            let more: &[&str] = if verb == "query" { &["--ask", "distance"] } else { &["--to", "1,0,-0.1"] };
            let args = [&[verb, "cell.toml", "--carry", carry][..], more].concat();
            let stderr = elbowroom(dir.path(), &args).expect(2).stderr;
            assert!(stderr.contains(expected), "{verb} {carry}: {stderr}");
        }
    }
    let twice = query(&text, &["--carry", "arm=bar", "--carry", "arm=bar"]).expect(2);
    assert!(twice.stderr.contains("held twice"), "{}", twice.stderr);
}
