//! Robots from 3DS and glTF models: tracks, joints files, and export as URDF and 3DS.

use std::path::Path;

use crate::common::solids::{corners, corners_apart, random_q, solids};
use elbowroom_formats::nodetree::{Keyframe, Node, NodeTree};
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_formats::{LoadedRobot, MeshData, joints, tds};
use elbowroom_kinematics::{Chain, ChainState, JointKind, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::folder;
use elbowroom_testkit::random::Xorshift;

fn box_mesh(name: &str) -> MeshData {
    let corner = |i: u32| Vec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 0.2;
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    MeshData { name: name.into(), vertices: (0..8).map(corner).collect(), triangles }
}

/// A base and one link, which may move.
fn one(track: impl Fn(Pose) -> Vec<Pose>) -> NodeTree {
    let mut tree = NodeTree::new("one");
    let mut base = Node::new("base", None, Pose::IDENTITY);
    base.meshes.push(box_mesh("base"));
    tree.push(base);
    let rest = Pose::from_xyz_rpy([0.3, -0.2, 0.5], [0.4, -0.6, 1.1]);
    let mut link = Node::new("link", Some(0), rest);
    link.meshes.push(box_mesh("link"));
    let key = |(i, in_parent): (usize, Pose)| Keyframe { time_s: i as f64, in_parent };
    link.track = track(rest).into_iter().enumerate().map(key).collect();
    tree.push(link);
    tree
}

fn load(tree: &NodeTree, options: &LoadOptions, side: Option<&str>) -> Result<LoadedRobot, String> {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("one.3ds");
    std::fs::write(&file, tds::write(tree, &file).unwrap()).unwrap();
    if let Some(side) = side {
        std::fs::write(joints::default_path(&file), side).unwrap();
    }
    robot::load(&file, options).map_err(|e| e.to_string().replace(&dir.path().display().to_string(), ""))
}

fn bare(tree: &NodeTree) -> LoadedRobot {
    load(tree, &LoadOptions::default(), None).unwrap()
}

fn turned(rest: Pose, axis: Vec3, degrees: &[f64]) -> Vec<Pose> {
    let turn = |d: &f64| rest * Pose::new(Rotation::from_axis_angle(axis, d.to_radians()), Vec3::ZERO);
    degrees.iter().map(turn).collect()
}

#[test]
fn a_rotation_track_is_a_revolute_joint_limited_by_its_keys() {
    let axis = Vec3::new(0.6, 0.0, 0.8);
    let loaded = bare(&one(|rest| turned(rest, axis, &[0.0, 60.0, 100.0, 20.0, -70.0, -130.0, -50.0, 0.0])));
    let joint = &loaded.robot.chain.joints()[0];
    assert_eq!((joint.kind, joint.name.as_str()), (JointKind::Revolute, "link"));
    assert!(joint.axis.distance(axis) < 1e-5, "{:?}", joint.axis);
    assert!((joint.limits.lower.to_degrees() + 130.0).abs() < 1e-3, "{:?}", joint.limits);
    assert!((joint.limits.upper.to_degrees() - 100.0).abs() < 1e-3, "{:?}", joint.limits);
    assert!(
        loaded.warnings.iter().any(|w| w.message.contains("`link` rotates about [0.6, 0, 0.8]")),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn a_full_turn_is_continuous_and_a_translation_is_prismatic() {
    let loaded = bare(&one(|rest| turned(rest, Vec3::Z, &[0.0, 90.0, 180.0, 270.0, 360.0])));
    assert_eq!(loaded.robot.chain.joints()[0].kind, JointKind::Continuous);
    let slide = |rest: Pose| [0.0, 0.7, -0.1].map(|x| rest * Pose::from_translation(Vec3::Y * x)).to_vec();
    let loaded = bare(&one(slide));
    let joint = &loaded.robot.chain.joints()[0];
    assert_eq!(joint.kind, JointKind::Prismatic);
    assert!(joint.axis.distance(Vec3::Y) < 1e-5);
    assert!((joint.limits.lower + 0.1).abs() < 1e-5 && (joint.limits.upper - 0.7).abs() < 1e-5);
}

/// A node that rotates about a point other than its origin.
#[test]
fn the_centre_of_a_track_becomes_the_links_origin() {
    let (axis, at) = (Vec3::X, Vec3::new(0.0, 0.4, -0.3));
    let about = |rest: Pose, d: f64| {
        let r = Rotation::from_axis_angle(axis, f64::to_radians(d));
        rest * Pose::new(r, at - r * at)
    };
    let tree = one(|rest| [0.0, 45.0, 80.0, -30.0].map(|d| about(rest, d)).to_vec());
    let loaded = bare(&tree);
    let chain = &loaded.robot.chain;
    assert_eq!(chain.dof(), 1, "{:?}", loaded.warnings);
    let mut state = ChainState::new(chain);
    state.q[0] = 0.5;
    chain.forward(&mut state);
    let link = chain.link("link").unwrap();
    let collider = &loaded.robot.colliders[link.0][0];
    let right = about(tree.nodes[1].in_parent, 0.5_f64.to_degrees());
    let Shape::Mesh(mesh) = &collider.shape else { panic!("no mesh") };
    for (v, raw) in mesh.vertices().iter().zip(&tree.nodes[1].meshes[0].vertices) {
        let here = (state.link_in_root(link) * collider.in_link).transform_point(*v);
        assert!(here.distance(right.transform_point(*raw)) < 1e-5);
    }
}

#[test]
fn a_track_that_is_not_a_joint_is_fixed_with_a_warning() {
    let twice = |rest: Pose| {
        let mut poses = turned(rest, Vec3::Z, &[0.0, 40.0]);
        poses.push(poses[1] * Pose::new(Rotation::from_axis_angle(Vec3::X, 0.7), Vec3::ZERO));
        poses
    };
    let loaded = bare(&one(twice));
    assert_eq!(loaded.robot.chain.dof(), 0);
    let said = loaded.warnings.iter().map(|w| w.message.clone()).collect::<String>();
    assert!(said.contains("rotates about [0, 0, 1] at first, but about [1, 0, 0] between 1.00 s and 2.00 s"), "{said}");
    // The joints file overrides the track.
    let side = "units = { length = \"mm\", angle = \"deg\" }\n[joint.link]\naxis = \"z\"\nmin = -10\nmax = 40\n";
    let loaded = load(&one(twice), &LoadOptions::default(), Some(side)).unwrap();
    assert_eq!(loaded.robot.chain.dof(), 1);
    let spiral = |rest: Pose| {
        (0..4)
            .map(|i| {
                rest * Pose::new(Rotation::from_axis_angle(Vec3::Z, 0.3 * f64::from(i)), Vec3::Z * 0.1 * f64::from(i))
            })
            .collect()
    };
    let said = bare(&one(spiral)).warnings.iter().map(|w| w.message.clone()).collect::<String>();
    assert!(said.contains("rotates about [0, 0, 1] and translates at once"), "{said}");
}

#[test]
fn a_model_without_joints_gives_a_joint_file_to_fill_in() {
    let loaded = bare(&one(|_| Vec::new()));
    assert_eq!((loaded.robot.chain.dof(), loaded.robot.chain.joints().len()), (0, 1));
    let asked = loaded.warnings.iter().find(|w| w.message.starts_with("no joint moves")).expect("a warning");
    assert!(asked.message.contains("`link`") && !asked.message.contains("`base`"), "{asked}");
    let skeleton = asked.hint.as_ref().unwrap();
    assert!(skeleton.contains("on base, origin at [0.3, -0.2, 0.5] m"), "{skeleton}");
    // The printed template is valid once the axis is filled in.
    let toml = skeleton.split_once('\n').unwrap().1;
    let error = load(&one(|_| Vec::new()), &LoadOptions::default(), Some(toml)).unwrap_err();
    assert!(error.contains("one.joints.toml:3: `axis` is still to be filled in"), "{error}");
    let loaded = load(&one(|_| Vec::new()), &LoadOptions::default(), Some(&toml.replace('?', "-y"))).unwrap();
    let joint = &loaded.robot.chain.joints()[0];
    assert_eq!((joint.axis, joint.limits.upper), (-Vec3::Y, std::f64::consts::PI));
    assert!((joint.limits.velocity.unwrap() - 90.0_f64.to_radians()).abs() < 1e-12);
}

#[test]
fn axes_in_other_frames_and_other_origins() {
    let tree = one(|_| Vec::new());
    let rest = tree.nodes[1].in_parent;
    for (frame, in_world) in [("world", Vec3::Z), ("parent", Vec3::Z), ("node", rest.rotation * Vec3::Z)] {
        let joint = format!("link: axis=z, in={frame}, min=-90, max=90, at=0.1 0 0.2");
        let options = LoadOptions { joint: vec![joint], ..LoadOptions::default() };
        let loaded = load(&tree, &options, None).unwrap();
        let (chain, link) = (&loaded.robot.chain, loaded.robot.chain.link("link").unwrap());
        let joint = &chain.joints()[0];
        assert!((joint.origin.rotation * joint.axis).distance(in_world) < 1e-6, "{frame}");
        let at = Vec3::new(0.1, 0.0, 0.2);
        let at = if frame == "node" { rest.transform_point(at) } else { at };
        assert!(joint.origin.translation.distance(at) < 1e-6, "{frame}");
        // The geometry does not move.
        let mut state = ChainState::new(chain);
        chain.forward(&mut state);
        let place = state.link_in_root(link) * loaded.robot.colliders[link.0][0].in_link;
        assert!(place.translation.distance(rest.translation) < 1e-6, "{frame}");
    }
}

#[test]
fn errors_in_joints_name_file_and_line() {
    let units = "units = { length = \"mm\", angle = \"deg\" }\n";
    for (side, said) in [
        ("[joint.link]\naxis = \"z\"\n".to_owned(), "no `units`"),
        (format!("{units}[joint.lonk]\naxis = \"z\"\n"), "2: there is no node `lonk`"),
        (format!("{units}[joint.Link]\naxis = \"z\"\n"), "[joint.link]"),
        (format!("{units}[joint.link]\naxis = \"up\"\n"), "3: `axis` is \"up\""),
        (format!("{units}[joint.link]\naxis = [0, 0, 0]\n"), "3: `axis` has no direction"),
        (format!("{units}[joint.link]\naxis = [0, 0, nan]\n"), "3: `axis` is not three numbers"),
        (format!("{units}[joint.link]\naxis = \"z\"\nmin = 5\nmax = 3\n"), "min = 5 above max = 3"),
        (format!("{units}[joint.link]\naxis = \"z\"\nmin = 5\n"), "needs min and max"),
        (format!("{units}[joint.link]\nkind = \"prismatic\"\naxis = \"z\"\n"), "needs min and max"),
        (format!("{units}[joint.link]\nmin = 5\nmax = 6\n"), "no axis"),
        (format!("{units}[joint.link]\nspead = 5\n"), "3: `spead` is not known"),
        (format!("{units}[joint.link]\nspeed = -5\n"), "3: `speed` is not a number above 0"),
        (format!("{units}[joint.link]\nkind = \"hinge\"\n"), "\"revolute\" or \"prismatic\""),
        (format!("{units}[joint.link]\naxis = \"z\"\nmimic = {{ joint = \"x\" }}\n"), "follows `x`"),
        (format!("{units}joint = 3\n"), "`joint` is not known here"),
        (format!("{units}[joint\n"), "this is not TOML"),
    ] {
        let error = load(&one(|_| Vec::new()), &LoadOptions::default(), Some(&side)).unwrap_err();
        assert!(error.contains(said), "{said}: {error}");
        assert!(error.contains("write:"), "{error}");
    }
    for (option, said) in [("link", "colon"), ("link: axis", "key=value"), ("nobody: axis=z", "no node `nobody`")] {
        let options = LoadOptions { joint: vec![option.into()], ..LoadOptions::default() };
        let error = load(&one(|_| Vec::new()), &options, None).unwrap_err();
        assert!(error.contains(said) && error.contains("write:"), "{error}");
    }
}

#[test]
fn several_roots_get_a_common_root_and_equal_names_are_numbered() {
    let mut tree = NodeTree::new("one");
    for x in [0.0, 1.0] {
        let mut node = Node::new("part", None, Pose::from_translation(Vec3::X * x));
        node.meshes.push(box_mesh("part"));
        tree.push(node);
    }
    let loaded = bare(&tree);
    assert_eq!(loaded.robot.chain.links(), ["part", "part_2", "one"]);
    assert_eq!(loaded.robot.chain.root(), LinkId(2));
}

/// Loads a glTF of a base and a link that rotates about its y axis in three keys; `edit` changes the JSON.
fn animated(edit: impl Fn(String) -> String, values: &[f32]) -> Result<LoadedRobot, String> {
    use base64::Engine as _;
    let corners = [0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.2, 0.0];
    let numbers = corners.iter().chain(&[0.0, 1.0, 2.0]).chain(values);
    let bytes: Vec<u8> = numbers.flat_map(|x: &f32| x.to_le_bytes()).collect();
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let (length, count) = (bytes.len(), values.len() / 4);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],
"nodes":[{{"name":"base","mesh":0,"children":[1]}},{{"name":"link","mesh":0,"translation":[0,0,0.5],"scale":[2,2,2]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
"buffers":[{{"byteLength":{length},"uri":"data:application/octet-stream;base64,{data}"}}],
"bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":12}},{{"buffer":0,"byteOffset":48,"byteLength":{}}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5126,"count":3,"type":"SCALAR","min":[0],"max":[2]}},
{{"bufferView":2,"componentType":5126,"count":{count},"type":"VEC4"}}],
"animations":[{{"channels":[{{"sampler":0,"target":{{"node":1,"path":"rotation"}}}}],"samplers":[{{"input":1,"output":2}}]}}]}}"#,
        length - 48
    );
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("arm.gltf");
    std::fs::write(&file, edit(json)).unwrap();
    robot::load(&file, &LoadOptions::default()).map_err(|e| e.to_string())
}

