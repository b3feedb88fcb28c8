//! `elbowroom query --between`, `--no-self`, `--all-pairs`: the tested pairs, and the messages for wrong names.

use crate::common::{Answer, elbowroom, with_cell};

/// Two arms of one link each, and a third link that folds back onto the first; a sphere, a post, regions.
const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.left]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }, [], { capsule = { from = [-200, 0, 0], to = [0, 0, 0], radius = 40 } }]
start = [0, 90, 90]
[robot.right]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }]
links = [{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }]
base = { at = [1500, 0, 0], rpy = [0, 0, 180] }
[object.ball]
shape = "sphere"
at = [0, 1000, 0]
radius = 100
[object.post]
shape = "sphere"
at = [0, -1000, 0]
radius = 100
[region.corner]
shape = "sphere"
centre = [400, -1000, 0]
radius = 100
warning = 50
[region.hand]
shape = "sphere"
centre = [0, 0, 0]
radius = 100
warning = 50
follow = { robot = "right", frame = "link_1" }
"#;

fn query(args: &[&str]) -> Answer {
    let dir = with_cell(CELL);
    elbowroom(dir.path(), &[&["query", "cell.toml"], args].concat())
}

/// Returns distance and both names of each row.
fn rows(answer: &Answer) -> Vec<(f64, String, String)> {
    let of = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[2].parse().unwrap_or(f64::NAN), cells[3].to_owned(), cells[4].to_owned())
    };
    answer.stdout.lines().skip(1).map(of).collect()
}

#[track_caller]
fn assert_row(args: &[&str], metres: f64, a: &str, b: &str) {
    let answer = query(&[&["--ask", "distance"], args].concat()).expect(0);
    let rows = rows(&answer);
    assert_eq!(rows.len(), 1, "{}", answer.stdout);
    let (found, x, y) = &rows[0];
    assert!((found - metres).abs() < 1e-9, "{rows:?}");
    assert!((x, y) == (&a.to_owned(), &b.to_owned()) || (x, y) == (&b.to_owned(), &a.to_owned()), "{rows:?}");
}

#[test]
fn only_the_named_pairs_are_tested() {
    // From link_3, at (300, 300) to (100, 300) mm, to the sphere; from the tip of the right arm, at 1100 mm, to link_1.
    assert_row(&["--between", "left,ball"], (100.0_f64.hypot(700.0) - 140.0) / 1e3, "left/link_3", "ball");
    assert_row(&["--between", "left/link_1,right"], 0.62, "left/link_1", "right/link_1");
    assert_row(&["--between", "ball,post"], 1.8, "ball", "post");
    assert_row(&["--between", "left,ball;left,right"], (100.0_f64.hypot(700.0) - 140.0) / 1e3, "left/link_3", "ball");
    // Two links of one arm are nearer than all other pairs.
    assert_row(&[], 0.22, "left/link_1", "left/link_3");
    assert_row(&["--between", "left,left"], 0.22, "left/link_1", "left/link_3");
    assert_row(&["--no-self"], (100.0_f64.hypot(700.0) - 140.0) / 1e3, "left/link_3", "ball");
}

#[test]
fn regions_are_partners_and_those_that_follow_a_robot_move_with_it() {
    assert_row(&["--between", "left,corner"], 0.86, "left/link_1", "corner");
    assert_row(&["--between", "left/link_1,hand"], 0.56, "left/link_1", "hand");
    let dir = with_cell(CELL);
    std::fs::write(dir.path().join("q.csv"), "right.joint_1\n0\n1.5707963267948966\n").unwrap();
    let args = ["query", "cell.toml", "--ask", "distance", "--between", "left/link_1,hand", "--states", "q.csv"];
    let moved = rows(&elbowroom(dir.path(), &args).expect(0));
    let expected = (1100.0_f64.hypot(400.0) - 140.0) / 1e3;
    assert!((moved[0].0 - 0.56).abs() < 1e-9 && (moved[1].0 - expected).abs() < 1e-9, "{moved:?}");
    // A region is a solid only if it is named.
    assert!(!query(&["--ask", "distance", "--all-pairs", "10"]).expect(0).stdout.contains("corner"));
}

