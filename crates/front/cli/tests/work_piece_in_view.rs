//! `elbowroom run` with a camera that looks at the work-piece of a virtual robot: it is handed over before an arm hides it, and
//! what is hidden is told.

use std::fmt::Write;
use std::path::Path;

use elbowroom::spatial::{Pose, Rotation, Vec3};

use crate::common::elbowroom;

/// Two arms that face each other, with a plate whose faces and edges they grasp, before a camera at the side.
const CELL: &str = r#"
version = 1
units = { length = "m", angle = "rad" }
tick_ms = 8
[robot.one]
model = "MODELS/rx60b/rx60b.urdf"
srdf = "MODELS/rx60b/rx60b.srdf"
base = { at = [-0.6, 0, 0] }
start = [-0.10120359675944046, 0.7238033882480872, 1.2038574931313892, -0.2828976156779772, -0.3703453306500058, 0.26463042465227105]
[robot.one.tool]
tcp = { at = [0, 0, 0.06] }
box = { at = [0, 0, 0.03], size = [0.03, 0.03, 0.06] }
[robot.two]
model = "MODELS/rx60b/rx60b.urdf"
srdf = "MODELS/rx60b/rx60b.srdf"
base = { at = [0.6, 0, 0], rpy = [0, 0, 3.141592653589793] }
start = [-0.28379410920832804, -0.45001712758409607, 1.699600461611587, 0.7458210541766666, 0.42533870214091224, -0.6995430828466329]
[robot.two.tool]
tcp = { at = [0, 0, 0.06] }
box = { at = [0, 0, 0.03], size = [0.03, 0.03, 0.06] }
[object.plate]
shape = "box"
at = [0.02, 0, 0.45]
rpy = [0, 1.5707963267948966, 0]
size = [0.12, 0.12, 0.02]
# Level: it does not show the floor.
[camera.side]
size = [640, 480]
focal_px = 470
pose = { at = [-0.1, -1.3, 0.45], rpy = [-1.5707963267948966, 0, 0] }
[virtual_robot.pair]
robots = ["one", "two"]
work_piece = "plate"
holder = "one"
stream = "plate.csv"
seen_by = "side"
hidden = PERCENT
[virtual_robot.pair.grasps]
one = [
  { at = [0, 0, 0.01], rpy = [3.141592653589793, 0, 0], approach = 0.06 },
  { at = [0, 0, -0.01], approach = 0.06 },
  { at = [0.06, 0, 0], rpy = [0, -1.5707963267948966, 0], approach = 0.06 },
  { at = [-0.06, 0, 0], rpy = [0, 1.5707963267948966, 0], approach = 0.06 },
  { at = [0, 0.06, 0], rpy = [1.5707963267948966, 0, 0], approach = 0.06 },
  { at = [0, -0.06, 0], rpy = [1.5707963267948966, 0, 3.141592653589793], approach = 0.06 },
]
two = [
  { at = [0, 0, 0.01], rpy = [3.141592653589793, 0, 0], approach = 0.06 },
  { at = [0, 0, -0.01], approach = 0.06 },
  { at = [0.06, 0, 0], rpy = [0, -1.5707963267948966, 0], approach = 0.06 },
  { at = [-0.06, 0, 0], rpy = [0, 1.5707963267948966, 0], approach = 0.06 },
  { at = [0, 0.06, 0], rpy = [1.5707963267948966, 0, 0], approach = 0.06 },
  { at = [0, -0.06, 0], rpy = [1.5707963267948966, 0, 3.141592653589793], approach = 0.06 },
]
"#;

/// A turn that brings the hand of `one` between the plate and the camera within 5 s, then a slow motion for 10 s.
fn stream() -> String {
    let start = Pose::new(Rotation::from_z(Vec3::X), Vec3::new(0.02, 0.0, 0.45));
    let to = Vec3::new(-0.1, 0.1, 0.45);
    let turned = Pose::new(Rotation::from_axis_angle(Vec3::Z, 1.1) * start.rotation, to);
    let end = Pose::new(turned.rotation, to + Vec3::splat(0.05));
    let mut text = String::from("t_s,x,y,z,qx,qy,qz,qw\n");
    for k in 0..=375_u32 {
        let t_s = 0.04 * f64::from(k);
        let pose =
            if t_s < 5.0 { start.interpolate(&turned, t_s / 5.0) } else { turned.interpolate(&end, 0.1 * t_s - 0.5) };
        let (p, [x, y, z, w]) = (pose.translation, pose.rotation.to_quaternion_xyzw());
        _ = writeln!(text, "{t_s},{},{},{},{x},{y},{z},{w}", p.x, p.y, p.z);
    }
    text
}

