//! `elbowroom inspect`: its output for the example arm.

use crate::common;
use crate::common::{elbowroom, examples, keys, model};

fn ns16() -> String {
    model("ns16").to_str().unwrap().to_owned()
}

#[test]
fn json_has_the_documented_keys_and_the_table_reproduces_the_chain() {
    let json = elbowroom(&examples(), &["inspect", &ns16(), "--json"]).expect(0).json();
    let keys_there = keys(&json);
    for key in ["links", "joints", "meshes", "dh", "dh_residual", "dh_tip", "warnings"] {
        assert!(keys_there.contains(&key), "{key} is missing: {keys_there:?}");
    }
    assert_eq!(json["links"].as_array().map(Vec::len), Some(8));
    assert_eq!(json["dh_tip"], "tool0");
    let residual = json["dh_residual"].as_f64().unwrap();
    assert!((0.0..1e-9).contains(&residual), "{residual}");
    let meshes = json["meshes"].as_array().unwrap();
    assert_eq!(meshes.len(), 7);
    for mesh in meshes {
        assert_eq!((mesh["closed"].as_bool(), mesh["degenerate"].as_u64()), (Some(true), Some(0)), "{mesh}");
        assert!(mesh["triangles"].as_u64().unwrap() > 100);
        assert!(mesh["link"].is_string());
        let extent: Vec<f64> =
            mesh["extent_m"].as_array().unwrap().iter().filter_map(serde_json::Value::as_f64).collect();
        assert!(extent.len() == 3 && extent.iter().all(|e| (0.005..2.0).contains(e)), "metres: {extent:?}");
    }
    let rows = json["dh"].as_array().unwrap();
    assert!(rows.iter().all(|r| keys(r) == ["a", "alpha", "b", "d", "joint", "theta"]));
    let moving: Vec<&str> = rows.iter().filter_map(|r| r["joint"].as_str()).collect();
    assert_eq!(moving, ["joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6"]);
}

#[test]
fn states_give_a_row_per_state_and_link() {
    let dir = tempfile::tempdir().unwrap();
    // Columns in another order, and joint_1 turned by a quarter turn in the second row.
    let states = "joint_6,joint_5,joint_4,joint_3,joint_2,joint_1\n0,0,0,0,0,0\n0,0,0,0,0,1.5707963267948966\n";
    std::fs::write(dir.path().join("q.csv"), states).unwrap();
    let answer = elbowroom(dir.path(), &["inspect", &ns16(), "--states", "q.csv"]).expect(0);
    let mut lines = answer.stdout.lines();
    assert_eq!(lines.next(), Some("index,link,r11,r12,r13,r21,r22,r23,r31,r32,r33,x_m,y_m,z_m"));
    let rows: Vec<Vec<&str>> = lines.map(|l| l.split(',').collect()).collect();
    assert_eq!(rows.len(), 2 * 8);
    assert!(rows.iter().all(|r| r.len() == 14));
    let tool = |index: &str| {
        let row = rows.iter().find(|r| r[0] == index && r[1] == "tool0").unwrap();
        row[11..].iter().map(|v| v.parse::<f64>().unwrap()).collect::<Vec<_>>()
    };
    let (straight, turned) = (tool("0"), tool("1"));
    assert!((straight[0] - 1.044).abs() < 1e-9 && (straight[2] - 1.485).abs() < 1e-9, "{straight:?}");
    assert!((turned[1] - 1.044).abs() < 1e-9 && turned[0].abs() < 1e-9, "{turned:?}");
}

#[test]
fn a_table_of_states_is_in_millimetres_and_degrees() {
    let dir = tempfile::tempdir().unwrap();
    let states = "joint_6,joint_5,joint_4,joint_3,joint_2,joint_1\n0,0,0,0,0,0\n0,0,0,0,0,1.5707963267948966\n";
    std::fs::write(dir.path().join("q.csv"), states).unwrap();
    let table = elbowroom(dir.path(), &["inspect", &ns16(), "--states", "q.csv", "--table"]).expect(0).stdout;
    assert!(table.lines().all(|line| line.chars().count() <= 100), "{table}");
    let lines: Vec<Vec<&str>> = table.lines().map(|line| line.split_whitespace().collect()).collect();
    let head = "state link x (mm) y (mm) z (mm) roll (deg) pitch (deg) yaw (deg)";
    assert_eq!(lines[0], head.split_whitespace().collect::<Vec<_>>());
    assert_eq!(lines.len(), 1 + 2 * 8);
    let tools: Vec<&Vec<&str>> = lines.iter().filter(|line| line[1] == "tool0").collect();
    assert_eq!((tools[0][0], &tools[0][2..5]), ("0", &["1044.00", "0.00", "1485.00"][..]), "{table}");
    assert_eq!((tools[1][0], &tools[1][2..5]), ("1", &["0.00", "1044.00", "1485.00"][..]), "{table}");
    // The link that the first joint turns.
    let turned = lines.iter().rfind(|line| line[1] == "link_1").unwrap();
    assert_eq!(turned[7], "90.00", "{table}");
}

