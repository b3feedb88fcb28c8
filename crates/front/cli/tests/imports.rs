//! Files from other programs: planning scenes, SRDFs, CAD files.

use std::path::Path;

use crate::common::{elbowroom, model};

const SCENE: &str = "shelf\n* board\n0.9 0 0.5\n0 0 0 1\n1\nbox\n0.6 0.4 0.1\n0 0 0\n0 0 0 1\n0 0 0 0\n0\n* wedge\n0 2 0\n0 0 0 1\n1\nmesh\n4 4\n\
0 0 0\n0.5 0 0\n0 0.5 0\n0 0 0.5\n0 2 1\n0 1 3\n1 2 3\n0 3 2\n0 0 0\n0 0 0 1\n0 0 0 0\n0\n* floor\n0 0 -0.01\n0 0 0 1\n1\nplane\n0 0 1 0\n\
0 0 0\n0 0 0 1\n0 0 0 0\n0\n.\n";

/// Makes a cell with a turning bar on a post, and the tables `more`.
fn cell(more: &str) -> String {
    format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[robot.bar]\n\
         dh = [{{ a = 700, d = 540, min = -170, max = 170, speed = 90 }}]\n\
         links = [{{ capsule = {{ from = [-600, 0, 0], to = [0, 0, 0], radius = 20 }} }}]\n\
         start = [90]\nstates = {{ left = [90], right = [-90] }}\n{more}"
    )
}

fn write(dir: &Path, name: &str, text: &str) {
    std::fs::write(dir.join(name), text).unwrap();
}

#[test]
fn every_verb_has_the_objects_of_a_scene() {
    let dir = tempfile::tempdir().unwrap();
    let here = dir.path();
    write(here, "shelf.scene", SCENE);
    let scene = "[scene.shelf]\nfile = \"shelf.scene\"\n";
    let program =
        "[program.bar]\nsteps = [{ move = \"joint\", to = [-90], speed = 100 }]\n[map.bar]\njoints = [\"joint_1\"]\n";
    write(here, "cell.toml", &cell(&format!("{scene}{program}")));
    let run = elbowroom(here, &["run", "cell.toml", "--json", "--out", "out"]).expect(1);
    assert!(run.stdout.contains("\"board\""), "{}", run.stdout);
    assert!(std::fs::read_to_string(here.join("out/report.html")).unwrap().contains("id=\"scene-data\""));
    write(here, "q.csv", "joint_1\n1.5707963267948966\n0\n");
    let query = ["query", "cell.toml", "--ask", "distance", "--between", "bar,board", "--states", "q.csv", "--json"];
    let json = elbowroom(here, &query).expect(0).json();
    let distance = |row: usize| json["rows"][row]["distance_m"].as_f64().unwrap();
    // At 90 degrees the axis of the bar is in the plane x = 0, at a height of the board, which begins at x = 0.6 m.
    assert!((distance(0) - 0.58).abs() < 1e-9 && distance(1) == 0.0, "{json}");
    let blocked = elbowroom(here, &["map", "cell.toml", "--json"]).expect(0).stdout;
    assert!(blocked.contains("\"board\"") && blocked.contains("\"floor\""), "{blocked}");
    let plan = ["plan", "cell.toml", "--robot", "bar", "--to", "right", "--json"];
    assert!(elbowroom(here, &plan).expect(1).stdout.contains("no path exists"));
    write(here, "cell.toml", &cell(&format!("{scene}at = [0, 0, 300]\n")));
    elbowroom(here, &plan).expect(0);
}

