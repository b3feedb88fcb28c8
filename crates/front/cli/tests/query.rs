//! `elbowroom query`: columns, JSON, exit status, messages.

use crate::common::{Answer, elbowroom, examples, keys, model, with_cell, with_input};

const HEADER: &str = "index,collides,distance_m,a,b,ax,ay,az,bx,by,bz,level";

/// An arm that meets a sphere when it is straight, and a second arm on the other side.
const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
start = [90, 0]
[object.ball]
shape = "sphere"
at = [800, 0, 0]
radius = 100
"#;

fn query(cell: &str, states: Option<&str>, args: &[&str]) -> Answer {
    let dir = with_cell(cell);
    let mut all = vec!["query", "cell.toml"];
    if let Some(text) = states {
        std::fs::write(dir.path().join("q.csv"), text).unwrap();
        all.extend(["--states", "q.csv"]);
    }
    all.extend(args);
    elbowroom(dir.path(), &all)
}

fn cells(line: &str) -> Vec<&str> {
    line.split(',').collect()
}

#[test]
fn distance_has_a_row_per_state_whatever_the_order_of_columns() {
    for states in [
        "joint_1,joint_2\n0,0\n1.5,0\n",
        "joint_2,t_s,joint_1\n0,0,0\n\n0,1,1.5\n",
        "arm.joint_2,joint_1\r\n0,0\r\n0,1.5\r\n",
    ] {
        let answer = query(CELL, Some(states), &["--ask", "distance"]).expect(0);
        let lines: Vec<&str> = answer.stdout.lines().collect();
        assert_eq!((lines.len(), lines[0]), (3, HEADER));
        let (first, second) = (cells(lines[1]), cells(lines[2]));
        // The tip's cap reaches to 740 mm, the sphere begins at 700 mm.
        assert_eq!(first[..5], ["0", "1", "0.0", "arm/link_2", "ball"]);
        assert_eq!((second.len(), second[0], second[1]), (12, "1", "0"));
        let number = |i: usize| second[i].parse::<f64>().unwrap();
        let [a, b] = [5, 8].map(|i| [number(i), number(i + 1), number(i + 2)]);
        let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        assert!((apart - number(2)).abs() < 1e-9 && number(2) > 0.3, "{second:?}");
        assert!(((b[0] - 0.8).hypot(b[1]) - 0.1).abs() < 1e-9, "on the ball: {b:?}");
    }
}

#[test]
fn states_come_from_standard_input_too() {
    let states = "joint_1,joint_2\n0,0\n1.5,0\n";
    let file = query(CELL, Some(states), &["--ask", "distance"]).expect(0);
    let dir = with_cell(CELL);
    let args = ["query", "cell.toml", "--ask", "distance", "--states", "-"];
    assert_eq!(with_input(dir.path(), &args, states).expect(0).stdout, file.stdout);
    let wrong = with_input(dir.path(), &args, "joint_1,joint_2\n0,x\n").expect(2);
    assert!(wrong.stderr.contains("standard input:2:"), "{}", wrong.stderr);
    for (input, expected, hint) in [
        ("", "standard input:1: is empty", "joint_1"),
        ("joint_1\n0\n", "standard input:1: ", "joint_2"),
        ("joint_1,joint_2\n0,0\n\n1\n", "standard input:4: ", "write: "),
        ("joint_1,joint_2\n0,nan\n", "standard input:2: ", "write: "),
    ] {
        let refused = with_input(dir.path(), &args, input).expect(2);
        assert!(refused.stderr.contains(expected) && refused.stderr.contains(hint), "{input:?}: {}", refused.stderr);
        assert!(refused.stdout.is_empty(), "{}", refused.stdout);
    }
    let ns16 = model("ns16");
    let joints = "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0,0,0,0,0,0\n";
    let poses = with_input(dir.path(), &["inspect", ns16.to_str().unwrap(), "--states", "-"], joints).expect(0);
    assert!(poses.stdout.lines().count() > 6, "{}", poses.stdout);
}

#[test]
fn only_ask_collision_has_exit_status_1() {
    let states = Some("joint_1,joint_2\n0,0\n1.5,0\n");
    let answer = query(CELL, states, &["--ask", "collision"]).expect(1);
    let lines: Vec<&str> = answer.stdout.lines().collect();
    assert!(lines[1].starts_with("0,1,0.0,arm/link_2,ball,"), "{}", lines[1]);
    assert!(lines[2].starts_with("1,0,,,,,,,,,,"), "{}", lines[2]);
    assert!(["L1", "L2", "L3"].contains(&cells(lines[2])[11]));
    query(CELL, Some("joint_1,joint_2\n1.5,0\n"), &["--ask", "collision"]).expect(0);
    query(CELL, states, &["--ask", "distance"]).expect(0);
    query(CELL, states, &["--ask", "tolerance=0.02"]).expect(0);
    // Without states: the start, at which the arm points elsewhere.
    let answer = query(CELL, None, &["--ask", "collision"]).expect(0);
    assert_eq!(answer.stdout.lines().count(), 2);
}

