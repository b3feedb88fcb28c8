//! `elbowroom plan` for several robots: document, samples, exit status, messages.

use crate::common::{Answer, elbowroom, with_cell};

/// Two arms that face each other and sweep through the same middle.
const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.left]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
base = { at = [-450, 0, 0], rpy = [0, 0, 0] }
start = [-60, 0]
[robot.left.states]
over = [60, 0]
middle = [0, 0]
[robot.right]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
base = { at = [450, 0, 0], rpy = [0, 0, 180] }
start = [-60, 0]
[robot.right.states]
middle = [0, 0]
"#;

fn plan(args: &[&str]) -> Answer {
    let dir = with_cell(CELL);
    let all: Vec<&str> = ["plan", "cell.toml"].into_iter().chain(args.iter().copied()).collect();
    elbowroom(dir.path(), &all)
}

#[test]
fn two_robots_have_one_file_and_a_cost_each() {
    let dir = with_cell(CELL);
    let args = "plan cell.toml --cell-units --robot left --from start --to over --robot right --from start --to 60,0";
    let both: Vec<&str> = args.split(' ').chain(["--out", "both.csv", "--period", "0.01", "--json"]).collect();
    let answer = elbowroom(dir.path(), &both).expect(0).json();
    assert_eq!(answer["found"], true);
    let robots = answer["robots"].as_array().unwrap();
    assert_eq!(robots.iter().map(|r| r["robot"].as_str().unwrap()).collect::<Vec<_>>(), ["left", "right"]);
    for robot in robots {
        assert!(robot["cost_rad"].as_f64().unwrap() > 2.0 && robot["end_s"].as_f64() <= answer["duration_s"].as_f64());
    }
    let csv = std::fs::read_to_string(dir.path().join("both.csv")).unwrap();
    assert_eq!(csv.lines().next(), Some("t_s,left.joint_1,left.joint_2,right.joint_1,right.joint_2"));
    let last: Vec<f64> = csv.lines().last().unwrap().split(',').map(|v| v.parse().unwrap()).collect();
    assert!((last[0] - answer["duration_s"].as_f64().unwrap()).abs() < 1e-9);
    let goal = 60_f64.to_radians();
    assert!((last[1] - goal).abs() < 1e-9 && (last[3] - goal).abs() < 1e-9 && last[2] == 0.0 && last[4] == 0.0);
    let text = plan(&["--robot", "left", "--to", "over", "--robot", "right", "--to", "1,0"]).expect(0).stdout;
    assert!(text.contains("2 robots at the same time") && text.contains("right"), "{text}");
}

#[test]
fn a_report_plays_the_paths() {
    let dir = with_cell(CELL);
    let go = |args: &str| elbowroom(dir.path(), &args.split(' ').collect::<Vec<_>>());
    go("plan cell.toml --robot left --from start --to over --robot right --from start --to 1,0 --report both.html")
        .expect(0);
    go("plan cell.toml --robot left --to over --report one.html").expect(0);
    let page = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
    for name in ["both.html", "one.html"] {
        let page = page(name);
        assert!(page.starts_with("<!DOCTYPE html>") && page.contains("left") && page.contains("right"), "{name}");
    }
    // Errors: a missing folder, no path, problems.
    let message = go("plan cell.toml --robot left --to over --report missing/one.html").expect(2).stderr;
    assert!(message.contains("missing/one.html") && message.contains("write:"), "{message}");
    go("plan cell.toml --robot left --to middle --robot right --to middle --report none.html").expect(1);
    assert!(!dir.path().join("none.html").exists());
    let message = go("plan --urdf arm.urdf --problems p.json --report one.html").expect(2).stderr;
    assert!(message.contains("--report"), "{message}");
}

/// On one rail neither robot can pass the other, in any order: the message says that, without a count of unchecked states.
#[test]
fn robots_that_would_have_to_make_way_are_told_so() {
    let carriage = |name: &str, start: f64| {
        format!(
            "[robot.{name}]\nbase = {{ at = [0, 0, 0], rpy = [0, 90, 0] }}\n\
             dh = [{{ kind = \"prismatic\", min = 0, max = 2000, speed = 1000 }}]\n\
             links = [{{ sphere = {{ radius = 50 }} }}]\nstart = [{start}]\n"
        )
    };
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n{}{}",
        carriage("left", 200.0),
        carriage("right", 1800.0)
    );
    let dir = with_cell(&text);
    let args = "plan cell.toml --cell-units --robot left --to 1000 --robot right --to 500 --time-limit 4 --json";
    let answer = elbowroom(dir.path(), &args.split(' ').collect::<Vec<_>>()).expect(1).json();
    let reason = answer["reason"].as_str().unwrap();
    assert!(
        reason.contains("no path in 2 orders of the robots") && reason.contains("make way for each other"),
        "{reason}"
    );
    assert!(reason.starts_with("robot \"") && !reason.contains("states checked"), "{reason}");
}

#[test]
fn no_path_is_an_answer() {
    let answer =
        plan(&["--robot", "left", "--to", "middle", "--robot", "right", "--to", "middle", "--json"]).expect(1).json();
    assert!(answer["found"] == false && answer["reason"].as_str().unwrap().contains("left"), "{answer}");
}

#[test]
fn wrong_calls_are_refused_with_a_hint() {
    let error = |args: &str| {
        let message = plan(&args.split(' ').collect::<Vec<_>>()).expect(2).stderr;
        assert!(message.contains("write:"), "{message}");
        message
    };
    assert!(error("--robot left --robot right --to over").contains("--to is given 1 times for 2 robots"));
    assert!(error("--robot left --from start --to over --robot right --to 1,0").contains("--from is given 1 times"));
    assert!(error("--robot left --to over --robot right --to over").contains("no state \"over\""));
    assert!(error("--robot left --to over --robot left --to over").contains("two goals"));
    assert!(error("--robot left --to over --to 1,0").contains("--to is given 2 times, --robot 1 times"));
    assert!(error("--robot left --to over --robot right --to 1,0 --optimize").contains("--optimize is for one robot"));
}
