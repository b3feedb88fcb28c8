//! `elbowroom inspect` with `--pose` and `--at`: inverse kinematics, and the chain to a point of a link.

use std::f64::consts::TAU;
use std::path::Path;

use elbowroom_testkit::random::SplitMix;

use crate::common::{elbowroom, model};

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().filter_map(serde_json::Value::as_f64).collect()
}

fn states(dir: &Path, rows: &[[f64; 6]]) {
    let row = |q: &[f64; 6]| q.map(|v| v.to_string()).join(",");
    let text: Vec<String> = rows.iter().map(row).collect();
    let head = "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6";
    std::fs::write(dir.join("q.csv"), format!("{head}\n{}\n", text.join("\n"))).unwrap();
}

/// Rows of a CSV answer, without names.
fn rows(text: &str, keep: impl Fn(&str) -> bool) -> Vec<Vec<f64>> {
    let rows = text.lines().skip(1).filter(|line| keep(line));
    rows.map(|line| line.split(',').filter_map(|cell| cell.parse().ok()).collect()).collect()
}

#[test]
fn joint_values_are_among_the_answers_for_the_pose_that_they_give() {
    let dir = tempfile::tempdir().unwrap();
    let mut random = SplitMix(12);
    for name in ["ns16", "rx60b"] {
        let model = model(name);
        let model = model.to_str().unwrap();
        let q: Vec<[f64; 6]> = (0..10).map(|_| std::array::from_fn(|_| random.between(-0.8, 1.5))).collect();
        states(dir.path(), &q);
        let poses = elbowroom(dir.path(), &["inspect", model, "--states", "q.csv"]).expect(0).stdout;
        let poses = rows(&poses, |line| line.contains(",tool0,"));
        for (q, pose) in q.iter().zip(poses) {
            let r = &pose[1..10];
            let [roll, yaw] = [r[7].atan2(r[8]), r[3].atan2(r[0])];
            let pitch = (-r[6]).atan2(r[0].hypot(r[3]));
            let wanted = [pose[10], pose[11], pose[12], roll, pitch, yaw].map(|v| format!("{v:?}")).join(",");
            let answer = elbowroom(dir.path(), &["inspect", model, "--pose", &wanted, "--json"]).expect(0).json();
            assert_eq!((&answer["method"], &answer["link"]), (&"closed_form".into(), &"tool0".into()));
            let solutions = answer["solutions"].as_array().unwrap();
            assert!(solutions.iter().all(|s| s["position_error_m"].as_f64().unwrap() < 1e-8), "{answer}");
            let mut configurations: Vec<&str> = solutions.iter().filter_map(|s| s["configuration"].as_str()).collect();
            let is_own = |s: &&serde_json::Value| {
                numbers(&s["q"]).iter().zip(q).all(|(a, b)| (a - b - ((a - b) / TAU).round() * TAU).abs() < 1e-6)
            };
            let own = solutions.iter().find(is_own).unwrap_or_else(|| panic!("{name}: {q:?} is not in {answer}"));
            assert!(own["configuration"].is_string());
            configurations.sort_unstable();
            configurations.dedup();
            assert_eq!(configurations.len(), solutions.len(), "each branch once: {answer}");
        }
    }
}

#[test]
fn a_pose_out_of_reach_has_no_answer_and_says_so() {
    let ns16 = model("ns16");
    let ns16 = ns16.to_str().unwrap();
    let answer = elbowroom(Path::new("."), &["inspect", ns16, "--pose", "9,0,0,0,0,0"]).expect(1);
    assert!(answer.stdout.contains("0 solutions") && answer.stdout.contains("out of reach"), "{}", answer.stdout);
    let json = elbowroom(Path::new("."), &["inspect", ns16, "--pose=9,0,0,0,0,0", "--json"]).expect(1).json();
    assert!(json["solutions"].as_array().unwrap().is_empty() && json["why_none"].is_string(), "{json}");
    for (pose, part) in [("1e9,0,0,0,0,0", "1000000 metres"), ("0,0,1,1e300,0,0", "100 radians")] {
        let refused = elbowroom(Path::new("."), &["inspect", ns16, "--pose", pose]).expect(2);
        assert!(refused.stderr.contains(part), "{}", refused.stderr);
    }
    for other in [["--picture", "a.png"], ["--models", "m"], ["--pairs", "p.toml"], ["--write-srdf", "s.srdf"]] {
        let args = [&["inspect", ns16, "--pose", "1,0,1,0,0,0"][..], &other].concat();
        assert!(elbowroom(Path::new("."), &args).expect(2).stderr.contains(other[0]), "never ignored: {other:?}");
    }
    let refused = elbowroom(Path::new("."), &["inspect", ns16, "--pose", "1,2,3"]).expect(2);
    assert!(refused.stderr.contains("has 3 numbers"), "{}", refused.stderr);
    let refused = elbowroom(Path::new("."), &["inspect", ns16, "--pose", "1,0,1,0,0,0", "--tip", "hand"]).expect(2);
    assert!(refused.stderr.contains("link `hand`") && refused.stderr.contains("tool0"), "{}", refused.stderr);
    let torch = crate::common::examples().join("models/tools/torch.stl");
    let refused = elbowroom(Path::new("."), &["inspect", torch.to_str().unwrap(), "--pose", "1,0,1,0,0,0"]).expect(2);
    assert!(refused.stderr.contains("is a mesh"), "{}", refused.stderr);
}