/// A rotation about y as a quaternion.
fn about_y(degrees: f32) -> [f32; 4] {
    let (sine, cosine) = (0.5 * degrees.to_radians()).sin_cos();
    [0.0, sine, 0.0, cosine]
}

#[test]
fn animations_of_gltf_are_joints() {
    let keys = [about_y(0.0), about_y(70.0), about_y(-20.0)].concat();
    let check = |loaded: LoadedRobot| {
        let joint = &loaded.robot.chain.joints()[0];
        assert_eq!(joint.kind, JointKind::Revolute, "{:?}", loaded.warnings);
        assert!(joint.axis.distance(Vec3::Y) < 1e-5);
        assert!((joint.limits.upper.to_degrees() - 70.0).abs() < 1e-3, "{:?}", joint.limits);
        assert!((joint.limits.lower.to_degrees() + 20.0).abs() < 1e-3, "{:?}", joint.limits);
        assert!(joint.origin.translation.distance(Vec3::Z * 0.5) < 1e-7);
        let link = loaded.robot.chain.link("link").unwrap();
        let Shape::Mesh(mesh) = &loaded.robot.colliders[link.0][0].shape else { panic!("no mesh") };
        assert!(mesh.vertices()[1].distance(Vec3::X * 0.4) < 1e-7, "the scale is in the mesh");
    };
    check(animated(|j| j, &keys).unwrap());
    // A spline has tangents around each value.
    let zero = [0.0; 4];
    let spline = [0.0, 70.0, -20.0].map(|d| [zero, about_y(d), zero].concat()).concat();
    let cubic = |j: String| j.replace("\"output\":2", "\"output\":2,\"interpolation\":\"CUBICSPLINE\"");
    check(animated(cubic, &spline).unwrap());
    for (values, said) in [
        (keys[..8].to_vec(), "fewer values than times"),
        ([about_y(0.0), zero, zero].concat(), "a rotation that is no unit quaternion"),
        ([about_y(0.0), [f32::NAN; 4], zero].concat(), "a number that is not finite"),
    ] {
        let error = animated(|j| j, &values).unwrap_err();
        assert!(error.contains(said) && error.contains("animation 0, channel 0"), "{error}");
    }
    let error = animated(|j| j.replace("VEC4", "VEC3"), &keys).unwrap_err();
    assert!(error.contains("values of 3 numbers instead of 4"), "{error}");
    let error = animated(|j| j.replace("\"sampler\":0", "\"sampler\":7"), &keys).unwrap_err();
    assert!(error.contains("sampler 7, which does not exist"), "{error}");
    let error = animated(|j| j.replace("{\"node\":1", "{\"node\":7"), &keys).unwrap_err();
    assert!(error.contains("moves node 7, which does not exist"), "{error}");
    assert!(animated(|j| j.replace("\"rotation\"", "\"roll\""), &keys).is_ok());
}

