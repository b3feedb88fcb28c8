//! `[scene.NAME]`: the objects of MoveIt's planning scenes in a cell.

use std::path::Path;

use crate::common::{HEAD, rail};
use elbowroom_cell::{Cell, QueryModel, object_tables};
use elbowroom_formats::{Diagnostic, stl};
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_spatial::{Pose, Vec3};

const SCENE: &str = "shelf\n* board\n1 0 0.5\n0 0 0 1\n2\nbox\n0.6 0.4 0.1\n0 0 0\n0 0 0 1\n0 0 0 0\ncylinder\n0.05 0.8\n0.1 0 0\n\
0 0 0.6 0.8\n0 0 0 0\n0\n* a/b\n0 0 2\n0 0 0 1\n1\nmesh\n4 4\n0 0 0\n0.5 0 0\n0 0.5 0\n0 0 0.5\n0 2 1\n0 1 3\n1 2 3\n0 3 2\n0 0 0\n0 0 0 1\n\
0 0 0 0\n0\n* ground\n0 0 -2\n0 0 0 1\n1\nplane\n0 0 1 0\n0 0 0\n0 0 0 1\n0 0 0 0\n0\n.\n";
const YAML: &str = "fixed_frame_transforms:\n  - child_frame_id: desk\n    header: {frame_id: link_1}\n\
\x20   transform: {translation: [0, 0, 0.5], rotation: [0, 0, 0, 1]}\nworld:\n  collision_objects:\n    - id: can\n\
\x20     header: {frame_id: desk}\n      primitives: [{type: sphere, dimensions: [0.1]}]\n      primitive_poses: [{position: [1, 0, 0]}]\n";

fn parse(dir: &Path, tables: &str) -> Result<Cell, Diagnostic> {
    Cell::parse(dir.join("cell.toml"), &format!("{HEAD}{}{tables}", rail("r", 0.0)))
}

fn with_files() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("shelf.scene"), SCENE).unwrap();
    std::fs::write(dir.path().join("desk.yaml"), YAML).unwrap();
    dir
}

#[test]
fn a_scene_is_placed_and_its_objects_belong_to_the_cell() {
    let dir = with_files();
    let own = "[object.own]\nshape = \"sphere\"\nat = [0, 0, 3000]\nradius = 30\n";
    let cell = parse(
        dir.path(),
        &format!("{own}[scene.shelf]\nfile = \"shelf.scene\"\nat = [0, 1000, 0]\nrpy = [0, 0, 90]\n"),
    )
    .unwrap();
    let names: Vec<&str> = cell.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["own", "board:1", "board:2", "a_b", "ground"]);
    let at = |i: usize| cell.objects[i].in_world.translation;
    assert!((at(1) - Vec3::new(0.0, 2.0, 0.5)).length() < 1e-12 && (at(2) - Vec3::new(0.0, 2.1, 0.5)).length() < 1e-12);
    let (Shape::HalfSpace(_), z) = (&cell.objects[4].shape, at(4).z) else { panic!("a plane") };
    assert_eq!(z, -2.0);
    assert_eq!(QueryModel::of_cell(&cell).objects.len(), 5);
}

#[test]
fn frames_are_links_at_the_start_fixed_frames_and_the_frame_that_is_named() {
    let dir = with_files();
    let can = |tables: &str| parse(dir.path(), tables).unwrap().objects[0].in_world.translation;
    // The carriage of the rail is 0.5 m along world x at the start, and its z is world x.
    let at_link = can("start = [500]\n[scene.desk]\nfile = \"desk.yaml\"\n");
    assert!((at_link - Vec3::new(1.0, 0.0, -1.0)).length() < 1e-9, "{at_link:?}");
    let named = can("[scene.desk]\nfile = \"desk.yaml\"\nframe = \"desk\"\nat = [0, 0, 2000]\n");
    assert!((named - Vec3::new(1.0, 0.0, 2.0)).length() < 1e-12, "{named:?}");
}

#[test]
fn objects_are_written_as_tables_and_read_again() {
    let dir = with_files();
    let first =
        parse(dir.path(), "[scene.shelf]\nfile = \"shelf.scene\"\nat = [10.1, 1000, 0.7]\nrpy = [10, 20, 90]\n")
            .unwrap();
    let tables = object_tables(&first.objects, "meshes");
    std::fs::create_dir(dir.path().join("meshes")).unwrap();
    for (name, mesh) in &tables.meshes {
        let mut bytes = Vec::new();
        stl::write_binary(&mut bytes, std::slice::from_ref(mesh)).unwrap();
        std::fs::write(dir.path().join(name), bytes).unwrap();
    }
    let second = Cell::parse(dir.path().join("written.toml"), &tables.toml).unwrap();
    assert_eq!((tables.meshes.len(), second.objects.len()), (1, first.objects.len()));
    for (a, b) in first.objects.iter().zip(&second.objects) {
        assert_eq!((&a.name, a.shape.kind()), (&b.name, b.shape.kind()));
        let size = |shape: &Shape| shape.aabb(&Pose::IDENTITY).extent();
        if !matches!(a.shape, Shape::HalfSpace(_)) {
            assert!((size(&a.shape) - size(&b.shape)).length() < 1e-6, "{}", a.name);
        }
        assert!((a.in_world.translation - b.in_world.translation).length() < 1e-12, "{}", a.name);
        assert!((a.in_world.rotation.inverse() * b.in_world.rotation).angle() < 1e-7, "{}", a.name);
    }
}