#[test]
fn tolerance_names_the_nearest_pair_within_it() {
    // At the start the arm is along y; its shoulder end is nearest to the sphere.
    let far = query(CELL, None, &["--ask", "tolerance=0.1"]).expect(0);
    assert!(far.stdout.lines().nth(1).unwrap().starts_with("0,0,,,,"), "{}", far.stdout);
    let near = query(CELL, None, &["--ask", "tolerance=2"]).expect(0);
    assert!(!near.stderr.contains("warning"), "{}", near.stderr);
    let doubtful = query(CELL, None, &["--ask", "tolerance=20"]).expect(0).stderr;
    assert!(doubtful.contains("tolerance=20 is 20 m") && doubtful.contains("tolerance=0.02 is 20 mm"), "{doubtful}");
    let distance = query(CELL, None, &["--ask", "distance"]).expect(0);
    let (near, distance) = (near.stdout.lines().nth(1).unwrap(), distance.stdout.lines().nth(1).unwrap());
    assert_eq!(cells(near)[1], "1");
    assert_eq!(cells(near)[2..5], cells(distance)[2..5]);
}

#[test]
fn json_is_the_same_as_rows() {
    let states = Some("joint_1,joint_2\n0,0\n1.5,0\n");
    let json = query(CELL, states, &["--ask", "collision", "--json"]).expect(1).json();
    assert_eq!(keys(&json), ["ask", "colliding", "level", "model", "rows", "states", "tolerance_m"]);
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    let mut columns: Vec<&str> = HEADER.split(',').collect();
    columns.sort_unstable();
    assert_eq!(keys(&rows[0]), columns);
    assert_eq!((rows[0]["collides"].as_u64(), rows[0]["a"].as_str()), (Some(1), Some("arm/link_2")));
    assert_eq!((rows[1]["collides"].as_u64(), rows[1]["distance_m"].is_null()), (Some(0), true));
    assert_eq!((json["states"].as_u64(), json["colliding"].as_u64()), (Some(2), Some(1)));
    let empty = query(CELL, Some("joint_1,joint_2\n"), &["--ask", "distance", "--json"]).expect(0);
    assert_eq!(empty.json()["rows"].as_array().map(Vec::len), Some(0));
    assert!(empty.stderr.contains("no state"), "{}", empty.stderr);
}

#[test]
fn wrong_states_name_file_line_and_column() {
    for (states, parts) in [
        ("", &["q.csv:1:", "empty", "joint_1,joint_2"][..]),
        ("joint_1\n0\n", &["q.csv:1:", "`joint_2`"]),
        ("joint_1,joint_2,elbow\n0,0,0\n", &["q.csv:1:", "`elbow`"]),
        ("joint_1,joint_1,joint_2\n0,0,0\n", &["q.csv:1:", "two columns"]),
        ("0,0\n1,1\n", &["q.csv:1:", "names"]),
        ("joint_1,joint_2\n0,0\nNaN,0\n", &["q.csv:3:", "joint_1"]),
        ("joint_1,joint_2\n0,0\n0,inf\n", &["q.csv:3:", "joint_2"]),
        ("joint_1,joint_2\n0,\n", &["q.csv:2:", "joint_2"]),
        ("joint_1,joint_2\n\n0,0,0\n", &["q.csv:3:", "3 values"]),
        ("joint_1,joint_2\n0\n", &["q.csv:2:", "1 values"]),
        ("joint_1;joint_2\n0;0\n", &["q.csv:1:", "joint_1,joint_2"]),
    ] {
        for ask in ["collision", "distance", "tolerance=0.1"] {
            let answer = query(CELL, Some(states), &["--ask", ask]).expect(2);
            assert_eq!(answer.stdout, "", "{states:?}");
            for part in parts {
                assert!(answer.stderr.contains(part), "{states:?}: {}", answer.stderr);
            }
        }
    }
    let beyond = query(CELL, Some("joint_1,joint_2\n90,0\n"), &["--ask", "distance"]).expect(0);
    assert!(beyond.stderr.contains("degrees") && beyond.stderr.contains("q.csv:2"), "{}", beyond.stderr);
}

