//! `elbowroom plan --problems`: document, files, exit status, messages.

use std::path::Path;

use crate::common::{Answer, elbowroom, examples, keys, model};
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::kinematics::ChainState;
use serde_json::{Value, json};

/// Joint values of the example robot with its forearm in front.
const READY: [f64; 6] = [-0.8, 0.5, 0.0, 0.0, 0.4, 0.0];

/// Makes a problem from the ready posture to these values of the first joints, past a post in front of the robot.
fn problem(with_post: bool, to: &[f64]) -> Value {
    let names: Vec<String> = (1..=6).map(|i| format!("joint_{i}")).collect();
    let goal = |(value, joint): (&f64, &String)| json!({"joint_name": joint, "position": value});
    let goal: Vec<Value> = to.iter().zip(&names).map(goal).collect();
    let post = json!({"id": "post", "primitives": [{"type": "box", "dimensions": [0.1, 0.1, 1.8]}],
        "primitive_poses": [{"position": [1.1, 0, 0.9], "orientation": [0, 0, 0, 1]}]});
    let floor = json!({"id": "floor", "primitives": [{"type": "box", "dimensions": [4, 4, 0.1]}],
        "primitive_poses": [{"position": [0, 0, -0.2]}]});
    let objects = if with_post { vec![floor, post] } else { vec![floor] };
    json!({
        "scene": {"world": {"collision_objects": objects}},
        "request": {
            "start_state": {"joint_state": {"name": names, "position": READY}},
            "goal_constraints": [{"joint_constraints": goal}]
        }
    })
}

const ALL: [f64; 6] = [0.8, 0.5, 0.0, 0.0, 0.4, 0.0];

/// Makes sets with a solvable problem each, and one with a goal in the post.
fn sets() -> Value {
    json!({
        "post": {"0001": problem(true, &ALL), "0002": problem(true, &[0.0])},
        "../open": {"a/b": problem(false, &[0.8])}
    })
}

/// Runs `plan --urdf ns16 --problems …` on these sets, in a new folder.
fn plan(sets: &Value, args: &[&str]) -> (tempfile::TempDir, Answer) {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("sets.json"), sets.to_string()).unwrap();
    let robot = examples().join("models/ns16");
    let (urdf, srdf) = (robot.join("ns16.urdf"), robot.join("ns16.srdf"));
    let base = ["plan", "--urdf", urdf.to_str().unwrap(), "--srdf", srdf.to_str().unwrap(), "--problems", "sets.json"];
    let answer = elbowroom(dir.path(), &[&base[..], args].concat());
    (dir, answer)
}

fn rows(dir: &Path, file: &str) -> Vec<Vec<f64>> {
    let csv = std::fs::read_to_string(dir.join("paths").join(file)).unwrap();
    assert_eq!(csv.lines().next(), Some("t_s,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6"));
    csv.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect()
}

#[test]
fn the_document_has_the_documented_keys_and_the_files_the_paths() {
    let (dir, answer) = plan(&sets(), &["--json", "--paths", "paths", "--period", "0.01"]);
    let document = answer.expect(0).json();
    assert_eq!(keys(&document), ["problems", "summary"]);
    let problems = document["problems"].as_array().unwrap();
    let documented = "cost_rad cost_raw_rad duration_s found id improvements line_deviation_m line_deviation_rad motion \
                      planning_us proven reason set simplify_us valid";
    for problem in problems {
        assert_eq!(keys(problem).join(" "), documented);
    }
    let facts: Vec<_> =
        problems.iter().map(|p| ["set", "id", "valid", "found", "proven"].map(|key| p[key].clone())).collect();
    let fact = |set: &str, id: &str, solved: bool| [json!(set), json!(id), json!(solved), json!(solved), json!(solved)];
    assert_eq!(facts, [fact("post", "0001", true), fact("post", "0002", false), fact("../open", "a/b", true)]);
    assert!(problems[1]["reason"].as_str().unwrap().contains("`post` are in collision"));
    assert!(["planning_us", "cost_rad", "duration_s"].iter().all(|key| problems[1][key].is_null()));
    assert_eq!(problems[0]["improvements"][0]["cost_rad"], problems[0]["cost_rad"]);
    assert_eq!(problems[1]["improvements"], json!([]));
    let cost = |key: &str| problems[0][key].as_f64().unwrap();
    assert!(cost("cost_rad") > 1.6 && cost("cost_rad") <= cost("cost_raw_rad"));
    assert!((problems[2]["cost_rad"].as_f64().unwrap() - 1.6).abs() < 1e-12);
    let all = &document["summary"]["all"];
    assert_eq!([&all["total"], &all["valid"], &all["solved"], &all["proven"]], [3, 2, 2, 2]);
    assert_eq!(keys(&all["planning_us"]), ["mean", "p50", "p95"]);
    let names: Vec<_> = document["summary"]["sets"].as_array().unwrap().iter().map(|s| s["set"].clone()).collect();
    assert_eq!(names, ["post", "../open"]);

    let mut files: Vec<_> =
        std::fs::read_dir(dir.path().join("paths")).unwrap().map(|f| f.unwrap().file_name()).collect();
    files.sort();
    assert_eq!(files, ["_open-a_b.csv", "post-0001.csv"]);
    let path = rows(dir.path(), "post-0001.csv");
    assert_eq!((&path[0][1..], &path.last().unwrap()[1..]), (&READY[..], &ALL[..]));
    let duration = problems[0]["duration_s"].as_f64().unwrap();
    assert!((path.last().unwrap()[0] - duration).abs() < 1e-9 && (path[1][0] - 0.01).abs() < 1e-12);
    // Only joint_1 is planned.
    assert!(rows(dir.path(), "_open-a_b.csv").iter().all(|row| row[2..] == READY[1..]));
    // The result is deterministic.
    let (_, again) = plan(&sets(), &["--json"]);
    assert_eq!(again.json()["problems"][0]["cost_rad"], problems[0]["cost_rad"]);
}

