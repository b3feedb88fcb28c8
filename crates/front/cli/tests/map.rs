//! `elbowroom map`: document, NumPy file, pictures, models, messages.

use crate::common::{Answer, elbowroom, examples, keys, with_cell};

/// An arm of three joints among a table, a column and a sphere.
const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [
  { a = 0, alpha = 90, d = 400, min = -170, max = 170, speed = 90 },
  { a = 500, min = -30, max = 120, speed = 90 },
  { a = 400, min = -140, max = 140, speed = 90 },
]
links = [
  { capsule = { from = [0, -400, 0], to = [0, 0, 0], radius = 60 } },
  { capsule = { from = [-500, 0, 0], to = [0, 0, 0], radius = 50 } },
  { box = { at = [-200, 0, 0], size = [400, 80, 80] } },
]
start = [0, 90, 0]
[object.table]
shape = "box"
at = [700, 0, 100]
size = [400, 800, 200]
[object.column]
shape = "cylinder"
at = [-300, 600, 500]
radius = 60
height = 1000
[object.ball]
shape = "sphere"
at = [0, -600, 700]
radius = 100
[map.arm]
step = [5, 5, 4]
others = "start"
"#;

fn map(cell: &str, args: &[&str]) -> Answer {
    let dir = with_cell(cell);
    let mut all = vec!["map", "cell.toml"];
    all.extend(args);
    elbowroom(dir.path(), &all)
}