#[test]
fn contradictory_calls_are_refused() {
    let dir = with_cell(CELL);
    let urdf = model("ns16");
    let urdf = urdf.to_str().unwrap();
    for (args, part) in [
        (&["query", "cell.toml"][..], "--ask"),
        (&["query", "--ask", "collision"], "CELL"),
        (&["query", "cell.toml", "--ask", "touch"], "tolerance=0.02"),
        (&["query", "cell.toml", "--ask", "tolerance"], "tolerance=0.02"),
        (&["query", "cell.toml", "--ask", "tolerance=-1"], "0 or more"),
        (&["query", "cell.toml", "--ask", "tolerance=nan"], "0 or more"),
        (&["query", "cell.toml", "--ask", "collision", "--level", "L4"], "auto, L1, L2, L2:1 to L2:8, L3"),
        (&["query", "cell.toml", "--ask", "collision", "--srdf", "a.srdf"], "cannot be used"),
        (&["query", "cell.toml", "--ask", "collision", "--urdf", urdf], "cannot be used"),
        (&["query", urdf, "--ask", "collision"], "--urdf"),
        (&["query", "missing.toml", "--ask", "collision"], "missing.toml"),
        (&["query", "--urdf", "missing.urdf", "--ask", "collision"], "missing.urdf"),
        (&["query", "cell.toml", "--ask", "collision", "--states", "missing.csv"], "missing.csv"),
        (&["query", "cell.toml", "--ask", "collision", "--states", "."], "folder"),
    ] {
        let answer = elbowroom(dir.path(), args).expect(2);
        assert!(answer.stderr.contains(part), "{args:?}: {}", answer.stderr);
        assert_eq!(answer.stdout, "");
    }
}

#[test]
fn a_robot_alone_uses_bare_names_and_its_root_as_the_world() {
    let urdf = model("ns16");
    let base = ["query", "--urdf", urdf.to_str().unwrap(), "--ask", "distance"];
    let answer = elbowroom(&examples(), &base).expect(0);
    let row = cells(answer.stdout.lines().nth(1).unwrap()).into_iter().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(row[1], "0");
    assert!(!row[3].contains('/') && row[3].starts_with("link_"), "{row:?}");
    for level in ["L1", "L2", "capsule", "hull", "L3"] {
        let coarse = elbowroom(&examples(), &[&base[..], &["--level", level]].concat()).expect(0);
        let coarse = cells(coarse.stdout.lines().nth(1).unwrap())[2].parse::<f64>().unwrap();
        assert!(coarse <= row[2].parse::<f64>().unwrap() + 1e-12, "{level}");
    }
}

#[test]
fn levels_matrix_and_weights_change_the_time_and_not_the_answers() {
    let dir = tempfile::tempdir().unwrap();
    let cell = examples().join("inspection/cell.toml");
    let cell = cell.to_str().unwrap();
    let mut random = elbowroom_testkit::random::SplitMix(5);
    let robots = ["one", "two", "three"];
    let names: Vec<String> =
        robots.iter().flat_map(|robot| (1..=6).map(move |joint| format!("{robot}.joint_{joint}"))).collect();
    let mut text = names.join(",");
    for _ in 0..40 {
        let row: Vec<String> = names.iter().map(|_| random.between(-1.5, 1.5).to_string()).collect();
        text = format!("{text}\n{}", row.join(","));
    }
    std::fs::write(dir.path().join("q.csv"), text + "\n").unwrap();
    let ask = |what: &str, switches: &[&str]| {
        let args = [&["query", cell, "--ask", what, "--states", "q.csv", "--json", "--times"][..], switches].concat();
        let answer = elbowroom(dir.path(), &args);
        answer.json()
    };
    for (what, key) in [("collision", "collides"), ("distance", "distance_m")] {
        let all = ask(what, &[]);
        let column = |answer: &serde_json::Value| -> Vec<serde_json::Value> {
            answer["rows"].as_array().unwrap().iter().map(|row| row[key].clone()).collect()
        };
        for switches in [&["--start", "L3"][..], &["--no-matrix"], &["--no-weights"], &["--start", "L2", "--no-matrix"]]
        {
            let other = ask(what, switches);
            assert_eq!(column(&other), column(&all), "{what} {switches:?}");
            let times = &other["times"];
            assert_eq!(times["states"], 40);
            assert!(times["p50_us"].as_f64().unwrap() <= times["p99_us"].as_f64().unwrap(), "{times}");
            // Pairs that cannot meet still have a distance.
            let is_without = what == "distance" || switches.contains(&"--no-matrix");
            assert_eq!(times["pairs_skipped"].as_u64() == Some(0), is_without, "{switches:?}: {times}");
            if switches.contains(&"L3") {
                assert_eq!(keys(&times["answered"]), ["L3"], "{times}");
            }
        }
    }
    let text = elbowroom(dir.path(), &["query", cell, "--ask", "distance", "--times"]).expect(0);
    assert!(text.stderr.contains("1 state: ") && text.stderr.contains("answered by L3 1"), "{}", text.stderr);
    for wrong in [&["--start", "hull"][..], &["--start", "L2", "--level", "L3"]] {
        let refused = elbowroom(dir.path(), &[&["query", cell, "--ask", "distance"], wrong].concat()).expect(2);
        assert!(refused.stderr.contains("--start L1, L2 or L3"), "{}", refused.stderr);
    }
}