#[test]
fn shorter_paths_and_their_times_are_in_the_document() {
    let (_, answer) = plan(&sets(), &["--json", "--optimize", "--time-limit", "0.1"]);
    let problem = &answer.expect(0).json()["problems"][0];
    let values = |key: &str| -> Vec<f64> {
        problem["improvements"].as_array().unwrap().iter().map(|entry| entry[key].as_f64().unwrap()).collect()
    };
    let (times, costs) = (values("time_us"), values("cost_rad"));
    assert_eq!(costs.last().copied(), problem["cost_rad"].as_f64());
    assert!(costs.is_sorted_by(|a, b| a > b) && times.is_sorted() && times[0] > 0.0, "{times:?} {costs:?}");
}

#[test]
fn the_table_fits_and_selections_apply() {
    let (_, answer) = plan(&sets(), &[]);
    let text = answer.expect(0).stdout;
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[..5].iter().all(|line| line.chars().count() <= 80), "{text}");
    assert!(lines[2].starts_with("post") && lines[4].starts_with("all"), "{text}");
    assert!(text.contains("not valid:\n  post 0002: goal: "), "{text}");
    let count = |args: &[&str]| {
        plan(&sets(), &[args, &["--json"]].concat()).1.expect(0).json()["summary"]["all"]["total"].clone()
    };
    assert_eq!(count(&["--only", "post"]), 2);
    assert_eq!(count(&["--only", "../open,post", "--limit", "1"]), 2);
}

#[test]
fn a_valid_problem_without_a_path_is_exit_status_1() {
    // Only the first joint is planned, and the post is in between.
    let (dir, answer) =
        plan(&json!({"post": {"1": problem(true, &[0.8])}}), &["--time-limit", "0.2", "--paths", "paths"]);
    let text = answer.expect(1).stdout;
    assert!(text.contains("not solved:\n  post 1: no path found"), "{text}");
    assert_eq!(std::fs::read_dir(dir.path().join("paths")).unwrap().count(), 0);
}

#[test]
fn wrong_files_and_calls_are_exit_status_2_with_a_remedy() {
    let refused = |sets: &Value, args: &[&str], expected: &[&str]| {
        let stderr = plan(sets, args).1.expect(2).stderr;
        assert!(expected.iter().all(|e| stderr.contains(e)), "{args:?}: {stderr}");
    };
    refused(&sets(), &["--only", "pots"], &["no set `pots`", "write: post"]);
    refused(&sets(), &["--clearance", "-1"], &["--clearance", "0 or more"]);
    refused(&sets(), &["--limit", "0"], &["--limit"]);
    refused(&sets(), &["--to", "1,2"], &["--to"]);
    refused(&sets(), &["cell.toml"], &["cannot be used"]);
    refused(&json!({"post": {}}), &[], &["sets.json", "no planning problem", "SET"]);
    let mut unknown = sets();
    unknown["post"]["0001"]["request"]["goal_constraints"][0]["joint_constraints"][0]["joint_name"] = json!("joint_0");
    refused(&unknown, &[], &["set `post`, problem `0001`", "`joint_0`", "write: joint_1"]);
    let mut flat = sets();
    flat["../open"]["a/b"]["scene"]["world"]["collision_objects"][0]["primitives"][0]["dimensions"] = json!([1, 2]);
    refused(&flat, &[], &["problem `a/b`", "collision_objects[0].primitives[0].dimensions", "[x, y, z]"]);

    let dir = tempfile::tempdir().unwrap();
    let urdf = model("ns16");
    let urdf = urdf.to_str().unwrap();
    for (args, expected) in [
        (&["plan", "--urdf", urdf][..], "--problems"),
        (&["plan", "--problems", "p.json"], "--urdf"),
        (&["plan", "--urdf", urdf, "--problems", "missing.json"], "missing.json"),
        (&["plan", "cell.toml"], "--to"),
    ] {
        let stderr = elbowroom(dir.path(), args).expect(2).stderr;
        assert!(stderr.contains(expected), "{args:?}: {stderr}");
    }
}