#[test]
fn states_with_a_wrong_column_or_number_name_the_line() {
    let dir = tempfile::tempdir().unwrap();
    for (states, part) in [
        ("joint_1,joint_2,joint_3,joint_4,joint_5,elbow\n0,0,0,0,0,0\n", "joint_6"),
        ("joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0,0,0,0,0,0\n0,0,x,0,0,0\n", "q.csv:3"),
        ("joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0,0,0\n", "q.csv:2"),
        ("joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0,0,NaN,0,0,0\n", "q.csv:2"),
        ("", "q.csv"),
    ] {
        std::fs::write(dir.path().join("q.csv"), states).unwrap();
        let answer = elbowroom(dir.path(), &["inspect", &ns16(), "--states", "q.csv"]).expect(2);
        assert!(answer.stderr.contains(part), "{states:?}: {}", answer.stderr);
        assert_eq!(answer.stdout, "");
    }
}

#[test]
fn a_unit_scales_a_mesh_and_an_unknown_tip_is_refused() {
    let torch = examples().join("models/tools/torch.stl");
    let torch = torch.to_str().unwrap();
    let extent = |args: &[&str]| {
        let json = elbowroom(&examples(), args).expect(0).json();
        json["meshes"][0]["extent_m"][2].as_f64().unwrap()
    };
    let metres = extent(&["inspect", torch, "--json"]);
    let millimetres = extent(&["inspect", torch, "--json", "--unit", "mm"]);
    assert!((metres - 1000.0 * millimetres).abs() < 1e-6 * metres, "{metres} {millimetres}");
    let answer = elbowroom(&examples(), &["inspect", &ns16(), "--tip", "hand"]).expect(2);
    assert!(answer.stderr.contains("hand"), "{}", answer.stderr);
    let answer = elbowroom(&examples(), &["inspect", torch, "--states", torch]).expect(2);
    assert!(answer.stderr.contains("no joints"), "{}", answer.stderr);
}

#[test]
fn the_table_names_every_joint_and_mesh() {
    let answer = elbowroom(&examples(), &["inspect", &ns16()]).expect(0);
    for word in ["joint_1", "joint_6", "base_link", "link_6", "residual", "closed"] {
        assert!(answer.stdout.contains(word), "{word}: {}", answer.stdout);
    }
}

