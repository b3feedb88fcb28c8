//! `elbowroom plan`: document, samples, exit status, messages.

use crate::common::{Answer, elbowroom, examples, keys, with_cell};
use serde_json::Value;

/// A two-link arm whose straight path collides with a sphere, and another arm beside it.
const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
start = [-60, 0]
[robot.other]
dh = [{ a = 300, min = -90, max = 90 }]
links = [{ capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
base = { at = [-900, 0, 0], rpy = [0, 0, 0] }
[object.ball]
shape = "sphere"
at = [600, 0, 0]
radius = 100
"#;

fn plan(cell: &str, args: &[&str]) -> Answer {
    let dir = with_cell(cell);
    let mut all = vec!["plan", "cell.toml"];
    all.extend(args);
    elbowroom(dir.path(), &all)
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[test]
fn the_document_has_the_documented_keys() {
    let answer = plan(CELL, &["--robot", "arm", "--from", "-1,0.1", "--to", "1,-.1", "--json"]).expect(0).json();
    for key in ["found", "waypoints", "cost_rad", "planning_us", "simplify_us", "duration_s"] {
        assert!(keys(&answer).contains(&key), "{answer}");
    }
    assert_eq!(answer["found"], true);
    let waypoints: Vec<_> = answer["waypoints"].as_array().unwrap().iter().map(numbers).collect();
    assert!(waypoints.len() > 2 && waypoints[0] == [-1.0, 0.1] && waypoints[waypoints.len() - 1] == [1.0, -0.1]);
    let length: f64 = waypoints.windows(2).map(|w| (w[0][0] - w[1][0]).hypot(w[0][1] - w[1][1])).sum();
    assert!((answer["cost_rad"].as_f64().unwrap() - length).abs() < 1e-9);
    // 2 rad at 90 degrees per second at most.
    assert!(answer["duration_s"].as_f64().unwrap() > 1.27);
    assert!(answer["planning_us"].is_u64() && answer["simplify_us"].is_u64());
}

#[test]
fn samples_are_free_within_speed_and_play_back() {
    let dir = with_cell(CELL);
    let args = ["plan", "cell.toml", "--robot", "arm", "--to", "1.0471975511965976,0", "--out", "path.csv"];
    let text = elbowroom(dir.path(), &args).expect(0).stdout;
    assert!(text.contains("joint_2") && text.contains("path.csv") && text.contains("stretches"), "{text}");
    let csv = std::fs::read_to_string(dir.path().join("path.csv")).unwrap();
    let rows: Vec<Vec<f64>> = csv.lines().skip(1).map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!(csv.lines().next(), Some("t_s,joint_1,joint_2"));
    assert!(rows[0][0] == 0.0 && (rows[0][1] + 1.047_197_551_196_597_6).abs() < 1e-15);
    assert_eq!(rows.last().unwrap()[1..], [1.047_197_551_196_597_6, 0.0]);
    for w in rows.windows(2) {
        let step = w[1][0] - w[0][0];
        assert!((step - 0.002).abs() < 1e-9, "the cell's tick");
        for j in [1, 2] {
            assert!((w[1][j] - w[0][j]).abs() <= step * 90.0_f64.to_radians() * (1.0 + 1e-6));
        }
    }
    let states = csv.replace("joint", "arm.joint");
    std::fs::write(dir.path().join("q.csv"), states).unwrap();
    elbowroom(dir.path(), &["query", "cell.toml", "--ask", "collision", "--states", "q.csv"]).expect(0);
    // The trajectory player of the cell accepts the file.
    std::fs::write(dir.path().join("play.toml"), format!("{CELL}[program.arm]\ntrajectory = \"path.csv\"\n")).unwrap();
    let run = elbowroom(dir.path(), &["run", "play.toml", "--json"]).expect(0).json();
    assert_eq!(run["robots"][0]["finished"], true);
}

#[test]
fn no_path_has_exit_status_1_and_a_reason() {
    // The elbow cannot bend: the arm would have to pass through the sphere.
    let stiff = CELL.replace(
        "{ a = 300, min = -170, max = 170, speed = 90 }]\nlinks = [[], {",
        "{ a = 300, min = -1, max = 1, speed = 90 }]\nlinks = [[], {",
    );
    let args = ["--robot", "arm", "--to", "1,0", "--time-limit", "0.2"];
    let answer = plan(&stiff, &[&args[..], &["--json"]].concat()).expect(1).json();
    assert_eq!((&answer["found"], &answer["waypoints"]), (&false.into(), &Value::Array(vec![])));
    assert!(answer["reason"].as_str().unwrap().contains("no path exists: `joint_1`"), "{answer}");
    assert!(answer["cost_rad"].is_null() && answer["duration_s"].is_null() && answer["planning_us"].as_u64() > Some(0));
    let text = plan(&stiff, &args).expect(1).stdout;
    assert!(text.contains("no path exists"), "{text}");
}

#[test]
fn invalid_requests_are_refused_with_a_hint() {
    let cases: [(&[&str], &[&str]); 15] = [
        (&["--robot", "arm", "--to", "0,0"], &["goal", "arm/link_2", "`ball`", "collision"]),
        (&["--robot", "arm", "--from", "0,0", "--to", "1,0"], &["start", "arm/link_2", "`ball`"]),
        (&["--robot", "arm", "--to", "3.5,0"], &["joint_1", "3.5", "2.96"]),
        (&["--robot", "arm", "--to", "90,0"], &["joint_1", "degrees"]),
        (&["--robot", "arm", "--to", "1"], &["1 value for 2 joints", "joint_1,joint_2"]),
        (&["--robot", "arm", "--from", "1,2,3", "--to", "1,0"], &["start", "3 values for 2 joints"]),
        (&["--robot", "arm", "--to", "nan,0"], &["--to", "value 1", "nan"]),
        (&["--robot", "arm", "--to", "0.1,,2"], &["--to", "value 2"]),
        (&["--robot", "amr", "--to", "1,0"], &["amr", "arm"]),
        (&["--to", "1,0"], &["2 robots", "arm, other"]),
        (&["--robot", "other", "--to", "1"], &["other", "largest speed", "joint_1", "speed = [180]", "[robot.other]"]),
        (&["--robot", "arm", "--to", "1,0", "--time-limit", "-1"], &["--time-limit"]),
        (&["--robot", "arm", "--to", "1,0", "--clearance", "nan"], &["clearance", "NaN"]),
        (&["--robot", "arm", "--to", "1,0", "--planner", "grid"], &["has 2 joints", "need 3", "planner rrt-connect"]),
        (&["--robot", "arm", "--to", "1,0", "--planner", "grid", "--optimize"], &["--optimize", "rrt-connect"]),
    ];
    for (args, words) in cases {
        let answer = plan(CELL, args).expect(2);
        assert_eq!(answer.stdout, "", "{args:?}");
        for word in words {
            assert!(answer.stderr.contains(word), "{args:?}: no `{word}` in:\n{}", answer.stderr);
        }
    }
    plan(CELL, &["--robot", "arm"]).expect(2);
    let dir = with_cell(CELL);
    let args = ["plan", "cell.toml", "--robot", "arm", "--to", "-1,0.2", "--out", "no/such/folder.csv"];
    assert!(elbowroom(dir.path(), &args).expect(2).stderr.contains("cannot be written"));
    elbowroom(dir.path(), &["plan", "missing.toml", "--to", "0"]).expect(2);
}

#[test]
fn a_path_on_the_map_is_the_same_in_every_run() {
    let dir = with_cell(&CELL.replace(
        "{ a = 300, min = -170, max = 170, speed = 90 }]\nlinks = [[],",
        "{ a = 300, min = -170, max = 170, speed = 90 }, { a = 100, min = -90, max = 90, speed = 90 }]\nlinks = [[],",
    )
    .replace("radius = 40 } }]\nstart = [-60, 0]", "radius = 40 } }, []]\nstart = [-60, 0, 0]"));
    let plan = |more: &[&str], status| {
        let args =
            ["plan", "cell.toml", "--robot", "arm", "--from", "-1,0.1,0", "--to", "1,-.1,0", "--planner", "grid"];
        elbowroom(dir.path(), &[&args[..], more].concat()).expect(status)
    };
    let answers = [1, 2].map(|_| plan(&["--json"], 0).json());
    assert_eq!(answers[0]["waypoints"], answers[1]["waypoints"]);
    assert!(answers[0]["waypoints"].as_array().unwrap().len() > 2 && answers[0]["map_us"].as_u64() > Some(0));
    assert!(plan(&[], 0).stdout.contains("made the map in"));
    let two = [
        "plan",
        "cell.toml",
        "--robot",
        "arm",
        "--robot",
        "other",
        "--to",
        "1,0,0",
        "--to",
        "0.1",
        "--planner",
        "grid",
    ];
    assert!(elbowroom(dir.path(), &two).expect(2).stderr.contains("--planner grid is for one robot"));
}

/// The example arm with six joints, a mesh on each link, a gripper and a pallet, and another arm beside it.
#[test]
fn six_joints_with_meshes_find_around_the_pallet() {
    let cell = examples().join("exchange/cell.toml");
    let dir = tempfile::tempdir().unwrap();
    let args = [
        "--robot",
        "left",
        "--from",
        "1.0,0.9,0.2,0,0.8,0",
        "--to",
        "-1.0,0.9,0.2,0,0.8,0",
        "--out",
        "path.csv",
        "--json",
    ];
    let all = [&["plan", cell.to_str().unwrap()], &args[..]].concat();
    let answer = elbowroom(dir.path(), &all).expect(0).json();
    assert_eq!(answer["joints"].as_array().unwrap().len(), 6);
    let csv = std::fs::read_to_string(dir.path().join("path.csv")).unwrap();
    let header = csv.lines().next().unwrap().replace(',', ",left.").replace("left.t_s", "t_s");
    let states: Vec<&str> = std::iter::once(header.as_str()).chain(csv.lines().skip(1)).collect();
    std::fs::write(dir.path().join("q.csv"), states.join("\n")).unwrap();
    elbowroom(dir.path(), &["query", cell.to_str().unwrap(), "--ask", "collision", "--states", "q.csv"]).expect(0);
}

/// A region instead of a sphere blocks the arm's reach along x.
#[test]
fn forbidden_regions_are_obstacles_and_are_named() {
    let cell = CELL.replace("[object.ball]", "[region.press]") + "warning = 50\nrobots = [\"arm\"]\n";
    let cell = cell.replace("at = [600, 0, 0]\nradius", "centre = [600, 0, 0]\nradius");
    let go = ["--robot", "arm", "--from", "-1,0.1", "--to", "1,-.1", "--json"];
    let answer = plan(&cell, &go).expect(0).json();
    assert_eq!(answer["regions"], serde_json::json!(["press"]));
    assert!(answer["waypoints"].as_array().unwrap().len() > 2);
    let open = plan(&cell.replace("warning = 50", "life = \"temporary\""), &go).expect(0).json();
    assert_eq!(open["regions"], serde_json::json!([]));
    assert_eq!(open["waypoints"].as_array().unwrap().len(), 2);
    let refused = plan(&cell, &["--robot", "arm", "--from", "-1,0.1", "--to", "0,0"]).expect(2);
    assert!(refused.stderr.contains("goal") && refused.stderr.contains("region `press`"), "{}", refused.stderr);
}

/// A point in the middle of the second link goes to a place where only the elbow can bring it, around the ball.
#[test]
fn a_point_of_a_link_is_brought_to_a_place() {
    let go =
        |more: &[&str], status| plan(CELL, &[&["--robot", "arm", "--from", "-1,0.1"], more].concat()).expect(status);
    let args = ["--point", "link_2,-100,0,0", "--to-point", "389.7,382.6,0"];
    let answer = go(&[&args[..], &["--json"]].concat(), 0).json();
    let point = &answer["point"];
    assert_eq!(
        (&point["link"], &point["in_link_m"]),
        (&serde_json::json!("link_2"), &serde_json::json!([-0.1, 0.0, 0.0]))
    );
    assert_eq!(point["moved_by"], serde_json::json!(["joint_1", "joint_2"]));
    // The place of the point by the geometry of two links.
    let place = |q: &[f64]| {
        let [a, b] = [q[0], q[0] + q[1]];
        [0.4 * a.cos() + 0.2 * b.cos(), 0.4 * a.sin() + 0.2 * b.sin(), 0.0]
    };
    let waypoints = answer["waypoints"].as_array().unwrap();
    let places = point["waypoints_m"].as_array().unwrap();
    assert!(waypoints.len() > 2 && places.len() == waypoints.len());
    for (q, at) in waypoints.iter().zip(places) {
        assert!(place(&numbers(q)).iter().zip(numbers(at)).all(|(a, b)| (a - b).abs() < 1e-9), "{answer}");
    }
    let end = numbers(&places[places.len() - 1]);
    assert!((end[0] - 0.3897).hypot(end[1] - 0.3826) < 1e-6, "{end:?}");
    let chord = (numbers(&places[0])[0] - end[0]).hypot(numbers(&places[0])[1] - end[1]);
    assert!(point["length_m"].as_f64().unwrap() > chord);
    assert!(go(&args, 0).stdout.contains("the point of link_2 goes "));
    // As `query` names the link.
    go(&["--point", "arm/link_2,-100,0,0", "--to-point", "389.7,382.6,0"], 0);

    let refused = |point: &str, to: &str| go(&["--point", point, "--to-point", to], 2).stderr;
    let text = refused("link_7,0,0,0", "300,300,0");
    assert!(text.contains("no link \"link_7\"") && text.contains("write: "), "{text}");
    let text = refused("link_2,0,0,0", "900,300,0");
    assert!(text.contains("does not get there") && text.contains("mm away"), "{text}");
    let text = refused("link_2,-100,0,0", "0.3897,0.3826,0");
    assert!(text.contains("m seem to be meant"), "{text}");
    let text = refused("base,0,0,0", "0,0,900");
    assert!(text.contains("no joint moves `base`"), "{text}");
    assert!(refused("link_2,0,0", "0,0,900").contains("write LINK,x,y,z"));
    assert!(refused("link_2,0,0,0", "0,900").contains("--to-point has 2 numbers"));
    let both = ["--point", "link_2,0,0,0", "--to-point", "0,900,0", "--to", "1,0"];
    assert!(go(&both, 2).stderr.contains("cannot be used with"));
    assert!(go(&["--point", "link_2,0,0,0"], 2).stderr.contains("--to-point"));
    for more in [&["--near", "1,1"][..], &["--configuration", "front"], &["--to-pose", "1,2,3,0,0,0"]] {
        assert!(go(&[&args[..], more].concat(), 2).stderr.contains("cannot be used with"), "{more:?}");
    }
    assert!(go(&["--to-pose", "1,2,3,0,0,0", "--point", "link_2,0,0,0"], 2).stderr.contains("cannot be used with"));
    // In the ball, with every configuration.
    assert!(refused("link_2,0,0,0", "600,0,0").contains("configurations with the point at its place were tried"));
}

/// The arm's tip moves straight; and with an axis that is kept, which a planar arm always keeps.
#[test]
fn the_tcp_moves_straight_or_keeps_an_axis() {
    let go =
        |more: &[&str], status| plan(CELL, &[&["--robot", "arm", "--from", "-1,1.4"], more].concat()).expect(status);
    // The tip of two links, 400 and 300 mm.
    let tip = |q: &[f64]| [0.4 * q[0].cos() + 0.3 * (q[0] + q[1]).cos(), 0.4 * q[0].sin() + 0.3 * (q[0] + q[1]).sin()];
    let at = tip(&[-1.0, 1.4]);
    let target = format!("{},{},0,0,0,{}", 1e3 * at[0] - 60.0, 1e3 * at[1], 0.4_f64.to_degrees());
    // Two joints cannot keep the orientation on a line.
    let refused = go(&["--to-pose", &target, "--linear", "--json"], 1).json();
    assert!(
        refused["found"] == false && refused["reason"].as_str().unwrap().contains("the straight line can be followed")
    );
    let kept = go(&["--to", "1,-.1", "--keep", "z=5", "--json"], 0).json();
    assert!(kept["found"] == true && kept["waypoints"].as_array().unwrap().len() > 2);
    let turned = go(&["--to", "1,-.1", "--keep", "x=5"], 2).stderr;
    assert!(turned.contains("5.0° are allowed") && turned.contains("wider angle"), "{turned}");
    for (args, expected) in [
        (&["--to", "1,0", "--linear"][..], "leads to a pose"),
        (&["--to-pose", &target, "--linear", "--keep", "z=5"], "cannot be used with"),
        (&["--to", "1,0", "--keep", "z"], "AXIS=ANGLE"),
        (&["--to", "1,0", "--keep", "z=0"], "not above 0"),
        (&["--to", "1,0", "--keep", "1,2=5"], "AXIS=ANGLE"),
        (&["--to", "1,0", "--keep", "0,0,0=5"], "no direction"),
    ] {
        let text = go(args, 2).stderr;
        assert!(text.contains(expected), "{args:?}: {text}");
    }
}