/// Largest difference of a link's pose at random joint values, with joints matched by name.
fn apart(a: &Chain, b: &Chain, links: &[&str]) -> f64 {
    let mut random = Xorshift(0x1234_5678_9abc_def1);
    let mut worst: f64 = 0.0;
    let (mut sa, mut sb) = (ChainState::new(a), ChainState::new(b));
    for _ in 0..100 {
        sa.q = random_q(&mut random, a);
        for (id, value) in a.active_joints().iter().zip(&sa.q) {
            let same = b.joint(&a.joints()[id.0].name).expect("the joint");
            sb.q[b.q_index(same).expect("free")] = *value;
        }
        a.forward(&mut sa);
        b.forward(&mut sb);
        for link in links {
            let pose = |c: &Chain, s: &ChainState| {
                s.link_in_root(c.root()).inverse_mul(&s.link_in_root(c.link(link).unwrap()))
            };
            let (x, y) = (pose(a, &sa), pose(b, &sb));
            worst = worst.max(x.translation.distance(y.translation)).max((x.rotation.inverse() * y.rotation).angle());
        }
    }
    worst
}

#[test]
fn the_derived_3ds_and_glb_are_their_urdf_again_with_a_file_of_joints() {
    let Some(data) = folder::data() else { return };
    for name in ["comau_ns16arc", "staubli_rx160"] {
        let urdf = robot::load(
            &data.join(format!("urdf/{name}/{name}.urdf")),
            &LoadOptions { load_visuals: true, ..LoadOptions::default() },
        )
        .unwrap()
        .robot;
        let side = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(side.path(), joints::to_toml(&urdf.chain)).unwrap();
        let options = LoadOptions { joints: Some(side.path().to_owned()), ..LoadOptions::default() };
        let of =
            |kind: &str| robot::load(&data.join(format!("mesh/derived_{name}/{name}.{kind}")), &options).unwrap().robot;
        let (tds, glb) = (of("3ds"), of("glb"));
        let moving: Vec<&str> = urdf
            .chain
            .joints()
            .iter()
            .filter(|j| j.kind.moves())
            .map(|j| urdf.chain.links()[j.child.0].as_str())
            .collect();
        assert_eq!(moving.len(), 6);
        let (by_tds, by_glb) = (apart(&urdf.chain, &tds.chain, &moving), apart(&urdf.chain, &glb.chain, &moving));
        let every: Vec<&str> =
            urdf.chain.links().iter().map(String::as_str).filter(|l| glb.chain.link(l).is_some()).collect();
        let tools = apart(&urdf.chain, &glb.chain, &every);
        eprintln!(
            "{name}: forward kinematics off its URDF by {by_tds:.1e} (3ds), {by_glb:.1e} (glb), {tools:.1e} (glb, {} links)",
            every.len()
        );
        assert!(by_tds < 1e-6 && by_glb < 1e-6 && tools < 1e-6);
        let mut triangles = 0;
        for link in moving.iter().chain(&["base_link"]) {
            let (a, b) = (solids(&tds, link), solids(&glb, link));
            let off = corners_apart(&a, &b);
            assert!(off < 1e-6, "{name} {link}: {off}");
            triangles += a.len();
            let id = urdf.chain.link(link).unwrap().0;
            let sources = [corners(&urdf.visuals[id]), corners(&urdf.colliders[id])];
            let same = sources.iter().any(|s| s.len() == a.len() && corners_apart(&a, s) < 1e-6);
            assert!(same, "{name} {link}: {} triangles; the URDF has {:?}", a.len(), sources.each_ref().map(Vec::len));
        }
        eprintln!("{name}: {triangles} triangles of 3ds, glb and urdf are the same to 1 µm");
    }
}

