//! Tests of the two forms of planning scenes.

use std::path::Path;

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

use super::*;

const NEW: &str = "workshop floor\n\
* table top\n1 0 0.5\n0 0 0.7071068 0.7071068\n2\nbox\n0.6 0.4 0.1\n0.2 0 0\n0 0 0 1\n0.5 0.5 0.5 1\n\
cylinder\n0.05 0.8\n0 0 -0.4\n0 0 0 1\n0 0 0 0\n1\ncorner\n0.3 0.2 0\n0 0 0 1\n\
* ground\n0 0 0\n0 0 0 1\n1\nplane\n0 0 2 1\n0 0 0\n0 0 0 1\n0 0 0 0\n0\n.\n";
const OLD: &str = "old\n* ball\n1\nsphere\n0.1\n0 0 1\n0 0 0 1\n0 0 0 0\n* wedge\n1\nmesh\n4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n\
0 2 1\n0 1 3\n1 2 3\n0 3 2\n0 2 0\n0 0 0 1\n0 0 0 0\n.\n";
const YAML: &str = "name: shelf\nworld:\n  collision_objects:\n    - id: can\n      header: {frame_id: base_link}\n\
\x20     primitives:\n        - type: cylinder\n          dimensions: [0.14, 0.03]\n      primitive_poses:\n\
\x20       - position: [0.8, 0, 0.55]\n          orientation: [0, 0, 0, 1]\n    - id: board\n      pose: {position: [0, 0, 1]}\n\
\x20     primitives: [{type: 1, dimensions: [1, 2, 0.1]}]\n      primitive_poses: [{position: [0, 1, 0]}]\n\
allowed_collision_matrix:\n  entry_names: [can, board]\n  entry_values:\n  - enabled: [true, true]\n  - enabled: [true, true]\n\
robot_state:\n  joint_state:\n    name: [waist]\n    position: [0.5]\n---\nworld: a second document\n";

fn read(name: &str, text: &str) -> Result<PlanningScene, Diagnostic> {
    parse(Path::new(name), text.as_bytes())
}

fn solid(scene: &PlanningScene, object: usize, i: usize) -> (Shape, Pose) {
    scene.objects[object].solids[i].clone()
}

