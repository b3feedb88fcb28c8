//! Robots from 3DS and VRML models at the command line: convert, inspect, query.

use crate::common;
use crate::common::{elbowroom, model, with_cell};
use ::elbowroom::formats::robot::{self, LoadOptions};
use ::elbowroom::formats::tds;

fn ns16() -> String {
    model("ns16").to_str().unwrap().to_owned()
}

#[test]
fn a_urdf_becomes_3ds_and_a_urdf_again_with_the_same_joints_poses_and_distances() {
    let dir = tempfile::tempdir().unwrap();
    let here = dir.path();
    let wrote = elbowroom(here, &["convert", &ns16(), "--out", "out", "--to", "3ds"]).expect(0);
    assert!(wrote.stderr.contains("ns16.3ds"), "{}", wrote.stderr);
    assert!(here.join("out/ns16.joints.toml").is_file());
    elbowroom(here, &["convert", "out/ns16.3ds", "--out", "back", "--to", "urdf,3ds"]).expect(0);
    let inspect = |model: &str| elbowroom(here, &["inspect", model, "--brief", "--json"]).expect(0).json();
    let (urdf, tds, back) = (inspect(&ns16()), inspect("out/ns16.3ds"), inspect("back/ns16.urdf"));
    for json in [&tds, &back] {
        assert_eq!(urdf["links"].as_array().map(Vec::len), json["links"].as_array().map(Vec::len));
        assert_eq!(urdf["dof"], json["dof"]);
        let of = |j: &serde_json::Value| -> Vec<String> {
            let rows = j["dh"].as_array().unwrap().iter();
            rows.filter_map(|r| r["joint"].as_str().map(str::to_owned)).collect()
        };
        assert_eq!(of(&urdf), of(json));
        assert!(json["dh_residual"].as_f64().unwrap() < 1e-9);
        let triangles = |j: &serde_json::Value| -> u64 {
            j["meshes"].as_array().unwrap().iter().filter_map(|m| m["triangles"].as_u64()).sum()
        };
        assert_eq!(triangles(&urdf), triangles(json));
    }
    let states =
        "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0.3,-0.2,0.5,0.4,-0.3,0.2\n-1,0.4,0.9,-0.4,0.7,1.2\n";
    std::fs::write(here.join("q.csv"), states).unwrap();
    let distances = |model: &str| -> Vec<f64> {
        let call = ["query", "--urdf", model, "--ask", "distance", "--states", "q.csv", "--json"];
        let json = elbowroom(here, &call).expect(0).json();
        json["rows"].as_array().unwrap().iter().map(|r| r["distance_m"].as_f64().unwrap()).collect()
    };
    let (a, b) = (distances(&ns16()), distances("out/ns16.3ds"));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-5), "{a:?} {b:?}");
}

#[test]
fn a_model_without_joints_is_inspected_and_options_add_joints() {
    let dir = tempfile::tempdir().unwrap();
    let here = dir.path();
    let urdf = robot::load(ns16().as_ref(), &LoadOptions::default()).unwrap();
    let mut tree = robot::to_tree(&urdf.robot);
    tree.nodes.iter_mut().for_each(|n| n.track.clear());
    std::fs::write(here.join("still.3ds"), tds::write(&tree, "still.3ds".as_ref()).unwrap()).unwrap();
    let json = elbowroom(here, &["inspect", "still.3ds", "--brief", "--json"]).expect(0).json();
    assert_eq!(json["dof"], 0);
    assert_eq!(json["meshes"].as_array().map(Vec::len), Some(7));
    let warnings = json["warnings"].to_string();
    assert!(warnings.contains("no joint moves") && warnings.contains("[joint.link_1]"), "{warnings}");
    let moved = ["inspect", "still.3ds", "--brief", "--json", "--joint", "link_1: axis=z, min=-90, max=90, speed=100"];
    let json = elbowroom(here, &moved).expect(0).json();
    assert_eq!(json["dof"], 1);
    let unknown = ["inspect", "still.3ds", "--brief", "--joint", "Link_1: axis=z"];
    let error = elbowroom(here, &unknown).expect(2).stderr;
    assert!(error.contains("there is no node `Link_1`") && error.contains("link_1"), "{error}");
}

