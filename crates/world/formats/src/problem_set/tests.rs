//! Tests of the reader of problem sets.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Vec3;
use elbowroom_testkit::random::xorshift;
use serde_json::{Value, json};

use super::*;

/// A problem with one of everything.
fn complete() -> Value {
    json!({
        "scene": {
            "name": "",
            "fixed_frame_transforms": [
                {"child_frame_id": "rack", "header": {"frame_id": "/cell"},
                 "transform": {"translation": [1, 0, 0.5], "rotation": [0, 0, 0, 2]}},
                {"child_frame_id": "cell", "transform": {"translation": {"x": 0, "y": 2, "z": 0}}}
            ],
            "world": {"collision_objects": [
                {"id": "crate", "header": {"frame_id": "rack"}, "operation": 0,
                 "pose": {"position": [0, 0, 1], "orientation": [0, 0, 0.7, 0.7]},
                 "primitives": [{"type": "box", "dimensions": [0.4, 0.2, 0.1]}, {"type": 2, "dimensions": [0.05]}],
                 "primitive_poses": [{"position": [0.1, 0, 0]}, {"orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}]},
                {"id": "bin", "pose": {"position": [0, 0, 1]},
                 "primitives": [{"type": "CYLINDER", "dimensions": [0.3, 0.1]}, {"type": "cone", "dimensions": [0.2, 0.1]}]},
                {"id": "ramp", "meshes": [{"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], {"x": 0, "y": 0, "z": 1}],
                  "triangles": [[0, 2, 1], [0, 1, 3], {"vertex_indices": [1, 2, 3]}, [0, 3, 2]]}],
                 "mesh_poses": [{"position": [0, 0, 0]}]},
                {"id": "floor", "planes": [{"coef": [0, 0, 2, 1]}]}
            ], "octomap": {"octomap": {"data": []}}},
            "allowed_collision_matrix": {
                "entry_names": ["base", "hand", "crate"],
                "entry_values": [[false, true, true], {"enabled": [true, false, false]}, [false, false, false]],
                "default_entry_names": ["hand", "base"], "default_entry_values": [true, false]},
            "robot_state": {"joint_state": {"name": ["a", "b"], "position": [1, 2]}}
        },
        "request": {
            "start_state": {
                "joint_state": {"name": ["b", "c"], "position": [-2.5, 3]},
                "multi_dof_joint_state": {"joint_names": ["fixed", "cart"], "transforms": [
                    {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1]},
                    {"translation": [3, 0, 0], "rotation": [0, 0, 0, 1]}]},
                "attached_collision_objects": [{"link_name": "hand", "touch_links": ["finger"], "object":
                    {"id": "held", "primitives": [{"type": "sphere", "dimensions": [0.02]}],
                     "primitive_poses": [{"position": [0, 0, 0.1]}]}}]
            },
            "goal_constraints": [
                {"joint_constraints": [{"joint_name": "a", "position": 0.5, "tolerance_above": 0.01}]},
                {"joint_constraints": [{"joint_name": "a", "position": -0.5}, {"joint_name": "b", "position": 0}],
                 "position_constraints": []}
            ]
        }
    })
}

/// An orientation constraint of the hand, turned by a quarter about z of the rack.
fn upright(x: f64, y: f64, z: f64) -> Value {
    json!({"header": {"frame_id": "rack"}, "link_name": "hand", "orientation": [0, 0, 1, 1],
        "absolute_x_axis_tolerance": x, "absolute_y_axis_tolerance": y, "absolute_z_axis_tolerance": z})
}

#[test]
fn orientation_constraints_that_leave_one_axis_free_keep_that_axis() {
    let mut constrained = complete();
    let all = [upright(4.0, 0.3, 0.2), upright(4.0, 4.0, 4.0), upright(0.3, 0.4, 3.2)];
    constrained["request"]["path_constraints"] = json!({"orientation_constraints": all});
    let kept = parse_problem(&constrained).unwrap().problems.remove(0).kept;
    let facts: Vec<_> =
        kept.iter().map(|k| (k.link.as_str(), k.frame.as_str(), k.axis_in_link, k.tolerance_rad)).collect();
    assert_eq!(facts, [("hand", "rack", Vec3::X, 0.2), ("hand", "rack", Vec3::Z, 0.3)]);
    assert!(kept[0].direction.distance(Vec3::Y) < 1e-12 && kept[1].direction.distance(Vec3::Z) < 1e-12);
}

fn parse_problem(problem: &Value) -> Result<ProblemFile, Diagnostic> {
    parse(Path::new("set.json"), json!({"shelf": {"7": problem}}).to_string().as_bytes())
}

/// The message if one field of the complete problem is replaced.
fn refused(pointer: &str, value: Value) -> String {
    let mut problem = complete();
    *problem.pointer_mut(pointer).expect(pointer) = value;
    parse_problem(&problem).expect_err(pointer).to_string()
}

#[test]
fn a_complete_problem_is_read() {
    let file = parse_problem(&complete()).unwrap();
    let [problem] = &file.problems[..] else { panic!("{file:?}") };
    assert_eq!((problem.set.as_str(), problem.id.as_str()), ("shelf", "7"));
    let frames: Vec<_> = problem.frames.iter().map(|f| (f.name.as_str(), f.parent.as_str())).collect();
    assert_eq!(frames, [("rack", "cell"), ("cell", "")]);
    assert_eq!(problem.frames[0].in_parent, Pose::from_translation(Vec3::new(1.0, 0.0, 0.5)));
    let solids: Vec<_> = problem.objects.iter().map(|o| (o.id.as_str(), o.frame.as_str(), o.solids.len())).collect();
    assert_eq!(solids, [("crate", "rack", 2), ("bin", "", 2), ("ramp", "", 1), ("floor", "", 1)]);
    assert_eq!(problem.base_in_world, Pose::from_translation(Vec3::new(3.0, 0.0, 0.0)));
    let start: Vec<_> = problem.start.iter().map(|j| (j.joint.as_str(), j.value)).collect();
    assert_eq!(start, [("a", 1.0), ("b", -2.5), ("c", 3.0)], "the start of the request overrides");
    assert_eq!(problem.goals.iter().map(Vec::len).collect::<Vec<_>>(), [1, 2]);
    let attached = &problem.attached[0];
    assert_eq!((attached.link.as_str(), attached.object.frame.as_str()), ("hand", "hand"));
    assert_eq!(attached.touch_links, ["finger"]);
    // base-hand only: base-crate is not symmetric.
    assert_eq!(problem.matrix.allowed, [(0, 1)]);
    assert_eq!(problem.matrix.allowed_by_default, ["hand"]);
    let warnings: Vec<String> = file.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings[0].contains("cone") && warnings[1].contains("not symmetric"), "{warnings:?}");
}

#[test]
fn shapes_have_the_dimensions_and_poses_of_the_message() {
    let problem = parse_problem(&complete()).unwrap().problems.remove(0);
    let solid = |object: usize, i: usize| problem.objects[object].solids[i].clone();
    let (Shape::Cuboid(cuboid), pose) = solid(0, 0) else { panic!("a box") };
    assert_eq!(cuboid.half_extents, Vec3::new(0.2, 0.1, 0.05));
    // A quarter turn about z of the object's pose, from a quaternion whose length is not 1.
    assert!((pose.translation - Vec3::new(0.0, 0.1, 1.0)).length() < 1e-12);
    assert!((pose.transform_vector(Vec3::X) - Vec3::Y).length() < 1e-12);
    let (Shape::Sphere(sphere), _) = solid(0, 1) else { panic!("a sphere") };
    assert_eq!(sphere.radius, 0.05);
    let (Shape::Cylinder(cylinder), pose) = solid(1, 0) else { panic!("a cylinder") };
    assert_eq!((cylinder.half_length, cylinder.radius, pose.translation.z), (0.15, 0.1, 1.0));
    assert!(matches!(solid(1, 1).0, Shape::Cylinder(_)), "a cone is enclosed");
    let (Shape::Mesh(mesh), _) = solid(2, 0) else { panic!("a mesh") };
    assert!((mesh.report().volume - 1.0 / 6.0).abs() < 1e-12);
    let (Shape::HalfSpace(_), pose) = solid(3, 0) else { panic!("a plane") };
    assert!((pose.translation - Vec3::new(0.0, 0.0, -0.5)).length() < 1e-12);
}

#[test]
fn errors_name_file_set_problem_field_and_a_remedy() {
    let object = "/scene/world/collision_objects/0";
    let at = |field: &str| format!("{object}{field}");
    let cases: Vec<(String, Value, &str, &str)> = vec![
        ("/scene".into(), Value::Null, "has no `scene`", "request"),
        ("/scene/world".into(), json!([]), "`scene.world` is a list", "an object"),
        ("/scene/world/octomap".into(), json!({"data": [1]}), "octomap", "boxes or meshes"),
        (at("/id"), json!(""), "collision_objects[0].id` is empty", "a name"),
        (at("/id"), json!("bin"), "two objects `bin`", "a name of its own"),
        (at("/operation"), json!("remove"), "\"remove\"", "\"add\""),
        (at("/primitives/0/type"), json!("pyramid"), "\"pyramid\", no known shape", "cone"),
        (at("/primitives/0/dimensions"), json!([1, 2]), "dimensions` has 2 numbers, not 3", "[x, y, z]"),
        (at("/primitives/0/dimensions"), json!([1, -2, 1]), "-2 as y", "0 or more"),
        (at("/primitives/1/dimensions"), json!(["NaN"]), "dimensions[0]` is a text", "finite"),
        (at("/primitives/1"), json!({"type": "sphere"}), "has no `dimensions`", "metres"),
        (at("/primitive_poses"), json!([{}]), "2 in `primitives` and 1 in `primitive_poses`", "as many"),
        (at("/primitive_poses/0/position"), json!([1, 2, 3, 4]), "4 numbers, not 3", "[x, y, z]"),
        (at("/primitive_poses/0/position"), json!([1e10, 0, 0]), "1e9", "metres"),
        (at("/pose/orientation"), json!([0, 0, 0, 0]), "pose.orientation`", "[0, 0, 0, 1]"),
        (at("/pose/orientation"), json!([1e300, 1e300, 0, 0]), "without direction", "unit quaternion"),
        (at("/primitives"), json!([]), "0 in `primitives`", "as many"),
        ("/scene/world/collision_objects/2/meshes/0/triangles/0".into(), json!([0, 9, 1]), "no mesh", "vertices"),
        ("/scene/world/collision_objects/2/meshes/0/triangles/0".into(), json!([0, 1]), "2 corners", "[0, 1, 2]"),
        (
            "/scene/world/collision_objects/2/meshes/0".into(),
            json!({"resource": "package://a"}),
            "mesh file",
            "\"vertices\"",
        ),
        (
            "/scene/world/collision_objects/3/planes/0/coef".into(),
            json!([0, 0, 0, 1]),
            "without a direction",
            "[0, 0, 1, 0]",
        ),
        ("/scene/world/collision_objects/3".into(), json!({"id": "x"}), "`x` has no shape", "primitives"),
        ("/scene/allowed_collision_matrix/entry_values/0".into(), json!([true]), "1 entries for 3 names", "per name"),
        ("/scene/allowed_collision_matrix/entry_values".into(), json!([]), "0 entries for 3 names", "row per name"),
        ("/scene/allowed_collision_matrix/entry_values/0/1".into(), json!("yes"), "is a text", "true or false"),
        ("/request/start_state/joint_state/position".into(), json!([1]), "2 in `name` and 1 in `position`", "as many"),
        ("/request/start_state/joint_state/name/1".into(), json!("b"), "\"b\" a second time", "once"),
        ("/request/start_state/joint_state/position/0".into(), json!("1"), "position[0]` is a text", "0.25"),
        (
            "/request/start_state/multi_dof_joint_state/transforms/0/translation".into(),
            json!([1, 0, 0]),
            "two joints",
            "one joint",
        ),
        ("/request/start_state/attached_collision_objects/0/link_name".into(), json!(3), "is a number", "a text"),
        ("/request/goal_constraints".into(), json!([]), "no `goal_constraints`", "joint_constraints"),
        ("/request/goal_constraints/0".into(), json!({}), "no `joint_constraints`", "joint_name"),
        (
            "/request/goal_constraints/1/position_constraints".into(),
            json!([{}]),
            "joint values only",
            "joint_constraints",
        ),
        (
            "/request/goal_constraints/0/joint_constraints/0/position".into(),
            Value::Null,
            "has no `position`",
            "joint_name",
        ),
        ("/request/goal_constraints/1/joint_constraints/1/joint_name".into(), json!("a"), "a second time", "once"),
    ];
    for (pointer, value, what, hint) in cases {
        let message = refused(&pointer, value);
        let start = "set.json:1: set `shelf`, problem `7`: ";
        assert!(message.starts_with(start) && message.contains(what), "{pointer}: {message}");
        assert!(message.split("write: ").nth(1).is_some_and(|h| h.contains(hint)), "{pointer}: {message}");
    }
    for (key, constraint, words) in [
        ("position_constraints", json!({}), "`position_constraints`, which are not supported"),
        ("orientation_constraints", json!({}), "has no `absolute_x_axis_tolerance`"),
        ("orientation_constraints", upright(0.1, 0.1, 0.1), "leaves 0 axes free"),
        ("orientation_constraints", upright(0.1, 4.0, 4.0), "leaves 2 axes free"),
        ("orientation_constraints", upright(0.0, 0.1, 4.0), "is not above 0"),
    ] {
        let mut constrained = complete();
        constrained["request"]["path_constraints"] = json!({key: [constraint]});
        let message = parse_problem(&constrained).unwrap_err().message;
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn motions_of_the_industrial_planner_are_told_by_its_names() {
    let pilz = "pilz_industrial_motion_planner";
    let motion = |pipeline: Value, planner: Value| {
        let mut requested = complete();
        requested["request"]["pipeline_id"] = pipeline;
        requested["request"]["planner_id"] = planner;
        parse_problem(&requested).map(|mut file| file.problems.remove(0).motion)
    };
    let cases = [
        (json!(pilz), json!("LIN"), RequestedMotion::Linear),
        (Value::Null, json!("LIN"), RequestedMotion::Linear),
        (json!(""), json!("PTP"), RequestedMotion::PointToPoint),
        (json!("ompl"), json!("RRTConnect"), RequestedMotion::Any),
        (Value::Null, json!("BKPIECEGood"), RequestedMotion::Any),
        (json!("ompl"), Value::Null, RequestedMotion::Any),
    ];
    for (pipeline, planner, expected) in cases {
        assert_eq!(motion(pipeline.clone(), planner.clone()).unwrap(), expected, "{pipeline} {planner}");
    }
    for (pipeline, planner, what, hint) in [
        (json!(pilz), json!("CIRC"), "`request.planner_id` is \"CIRC\"", "\"LIN\" once per chord"),
        (Value::Null, json!("CIRC"), "circles are not supported", "\"PTP\""),
        (json!(pilz), json!("LIM"), "\"LIM\", which is no planner", "LIN"),
        (Value::Null, json!("lin"), "\"lin\", which is no planner", "LIN"),
        (json!(pilz), Value::Null, "has no `planner_id`", "\"planner_id\": \"LIN\""),
        (json!("ompl"), json!("LIN"), "`request.pipeline_id` is \"ompl\"", pilz),
        (json!(pilz), json!(5), "`request.planner_id` is a number", "a text"),
    ] {
        let message = motion(pipeline, planner).expect_err(what).to_string();
        assert!(message.contains(what), "{message}");
        assert!(message.split("write: ").nth(1).is_some_and(|h| h.contains(hint)), "{message}");
    }
    // The constraints of a circle do not hide that it is one.
    let mut circle = complete();
    circle["request"]["planner_id"] = json!("CIRC");
    circle["request"]["path_constraints"] = json!({"name": "center", "position_constraints": [{}]});
    let text = serde_json::to_string_pretty(&json!({"arcs.of": {"a[0]": circle}})).unwrap();
    let error = parse(Path::new("set.json"), text.as_bytes()).unwrap_err();
    let line = 1 + text.lines().position(|line| line.contains("planner_id")).unwrap();
    assert!(error.message.contains("CIRC") && error.line == Some(line), "{error}, not {line}");
}

#[test]
fn texts_that_are_no_problem_sets_are_refused_with_the_line() {
    let cases = [
        ("", "empty", "export"),
        ("{\"a\":\n{\"1\": {\"scene\": {}, \"request\": NaN}}}", "2: is not JSON", "NaN"),
        ("{\"a\":\n{\"1\": {\"scene\": 1e999}}}", "2: is not JSON", "finite"),
        ("{\"a\": {\"1\": {}\n", "is truncated", "complete"),
        ("{\"a\": {\"1\": {},\n\"1\": {}}}", "2: is no set of planning problems: the key `1` occurs twice", "SET"),
        ("[1, 2]", "is no set of planning problems", "SET"),
        ("{}", "has no planning problem", "SET"),
        ("{\"a\": {}}", "has no planning problem", "SET"),
        ("{\"a\": {\"1\": 5}}", "is a number", "an object"),
        ("{\"version\": 1}", "is no set", "SET"),
    ];
    for (text, what, hint) in cases {
        let message = parse(Path::new("set.json"), text.as_bytes()).expect_err(text).to_string();
        assert!(message.contains(what) && message.contains(hint), "{text}: {message}");
    }
    let deep = "[".repeat(100_000);
    assert!(parse(Path::new("set.json"), format!("{{\"a\": {{\"1\": {deep}").as_bytes()).is_err());
}

#[test]
fn damaged_files_give_a_message() {
    let text = json!({"shelf": {"7": complete()}}).to_string().into_bytes();
    for length in 0..text.len() {
        assert!(parse(Path::new("set.json"), &text[..length]).is_err());
    }
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..3000 {
        let mut bytes = text.clone();
        for _ in 0..3 {
            let at = (xorshift(&mut random) % bytes.len() as u64) as usize;
            bytes[at] = b"0123456789-eE.,:[]{}\"ntf\xff"[(xorshift(&mut random) % 25) as usize];
        }
        if let Ok(file) = parse(Path::new("set.json"), &bytes) {
            let solids = || file.problems.iter().flat_map(|p| &p.objects).flat_map(|o| &o.solids);
            assert!(solids().all(|(shape, pose)| shape.validate().is_ok() && pose.is_finite()));
        }
    }
}