#[test]
fn resolution_models_report_their_deviation() {
    let dir = tempfile::tempdir().unwrap();
    let answer =
        elbowroom(dir.path(), &["inspect", &ns16(), "--json", "--models", "m", "--picture", "p.png"]).expect(0);
    let json = answer.json();
    assert_eq!(json["suspect_units"].as_array().map(Vec::len), Some(0));
    assert!(json["meshes"].as_array().unwrap().iter().all(|m| m["open_edges"] == 0 && m["non_manifold_edges"] == 0));
    let levels = json["resolution"].as_array().unwrap();
    assert_eq!(levels.len(), 7);
    for l in levels {
        let triangles = |key: &str| l[key]["triangles"].as_u64().unwrap();
        assert!(triangles("middle") <= triangles("fine") / 4 + 1 && triangles("coarse") <= triangles("fine") / 16 + 12);
        let off = |key: &str| l[key]["deviation_m"].as_f64().unwrap();
        assert!(off("fine") == 0.0 && off("middle") > 0.0 && off("middle") < 0.01 && off("coarse") < 0.05, "{l}");
        assert!(["box", "obb", "capsule", "hull"].iter().all(|k| l[*k].is_object()), "{l}");
    }
    let pairs = json["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 7 * 6 / 2);
    assert_eq!(keys(&pairs[0]), ["a", "b", "margin_m", "reason", "suggestion", "tested", "weight"]);
    let adjacent = pairs.iter().filter(|p| p["tested"] == false && p["reason"] == "adjacent").count();
    assert_eq!(adjacent, 6);
    assert_eq!(std::fs::read_dir(dir.path().join("m")).unwrap().count(), 3 * 7);
    let coarse = dir.path().join("m/01_link_1.coarse.stl");
    let json = elbowroom(dir.path(), &["inspect", coarse.to_str().unwrap(), "--json", "--brief"]).expect(0).json();
    assert_eq!(json["meshes"][0]["triangles"], levels[1]["coarse"]["triangles"]);
    let png = std::fs::read(dir.path().join("p.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 20_000);
    elbowroom(dir.path(), &["inspect", &ns16(), "--brief", "--picture", "p.html"]).expect(0);
    assert_eq!(std::fs::read_to_string(dir.path().join("p.html")).unwrap().matches("data:image/png").count(), 4);
    let answer = elbowroom(dir.path(), &["inspect", &ns16(), "--brief", "--picture", "p.gif"]).expect(2);
    assert!(answer.stderr.contains("png"), "{}", answer.stderr);
}

/// Inspects a slide of 1 m whose cart is a cube; the coordinates of its corners are multiplied by `size`, and `scale`
/// is in the URDF.
fn cart(dir: &std::path::Path, size: f64, scale: f64) -> serde_json::Value {
    let obj = format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
    std::fs::write(dir.join("cart.obj"), obj).unwrap();
    let urdf = format!(
        "<robot name='slide'><link name='rail'/><link name='cart'><collision><geometry>\
         <mesh filename='cart.obj' scale='{scale} {scale} {scale}'/></geometry></collision></link>\
         <joint name='x' type='prismatic'><parent link='rail'/><child link='cart'/>\
         <limit lower='0' upper='1' velocity='1' effort='0'/></joint></robot>"
    );
    std::fs::write(dir.join("slide.urdf"), urdf).unwrap();
    elbowroom(dir, &["inspect", "slide.urdf", "--json"]).expect(0).json()
}

#[test]
fn wrong_units_are_reported_and_right_units_are_not() {
    let dir = tempfile::tempdir().unwrap();
    for (size, scale, looks_like) in [
        (300.0, 1.0, Some("mm")),
        (300.0, 0.001, None),
        (0.3, 1.0, None),
        (0.3, 0.001, Some("applied twice")),
        (3.0, 1.0, None),
        (0.02, 1.0, None),
    ] {
        let json = cart(dir.path(), size, scale);
        let doubts = json["suspect_units"].as_array().unwrap();
        assert_eq!(doubts.first().and_then(|d| d["looks_like"].as_str()), looks_like, "{size} {scale}");
        assert_eq!(doubts.len(), usize::from(looks_like.is_some()));
        assert_eq!(json["meshes"][0]["open_edges"], 3);
        if looks_like.is_some() {
            assert!(json["warnings"].to_string().contains(" look"), "{}", json["warnings"]);
        }
    }
}

/// A rotation matrix and an origin, as rows.
type Matrix = [[f64; 4]; 3];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let entry =
        |r: usize, c: usize| (0..3).map(|k| a[r][k] * b[k][c]).sum::<f64>() + if c == 3 { a[r][3] } else { 0.0 };
    std::array::from_fn(|r| std::array::from_fn(|c| entry(r, c)))
}

fn about_x(v: f64) -> Matrix {
    let (s, c) = v.sin_cos();
    [[1.0, 0.0, 0.0, 0.0], [0.0, c, -s, 0.0], [0.0, s, c, 0.0]]
}

fn about_z(v: f64) -> Matrix {
    let (s, c) = v.sin_cos();
    [[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]
}

fn along(x: f64, y: f64, z: f64) -> Matrix {
    [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]]
}

/// Multiplies the rows of one of the tables, with the factors in the order of the documents.
fn product(rows: &serde_json::Value, q: &dyn Fn(&str) -> (f64, bool), modified: bool) -> Matrix {
    let mut at = along(0.0, 0.0, 0.0);
    for row in rows.as_array().unwrap() {
        let number = |key: &str| row[key].as_f64();
        let (q, slides) = row["joint"].as_str().map_or((0.0, false), q);
        let theta = number("theta").unwrap() + if slides { 0.0 } else { q };
        let d = number("d").unwrap() + if slides { q } else { 0.0 };
        let (turn, slide) = (about_z(theta), along(0.0, 0.0, d));
        let (aside, twist) =
            (along(number("a").unwrap(), number("b").unwrap_or(0.0), 0.0), about_x(number("alpha").unwrap()));
        let factors = if modified { [twist, aside, turn, slide] } else { [turn, slide, aside, twist] };
        at = factors.iter().fold(at, |at, f| times(&at, f));
    }
    at
}

/// Makes an elbow over a rail, about an axis; the tip is beside its frame's x.
fn railed(axis: &str, aside: f64) -> String {
    format!(
        r#"<robot name="railed"><link name="hall"/><link name="cart"/><link name="arm"/><link name="hand"/>
  <joint name="x" type="prismatic"><parent link="hall"/><child link="cart"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="2" velocity="1" effort="0"/></joint>
  <joint name="turn" type="revolute"><parent link="cart"/><child link="arm"/><origin xyz="0.1 0.2 0.3" rpy="0.3 0 0"/>
    <axis xyz="{axis}"/><limit lower="-1" upper="1" velocity="1" effort="0"/></joint>
  <joint name="end" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0.5 {aside} 0.1"/></joint></robot>"#
    )
}

#[test]
fn every_table_multiplies_out_to_the_tip_and_classical_is_refused_with_b() {
    let dir = tempfile::tempdir().unwrap();
    for (name, axis, aside) in [("straight", "0 0 1", 0.0), ("aside", "0 0 1", 0.25), ("split", "1 0 0", 0.25)] {
        std::fs::write(dir.path().join(format!("{name}.urdf")), railed(axis, aside)).unwrap();
    }
    for (model, joints, tip, classical) in [
        (ns16().as_str(), "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6", "tool0", true),
        ("straight.urdf", "x,turn", "hand", true),
        // The transform to the tip takes two rows, and then no b.
        ("split.urdf", "x,turn", "hand", true),
        ("aside.urdf", "x,turn", "hand", false),
    ] {
        let q = [0.3, -0.7, 0.9, 0.4, -0.5, 0.6];
        let row: Vec<String> = joints.split(',').zip(q).map(|(_, v)| v.to_string()).collect();
        std::fs::write(dir.path().join("q.csv"), format!("{joints}\n{}\n", row.join(","))).unwrap();
        let poses = elbowroom(dir.path(), &["inspect", model, "--states", "q.csv"]).expect(0).stdout;
        let pose = poses.lines().find(|l| l.split(',').nth(1) == Some(tip)).unwrap();
        let n: Vec<f64> = pose.split(',').skip(2).map(|v| v.parse().unwrap()).collect();
        let right: Matrix = std::array::from_fn(|r| [n[3 * r], n[3 * r + 1], n[3 * r + 2], n[9 + r]]);
        let value = |name: &str| {
            let i = joints.split(',').position(|j| j == name).unwrap();
            (q[i], name == "x")
        };
        let json = elbowroom(dir.path(), &["inspect", model, "--brief", "--json"]).expect(0).json();
        let assert_right = |rows: &serde_json::Value, modified: bool| {
            let made = product(rows, &value, modified);
            let off = made.iter().flatten().zip(right.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{model}: {off}: {rows}");
        };
        assert_right(&json["dh"], false);
        assert_right(&json["dh_direct"]["rows"], false);
        assert_right(&json["dh_modified"]["rows"], true);
        let rows = &json["dh_classical"]["rows"];
        let why_not = json["dh_classical"]["why_not"].as_str();
        let text = elbowroom(dir.path(), &["inspect", model, "--brief", "--dh", "classical,modified,direct"]).expect(0);
        assert!(text.stdout.contains("Modified DH (Craig)") && text.stdout.contains("DH of each frame"));
        assert!(!text.stdout.contains("Generalized"), "only what was asked for: {}", text.stdout);
        if classical {
            assert_right(rows, false);
            assert_eq!((keys(&rows[0]), why_not), (vec!["a", "alpha", "d", "joint", "theta"], None));
            assert!(json["dh_classical"]["residual"].as_f64().unwrap() < 1e-9);
            assert!(text.stdout.contains("\nClassical DH to "), "{}", text.stdout);
        } else {
            assert_eq!(
                (rows.as_array().map(Vec::len), &json["dh_classical"]["residual"]),
                (Some(0), &serde_json::Value::Null)
            );
            let why_not = why_not.unwrap();
            assert!(why_not.contains("`turn`") && why_not.contains("b = 0.25"), "{why_not}");
            assert!(text.stdout.contains(&format!("No classical DH to hand: {why_not}")), "{}", text.stdout);
        }
    }
    let torch = examples().join("models/tools/torch.stl");
    let json = elbowroom(&examples(), &["inspect", torch.to_str().unwrap(), "--brief", "--json"]).expect(0).json();
    assert!(["dh_classical", "dh_modified", "dh_direct"].iter().all(|key| json[*key].is_null()), "{json}");
    let refused = elbowroom(dir.path(), &["inspect", "straight.urdf", "--dh", "craig"]).expect(2);
    assert!(refused.stderr.contains("modified"), "{}", refused.stderr);
}

/// Inspects the NS16 with all meshes scaled by `scale`; `edit` changes the text further.
fn scaled_ns16(dir: &std::path::Path, scale: f64, edit: impl Fn(String) -> String) -> common::Answer {
    let models = std::path::PathBuf::from(ns16());
    let folder = models.parent().unwrap().display().to_string();
    let text = std::fs::read_to_string(&models).unwrap();
    let text =
        text.replace("<mesh filename=\"", &format!("<mesh scale=\"{scale} {scale} {scale}\" filename=\"{folder}/"));
    std::fs::write(dir.join("scaled.urdf"), edit(text)).unwrap();
    elbowroom(dir, &["inspect", "scaled.urdf", "--brief", "--json"]).expect(0)
}

#[test]
fn text_and_json_name_the_same_unit() {
    let dir = tempfile::tempdir().unwrap();
    for (factor, looks_like, words) in [
        (1000.0, "mm", "look like mm, read as metres"),
        (100.0, "cm", "look like cm, read as metres"),
        (39.37, "in", "look like inches (in)"),
        (25.4, "in", "look like inches (in)"),
        (10.0, "mm", "look like mm, read as cm"),
        (0.1, "cm", "look like cm, read as mm"),
        (0.0254, "applied twice", "looks like inches (in) applied twice"),
        (0.001, "applied twice", "looks like mm applied twice"),
    ] {
        let json = scaled_ns16(dir.path(), factor, |text| text).json();
        let doubts = json["suspect_units"].as_array().unwrap();
        assert_eq!((doubts.len(), doubts[0]["looks_like"].as_str()), (1, Some(looks_like)), "{factor}: {doubts:?}");
        let said: Vec<&str> = json["warnings"].as_array().unwrap().iter().filter_map(|w| w.as_str()).collect();
        let about_units: Vec<_> = said.iter().filter(|w| w.contains("look")).collect();
        assert!(about_units.len() == 1 && about_units[0].contains(words), "{factor}: {said:?}");
    }
    let right = scaled_ns16(dir.path(), 1.0, |text| text).json();
    assert_eq!(right["suspect_units"], serde_json::json!([]));
}

#[test]
fn limits_in_degrees_are_reported() {
    let dir = tempfile::tempdir().unwrap();
    let degrees = |text: String| {
        let mut out = String::new();
        for (i, part) in text.split("<limit lower=\"").enumerate() {
            if i > 0 {
                out += "<limit lower=\"-170\" upper=\"170\" ";
                out += &part[part.find("velocity").unwrap()..];
            } else {
                out += part;
            }
        }
        out
    };
    let json = scaled_ns16(dir.path(), 1.0, degrees).json();
    assert_eq!(json["suspect_units"][0]["looks_like"], "deg", "{}", json["suspect_units"]);
    assert!(json["warnings"].to_string().contains("look like degrees (deg), read as radians"), "{}", json["warnings"]);
}

/// Makes a sphere as a file in single precision may have it: every triangle with corners of its own, slightly displaced.
fn seamed_ball() -> String {
    use std::f64::consts::{PI, TAU};
    use std::fmt::Write;
    let point = |i: u32, j: u32, hair: f64| {
        let (u, v) = (f64::from(i) / 12.0 * PI, f64::from(j % 24) / 24.0 * TAU);
        [u.sin() * v.cos() + hair, u.sin() * v.sin() - hair, u.cos() + hair]
    };
    let (mut obj, mut count) = (String::new(), 0_u32);
    for i in 0..12 {
        for j in 0..24 {
            for face in [[(i, j), (i + 1, j), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i, j + 1)]] {
                for (i, j) in face {
                    count += 1;
                    let [x, y, z] = point(i, j, f64::from(count % 7) * 1e-9);
                    writeln!(obj, "v {x} {y} {z}").unwrap();
                }
                writeln!(obj, "f {} {} {count}", count - 2, count - 1).unwrap();
            }
        }
    }
    obj
}

#[test]
fn hairline_seams_are_closed_said_and_simplified() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("ball.obj"), seamed_ball()).unwrap();
    std::fs::write(
        dir.path().join("ball.urdf"),
        "<robot name=\"ball\"><link name=\"ball\"><collision><geometry><mesh filename=\"ball.obj\"/></geometry></collision></link></robot>",
    )
    .unwrap();
    let json = elbowroom(dir.path(), &["inspect", "ball.urdf", "--json"]).expect(0).json();
    let mesh = &json["meshes"][0];
    assert_eq!((mesh["closed"].as_bool(), mesh["open_edges"].as_u64()), (Some(true), Some(0)), "{mesh}");
    assert!(mesh["welded_vertices"].as_u64() > Some(1000), "{mesh}");
    let tolerance = mesh["weld_tolerance_m"].as_f64().unwrap();
    assert!((1.9e-6..2.1e-6).contains(&tolerance), "a millionth of the extent: {tolerance}");
    let level = &json["resolution"][0];
    let count = |name: &str| level[name]["triangles"].as_u64().unwrap_or(0);
    assert!(count("middle") > 0 && count("middle") <= count("fine") / 3, "{level}");
    assert!(level["middle"]["deviation_m"].as_f64() < Some(0.1), "{level}");
    let text = elbowroom(dir.path(), &["inspect", "ball.urdf"]).expect(0).stdout;
    assert!(text.contains("vertices on seams within 2.0e-6 m of another count as one"), "{text}");
}