#[test]
fn a_cell_runs_with_the_3ds_model_as_with_the_urdf() {
    let dir = tempfile::tempdir().unwrap();
    let here = dir.path();
    elbowroom(here, &["convert", &ns16(), "--out", "out", "--to", "3ds"]).expect(0);
    let run = |model: &str| {
        let cell = format!(
            "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[robot.arm]\nmodel = \"{model}\"\n\
             start = [0, 0, 30, 0, 20, 0]\n[program.arm]\n\
             steps = [{{ move = \"joint\", to = [40, 10, 30, 0, 20, 0], speed = 50 }}]\n"
        );
        std::fs::write(here.join("cell.toml"), cell).unwrap();
        elbowroom(here, &["run", "cell.toml", "--json"]).expect(0).json()
    };
    let (tds, urdf) = (run("out/ns16.3ds"), run(&ns16()));
    assert_eq!(tds["robots"][0]["finished"], true);
    assert_eq!((&tds["duration_s"], &tds["ticks"]), (&urdf["duration_s"], &urdf["ticks"]));
}

#[test]
fn pictures_show_axes_and_the_page_names_them() {
    let dir = tempfile::tempdir().unwrap();
    elbowroom(dir.path(), &["inspect", &ns16(), "--brief", "--picture", "a.html"]).expect(0);
    let page = std::fs::read_to_string(dir.path().join("a.html")).unwrap();
    assert!(page.contains("joint_3 (revolute) moves link_3"), "{}", &page[page.len().saturating_sub(3000)..]);
}

#[test]
fn the_robot_of_a_cell_is_converted_and_errors_are_reported() {
    let dir = common::swing();
    let here = dir.path();
    elbowroom(here, &["convert", "cell.toml", "--out", "out"]).expect(0);
    let json = elbowroom(here, &["inspect", "out/arm.urdf", "--brief", "--json"]).expect(0).json();
    assert_eq!(json["dof"], 2);
    for (call, said) in [
        (vec!["convert", "cell.toml", "--out", "out", "--robot", "absent"], "--robot with one of arm"),
        (vec!["convert", "cell.toml", "--out", "out", "--unit", "mm"], "go with a model"),
        (vec!["convert", "out/arm.urdf", "--out", "out"], "is there already, beside the model"),
        (vec!["convert", "out/arm.urdf", "--out", "x", "--robot", "arm"], "goes with a cell file"),
        (vec!["convert", "out/arm.urdf", "--out", "x", "--joint", "a: axis=z"], "its own joints"),
        (vec!["query", "cell.toml", "--ask", "collision", "--joint", "a: axis=z"], "--urdf MODEL"),
        (vec!["convert", "nothing.3ds", "--out", "x"], "cannot be read"),
    ] {
        let error = elbowroom(here, &call).expect(2).stderr;
        assert!(error.contains(said), "{call:?}: {error}");
    }
    let two =
        with_cell(&common::SWING.replace(
            "[region.post]",
            "[robot.other]\ndh = [{ a = 400 }]\nbase = { at = [3000, 0, 0] }\n\n[region.post]",
        ));
    let error = elbowroom(two.path(), &["convert", "cell.toml", "--out", "out"]).expect(2).stderr;
    assert!(error.contains("which robot") && error.contains("arm, other"), "{error}");
}