#[test]
fn a_scene_becomes_a_cell_file() {
    let dir = tempfile::tempdir().unwrap();
    let here = dir.path();
    write(here, "shelf.scene", SCENE);
    let wrote = elbowroom(here, &["convert", "shelf.scene", "shelf.toml"]).expect(0);
    assert!(wrote.stderr.contains("wrote shelf.toml: 3 objects, 1 mesh files"), "{}", wrote.stderr);
    assert!(here.join("shelf_meshes/1.stl").is_file());
    let tables = std::fs::read_to_string(here.join("shelf.toml")).unwrap();
    let tables = tables.split_once("\n[").unwrap().1;
    write(here, "direct.toml", &cell("[scene.all]\nfile = \"shelf.scene\"\n"));
    // The tables are in metres.
    let head = cell("")
        .replace("700", "0.7")
        .replace("540", "0.54")
        .replace("-600", "-0.6")
        .replace("20 }", "0.02 }")
        .replace("\"mm\"", "\"m\"");
    write(here, "tables.toml", &format!("{head}\n[{tables}"));
    write(here, "q.csv", "joint_1\n1.5\n0.8\n0.5\n-2\n");
    let rows = |cell: &str| {
        let call = ["query", cell, "--ask", "distance", "--no-self", "--states", "q.csv", "--json"];
        let json = elbowroom(here, &call).expect(0).json();
        let of = |r: &serde_json::Value| (r["distance_m"].as_f64().unwrap(), r["pair"].to_string());
        json["rows"].as_array().unwrap().iter().map(of).collect::<Vec<_>>()
    };
    for (a, b) in rows("direct.toml").iter().zip(rows("tables.toml")) {
        assert!((a.0 - b.0).abs() < 1e-6 && a.1 == b.1, "{a:?} {b:?}");
    }
    let yaml = "world:\n  collision_objects:\n    - {id: can, header: {frame_id: base_link}, primitives: [{type: 2, dimensions: [1]}], primitive_poses: [{}]}\n";
    write(here, "can.yaml", yaml);
    let wrote = elbowroom(here, &["convert", "can.yaml", "can.toml"]).expect(0);
    assert!(wrote.stderr.contains("the frame `base_link` of the scene is the world of the cell"), "{}", wrote.stderr);
    let allowed = "allowed_collision_matrix: {entry_names: [can, hand], entry_values: [[true, true], [true, true]], default_entry_names: [can], default_entry_values: [true]}\n";
    let two_cans = yaml.replace("collision_objects:\n", "collision_objects:\n    - {id: lid, header: {frame_id: base_link}, primitives: [{type: 2, dimensions: [1]}], primitive_poses: [{}]}\n");
    write(here, "cans.yaml", &format!("{two_cans}{allowed}"));
    let wrote = elbowroom(here, &["convert", "cans.yaml", "cans.toml"]).expect(0);
    assert!(wrote.stderr.contains("wrote cans_pairs.toml: the pairs that the scene lets touch"), "{}", wrote.stderr);
    assert!(!wrote.stderr.contains("allowed_collision"), "{}", wrote.stderr);
    let pairs = std::fs::read_to_string(here.join("cans_pairs.toml")).unwrap();
    // Objects as rows, links as comments.
    assert!(
        pairs.contains("  { a = \"can\", b = \"lid\", state = \"skipped\", reason = \"allowed in cans.yaml\" },"),
        "{pairs}"
    );
    assert!(pairs.contains("# { a = \"can\", b = \"ROBOT/hand\""), "{pairs}");
    let written = std::fs::read_to_string(here.join("cans.toml")).unwrap();
    assert!(written.contains("\npairs = \"cans_pairs.toml\"\n"), "{written}");
    let refused = elbowroom(here, &["convert", "cans.yaml", "cans2.toml"]).expect(0);
    assert!(refused.stderr.contains("cans2_pairs.toml"), "{}", refused.stderr);
    std::fs::remove_file(here.join("cans2.toml")).unwrap();
    let again = elbowroom(here, &["convert", "cans.yaml", "cans2.toml"]);
    assert!(again.expect(2).stderr.contains("cans2_pairs.toml: is there already"), "pairs are not overwritten");
    let other =
        "    - {id: cup, header: {frame_id: odom}, primitives: [{type: 2, dimensions: [1]}], primitive_poses: [{}]}\n";
    write(here, "two.yaml", &format!("{yaml}{other}"));
    let cases: &[(&[&str], &str, &str)] = &[
        (&["convert", "shelf.scene", "shelf.toml"], "shelf.toml: is there already", "the name of a new file"),
        (&["convert", "shelf.scene", "--out", "x"], "shelf.scene cannot become x", "convert SCENE cell.toml"),
        (&["convert", "shelf.scene", "x.srdf"], "shelf.scene cannot become x.srdf", "convert SCENE cell.toml"),
        (
            &["convert", "shelf.scene", "x.toml", "--unit", "mm"],
            "--unit, --joints and --joint go with a robot",
            "convert SCENE",
        ),
        (&["convert", "two.yaml", "x.toml"], "frames `base_link` and `odom`", "fixed_frame_transforms"),
        (&["convert", "none.scene", "x.toml"], "none.scene: cannot be read", ""),
        (&["convert", "shelf.toml", "x.toml"], "shelf.toml cannot become x.toml", "convert MODEL arm.srdf"),
    ];
    for (call, what, hint) in cases {
        let refused = elbowroom(here, call).expect(2).stderr;
        assert!(refused.contains(what) && refused.contains(hint), "{call:?}: {refused}");
        assert!(!here.join("x.toml").exists() && !here.join("x.srdf").exists());
    }
}