#[test]
fn the_document_has_the_documented_keys() {
    let answer = map(CELL, &["--json"]).expect(0).json();
    for key in ["axes", "cells", "static_blocked", "obstacles", "blocked"] {
        assert!(keys(&answer).contains(&key), "{answer}");
    }
    let axes = answer["axes"].as_array().unwrap();
    let counts: Vec<_> = axes.iter().map(|a| a["count"].as_u64().unwrap()).collect();
    assert_eq!(counts, [68, 30, 70]);
    assert_eq!(axes[1]["joint"], "joint_2");
    assert!((axes[1]["min"].as_f64().unwrap() + 30_f64.to_radians()).abs() < 1e-12);
    assert!((axes[2]["step"].as_f64().unwrap() - 4_f64.to_radians()).abs() < 1e-12);
    assert_eq!(answer["cells"], 68 * 30 * 70);
    let obstacles = answer["obstacles"].as_array().unwrap();
    let names: Vec<_> = obstacles.iter().map(|o| o["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["table", "column", "ball"]);
    let each: Vec<u64> = obstacles.iter().map(|o| o["blocked"].as_u64().unwrap()).collect();
    let all = answer["blocked"].as_u64().unwrap();
    assert!(each.iter().all(|b| *b > 0 && *b <= all) && each.iter().sum::<u64>() >= all);
    assert!(obstacles.iter().all(|o| o["model"] == "exact" && o["time_us"].as_f64().unwrap() > 0.0));
    assert_eq!(answer["static_blocked"], all);
}

#[test]
fn numpy_reads_the_cells() {
    let dir = with_cell(CELL);
    let answer = elbowroom(dir.path(), &["map", "cell.toml", "--json", "--out", "map.npy"]).expect(0).json();
    let file = std::fs::read(dir.path().join("map.npy")).unwrap();
    assert!(file.starts_with(b"\x93NUMPY\x01\x00"));
    let header = String::from_utf8_lossy(&file[10..128]).to_string();
    assert!(header.contains("'|u1'") && header.contains("(68, 30, 70)"), "{header}");
    let cells = &file[128..];
    assert_eq!(cells.len(), 68 * 30 * 70);
    assert_eq!(cells.iter().map(|c| u64::from(*c)).sum::<u64>(), answer["blocked"].as_u64().unwrap());
    // Stretched out over the table, and straight up.
    let at = |q: [f64; 3]| {
        let cell = |q: f64, min: f64, step: f64| ((q - min) / step) as usize;
        cells[(cell(q[0], -170.0, 5.0) * 30 + cell(q[1], -30.0, 5.0)) * 70 + cell(q[2], -140.0, 4.0)]
    };
    assert_eq!((at([0.0, -25.0, 0.0]), at([0.0, 91.0, 1.0])), (1, 0));
}

#[test]
fn pictures_and_a_page() {
    let dir = with_cell(CELL);
    let text = elbowroom(dir.path(), &["map", "cell.toml", "--png", "slices"]).expect(0).stdout;
    assert!(text.contains("68 pictures") && text.contains("table") && text.contains("joint_1"), "{text}");
    let page = std::fs::read_to_string(dir.path().join("slices/index.html")).unwrap();
    assert_eq!(page.matches("<img").count(), 68);
    let picture = std::fs::read(dir.path().join("slices/slice_034.png")).unwrap();
    assert!(picture.starts_with(b"\x89PNG"));
}

#[test]
fn models_hold_the_exact_one() {
    let blocked = |model: &str| {
        let answer = map(CELL, &["--model", model, "--json"]).expect(0).json();
        assert_eq!(answer["obstacles"][0]["model"], model);
        answer["blocked"].as_u64().unwrap()
    };
    let exact = blocked("exact");
    for model in ["box", "slices", "spheres=8", "sphere"] {
        assert!(blocked(model) > exact, "{model}");
    }
    let error = map(CELL, &["--model", "cubes"]).expect(2).stderr;
    assert!(error.contains("spheres=N"), "{error}");
}

#[test]
fn a_deadline_says_how_many_spheres_were_reached() {
    let spheres = |args: &[&str]| {
        let answer = map(CELL, &[args, &["--json"]].concat()).expect(0).json();
        let reached: Vec<u64> =
            answer["obstacles"].as_array().unwrap().iter().map(|o| o["spheres"].as_u64().unwrap()).collect();
        (reached, answer["blocked"].as_u64().unwrap())
    };
    let (soon, coarse) = spheres(&["--model", "spheres=64", "--deadline", "0.000001"]);
    assert_eq!(soon, [1, 1, 1]);
    // A spherical object is always covered by one sphere.
    let (late, fine) = spheres(&["--model", "spheres=8", "--deadline", "600000"]);
    assert_eq!(late, [8, 8, 1]);
    let exact = map(CELL, &["--json"]).expect(0).json()["blocked"].as_u64().unwrap();
    assert!(exact < fine && fine < coarse, "{exact} {fine} {coarse}");
    let text = map(CELL, &["--model", "spheres=8", "--deadline", "600000"]).expect(0).stdout;
    assert!(text.contains("spheres=8") && text.contains("spheres=1"), "{text}");
}

#[test]
fn deadlines_are_for_spheres_on_covers() {
    let error = |args: &[&str]| map(CELL, args).expect(2).stderr;
    let message = error(&["--deadline", "5"]);
    assert!(message.contains("spheres") && message.contains("write: --model spheres=64"), "{message}");
    let message = error(&["--model", "spheres=8", "--deadline", "-1"]);
    assert!(message.contains("milliseconds"), "{message}");
    let two = CELL.replace("step = [5, 5, 4]", "joints = [\"joint_1\", \"joint_2\"]\nstep = 5");
    let message = map(&two, &["--model", "spheres=8", "--deadline", "5"]).expect(2).stderr;
    assert!(message.contains("cell.toml:") && message.contains("three joints"), "{message}");
    assert!(error(&["--model", "spheres=8", "--deadline", "5", "--exact"]).contains("--exact"));
}

#[test]
fn seeds_are_for_comparison_only() {
    let answer = map(CELL, &["--model", "seeds", "--json"]).expect(0);
    assert!(answer.stderr.contains("misses"), "{}", answer.stderr);
    let document = answer.json();
    assert!(document["obstacles"][0]["model"] == "seeds" && document["blocked"].as_u64() > Some(0), "{document}");
    let message = map(CELL, &["--model", "seeds", "--out", "map.npy"]).expect(2).stderr;
    assert!(message.contains("free") && message.contains("write: --model slices"), "{message}");
    let message = map(CELL, &["--model", "seeds", "--exact"]).expect(2).stderr;
    assert!(message.contains("cell.toml:") && message.contains("sphere covers"), "{message}");
    let message = map(CELL, &["--model", "seeds", "--deadline", "5"]).expect(2).stderr;
    assert!(message.contains("not for `seeds`"), "{message}");
}

#[test]
fn a_page_with_a_slider() {
    let dir = with_cell(CELL);
    let text = elbowroom(dir.path(), &["map", "cell.toml", "--page", "map.html"]).expect(0).stdout;
    assert!(text.contains("map.html"), "{text}");
    let page = std::fs::read_to_string(dir.path().join("map.html")).unwrap();
    assert!(page.len() < 200_000 && !page.contains("http") && !page.contains("/*DATA*/"), "{} bytes", page.len());
    for part in ["type=\"range\"", "aria-label", "joint_1", "\"unit\":\"deg\"", "table", "column", "ball"] {
        assert!(page.contains(part), "{part}");
    }
    let message = elbowroom(dir.path(), &["map", "cell.toml", "--page", "missing/map.html"]).expect(2).stderr;
    assert!(message.contains("missing/map.html") && message.contains("write:"), "{message}");
    let many = CELL.replace("step = [5, 5, 4]", "step = 0.3");
    let message = map(&many, &["--page", "map.html"]).expect(2).stderr;
    assert!(message.contains("too many for a page") && message.contains("larger step"), "{message}");
    let bad = elbowroom(dir.path(), &["map", "cell.toml", "--page"]).expect(2).stderr;
    assert!(bad.contains("--page"), "{bad}");
}

/// A path of the grid planner keeps to free cells; a straight one passes through the table.
#[test]
fn a_path_is_drawn_over_the_slices() {
    let dir = with_cell(CELL);
    let go = [
        "plan",
        "cell.toml",
        "--planner",
        "grid",
        "--from",
        "-0.9,-0.2,-0.2",
        "--to",
        "0.9,-0.2,-0.2",
        "--out",
        "path.csv",
    ];
    elbowroom(dir.path(), &go).expect(0);
    let draw = |path: &str, more: &[&str]| {
        elbowroom(dir.path(), &[&["map", "cell.toml", "--page", "map.html", "--path", path], more].concat())
    };
    let free = draw("path.csv", &["--json"]).expect(0).json();
    let rows = std::fs::read_to_string(dir.path().join("path.csv")).unwrap().lines().count() - 1;
    assert_eq!((free["path"]["rows"].as_u64(), free["path"]["blocked"].as_u64()), (Some(rows as u64), Some(0)));
    let page = std::fs::read_to_string(dir.path().join("map.html")).unwrap();
    let data = page.split("const map = ").nth(1).unwrap().split(";\n").next().unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let path = data["path"].as_array().unwrap();
    assert!(path.len() > 2 && path.len() < rows, "{} of {rows} points", path.len());
    // In cells: from -170, -30 and -140 degrees up, in steps of 5, 5 and 4.
    let first = [(-0.9_f64).to_degrees() + 170.0, (-0.2_f64).to_degrees() + 30.0, (-0.2_f64).to_degrees() + 140.0];
    for (k, step) in [5.0, 5.0, 4.0].into_iter().enumerate() {
        assert!((path[0][k].as_f64().unwrap() - first[k] / step).abs() < 0.006, "{}", path[0]);
    }
    let lines: Vec<String> = (0..=100).map(|n| format!("{},-0.2,-0.2", 0.018 * f64::from(n) - 0.9)).collect();
    std::fs::write(dir.path().join("q.csv"), format!("joint_1,joint_2,joint_3\n{}\n", lines.join("\n"))).unwrap();
    let text = draw("q.csv", &[]).expect(0).stdout;
    let line = text.lines().find(|line| line.contains("of 101 rows of the path are in blocked cells")).unwrap();
    assert!(!line.starts_with("0 "), "{line}");
    assert!(draw("none.csv", &[]).expect(2).stderr.contains("none.csv"));
    let alone = elbowroom(dir.path(), &["map", "cell.toml", "--path", "path.csv"]).expect(2).stderr;
    assert!(alone.contains("--page"), "{alone}");
}

#[test]
fn the_links_that_block_cells_are_told() {
    let answer = map(CELL, &["--links", "--json"]).expect(0).json();
    for obstacle in answer["obstacles"].as_array().unwrap() {
        let all = obstacle["blocked"].as_u64().unwrap();
        let links = obstacle["by_link"].as_object().unwrap();
        let each: Vec<u64> = links.values().map(|cells| cells.as_u64().unwrap()).collect();
        // A cell is blocked if any link may touch the object in it.
        assert!(each.iter().all(|cells| *cells <= all) && each.iter().sum::<u64>() >= all, "{obstacle}");
        // The forearm reaches farthest.
        assert!(links.contains_key("link_3"), "{obstacle}");
    }
    let text = map(CELL, &["--links"]).expect(0).stdout;
    assert!(text.contains("    by link_3 "), "{text}");
    assert!(map(CELL, &["--json"]).expect(0).json()["obstacles"][0].get("by_link").is_none());
    assert!(map(CELL, &["--links", "--model", "spheres=4", "--deadline", "5"]).expect(2).stderr.contains("--deadline"));
}

#[test]
fn other_joints_anywhere_block_more() {
    let two = CELL.replace("step = [5, 5, 4]", "joints = [\"joint_1\", \"joint_2\"]\nstep = 5");
    let held = map(&two, &["--json"]).expect(0).json();
    let any = map(&two.replace("others = \"start\"", "others = \"any\""), &["--json"]).expect(0).json();
    assert_eq!(held["cells"], 68 * 30);
    assert!(any["blocked"].as_u64() > held["blocked"].as_u64(), "{any} {held}");
}

#[test]
fn an_example_works_without_a_map_table() {
    let cell = examples().join("figure12/cell.toml");
    let dir = tempfile::tempdir().unwrap();
    let answer = elbowroom(dir.path(), &["map", cell.to_str().unwrap(), "--json"]).expect(0).json();
    assert_eq!(answer["axes"].as_array().unwrap().len(), 3);
}

#[test]
fn invalid_requests_are_refused_with_a_hint() {
    let error = |cell: &str, args: &[&str]| map(cell, args).expect(2).stderr;
    let unlimited = CELL.replace("min = -170, max = 170", "min = -170");
    assert!(!error(&unlimited, &[]).is_empty());
    let fine = CELL.replace("step = [5, 5, 4]", "step = 0.0001");
    let message = error(&fine, &[]);
    assert!(message.contains("joint_1") && message.contains("step = ") && message.contains("cell.toml:"), "{message}");
    let message = error(CELL, &["--robot", "harm"]);
    assert!(message.contains("harm") && message.contains("arm"), "{message}");
    let message = error(
        &CELL.replace("joints = [", "joints = [\"joint_9\", ").replace("step = [5, 5, 4]", "joints = [\"joint_9\"]"),
        &[],
    );
    assert!(message.contains("joint_9"), "{message}");
    let twice = CELL.replace("step = [5, 5, 4]", "joints = [\"joint_1\", \"joint_1\"]");
    assert!(error(&twice, &[]).contains("once"));
}