#[test]
fn what_a_cell_does_not_take_is_said() {
    let dir = with_files();
    let matrix = "allowed_collision_matrix:\n  entry_names: [base, link_1, can]\n  entry_values: [[true, true, true], [true, true, false], [true, false, true]]\n\
                  robot_state: {joint_state: {name: [joint_1], position: [0.5]}}\n";
    std::fs::write(dir.path().join("desk.yaml"), format!("{YAML}{matrix}")).unwrap();
    let cell = parse(dir.path(), "[scene.desk]\nfile = \"desk.yaml\"\n").unwrap();
    let warnings: Vec<String> = cell.warnings.iter().map(ToString::to_string).collect();
    // `base` and `link_1` are adjacent and not tested anyway.
    let expected = "is applied: 1 of its pairs are not tested, such as `base` and `can`";
    assert!(warnings.iter().any(|w| w.contains(expected)), "{warnings:?}");
    assert!(
        warnings.iter().any(|w| w.contains("`robot_state` is not applied") && w.contains("start = [")),
        "{warnings:?}"
    );
    let far = parse(dir.path(), "[scene.shelf]\nfile = \"shelf.scene\"\nat = [9e7, 0, 0]\n").unwrap();
    let far: Vec<_> = far.warnings.iter().filter(|w| w.message.contains("object \"board:1\"")).collect();
    assert_eq!((far.len(), far[0].line), (1, Some(8)), "at the table of the scene, of its first object: {far:?}");
}

/// The reason why the object `can` and another geometry are not tested.
fn skipped(cell: &Cell, other: GeometryId) -> Option<&str> {
    let can = cell.objects.iter().position(|o| o.name.starts_with("can")).unwrap();
    cell.pair_rules.given.skipped(GeometryId::Object(ObjectId(can)), other)
}

#[test]
fn pairs_that_a_scene_allows_are_not_tested() {
    let dir = with_files();
    let matrix = "allowed_collision_matrix:\n  entry_names: [base, link_1, can]\n  entry_values: [[true, true, true], [true, true, false], [true, false, true]]\n";
    std::fs::write(dir.path().join("desk.yaml"), format!("{YAML}{matrix}")).unwrap();
    let scene = "[scene.desk]\nfile = \"desk.yaml\"\n";
    let cell = parse(dir.path(), scene).unwrap();
    let link =
        |robot, link| GeometryId::Link { robot: RobotId(robot), link: cell.robots[0].robot.chain.link(link).unwrap() };
    assert_eq!(skipped(&cell, link(0, "base")), Some("allowed in desk.yaml"));
    assert_eq!(skipped(&cell, link(0, "link_1")), None);
    // The pair is tested if the cell says so, in the table or in the file of pairs.
    let cell_2 = parse(dir.path(), &format!("{scene}allowed_collisions = false\n")).unwrap();
    assert!(
        cell_2.pair_rules.given.is_empty() && !cell_2.warnings.iter().any(|w| w.message.contains("allowed_collision"))
    );
    std::fs::write(
        dir.path().join("pairs.toml"),
        "version = 1\npairs = [{ a = \"r/base\", b = \"can\", state = \"tested\", reason = \"it is firm\" }]\n",
    )
    .unwrap();
    let text = format!("{HEAD}pairs = \"pairs.toml\"\n{}{scene}", rail("r", 0.0));
    let cell_3 = Cell::parse(dir.path().join("cell.toml"), &text).unwrap();
    assert_eq!(skipped(&cell_3, link(0, "base")), None);
    // A default entry applies to all names that the matrix does not contain, such as a link.
    let by_default = "allowed_collision_matrix:\n  entry_names: [can]\n  entry_values: [[true]]\n  default_entry_names: [can]\n  default_entry_values: [true]\n";
    std::fs::write(dir.path().join("desk.yaml"), format!("{YAML}{by_default}")).unwrap();
    let cell_4 = parse(dir.path(), scene).unwrap();
    assert!(skipped(&cell_4, link(0, "link_1")).is_some() && skipped(&cell_4, link(0, "base")).is_some());
    // A link name of two robots is ambiguous.
    std::fs::write(dir.path().join("desk.yaml"), format!("{YAML}{matrix}")).unwrap();
    let two = format!("{}[scene.desk]\nfile = \"desk.yaml\"\nframe = \"desk\"\n", rail("r2", 1000.0));
    let cell_5 = parse(dir.path(), &two).unwrap();
    assert_eq!((skipped(&cell_5, link(0, "base")), skipped(&cell_5, link(1, "base"))), (None, None));
    assert!(
        cell_5.warnings.iter().any(|w| w.message.contains("several robots have such a link")),
        "{:?}",
        cell_5.warnings
    );
}