#[test]
fn the_levels_are_a_page_with_the_boxes_of_queries() {
    let dir = tempfile::tempdir().unwrap();
    let inspect = |args: &[&str]| {
        let model = ns16();
        let mut all = vec!["inspect", &model, "--brief"];
        all.extend(args);
        elbowroom(dir.path(), &all)
    };
    inspect(&["--picture", "levels.html", "--levels"]).expect(0);
    let page = std::fs::read_to_string(dir.path().join("levels.html")).unwrap();
    assert!(page.contains("<title>") && !page.contains("http://") && !page.contains("src="));
    let table = &page[page.find("<tbody").unwrap()..page.find("</tbody>").unwrap()];
    let rows: Vec<Vec<f64>> = table
        .split("<tr>")
        .skip(1)
        .map(|row| {
            let cells = row.split("class=\"number\">").skip(1);
            cells.map(|cell| cell[..cell.find('<').unwrap()].trim_end_matches(" mm").parse().unwrap_or(0.0)).collect()
        })
        .collect();
    assert_eq!(rows.len(), 11, "L1, L2, L2:1 to L2:8, L3: {table}");
    // The arm has seven links with meshes.
    assert_eq!((rows[0][0], rows[1][0], rows[2][0], rows[3][0]), (1.0, 7.0, 14.0, 28.0));
    assert!(rows.windows(2).take(9).all(|pair| pair[0][0] < pair[1][0]) && rows[9][0] <= 7.0 * 256.0, "{rows:?}");
    assert!(rows[0][1] > rows[1][1] && rows[1][1] > rows[9][1] && rows[9][1] > 0.0, "{rows:?}");
    let png = inspect(&["--picture", "levels.png", "--levels"]).expect(2);
    assert!(png.stderr.contains("write: --picture levels.html --levels"), "{}", png.stderr);
    assert!(inspect(&["--levels"]).expect(2).stderr.contains("--picture"));
    std::fs::write(dir.path().join("t.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let mesh = elbowroom(dir.path(), &["inspect", "t.obj", "--unit", "m", "--picture", "l.html", "--levels"]).expect(2);
    assert!(mesh.stderr.contains("is a mesh") && mesh.stderr.contains("write: a robot"), "{}", mesh.stderr);
    let bare = "<robot name='bare'><link name='base'/></robot>";
    std::fs::write(dir.path().join("bare.urdf"), bare).unwrap();
    let bare = elbowroom(dir.path(), &["inspect", "bare.urdf", "--picture", "l.html", "--levels"]).expect(2);
    assert!(bare.stderr.contains("no link with a bounded shape"), "{}", bare.stderr);
    assert!(!dir.path().join("l.html").exists());
}
