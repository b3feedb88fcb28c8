//! `elbowroom query --ask limits`: the joint that is farthest beyond its limits.

use std::fmt::Write as _;
use std::path::Path;

use crate::common::{elbowroom, with_cell};
use elbowroom_testkit::folder::robots;
use elbowroom_testkit::random::XorshiftStar;

const HEADER: &str = "index,beyond,joint,overshoot,unit,value,lower,upper,stops";

/// An arm of a turning and a sliding joint with their own tolerances, and one that stays.
const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ min = -90, max = 90, speed = 90 }, { kind = "prismatic", min = 0, max = 500, speed = 90 }]
overshoot = [1, 20]
[robot.other]
dh = [{ name = "turn", min = -90, max = 90, speed = 90 }]
base = { at = [0, 3000, 0] }
"#;

/// A joint as its URDF writes it.
struct Limited {
    name: String,
    is_sliding: bool,
    lower: f64,
    upper: f64,
}

/// The independent joints with limits of a URDF, read from its text alone.
fn limited(urdf: &Path) -> Vec<Limited> {
    let text = std::fs::read_to_string(urdf).unwrap();
    let attribute = |element: &str, name: &str| {
        let at =
            element.find(&format!(" {name}=\"")).unwrap_or_else(|| panic!("no {name}: {element}")) + name.len() + 3;
        element[at..].split('"').next().unwrap().to_owned()
    };
    let mut found = Vec::new();
    for joint in text.split("<joint ").skip(1).filter_map(|joint| joint.split_once("</joint>")).map(|(joint, _)| joint)
    {
        let kind = attribute(&format!(" {joint}"), "type");
        if joint.contains("<mimic") || !["revolute", "prismatic"].contains(&kind.as_str()) {
            continue;
        }
        let limit = joint.split("<limit").nth(1).unwrap().split("/>").next().unwrap();
        let number = |name: &str| attribute(limit, name).parse().unwrap();
        let name = attribute(&format!(" {joint}"), "name");
        found.push(Limited { name, is_sliding: kind == "prismatic", lower: number("lower"), upper: number("upper") });
    }
    found
}

/// Turning and sliding joints, of which one follows another.
#[test]
fn the_rows_of_a_real_robot_are_those_of_its_file() {
    let Some(panda) = robots(&["urdf"]).into_iter().find(|path| path.ends_with("panda.urdf")) else { return };
    let joints = limited(&panda);
    assert_eq!((joints.len(), joints[7].is_sliding), (8, true));
    let mut random = XorshiftStar(7);
    let names: Vec<&str> = joints.iter().map(|j| j.name.as_str()).collect();
    let mut states = names.join(",") + "\n";
    let mut expected = Vec::new();
    for _ in 0..400 {
        let value = |j: &Limited, random: &mut XorshiftStar| match random.below(8) {
            0 => j.lower,
            1 => j.upper,
            2 => j.upper + random.between(0.0, 0.1),
            3 => j.lower - random.between(0.0, 0.1),
            _ => random.between(j.lower, j.upper),
        };
        let q: Vec<f64> = joints.iter().map(|j| value(j, &mut random)).collect();
        let _ = writeln!(states, "{}", q.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(","));
        let beyond = |(i, j): (usize, &Limited)| match q[i] {
            v if v > j.upper => Some((i, v - j.upper)),
            v if v < j.lower => Some((i, v - j.lower)),
            _ => None,
        };
        let all: Vec<(usize, f64)> = joints.iter().enumerate().filter_map(beyond).collect();
        let stops = all.iter().any(|(_, by)| by.abs() > 0.05);
        expected.push((all.into_iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())), q, stops));
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("q.csv"), &states).unwrap();
    let args = ["query", "--urdf", panda.to_str().unwrap(), "--ask", "limits", "--states", "q.csv"];
    let answer = elbowroom(dir.path(), &args).expect(0);
    let mut lines = answer.stdout.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), expected.len());
    let mut counts = [0; 3];
    for (i, (row, (farthest, q, stops))) in rows.iter().zip(&expected).enumerate() {
        assert_eq!((row[0], row[8]), (i.to_string().as_str(), if *stops { "1" } else { "0" }), "{row:?}");
        counts[usize::from(*stops)] += 1;
        let Some((joint, by)) = farthest else {
            assert_eq!(row[1..8], ["0", "", "0.0", "", "", "", ""], "{row:?}");
            counts[2] += 1;
            continue;
        };
        let j = &joints[*joint];
        assert_eq!(row[1..3], ["1", &*j.name], "{row:?}");
        assert_eq!(row[4], if j.is_sliding { "m" } else { "rad" });
        let numbers: Vec<f64> = [3, 5, 6, 7].iter().map(|c| row[*c].parse().unwrap()).collect();
        assert_eq!(numbers, [*by, q[*joint], j.lower, j.upper], "{row:?}");
    }
    assert!(counts.iter().all(|count| *count > 10), "{counts:?}");
    let json = elbowroom(dir.path(), &[&args[..], &["--json"]].concat()).expect(0).json();
    let beyond = expected.iter().filter(|(farthest, ..)| farthest.is_some()).count();
    assert_eq!((&json["ask"], &json["states"], &json["beyond"]), (&"limits".into(), &400.into(), &beyond.into()));
    assert!(json.get("colliding").is_none());
    let by = json["rows"].as_array().unwrap().iter().map(|row| row["overshoot"].as_f64().unwrap());
    let of_csv = rows.iter().map(|row| row[3].parse::<f64>().unwrap());
    assert!(by.zip(of_csv).all(|(json, csv)| (json - csv).abs() < 1e-15));
}