#[test]
fn wrong_scenes_are_refused_with_line_and_remedy() {
    let dir = with_files();
    let held = "robot_state:\n  attached_collision_objects:\n    - link_name: link_1\n      object: {id: part, pose: {}, primitives: [{type: 2, dimensions: [1]}]}\n";
    std::fs::write(dir.path().join("held.yaml"), format!("{YAML}{held}")).unwrap();
    std::fs::write(dir.path().join("half.scene"), &SCENE[..60]).unwrap();
    let two = format!("{}[scene.desk]\nfile = \"desk.yaml\"\n", rail("r2", 1000.0));
    // Tables, file of the error, line (0 for none), message, hint. The tables begin at line 8.
    let cases: &[(&str, &str, usize, &str, &str)] = &[
        ("[scene.s]\n", "cell.toml", 8, "`scene.s` needs the key `file`", "file = \"workshop.scene\""),
        ("[scene.s]\nfile = \"none.scene\"\n", "cell.toml", 9, "does not exist", "relative to"),
        ("[scene.s]\nfile = \"shelf.scene\"\npose = 1\n", "cell.toml", 10, "no key `pose`", "rpy"),
        (
            "[scene.s]\nfile = \"shelf.scene\"\nat = [1, 2]\n",
            "cell.toml",
            10,
            "needs 3 numbers, not 2",
            "at = [0, 0, 0]",
        ),
        ("[scene.s]\nfile = \"shelf.scene\"\nrpy = 3\n", "cell.toml", 10, "must be a list", "rpy = [0, 0, 0]"),
        (
            "[scene.s]\nfile = \"shelf.scene\"\nquaternion = [0, 0, 0, 2]\n",
            "cell.toml",
            10,
            "has the length 2",
            "[0, 0, 0, 1]",
        ),
        (
            "[scene.s]\nfile = \"desk.yaml\"\nframe = \"dsek\"\n",
            "cell.toml",
            10,
            "names the frame \"dsek\"",
            "desk   (did you mean it?",
        ),
        (
            "[scene.s]\nfile = \"desk.yaml\"\nallowed_collisions = 1\n",
            "cell.toml",
            10,
            "must be true or false",
            "allowed_collisions = true",
        ),
        (
            "[scene.s]\nfile = \"desk.yaml\"\nallowed_collisions = \"no\"\n",
            "cell.toml",
            10,
            "must be true or false",
            "allowed_collisions = true",
        ),
        (
            "[scene.s]\nfile = \"desk.yaml\"\nallowed_collision = false\n",
            "cell.toml",
            10,
            "no key `allowed_collision`",
            "allowed_collisions",
        ),
        ("[scene.s]\nfile = \"desk.yaml\"\nframe = 3\n", "cell.toml", 10, "must be a text", "frame = "),
        ("[scene.s]\nfile = \"desk.yaml\"\nframe = \"\"\n", "cell.toml", 10, "names the frame \"\"", "desk"),
        (&two, "cell.toml", 13, "in the frame \"link_1\", which is a link of several robots", "frame = \"link_1\""),
        (
            "[scene.a]\nfile = \"shelf.scene\"\n[scene.b]\nfile = \"shelf.scene\"\n",
            "cell.toml",
            11,
            "has an object \"board:1\", and the cell",
            "another name",
        ),
        (
            "[object.can]\nshape = \"sphere\"\nradius = 9\n[scene.b]\nfile = \"desk.yaml\"\n",
            "cell.toml",
            12,
            "has an object \"can\"",
            "another name",
        ),
        ("[scene.s]\nfile = \"held.yaml\"\n", "held.yaml", 0, "`part` is attached to the link `link_1`", "load = {"),
        ("[scene.s]\nfile = \"half.scene\"\n", "half.scene", 9, "the quaternion of `board` has no w", "truncated"),
        ("[object.p]\nshape = \"plane\"\nsize = [1, 1, 1]\n", "cell.toml", 10, "no key `size`", "rpy"),
        ("[object.p]\nshape = \"plane\"\nmotion = { turn = [0, 0, 9] }\n", "cell.toml", 10, "moves a plane", "box"),
        ("[object.p]\nshape = \"plain\"\n", "cell.toml", 9, "cannot be \"plain\"", "plane"),
    ];
    for &(tables, file, line, what, hint) in cases {
        let e = parse(dir.path(), tables).expect_err(tables);
        assert_eq!((e.file.file_name().unwrap().to_str(), e.line.unwrap_or(0)), (Some(file), line), "{e}");
        assert!(e.message.contains(what) && e.hint.as_ref().is_some_and(|h| h.contains(hint)), "{e}");
    }
    std::fs::write(dir.path().join("desk.yaml"), YAML.replace("link_1", "odom")).unwrap();
    let e = parse(dir.path(), "[scene.s]\nfile = \"desk.yaml\"\n").unwrap_err();
    assert!(
        e.message.contains("\"odom\", which is neither a link") && e.to_string().contains("frame = \"odom\""),
        "{e}"
    );
}