/// A post with an arm that turns about y, as VRML and as the same URDF.
const VRML_ARM: &str = "#VRML V2.0 utf8
DEF post Transform { children [
  Shape { geometry Box { size 0.2 0.4 0.2 } }
  DEF arm Transform { translation 0 0.3 0 children Transform { translation 0.4 0 0 scale 0.001 0.001 0.001 children
    Shape { geometry Box { size 800 100 100 } } } }
  DEF wall Transform { translation 0 0.3 0.8 children Shape { geometry Box { size 0.1 0.1 0.1 } } }
] }
";
const URDF_ARM: &str = r#"<robot name="arm">
<link name="post"><collision><geometry><box size="0.2 0.4 0.2"/></geometry></collision></link>
<link name="arm"><collision><origin xyz="0.4 0 0"/><geometry><mesh filename="bar.wrl" scale="1 1 1"/></geometry></collision></link>
<link name="wall"><collision><geometry><mesh filename="cube.wrl"/></geometry></collision></link>
<joint name="arm" type="revolute"><parent link="post"/><child link="arm"/><origin xyz="0 0.3 0"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="wall" type="fixed"><parent link="post"/><child link="wall"/><origin xyz="0 0.3 0.8"/></joint></robot>"#;

#[test]
fn vrml_is_read_wherever_a_robot_or_a_mesh_is() {
    let dir = tempfile::tempdir().unwrap();
    let here = dir.path();
    let write = |name: &str, text: &str| std::fs::write(here.join(name), text).unwrap();
    let cuboid = |size: &str| format!("#VRML V2.0 utf8\nShape {{ geometry Box {{ size {size} }} }}\n");
    write("arm.wrl", VRML_ARM);
    write(
        "arm.joints.toml",
        "units = { length = \"m\", angle = \"rad\" }\n[joint.arm]\naxis = \"y\"\nmin = -3\nmax = 3\nspeed = 1\n",
    );
    write("arm.urdf", URDF_ARM);
    write("bar.wrl", &cuboid("0.8 0.1 0.1"));
    write("cube.wrl", &cuboid("0.1 0.1 0.1"));
    write("q.csv", "arm\n0\n-0.7\n-1.4\n1.2\n");
    let json = |call: &[&str]| elbowroom(here, call).expect(0).json();
    let inspected = json(&["inspect", "arm.wrl", "--json"]);
    assert_eq!((&inspected["dof"], inspected["links"].as_array().map(Vec::len)), (&1.into(), Some(4)), "{inspected}");
    let distances = |model: &str| -> Vec<f64> {
        let rows = json(&["query", "--urdf", model, "--ask", "distance", "--states", "q.csv", "--json"]);
        rows["rows"].as_array().unwrap().iter().map(|r| r["distance_m"].as_f64().unwrap()).collect()
    };
    let (vrml, urdf) = (distances("arm.wrl"), distances("arm.urdf"));
    assert!(vrml.len() == 4 && vrml.iter().zip(&urdf).all(|(a, b)| (a - b).abs() < 1e-7), "{vrml:?} {urdf:?}");
    let error = elbowroom(here, &["query", "arm.wrl", "--ask", "collision"]).expect(2).stderr;
    assert!(error.contains("--urdf arm.wrl"), "{error}");
    elbowroom(here, &["convert", "arm.wrl", "--out", "out"]).expect(0);
    assert_eq!(json(&["inspect", "out/arm.urdf", "--brief", "--json"])["dof"], 1);
    let cell = |object: &str| {
        format!(
            "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\n[robot.arm]\nmodel = \"arm.wrl\"\n\
             [object.cube]\nshape = \"mesh\"\nmesh = \"{object}\"\nat = [0, 0.3, -0.6]\n"
        )
    };
    write("cell.toml", &cell("cube.wrl"));
    write("at.csv", "arm.arm\n0\n1.5707963\n");
    let call = ["query", "cell.toml", "--ask", "collision", "--states", "at.csv", "--json"];
    let found = elbowroom(here, &call).expect(1).json();
    let hits: Vec<u64> = found["rows"].as_array().unwrap().iter().filter_map(|r| r["collides"].as_u64()).collect();
    assert_eq!(hits, [0, 1], "{found}");
    write("old.wrl", "#VRML V1.0 ascii\nSeparator { }\n");
    write("cell.toml", &cell("old.wrl"));
    for call in [&["query", "cell.toml", "--ask", "collision"][..], &["inspect", "old.wrl"]] {
        let error = elbowroom(here, call).expect(2).stderr;
        assert!(error.contains("old.wrl:1: is VRML 1.0") && error.contains("VRML 2 (VRML97)"), "{error}");
    }
}