#[test]
fn a_robot_without_speeds_has_no_timed_paths() {
    let dir = tempfile::tempdir().unwrap();
    let urdf = std::fs::read_to_string(model("ns16")).unwrap();
    let urdf = urdf.replace("velocity=\"3.0543261909900767\" ", "");
    std::fs::write(
        dir.path().join("slow.urdf"),
        urdf.replace("meshes/", &format!("{}/", examples().join("models/ns16/meshes").display())),
    )
    .unwrap();
    std::fs::write(dir.path().join("sets.json"), sets().to_string()).unwrap();
    let args = ["plan", "--urdf", "slow.urdf", "--problems", "sets.json", "--only", "../open", "--json"];
    let answer = elbowroom(dir.path(), &args).expect(0);
    assert!(answer.stderr.contains("no largest speed for joint_1: "), "{}", answer.stderr);
    let problem = answer.json()["problems"][0].clone();
    assert!(problem["found"] == true && problem["duration_s"].is_null(), "{problem}");
    let refused = elbowroom(dir.path(), &[&args[..], &["--paths", "paths"]].concat()).expect(2);
    assert!(refused.stderr.contains("joint_1") && refused.stderr.contains("<limit velocity="), "{}", refused.stderr);
    assert!(!dir.path().join("paths").exists());
}

/// The tool of the robot points down within 0.1 rad on the whole way around the post.
#[test]
fn a_path_constraint_keeps_an_axis_of_a_link_and_is_refused_where_it_cannot_be_kept() {
    let down = [-0.8, 0.5, 0.0, 0.0, std::f64::consts::FRAC_PI_2 - 0.5, 0.0];
    let upright = |x: f64, free: f64| {
        json!({"orientation_constraints": [{"link_name": "tool0", "orientation": [1, 0, 0, 0],
            "absolute_x_axis_tolerance": x, "absolute_y_axis_tolerance": 0.3, "absolute_z_axis_tolerance": free}]})
    };
    let with = |constraints: Value, goal: f64| {
        let mut one = problem(true, &[0.8, 0.5, 0.0, 0.0, down[4] + goal, 0.0]);
        one["request"]["start_state"]["joint_state"]["position"] = json!(down);
        one["request"]["path_constraints"] = constraints;
        json!({"set": {"1": one}})
    };
    let robot = load(&model("ns16"), &LoadOptions::default()).unwrap().robot;
    let tool = robot.chain.link("tool0").unwrap();
    let mut state = ChainState::new(&robot.chain);
    let mut largest_tilt_rad = |dir: &Path| {
        let tilt = |row: Vec<f64>| {
            state.q.copy_from_slice(&row[1..]);
            robot.chain.forward(&mut state);
            let axis = state.link_in_root(tool).rotation.z_axis();
            axis.x.hypot(axis.y).atan2(-axis.z)
        };
        rows(dir, "set-1.csv").into_iter().map(tilt).fold(0.0, f64::max)
    };
    let (dir, answer) = plan(&with(upright(0.1, 3.2), 0.0), &["--json", "--paths", "paths"]);
    assert_eq!(answer.expect(0).json()["problems"][0]["proven"], true);
    assert!(largest_tilt_rad(dir.path()) <= 0.1 + 1e-9);
    let (dir, answer) = plan(&with(json!({}), 0.0), &["--json", "--paths", "paths"]);
    answer.expect(0);
    assert!(largest_tilt_rad(dir.path()) > 0.1, "without it the tool tilts");
    // A goal that tilts the tool by 0.2 rad.
    let (_, answer) = plan(&with(upright(0.1, 3.2), 0.2), &["--json"]);
    let reason = answer.expect(0).json()["problems"][0]["reason"].clone();
    let words = "goal: the path constraint is violated: an orientation that the constraint forbids (an axis of `tool0` is 11.5° off";
    assert!(reason.as_str().unwrap().starts_with(words), "{reason}");
    for (constraints, message) in [
        (upright(0.1, 0.5), "leaves 0 axes free"),
        (
            json!({"orientation_constraints": [{"link_name": "tool", "absolute_x_axis_tolerance": 0.1,
            "absolute_y_axis_tolerance": 0.1, "absolute_z_axis_tolerance": 4}]}),
            "there is no link `tool`",
        ),
    ] {
        let (_, answer) = plan(&with(constraints, 0.0), &["--json"]);
        let refused = answer.expect(2).stderr;
        assert!(refused.contains("set `set`, problem `1`") && refused.contains(message), "{refused}");
    }
}