#[test]
fn the_newer_text_has_poses_of_objects_and_subframes() {
    let scene = read("a.scene", NEW).unwrap();
    assert_eq!(scene.name, "workshop floor");
    let ids: Vec<_> = scene.objects.iter().map(|o| (o.id.as_str(), o.solids.len())).collect();
    assert_eq!(ids, [("table top", 2), ("ground", 1)]);
    let (Shape::Cuboid(cuboid), pose) = solid(&scene, 0, 0) else { panic!("a box") };
    assert_eq!(cuboid.half_extents, Vec3::new(0.3, 0.2, 0.05));
    // The object is turned by a quarter about z: its x is the y of the world.
    assert!((pose.translation - Vec3::new(1.0, 0.2, 0.5)).length() < 1e-7, "{pose:?}");
    let (Shape::Cylinder(cylinder), pose) = solid(&scene, 0, 1) else { panic!("a cylinder") };
    assert_eq!((cylinder.radius, cylinder.half_length), (0.05, 0.4), "radius, then length");
    assert!((pose.translation - Vec3::new(1.0, 0.0, 0.1)).length() < 1e-7, "{pose:?}");
    let (Shape::HalfSpace(_), pose) = solid(&scene, 1, 0) else { panic!("a plane") };
    assert_eq!(pose.translation, Vec3::new(0.0, 0.0, -0.5));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn the_older_text_has_only_poses_of_shapes() {
    let scene = read("a.scene", &OLD.replace('\n', "\r\n")).unwrap();
    let (Shape::Sphere(sphere), pose) = solid(&scene, 0, 0) else { panic!("a sphere") };
    assert_eq!((sphere.radius, pose.translation), (0.1, Vec3::Z));
    let (Shape::Mesh(mesh), pose) = solid(&scene, 1, 0) else { panic!("a mesh") };
    assert!((mesh.report().volume - 1.0 / 6.0).abs() < 1e-12);
    assert_eq!(pose.translation, Vec3::Y * 2.0);
}

#[test]
fn the_message_has_frames_a_matrix_and_a_state() {
    let scene = read("a.yaml", YAML).unwrap();
    let objects: Vec<_> = scene.objects.iter().map(|o| (o.id.as_str(), o.frame.as_str())).collect();
    assert_eq!((scene.name.as_str(), objects), ("shelf", vec![("can", "base_link"), ("board", "")]));
    let (Shape::Cylinder(cylinder), pose) = solid(&scene, 0, 0) else { panic!("a cylinder") };
    assert_eq!((cylinder.radius, cylinder.half_length, pose.translation.z), (0.03, 0.07, 0.55), "height, then radius");
    assert_eq!(solid(&scene, 1, 0).1.translation, Vec3::new(0.0, 1.0, 1.0));
    assert_eq!((scene.allowed.allowed, scene.joints[0].value), (vec![(0, 1)], 0.5));
    let wrapped = format!("scene:\n  {}", YAML.split("---").next().unwrap().trim_end().replace('\n', "\n  "));
    assert_eq!(read("answer.yaml", &wrapped).unwrap().objects.len(), 2, "the answer of a service");
    let json = r#"{"world": {"collision_objects": [{"id": "a", "planes": [[0, 0, 1, 0]], "plane_poses": [{}]}]}}"#;
    assert_eq!(read("a.json", json).unwrap().objects.len(), 1, "JSON is YAML");
}

#[test]
fn the_form_is_recognized_by_content() {
    assert_eq!(read("a.txt", NEW).unwrap().objects.len(), 2);
    assert_eq!(read("a.txt", YAML).unwrap().objects.len(), 2);
    assert_eq!(read("empty.scene", "nothing\n.\n").unwrap().objects.len(), 0);
}

#[test]
fn mesh_files_are_found_beside_the_scene() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("parts")).unwrap();
    std::fs::write(
        dir.path().join("parts/a.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n",
    )
    .unwrap();
    let text = "world:\n  collision_objects:\n    - id: a\n      meshes: [{resource: \"package://parts/a.obj\"}, {resource: parts/a.obj, \
                dimensions: [1, 1, 3]}]\n      mesh_poses: [{}, {}]\n";
    let scene = parse(&dir.path().join("s.yaml"), text.as_bytes()).unwrap();
    let volume = |i: usize| if let (Shape::Mesh(m), _) = solid(&scene, 0, i) { m.report().volume } else { 0.0 };
    assert!((volume(0) - 1.0 / 6.0).abs() < 1e-12 && (volume(1) - 0.5).abs() < 1e-12);
    let e = parse(&dir.path().join("s.yaml"), text.replace("parts/a.obj, ", "parts/b.obj, ").as_bytes()).unwrap_err();
    assert!(
        e.to_string().contains("s.yaml:4: `world.collision_objects[0].meshes[1].resource` names a mesh file"),
        "{e}"
    );
}