/// Differences between the robot and the robot after export and loading.
fn round_trip(robot: &Robot, name: &str, links: &[&str]) -> (f64, f64, f64) {
    let dir = tempfile::tempdir().unwrap();
    let files = robot::write_urdf(robot, dir.path(), name).unwrap();
    let again = robot::load(&files[0], &LoadOptions::default()).unwrap().robot;
    assert_eq!(again.chain.links(), robot.chain.links());
    assert_eq!(again.disabled_pairs.len(), 0);
    for (a, b) in robot.chain.joints().iter().zip(again.chain.joints()) {
        assert_eq!((&a.name, a.kind, a.limits, a.mimic), (&b.name, b.kind, b.limits, b.mimic));
    }
    let mut off: f64 = 0.0;
    for (a, b) in robot.colliders.iter().zip(&again.colliders) {
        assert_eq!(a.len(), b.len());
        off = off.max(corners_apart(&corners(a), &corners(b)));
    }
    let path = dir.path().join(format!("{name}.3ds"));
    std::fs::write(&path, tds::write(&robot::to_tree(robot), &path).unwrap()).unwrap();
    std::fs::write(joints::default_path(&path), joints::to_toml(&robot.chain)).unwrap();
    let by_tds = robot::load(&path, &LoadOptions::default()).unwrap().robot;
    (apart(&robot.chain, &again.chain, links), off, apart(&robot.chain, &by_tds.chain, links))
}

