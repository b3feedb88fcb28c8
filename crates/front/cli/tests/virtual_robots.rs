//! `elbowroom run` with `[virtual_robot.NAME]`: a work-piece is carried and handed over, stops before regions, and wrong
//! tables are refused at their line.

use std::path::Path;

use crate::common::elbowroom;

/// The example `inspection` in a folder, with a change of its cell; of its stream the first seconds.
fn write(dir: &Path, change: impl Fn(String) -> String, seconds: f64) {
    let examples = elbowroom_testkit::folder::examples();
    let read = |name: &str| std::fs::read_to_string(examples.join("inspection").join(name)).unwrap();
    let cell = read("cell.toml").replace("../models", &examples.join("models").display().to_string());
    std::fs::write(dir.join("cell.toml"), change(cell.replace("tick_ms = 4", "tick_ms = 8"))).unwrap();
    let stream = read("bar.csv");
    let is_early = |line: &&str| line.split(',').next().unwrap().parse::<f64>().map_or(true, |t_s| t_s <= seconds);
    let rows: Vec<&str> = stream.lines().filter(is_early).collect();
    std::fs::write(dir.join("bar.csv"), rows.join("\n")).unwrap();
}

fn run(dir: &Path, status: i32) -> serde_json::Value {
    let answer = elbowroom(dir, &["run", "cell.toml", "--json", "--out", "out"]);
    assert_eq!(answer.status, status, "{}", answer.stderr);
    serde_json::from_str(&answer.stdout).unwrap()
}

#[test]
fn a_bar_is_handed_over_in_motion_and_stays_on_its_path() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), |cell| cell, 8.0);
    let summary = run(dir.path(), 0);
    let trio = &summary["virtual_robots"][0];
    assert!(trio["carried_share"].as_f64().unwrap() > 0.999, "{trio}");
    assert!(trio["path_deviation_m"].as_f64().unwrap() < 1e-9, "{trio}");
    let hand_overs = trio["hand_overs"].as_array().unwrap();
    assert!(!hand_overs.is_empty(), "{trio}");
    let reason = hand_overs[0]["reason"].as_str().unwrap();
    assert!(reason.starts_with("one ") && reason.contains("can hold"), "{reason}");
    for robot in summary["robots"].as_array().unwrap() {
        assert_eq!(robot["collisions"].as_array().unwrap().len(), 0, "{robot}");
    }
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    let of = |event: &str| events.lines().filter(|line| line.ends_with(&format!(",bar,{event}"))).count();
    assert_eq!(
        (of("hand_over"), of("grip"), of("release")),
        (hand_overs.len(), hand_overs.len() + 1, hand_overs.len())
    );
    // Per tick the holder changes when the receiver takes the bar, and the bar never jumps.
    let rows = std::fs::read_to_string(dir.path().join("out/work_piece.csv")).unwrap();
    let mut lines = rows.lines();
    assert_eq!(lines.next(), Some("t_s,name,holder,x_m,y_m,z_m,qx,qy,qz,qw,hidden"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let changes = rows.windows(2).filter(|w| w[0][2] != w[1][2]).count();
    assert_eq!(changes, hand_overs.len());
    let place = |row: &[&str]| [3, 4, 5].map(|column| row[column].parse::<f64>().unwrap());
    for w in rows.windows(2) {
        let (a, b) = (place(&w[0]), place(&w[1]));
        let moved = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        assert!(moved <= 0.25 * 0.008 * 1.000_001, "{moved} m from {:?} to {:?}", w[0], w[1]);
    }
}

#[test]
fn the_bar_stops_before_a_region_and_the_reason_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let region = "\n[region.wall]\nshape = \"box\"\nfrom = [-100, 90, 350]\nto = [200, 300, 550]\nwarning = 40\n";
    write(dir.path(), |cell| cell + region, 0.0);
    // 150 mm towards the wall, with the orientation of the start.
    let first = std::fs::read_to_string(dir.path().join("bar.csv")).unwrap();
    let row: Vec<&str> = first.lines().nth(1).unwrap().split(',').collect();
    let turn = row[4..].join(",");
    let at = |k: i32| format!("{},{},{},{},{turn}", 0.04 * f64::from(k), row[1], 3 * k, row[3]);
    let rows: Vec<String> = (0..=50).map(at).collect();
    std::fs::write(dir.path().join("bar.csv"), format!("t_s,x,y,z,qx,qy,qz,qw\n{}\n", rows.join("\n"))).unwrap();
    let summary = run(dir.path(), 0);
    assert_eq!(summary["regions"][0]["entered"], false, "{summary}");
    let trio = &summary["virtual_robots"][0];
    assert!(trio["carried_share"].as_f64().unwrap() < 0.999, "{trio}");
    let stops = trio["stops"].as_array().unwrap();
    assert!(stops.iter().any(|s| s["reason"] == "a monitor has stopped a robot that carries it"), "{trio}");
}

