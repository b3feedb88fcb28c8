//! `elbowroom fixture`: shields of virtual fixtures, from the cell file to the mesh.

use std::path::Path;

use elbowroom::proximity::TriMesh;
use elbowroom::spatial::Vec3;

use crate::common::elbowroom;

const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ a = 300, speed = 90 }]
[robot.arm.tool]
tcp = { at = [0, 0, 60] }
box = { at = [0, 0, 30], size = [6, 6, 60] }
[object.block]
shape = "box"
size = [60, 50, 50]
at = [500, 0, 100]
rpy = [0, 0, 30]
[fixture.hole]
protects = "block"
target = { drill = { at = [500, 0, 125], axis = [0, 0, -1], depth = 10 } }
width = 14
offset = 4
tolerance = 1.5
tool = "arm"
"#;

fn write(dir: &Path, text: &str) {
    std::fs::write(dir.join("cell.toml"), text).unwrap();
}

#[test]
fn a_shield_is_written_in_the_world_and_its_tool_reaches_the_ground() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), CELL);
    let args = ["fixture", "cell.toml", "--json", "--name", "hole", "--out", "shield.stl"];
    let answer = elbowroom(dir.path(), &args).expect(0).json();
    assert_eq!((&answer["reachable"], &answer["closed"]), (&true.into(), &true.into()), "{answer}");
    let number = |key: &str| answer[key].as_f64().unwrap();
    assert!((number("narrowest_m") - 0.014).abs() < 0.0015, "{answer}");
    assert!((number("tool_width_m") - 0.006 * 2.0_f64.sqrt()).abs() < 1e-6, "{answer}");
    let shield = elbowroom::formats::mesh::load(&dir.path().join("shield.stl"), None).unwrap().meshes.remove(0);
    assert_eq!(shield.triangles.len(), answer["triangles"].as_u64().unwrap() as usize);
    let shield = TriMesh::new(shield.vertices, shield.triangles).unwrap();
    // Above the hole and in it is outside of the shield, beside it and in the block inside.
    for (x, y, z, inside) in
        [(0.5, 0.0, 0.127, false), (0.5, 0.0, 0.118, false), (0.52, 0.0, 0.127, true), (0.5, 0.0, 0.105, true)]
    {
        assert_eq!(shield.contains(Vec3::new(x, y, z)), inside, "({x}, {y}, {z})");
    }
}

#[test]
fn a_tool_that_is_too_wide_is_a_negative_answer_with_the_place() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), &CELL.replace("width = 14", "width = 6"));
    let answer = elbowroom(dir.path(), &["fixture", "cell.toml", "--json"]).expect(1).json();
    assert_eq!(answer["reachable"], false, "{answer}");
    let text = elbowroom(dir.path(), &["fixture", "cell.toml"]).expect(1).stdout;
    assert!(text.contains("does not reach the target at [500 mm, 0 mm, 125 mm]"), "{text}");
}

#[test]
fn targets_and_keys_that_are_wrong_are_refused_with_line_and_place() {
    let dir = tempfile::tempdir().unwrap();
    for (old, new, expected) in [
        (
            "at = [500, 0, 125], axis",
            "at = [500, 0, 131], axis",
            &["is 6 mm off the surface", "`tolerance` allows 1.5 mm"][..],
        ),
        ("protects = \"block\"", "protects = \"blok\"", &["cell.toml:15", "\"blok\"", "block"]),
        ("depth = 10 }", "depth = 10 }, line = [[0, 0, 0], [1, 0, 0]]", &["cell.toml:16", "has 2 of line"]),
        ("tool = \"arm\"", "tool = \"arm/saw\"", &["cell.toml:20", "\"saw\"", "tool"]),
        ("width = 14", "wide = 14", &["cell.toml:17", "wide", "width"]),
        ("axis = [0, 0, -1]", "axis = [0, 0, 0]", &["cell.toml:16", "has no length"]),
        (
            "shape = \"box\"\nsize = [60, 50, 50]\nat = [500, 0, 100]\nrpy = [0, 0, 30]",
            "shape = \"plane\"\n\n\n",
            &["cell.toml:15", "is a plane"],
        ),
    ] {
        assert!(CELL.contains(old), "{old}");
        write(dir.path(), &CELL.replacen(old, new, 1));
        let text = elbowroom(dir.path(), &["fixture", "cell.toml"]).expect(2).stderr;
        for word in expected {
            assert!(text.contains(word), "{new}: {word} is not in {text}");
        }
    }
    write(dir.path(), CELL);
    let text = elbowroom(dir.path(), &["fixture", "cell.toml", "--name", "cut"]).expect(2).stderr;
    assert!(text.contains("has no fixture \"cut\"") && text.contains("--name with one of hole"), "{text}");
}

#[test]
fn a_shield_that_was_written_is_read_again_and_a_broken_one_refused() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), CELL);
    let made = elbowroom(dir.path(), &["fixture", "cell.toml", "--json", "--out", "shield.stl"]).expect(0).json();
    let read = |keys: &str| {
        let at = CELL.find("target").unwrap();
        format!("{}{keys}\ntool = \"arm\"\n", &CELL[..at])
    };
    write(dir.path(), &read("mesh = \"shield.stl\""));
    let answer = elbowroom(dir.path(), &["fixture", "cell.toml", "--json", "--out", "again.stl"]).expect(0).json();
    assert_eq!(answer["triangles"], made["triangles"]);
    assert!(answer["closed"] == true && answer["reachable"].is_null() && answer["tolerance_m"].is_null(), "{answer}");
    let load = |name: &str| elbowroom::formats::mesh::load(&dir.path().join(name), None).unwrap().meshes.remove(0);
    let (first, second) = (load("shield.stl"), load("again.stl"));
    let farthest = first.vertices.iter().zip(&second.vertices).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(farthest < 1e-6, "{farthest} m");
    let text = elbowroom(dir.path(), &["fixture", "cell.toml"]).expect(0).stdout;
    assert!(text.contains("what it leaves open is not examined"), "{text}");
    let facet = |corner: &str| {
        format!("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex {corner}\nvertex 0 0 1\nendloop\nendfacet\n")
    };
    let open = format!("solid open\n{}{}endsolid open\n", facet("1 0 0"), facet("0 1 0"));
    std::fs::write(dir.path().join("open.stl"), open).unwrap();
    // In the wrong unit the shield lies elsewhere: the tool would keep off it in place of the object.
    for (keys, expected) in [
        ("mesh = \"shield.stl\"\nmesh_unit = \"mm\"", "of 8 corners of \"block\" in it"),
        ("mesh = \"open.stl\"", "the protected mesh is open"),
        ("mesh = \"shield.stl\"\nwidth = 3", "either `mesh` or `target`"),
        (
            "mesh_unit = \"mm\"\ntarget = { faces_within = { at = [500, 0, 125], radius = 9 } }\nwidth = 9",
            "no `mesh_unit`",
        ),
        ("guide = \"line\"\npoints = [[0, 0, 0], [9, 0, 0]]", "`protects`"),
    ] {
        write(dir.path(), &read(keys));
        let text = elbowroom(dir.path(), &["fixture", "cell.toml"]).expect(2).stderr;
        assert!(text.contains(expected), "{expected}: {text}");
    }
}