#[test]
fn all_near_pairs_are_listed_the_nearest_first() {
    let all = rows(&query(&["--ask", "distance", "--all-pairs", "1.0"]).expect(0));
    assert!(all.len() >= 4 && all.windows(2).all(|w| w[0].0 <= w[1].0), "{all:?}");
    assert!(all.iter().all(|row| row.0 <= 1.0));
    assert_eq!((&all[0].1[..], &all[0].2[..]), ("left/link_1", "left/link_3"));
    let some =
        rows(&query(&["--ask", "distance", "--all-pairs", "1.0", "--between", "left,right;right,left"]).expect(0));
    // Both orders of one pair give one row.
    assert_eq!(some.len(), 2, "{some:?}");
    assert!(query(&["--ask", "distance", "--all-pairs", "0.01"]).expect(0).stdout.lines().count() == 1);
    let json = query(&["--ask", "distance", "--all-pairs", "1.0", "--json"]).expect(0).json();
    assert_eq!(json["rows"].as_array().unwrap().len(), all.len());
}

#[test]
fn collisions_and_tolerances_are_those_of_the_pairs() {
    let json = query(&["--ask", "tolerance=0.65", "--between", "left,right", "--json"]).expect(0).json();
    assert_eq!((json["rows"][0]["collides"].as_u64(), json["rows"][0]["b"].as_str()), (Some(1), Some("right/link_1")));
    let dir = with_cell(CELL);
    std::fs::write(dir.path().join("q.csv"), "left.joint_1,left.joint_2,left.joint_3\n0,0,3.1\n").unwrap();
    let folded = |more: &[&str], status: i32| {
        let args = [&["query", "cell.toml", "--ask", "collision", "--states", "q.csv"], more].concat();
        elbowroom(dir.path(), &args).expect(status)
    };
    folded(&[], 1);
    folded(&["--no-self"], 0);
    folded(&["--between", "left,ball"], 0);
}

#[test]
fn wrong_names_and_contradictions_are_refused_with_what_to_write() {
    for (args, expected) in [
        (&["--between", "left,bal"][..], "ball"),
        (&["--between", "left"][..], "arm,table"),
        (&["--between", "left,ball,post"][..], "semicolons"),
        (&["--between", ";"][..], "arm,table"),
        (&["--between", "left/link_9,ball"][..], "left/link_"),
        (&["--between", "left/link_1,left", "--no-self"][..], "--no-self"),
        (&["--all-pairs", "-1"][..], "0 or more"),
        (&["--all-pairs", "near"][..], "0 or more"),
        (&["--all-pairs", "nan"][..], "0 or more"),
        (&["--between", "left,left", "--no-self"][..], "--no-self"),
        (&["--no-self=1"][..], "unexpected value"),
    ] {
        let answer = query(&[&["--ask", "distance"], args].concat()).expect(2);
        assert!(answer.stderr.contains(expected) && answer.stdout.is_empty(), "{args:?}: {}", answer.stderr);
    }
    let answer = query(&["--ask", "collision", "--all-pairs", "1"]).expect(2);
    assert!(answer.stderr.contains("--ask distance"), "{}", answer.stderr);
}

#[test]
fn quaternions_stand_wherever_rpy_does() {
    let turned = |by: &str| {
        let cell = CELL
            .replace(
                "shape = \"sphere\"\nat = [0, 1000, 0]\nradius = 100\n",
                &format!("shape = \"box\"\nat = [0, 1000, 0]\nsize = [100, 600, 100]\n{by}\n"),
            )
            .replace(
                "rpy = [0, 0, 180]",
                if by.starts_with('q') { "quaternion = [0, 0, 1, 0]" } else { "rpy = [0, 0, 180]" },
            );
        let dir = with_cell(&cell);
        elbowroom(dir.path(), &["query", "cell.toml", "--ask", "distance", "--between", "left,ball;right,ball"])
    };
    let (angles, quaternion) = (
        rows(&turned("rpy = [0, 0, 90]").expect(0)),
        rows(&turned("quaternion = [0, 0, 0.70710678, 0.70710678]").expect(0)),
    );
    assert!((angles[0].0 - quaternion[0].0).abs() < 1e-9 && angles[0].0 > 0.5, "{angles:?} {quaternion:?}");
    for (by, expected) in [
        ("quaternion = [0, 0, 1]", "needs 4 numbers, not 3"),
        ("quaternion = [0, 0, 1, 1]", "has the length 1.4"),
        ("quaternion = [0, 0, 0, 1]\nrpy = [0, 0, 0]", "contradicts `rpy`"),
    ] {
        let message = turned(by).expect(2).stderr;
        assert!(message.contains(expected) && message.contains("cell.toml:"), "{by}: {message}");
    }
}