#[test]
fn the_chain_to_a_point_of_a_link_moves_as_its_jacobian_says() {
    let dir = tempfile::tempdir().unwrap();
    let ns16 = model("ns16");
    let ns16 = ns16.to_str().unwrap();
    let at = ["inspect", ns16, "--at", "link_3,0.1,0.05,-0.02"];
    let answer = elbowroom(dir.path(), &[&at[..], &["--json"]].concat()).expect(0).json();
    assert_eq!(answer["moved_by"], serde_json::json!(["joint_1", "joint_2", "joint_3"]));
    assert!(answer["dh_residual"].as_f64().unwrap() < 1e-9, "{answer}");
    let step = 1e-6;
    let mut q = vec![[0.0; 6]];
    q.extend((0..6).map(|joint| std::array::from_fn(|k| if k == joint { step } else { 0.0 })));
    states(dir.path(), &q);
    let places = elbowroom(dir.path(), &[&at[..], &["--states", "q.csv"]].concat()).expect(0).stdout;
    let places = rows(&places, |_| true);
    let rest = numbers(&answer["at_rest_m"]);
    for (joint, column) in answer["jacobian"].as_array().unwrap().iter().enumerate() {
        for (k, speed) in numbers(column).into_iter().enumerate() {
            assert!((places[0][k + 1] - rest[k]).abs() < 1e-12);
            let measured = (places[joint + 1][k + 1] - places[0][k + 1]) / step;
            assert!((measured - speed).abs() < 1e-5, "joint {joint}, {k}: {measured} instead of {speed}");
        }
    }
    // The poses of the link, which another option prints, carry the point along.
    let poses = elbowroom(dir.path(), &["inspect", ns16, "--states", "q.csv"]).expect(0).stdout;
    for (pose, place) in rows(&poses, |line| line.contains(",link_3,")).iter().zip(&places) {
        for k in 0..3 {
            let moved = pose[10 + k] + 0.1 * pose[1 + 3 * k] + 0.05 * pose[2 + 3 * k] - 0.02 * pose[3 + 3 * k];
            assert!((moved - place[k + 1]).abs() < 1e-12);
        }
    }
    let [least, most] = numbers(&answer["reach_m"])[..] else { panic!("{answer}") };
    assert!(least < most && (least..=most).contains(&rest.iter().map(|v| v * v).sum::<f64>().sqrt()), "{answer}");
}

#[test]
fn a_point_beside_its_link_is_told_the_nearest_point_and_drawn() {
    let dir = tempfile::tempdir().unwrap();
    let ns16 = model("ns16");
    let ns16 = ns16.to_str().unwrap();
    let json = elbowroom(dir.path(), &["inspect", ns16, "--at", "link_3,0.5,0.5,0.5", "--json"]).expect(0).json();
    let (off, nearest) = (json["off_surface_m"].as_f64().unwrap(), numbers(&json["nearest_m"]));
    let away = nearest.iter().map(|v| (v - 0.5) * (v - 0.5)).sum::<f64>().sqrt();
    assert!(off > 0.1 && (off - away).abs() < 1e-9, "{json}");
    let on = nearest.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let at = format!("link_3,{on}");
    let text = elbowroom(dir.path(), &["inspect", ns16, "--at", &at, "--picture", "at.png"]).expect(0).stdout;
    assert!(text.contains("surface  on it") && text.contains("Generalized DH to link_3 at"), "{text}");
    elbowroom(dir.path(), &["inspect", ns16, "--brief", "--picture", "without.png"]).expect(0);
    let bytes = |name: &str| std::fs::read(dir.path().join(name)).unwrap();
    assert_ne!(bytes("at.png"), bytes("without.png"));
    for (at, part) in [
        ("link_3,1,2", "LINK,x,y,z"),
        ("link_3,a,0,0", "\"a\""),
        ("leg,0,0,0", "base_link"),
        ("link_3,1e200,0,0", "metres"),
    ] {
        let refused = elbowroom(dir.path(), &["inspect", ns16, "--at", at]).expect(2);
        assert!(refused.stderr.contains(part), "{at}: {}", refused.stderr);
    }
}

/// In single precision the axes of a 3DS model meet only nearly.
#[test]
fn a_model_in_single_precision_has_a_classical_table() {
    let kr150 = crate::common::examples().join("models/kr150/kr150.3ds");
    let json = elbowroom(Path::new("."), &["inspect", kr150.to_str().unwrap(), "--brief", "--json"]).expect(0).json();
    let classical = &json["dh_classical"];
    let residual = classical["residual"].as_f64().unwrap_or_else(|| panic!("{classical}"));
    assert!(residual < 1e-7 && classical["zero_below_m"].as_f64().unwrap() < 5e-6, "{classical}");
    assert!(json["dh"].as_array().unwrap().iter().any(|row| row["b"].as_f64().unwrap() != 0.0), "a small b is there");
    assert!(json["dh_residual"].as_f64().unwrap() < 1e-14);
}