#[test]
fn every_robot_of_the_data_survives_the_export_to_urdf_and_3ds() {
    let Some(data) = folder::data() else { return };
    let mut worst = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut robots = 0;
    for path in folder::files_below(&data.join("urdf")) {
        let folder = path.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy().into_owned();
        if path.file_name().is_none_or(|f| f.to_string_lossy() != format!("{folder}.urdf")) {
            continue;
        }
        let Ok(loaded) = robot::load(&path, &LoadOptions::default()) else { continue };
        let links: Vec<&str> = loaded.robot.chain.links().iter().map(String::as_str).collect();
        let off = round_trip(&loaded.robot, &folder, &links);
        worst = (worst.0.max(off.0), worst.1.max(off.1), worst.2.max(off.2));
        robots += 1;
    }
    eprintln!(
        "{robots} robots: urdf off by {:.1e}, its triangles by {:.1e} m, 3ds off by {:.1e}",
        worst.0, worst.1, worst.2
    );
    assert!(robots > 20);
    assert!(worst.0 < 1e-9, "{worst:?}");
    assert!(worst.1 < 1e-6, "{worst:?}");
    assert!(worst.2 < 5e-6, "{worst:?}");
}

#[test]
fn tracks_alone_carry_axes_and_limits_of_an_exported_robot() {
    let Some(data) = folder::data() else { return };
    let urdf = robot::load(&data.join("urdf/kuka_kr150_2/kuka_kr150_2.urdf"), &LoadOptions::default()).unwrap().robot;
    let loaded = bare(&robot::to_tree(&urdf));
    let chain = &loaded.robot.chain;
    assert_eq!(chain.dof(), urdf.chain.dof());
    for joint in urdf.chain.joints().iter().filter(|j| j.kind.moves()) {
        let link = &urdf.chain.links()[joint.child.0];
        let same = &chain.joints()[chain.parent_joint(chain.link(link).unwrap()).unwrap().0];
        assert_eq!(same.kind, joint.kind);
        // The direction is that of the first motion: upward if the range allows it. Zero is in the range.
        let sense = if joint.limits.upper > 0.0 { 1.0 } else { -1.0 };
        assert!(same.axis.distance(joint.axis * sense) < 1e-5, "{link}: {:?} {:?}", same.axis, joint.axis);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-4;
        let mut range = [joint.limits.lower * sense, joint.limits.upper * sense];
        range.sort_by(f64::total_cmp);
        assert!(near(same.limits.lower, range[0].min(0.0)) && near(same.limits.upper, range[1].max(0.0)), "{link}");
    }
}