/// The arm turns from beside the ball into it, and from there away.
#[test]
fn time_is_the_share_of_a_motion_that_is_free() {
    let states = Some("joint_1,joint_2\n1.5,0\n0,0\n1.5,0\n1.4,0\n");
    let answer = query(CELL, states, &["--ask", "time"]).expect(0);
    let lines: Vec<&str> = answer.stdout.lines().collect();
    assert_eq!((lines.len(), lines[0]), (4, "index,collides,free_share,a,b,ax,ay,az,bx,by,bz,certain"));
    let (into, out, beside) = (cells(lines[1]), cells(lines[2]), cells(lines[3]));
    assert_eq!((into[0], into[1], into[3], into[4], into[11]), ("0", "1", "arm/link_2", "ball", "1"));
    let share: f64 = into[2].parse().unwrap();
    // Just before it the arm is free, just after it not.
    let at = |share: f64| format!("joint_1,joint_2\n{},0\n", 1.5 * (1.0 - share));
    query(CELL, Some(&at(share - 1e-3)), &["--ask", "collision"]).expect(0);
    query(CELL, Some(&at(share + 1e-3)), &["--ask", "collision"]).expect(1);
    assert_eq!(out[..5], ["1", "1", "0.0", "arm/link_2", "ball"]);
    assert_eq!(beside[..], ["2", "0", "1.0", "", "", "", "", "", "", "", "", "1"]);
    let json = query(CELL, states, &["--ask", "time", "--json"]).expect(0).json();
    assert_eq!((&json["ask"], &json["colliding"]), (&"time".into(), &2.into()));
    assert!((json["rows"][0]["free_share"].as_f64().unwrap() - share).abs() < 1e-15);
    let refused = query(CELL, None, &["--ask", "time"]).expect(2).stderr;
    assert!(refused.contains("two rows or more"), "{refused}");
}

/// The JSON of a collision point has its place in the frame of the link, as `inspect --at` and `plan --point` take it.
#[test]
fn a_collision_point_is_told_in_the_frame_of_its_link() {
    let states = Some("joint_1,joint_2\n0.1,-0.1\n1.5,0\n");
    let json = query(CELL, states, &["--ask", "point", "--json"]).expect(0).json();
    let row = &json["rows"][0];
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let [x, y, z] = [0, 1, 2].map(|i| number(&row["point_in_a_m"][i]));
    // Two links of 400 and 300 mm; the sum of the angles is 0.
    let at = [0.4 * 0.1_f64.cos() + 0.3 + x, 0.4 * 0.1_f64.sin() + y, z];
    for (key, value) in ["ax", "ay", "az"].into_iter().zip(at) {
        assert!((number(&row[key]) - value).abs() < 1e-12, "{row}");
    }
    assert!(json["rows"][1].get("point_in_a_m").is_none());
}

#[test]
fn a_level_has_depths_of_boxes_and_a_wrong_one_says_what_to_write() {
    let states = Some("joint_1,joint_2\n0,0\n1.5,0\n");
    let rows = |level: &str| query(CELL, states, &["--ask", "distance", "--level", level]).expect(0).stdout;
    assert_eq!(rows("L2:0"), rows("L2"));
    let deep = rows("L2:3");
    assert_eq!(cells(deep.lines().nth(1).unwrap())[11], "L2:3", "{deep}");
    // One capsule has one box: only the name of the level differs.
    assert_eq!(deep.replace("L2:3", "L2"), rows("L2"));
    let json = query(CELL, states, &["--ask", "collision", "--level", "l2:2", "--json"]).expect(1).json();
    assert_eq!((json["level"].as_str(), json["rows"][0]["level"].as_str()), (Some("L2:2"), Some("L2:2")));
    for (wrong, hint) in [
        ("L4", "write auto, L1, L2, L2:1 to L2:8, L3, capsule or hull"),
        ("L2:-1", "a whole number from 0 to 8; write L2:3"),
        ("L2:99999999999", "a whole number from 0 to 8; write L2:3"),
        ("L3:2", "only L2 has depths; write L3, or L2:1 to L2:8"),
    ] {
        let refused = query(CELL, states, &["--ask", "distance", "--level", wrong]).expect(2);
        assert!(refused.stderr.contains(hint) && refused.stdout.is_empty(), "{wrong}: {}", refused.stderr);
    }
    let start = query(CELL, states, &["--ask", "distance", "--start", "L2:1"]).expect(2);
    assert!(start.stderr.contains("write: --start L1, L2 or L3"), "{}", start.stderr);
    let point = query(CELL, states, &["--ask", "point", "--level", "L2:1"]).expect(2);
    assert!(point.stderr.contains("write: --level auto"), "{}", point.stderr);
}