#[test]
fn errors_name_the_line_and_a_remedy() {
    // File, text, replaced part, replacement, line, message, hint.
    let cases: &[(&str, &str, &str, &str, usize, &str, &str)] = &[
        ("a.scene", NEW, "* table top", "*table top", 2, "`*table` where an object begins", "* NAME"),
        ("a.scene", NEW, "* table top", "* ", 2, "object without a name", "* NAME"),
        ("a.scene", NEW, "* ground", "* table top", 0, "two objects `table top`", "a name of its own"),
        ("a.scene", NEW, "box", "pyramid", 6, "`pyramid` is no shape", "cone"),
        ("a.scene", NEW, "0.6 0.4 0.1", "0.6 wide 0.1", 7, "`wide` is no finite number, for y of `table top`", "x y z"),
        ("a.scene", NEW, "0.6 0.4 0.1", "0.6 -0.4 0.1", 7, "-0.4 as y", "0 or more"),
        (
            "a.scene",
            NEW,
            "0 0 0.7071068 0.7071068",
            "0 0 0 0",
            4,
            "quaternion of `table top` has no direction",
            "0 0 0 1",
        ),
        ("a.scene", NEW, "1 0 0.5", "1 0 5e9", 3, "above 1e9 m", "metres"),
        ("a.scene", NEW, "1 0 0.5", "1 0 nan", 3, "`nan` is no finite number", "x y z"),
        ("a.scene", NEW, "2\nbox", "2.5\nbox", 5, "`2.5` is no whole number, for number of shapes", "0, 1, 2"),
        ("a.scene", NEW, "2\nbox", "3\nbox", 16, "`1` is no shape", "box, sphere"),
        ("a.scene", NEW, "0 0 2 1", "0 0 0 1", 25, "the plane of `ground` has no direction", "0 0 1 0"),
        ("a.scene", NEW, "0\n.\n", "0\n", 30, "has no end", "a dot"),
        ("a.scene", OLD, "4 4\n", "400000000 4\n", 12, "400000000 vertices and 4 triangles, but", "truncated"),
        ("a.scene", OLD, "0 2 1\n", "0 9 1\n", 12, "mesh of `wedge` is no solid", "x y z and i j k"),
        ("a.yaml", YAML, "0.14, 0.03", "0.14", 8, "dimensions` has 1 numbers, not 2", "[height, radius]"),
        ("a.yaml", YAML, "type: cylinder", "type: tube", 7, "\"tube\", no known shape", "cone"),
        ("a.yaml", YAML, "id: can", "id: board", 1, "two objects `board`", "a name of its own"),
        ("a.yaml", YAML, "id: board", "id: board\n      operation: 1", 13, "only objects that are added", "\"add\""),
        ("a.yaml", "- world: {}\n", "- world", "- world", 1, "is no planning scene", "collision_objects"),
        ("a.yaml", YAML, "world:\n", "World:\n", 1, "has no `world`: it is no planning scene", "collision_objects"),
        (
            "a.yaml",
            YAML,
            "world:\n",
            "world:\n  octomap: {octomap: {data: [1]}}\n",
            3,
            "has data, which are not read",
            "boxes",
        ),
        ("a.yaml", YAML, "position: [0.5]", "position: [.nan]", 24, "position[0]` is a text", "finite"),
        ("a.yaml", YAML, "  - enabled: [true, true]\n", "", 17, "1 entries for 2 names", "a row per name"),
        ("a.yaml", YAML, "name: shelf", "\tname: shelf", 2, "not YAML", "spaces"),
    ];
    for &(file, text, from, to, line, what, hint) in cases {
        assert!(text.contains(from), "{from}");
        let e = read(file, &text.replacen(from, to, 1)).expect_err(to);
        assert_eq!(e.line.unwrap_or(0), line, "{e}");
        assert!(e.message.contains(what) && e.hint.as_ref().is_some_and(|h| h.contains(hint)), "{e}");
    }
}

#[test]
fn what_is_left_out_is_said() {
    let text = OLD.replacen("1\nsphere\n0.1\n0 0 1\n0 0 0 1\n0 0 0 0\n", "0\n", 1).replacen(
        "mesh\n4 4",
        "cone\n0.1 0.2\n0 0 0\n0 0 0 1\n0 0 0 0\nmesh\n4 4",
        1,
    );
    let text = text.replacen("wedge\n1\n", "wedge\n2\n", 1).replacen("\n.\n", "\n.\nmore\n", 1);
    let scene = read("a.scene", &text).unwrap();
    assert_eq!(scene.objects.len(), 1);
    let warnings: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
    let expected = [
        "a.scene:2: the object `ball` has no shape",
        "a.scene:6: the object `wedge` is a cone",
        "`more` behind the dot",
    ];
    for (warning, expected) in warnings.iter().zip(expected) {
        assert!(warning.contains(expected), "{warning}");
    }
    assert_eq!(warnings.len(), expected.len());
}