/// Runs the cell with this percentage. Returns the summary of the virtual robot, and per tick the hidden share.
fn run(dir: &Path, percent: u32) -> (serde_json::Value, Vec<Option<f64>>) {
    let models = elbowroom_testkit::folder::examples().join("models").display().to_string();
    let cell = CELL.replace("MODELS", &models).replace("PERCENT", &percent.to_string());
    std::fs::write(dir.join("cell.toml"), cell).unwrap();
    std::fs::write(dir.join("plate.csv"), stream()).unwrap();
    let answer = elbowroom(dir, &["run", "cell.toml", "--json", "--out", "out"]);
    assert_eq!(answer.status, 0, "{}", answer.stderr);
    let summary: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    let rows = std::fs::read_to_string(dir.join("out/work_piece.csv")).unwrap();
    let mut lines = rows.lines();
    assert_eq!(lines.next(), Some("t_s,name,holder,x_m,y_m,z_m,qx,qy,qz,qw,hidden"));
    let share = |line: &str| line.split(',').nth(10).unwrap().parse().ok();
    (summary["virtual_robots"][0].clone(), lines.map(share).collect())
}

/// Time for which more than a share is hidden, s.
fn hidden_s(shares: &[Option<f64>], share: f64) -> f64 {
    0.008 * shares.iter().flatten().filter(|hidden| **hidden > share).count() as f64
}

#[test]
fn a_plate_is_handed_over_before_the_arm_that_holds_it_hides_it() {
    let dir = tempfile::tempdir().unwrap();
    let (pair, shares) = run(dir.path(), 100);
    assert!(pair["hand_overs"].as_array().unwrap().is_empty(), "{pair}");
    assert!(hidden_s(&shares, 0.3) > 8.0, "{} s: {pair}", hidden_s(&shares, 0.3));
    assert_eq!((pair["hidden_s"].as_f64(), pair["out_of_view_s"].as_f64()), (Some(0.0), Some(0.0)), "{pair}");

    let (pair, shares) = run(dir.path(), 30);
    let hand_overs = pair["hand_overs"].as_array().unwrap();
    let reason = hand_overs[0]["reason"].as_str().unwrap();
    assert!(reason.starts_with("one would hide plate from camera side in "), "{reason}");
    assert!(reason.contains("two keeps it in view"), "{reason}");
    assert!(hand_overs.len() <= 2 && pair["stopped_s"] == 0.0, "{pair}");
    assert!(pair["carried_share"].as_f64().unwrap() > 0.999_999, "{pair}");
    let told_s = pair["hidden_s"].as_f64().unwrap();
    assert!(told_s < 0.2 && (told_s - hidden_s(&shares, 0.3)).abs() < 1e-9, "{pair}");
    let largest = shares.iter().flatten().fold(0.0, |a, b| f64::max(a, *b));
    assert!(largest > 0.0 && pair["largest_hidden_share"].as_f64() == Some(largest), "{pair}");
}

#[test]
fn what_is_hidden_is_told_in_the_events_and_the_report() {
    let dir = tempfile::tempdir().unwrap();
    let (pair, shares) = run(dir.path(), 0);
    let told_s = pair["hidden_s"].as_f64().unwrap();
    assert!(told_s > 1.0 && (told_s - hidden_s(&shares, 0.0)).abs() < 1e-9, "{pair}");
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    let first = events.lines().find(|line| line.ends_with(",plate,hidden")).expect("an event");
    let at = shares.iter().position(|share| share.is_some_and(|share| share > 0.0)).unwrap();
    let t_s: f64 = first.split(',').next().unwrap().parse().unwrap();
    assert!((t_s - 0.008 * at as f64).abs() < 1e-9, "{first}, hidden from tick {at} on");
    let report = std::fs::read_to_string(dir.path().join("out/report.html")).unwrap();
    assert!(report.contains("hidden from camera side"), "the plot and the sentence");
}