#[test]
fn an_srdf_is_written_from_models_and_cells_and_read_again() {
    let dir = tempfile::tempdir().unwrap();
    let here = dir.path();
    write(here, "cell.toml", &cell(""));
    elbowroom(here, &["convert", "cell.toml", "bar.srdf"]).expect(0);
    let text = std::fs::read_to_string(here.join("bar.srdf")).unwrap();
    assert!(text.contains("<chain base_link=\"base\" tip_link=\"link_1\"/>"), "{text}");
    assert!(text.contains("<group_state name=\"right\" group=\"manipulator\">"), "{text}");
    // The states of the SRDF are states of the cell.
    let states = "states = { left = [90], right = [-90] }\n";
    write(here, "again.toml", &cell("srdf = \"bar.srdf\"\n").replace(states, ""));
    elbowroom(here, &["plan", "again.toml", "--to", "right"]).expect(0);
    let arm = model("kr125");
    let arm = arm.to_str().unwrap();
    elbowroom(here, &["convert", arm, "first.srdf"]).expect(0);
    let first = std::fs::read_to_string(here.join("first.srdf")).unwrap();
    let state = "  <group_state name=\"home\" group=\"manipulator\">\n    <joint name=\"joint_1\" value=\"0.25\"/>\n  </group_state>\n";
    write(
        here,
        "first.srdf",
        &first.replace(
            "</robot>",
            &format!("{state}<end_effector name=\"t\" group=\"manipulator\" parent_link=\"tool0\"/></robot>"),
        ),
    );
    elbowroom(here, &["convert", arm, "second.srdf", "--srdf", "first.srdf"]).expect(0);
    elbowroom(here, &["inspect", arm, "--srdf", "first.srdf", "--write-srdf", "third.srdf"]).expect(0);
    let [second, third] = ["second.srdf", "third.srdf"].map(|f| std::fs::read_to_string(here.join(f)).unwrap());
    assert_eq!(second, third, "one writer");
    assert!(
        second.contains(state)
            && second.contains("<end_effector name=\"t\" parent_link=\"tool0\" group=\"manipulator\"/>"),
        "{second}"
    );
    let pairs = |text: &str| text.matches("<disable_collisions").count();
    assert!(pairs(&first) > 0 && pairs(&first) == pairs(&second), "{first}\n{second}");
    let cases: &[(&[&str], &str, &str)] = &[
        (&["convert", arm, "first.srdf"], "first.srdf: is there already", "the name of a new file"),
        (&["convert", arm, "x.stl"], "cannot become x.stl", "convert MODEL --out DIR"),
        (&["convert", "cell.toml", "x.srdf", "--srdf", "first.srdf"], "go with a model", "the cell file says"),
        (&["convert", "cell.toml", "x.srdf", "--robot", "bra"], "which robot?", "--robot with one of bar"),
        (&["convert", arm, "x.srdf", "--out", "y"], "cannot be used with", "--out"),
        (&["convert", arm], "required arguments were not provided", "OUTPUT"),
    ];
    for (call, what, hint) in cases {
        let refused = elbowroom(here, call).expect(2).stderr;
        assert!(refused.contains(what) && refused.contains(hint), "{call:?}: {refused}");
        assert!(!here.join("x.srdf").exists());
    }
}