#[test]
fn the_tolerance_of_the_cell_file_decides_whether_a_monitor_stops() {
    let dir = with_cell(CELL);
    let states = "arm.joint_1,arm.joint_2,other.turn\n0,0.1,0\n1.58,0.1,0\n1.6,0.51,-1.6\n0,0.53,-1.6\n";
    std::fs::write(dir.path().join("q.csv"), states).unwrap();
    let args = ["query", "cell.toml", "--ask", "limits", "--states", "q.csv", "--json"];
    let json = elbowroom(dir.path(), &args).expect(0).json();
    let rows: Vec<_> =
        json["rows"].as_array().unwrap().iter().map(|r| (r["joint"].as_str(), r["stops"].as_u64())).collect();
    let expected = [
        (None, Some(0)),
        // 0.5 degrees are within the one degree of the file.
        (Some("arm.joint_1"), Some(0)),
        // 1.7 degrees are not; the other robot has the default, 0.05 rad.
        (Some("arm.joint_1"), Some(1)),
        // 30 mm are farther beyond as numbers, and more than 20 mm.
        (Some("arm.joint_2"), Some(1)),
    ];
    assert_eq!(rows, expected, "{json}");
    assert_eq!(json["rows"][3]["unit"], "m");
}

#[test]
fn options_about_pairs_are_refused() {
    let dir = with_cell(CELL);
    for option in [&["--no-self"][..], &["--between", "arm,other"], &["--level", "L2"], &["--times"], &["--no-matrix"]]
    {
        let refused = elbowroom(dir.path(), &[&["query", "cell.toml", "--ask", "limits"], option].concat()).expect(2);
        let expected = format!("{} is about pairs", option[0]);
        assert!(refused.stderr.contains(&expected) && refused.stdout.is_empty(), "{}", refused.stderr);
    }
    // Without states: the start, which is within the limits.
    let start = elbowroom(dir.path(), &["query", "cell.toml", "--ask", "limits"]).expect(0);
    assert_eq!(start.stdout, format!("{HEADER}\n0,0,,0.0,,,,,0\n"));
    assert!(!start.stderr.contains("no pair"), "{}", start.stderr);
}