#[test]
fn a_pose_that_is_left_out_is_not_carried_out() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), |cell| cell, 0.0);
    let text = std::fs::read_to_string(dir.path().join("bar.csv")).unwrap();
    let first: Vec<&str> = text.lines().nth(1).unwrap().split(',').collect();
    let far = format!("0.5,1e12,{}", first[2..].join(","));
    let rows = format!("t_s,x,y,z,qx,qy,qz,qw\n{}\n{far}\n", first.join(","));
    std::fs::write(dir.path().join("bar.csv"), rows).unwrap();
    let trio = &run(dir.path(), 0)["virtual_robots"][0];
    assert!(trio["carried_share"].as_f64().unwrap() < 0.01, "{trio}");
}

#[test]
fn wrong_tables_are_refused_at_their_line() {
    let dir = tempfile::tempdir().unwrap();
    let cases = [
        ("robots = [\"one\", \"two\", \"three\"]", "robots = [\"one\"]", "two to eight"),
        ("robots = [\"one\", \"two\", \"three\"]", "robots = [\"one\", \"two\", \"two\"]", "twice"),
        ("robots = [\"one\", \"two\", \"three\"]", "robots = [\"one\", \"two\", \"free\"]", "three"),
        ("work_piece = \"bar\"", "work_piece = \"bat\"", "bar"),
        ("holder = \"one\"", "holder = \"four\"", "not in this cell"),
        ("holder = \"one\"", "holder = \"two\"", "does not hold"),
        ("stream = \"bar.csv\"", "stream = \"bor.csv\"", "bor.csv"),
        ("stream = \"bar.csv\"", "stream = \"bar.csv\"\nspeed = -1", "speed"),
        ("stream = \"bar.csv\"", "stream = \"bar.csv\"\nspeeed = 1", "speed"),
        ("stream = \"bar.csv\"", "stream = \"bar.csv\"\nhorizon_s = 1e9", "horizon_s = 5   (at most 60)"),
        ("stream = \"bar.csv\"", "stream = \"bar.csv\"\nsettle_ms = 1e9", "settle_ms = 300   (at most 60000)"),
        ("stream = \"bar.csv\"", "stream = \"bar.csv\"\napproach_speed = 1e-9", "at least 1 mm/s"),
        ("approach = 60 }", "approach = [0, 0, 0] }", "length 0"),
        ("approach = 60 }", "aproach = 60 }", "approach"),
        ("approach = 60 }", "approach = 5 }", "nearer to \"bar\" than the gap of 10 mm"),
        ("seen_by = \"above\"", "seen_by = \"abov\"", "above"),
        ("seen_by = \"above\"\n", "", "needs the camera"),
        ("hidden = 30", "hidden = 130", "0 to 100"),
        // Then it detects obstacles too.
        ("[camera.above]", "[camera.above]\nuncertainty = 0.02", "needs the key `robot`"),
        ("at = [0, 0, 1020], rpy = [180, 0, 0]", "at = [0, 0, 1020]", "shows \"bar\" at no pose of the stream"),
        ("at = [20, 0, 450]", "at = [40, 0, 450]", "the grasp where the tool is"),
    ];
    // Both commands read the file in the same way.
    for ((from, to, expected), command) in cases.into_iter().zip(["check", "run"].into_iter().cycle()) {
        let change = |cell: String| {
            assert!(cell.contains(from), "{from}");
            // A camera that nothing names detects obstacles for a robot.
            let cell =
                if to.is_empty() { cell.replace("[camera.above]", "[camera.above]\nrobot = \"one\"") } else { cell };
            cell.replacen(from, to, 1)
        };
        write(dir.path(), change, 1.0);
        let answer = elbowroom(dir.path(), &[command, "cell.toml"]);
        assert_eq!(answer.status, 2, "{command}, {to}: {}", answer.stderr);
        assert!(answer.stderr.contains(expected), "{command}, {to}: {}", answer.stderr);
        let is_placed = answer.stderr.contains("cell.toml:") || answer.stderr.contains("bor.csv");
        assert!(is_placed, "{command}, {to}: {}", answer.stderr);
    }
}