#[test]
fn motions_of_the_industrial_planner_are_straight_lines_and_straight_joint_motions() {
    let requested = |planner: &str, with_post: bool, to: &[f64]| {
        let mut one = problem(with_post, to);
        one["request"]["pipeline_id"] = json!("pilz_industrial_motion_planner");
        one["request"]["planner_id"] = json!(planner);
        one
    };
    let robot = load(&model("ns16"), &LoadOptions::default()).unwrap().robot;
    let tool = robot.chain.link("tool0").unwrap();
    let position = |q: &[f64]| {
        let mut state = ChainState::new(&robot.chain);
        state.q.copy_from_slice(q);
        robot.chain.forward(&mut state);
        state.link_in_root(tool).translation
    };
    let near = [-0.5, 0.62, -0.1, 0.1, 0.3, 0.2];
    let mut blocked = requested("LIN", true, &ALL);
    let middle = (position(&READY) + position(&ALL)) * 0.5;
    blocked["scene"]["world"]["collision_objects"][1]["primitive_poses"][0]["position"] =
        json!([middle.x, middle.y, 0.9]);
    let set = json!({"moves": {
        "lin": requested("LIN", false, &near), "ptp": requested("PTP", false, &near),
        "ptp post": requested("PTP", true, &ALL), "lin post": blocked}});
    let (dir, answer) = plan(&set, &["--json", "--paths", "paths"]);
    let document = answer.expect(1).json();
    let facts: Vec<_> = ["motion", "valid", "found"]
        .map(|key| document["problems"].as_array().unwrap().iter().map(|p| p[key].clone()).collect::<Value>())
        .into();
    assert_eq!(
        facts,
        [json!(["LIN", "PTP", "PTP", "LIN"]), json!([true, true, true, true]), json!([true, true, false, false])]
    );
    let reason = |i: usize| document["problems"][i]["reason"].as_str().unwrap().to_owned();
    assert!(reason(2).contains("% only, there `") && reason(2).contains("`post` meet"), "{}", reason(2));
    assert!(reason(3).starts_with("the straight line can be followed for "), "{}", reason(3));

    let (from, to) = (position(&READY), position(&near));
    let largest_off_m = |file: &str| {
        let rows = rows(dir.path(), file);
        assert!(position(&rows.last().unwrap()[1..]).distance(to) < 1e-6);
        let off = |row: &Vec<f64>| (position(&row[1..]) - from).cross(to - from).length() / (to - from).length();
        rows.iter().map(off).fold(0.0, f64::max)
    };
    let told = document["problems"][0]["line_deviation_m"].as_f64().unwrap();
    let straight = largest_off_m("moves-lin.csv");
    assert!(straight <= told + 1e-6 && told < 1e-3, "{straight} {told}");
    assert!(largest_off_m("moves-ptp.csv") > 2e-3 && document["problems"][1]["line_deviation_m"].is_null());
    assert_eq!(document["summary"]["all"]["line_deviation_m"], told);
    let table = plan(&set, &[]).1.expect(1).stdout;
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[1].ends_with("line mm") && lines[2].ends_with(&format!("{:.3}", 1e3 * told)), "{table}");
    assert!(lines[..4].iter().all(|line| line.chars().count() <= 80), "{table}");

    for (planner, group, words) in [
        ("CIRC", "arm", ["circles are not supported", "\"LIN\" once per chord"]),
        ("LINE", "arm", ["\"LINE\"", "write: LIN"]),
        ("LIN", "amr", ["no group `amr`", "write: "]),
    ] {
        let mut one = requested(planner, false, &near);
        one["request"]["group_name"] = json!(group);
        let refused = plan(&json!({"moves": {"1": one}}), &[]).1.expect(2).stderr;
        assert!(refused.contains("sets.json") && refused.contains("set `moves`, problem `1`"), "{refused}");
        assert!(words.iter().all(|word| refused.contains(word)), "{refused}");
    }
}
