//! 3DS: written trees are read back unchanged, frames follow the format, hostile bytes are refused.

use std::path::Path;

use crate::common::corpus::waving::waving;
use elbowroom_formats::nodetree::{Keyframe, Node, NodeTree};
use elbowroom_formats::{MeshData, mesh, tds};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use proptest::prelude::*;

const FILE: &str = "a.3ds";

fn again(tree: &NodeTree) -> NodeTree {
    let bytes = tds::write(tree, FILE.as_ref()).unwrap();
    tds::parse(&bytes, FILE.as_ref()).unwrap()
}

fn apart(a: &Pose, b: &Pose) -> f64 {
    let turned = (a.rotation.inverse() * b.rotation).to_rotation_vector().length();
    turned.max(a.translation.distance(b.translation))
}

/// Checks that two trees are equal, within single precision and except for the names.
fn assert_same(a: &NodeTree, b: &NodeTree, tolerance: f64) {
    assert_eq!(a.nodes.len(), b.nodes.len());
    for (a, b) in a.nodes.iter().zip(&b.nodes) {
        assert_eq!((&a.name, a.parent), (&b.name, b.parent));
        assert!(apart(&a.in_parent, &b.in_parent) < tolerance, "{}: {:?} {:?}", a.name, a.in_parent, b.in_parent);
        assert_eq!(a.meshes.len(), b.meshes.len(), "{}", a.name);
        for (a, b) in a.meshes.iter().zip(&b.meshes) {
            assert_eq!((a.vertices.len(), &a.triangles), (b.vertices.len(), &b.triangles));
            a.vertices.iter().zip(&b.vertices).for_each(|(a, b)| assert!(a.distance(*b) < tolerance, "{a:?} {b:?}"));
        }
        assert_eq!(a.track.len(), b.track.len(), "{}", a.name);
        for (a, b) in a.track.iter().zip(&b.track) {
            assert!((a.time_s - b.time_s).abs() < 1e-9);
            assert!(apart(&a.in_parent, &b.in_parent) < tolerance, "{a:?} {b:?}");
        }
    }
}

#[test]
fn a_tree_round_trips_with_frames_meshes_and_tracks() {
    let tree = waving();
    assert_same(&tree, &again(&tree), 1e-5);
    assert!(again(&tree).warnings.is_empty());
}

/// Replaces the body of the first chunk that has this number and length.
fn patch(bytes: &mut [u8], head: [u8; 6], body: &[u8]) {
    let at = bytes.windows(6).position(|w| w == head).unwrap();
    bytes[at + 6..at + 6 + body.len()].copy_from_slice(body);
}

fn floats(v: &[f32]) -> Vec<u8> {
    v.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn flag(at: [f64; 3], rpy: [f64; 3]) -> NodeTree {
    let mut tree = NodeTree::new("a");
    let mut node = Node::new("flag", None, Pose::from_xyz_rpy(at, rpy));
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Z];
    node.meshes.push(MeshData { name: "flag".into(), vertices, triangles: vec![[0, 1, 2]] });
    tree.push(node);
    tree
}

#[test]
fn the_pivot_becomes_the_origin_of_the_node() {
    let mut bytes = tds::write(&flag([1.0, 2.0, 3.0], [0.4, 0.5, 0.6]), FILE.as_ref()).unwrap();
    patch(&mut bytes, [0x13, 0xb0, 18, 0, 0, 0], &floats(&[0.25, -0.5, 0.0]));
    let tree = tds::parse(&bytes, FILE.as_ref()).unwrap();
    let v = &tree.nodes[0].meshes[0].vertices;
    assert!(v[0].distance(Vec3::new(-0.25, 0.5, 0.0)) < 1e-6, "{v:?}");
    assert!(tree.nodes[0].in_parent.translation.distance(Vec3::new(1.0, 2.0, 3.0)) < 1e-6);
}

#[test]
fn scale_goes_into_the_meshes_and_frames_stay_rigid() {
    let mut bytes = tds::write(&flag([1.0, 2.0, 3.0], [0.4, 0.5, 0.6]), FILE.as_ref()).unwrap();
    let scale = bytes.windows(2).position(|w| w == [0x22, 0xb0]).unwrap() + 6 + 14 + 6;
    bytes[scale..scale + 12].copy_from_slice(&floats(&[2.0, 1.0, -3.0]));
    let tree = tds::parse(&bytes, FILE.as_ref()).unwrap();
    let world = tree.in_world()[0];
    let right = Pose::from_xyz_rpy([1.0, 2.0, 3.0], [0.4, 0.5, 0.6]);
    let mesh = &tree.nodes[0].meshes[0];
    for (v, scaled) in mesh.vertices.iter().zip([Vec3::ZERO, Vec3::X * 2.0, Vec3::Z * -3.0]) {
        assert!(world.transform_point(*v).distance(right.transform_point(scaled)) < 1e-5);
    }
    assert_eq!(mesh.triangles, [[0, 2, 1]], "a mirror image keeps its outside outside");
}

#[test]
fn the_master_scale_divides_with_a_warning() {
    let mut bytes = tds::write(&flag([1.0, 2.0, 3.0], [0.0; 3]), FILE.as_ref()).unwrap();
    patch(&mut bytes, [0x00, 0x01, 10, 0, 0, 0], &floats(&[4.0]));
    let tree = tds::parse(&bytes, FILE.as_ref()).unwrap();
    assert!(tree.nodes[0].in_parent.translation.distance(Vec3::new(0.25, 0.5, 0.75)) < 1e-6);
    assert!((tree.nodes[0].meshes[0].vertices[1].x - 0.25).abs() < 1e-6);
    assert!(tree.warnings[0].message.contains("master scale 4"), "{:?}", tree.warnings);
}

#[test]
fn large_rotations_between_keys_get_intermediate_keys() {
    let mut tree = flag([0.0; 3], [0.0; 3]);
    let key = |i: u32, angle: f64| Keyframe {
        time_s: f64::from(i),
        in_parent: Pose::new(Rotation::from_axis_angle(Vec3::Z, angle), Vec3::ZERO),
    };
    tree.nodes[0].track = vec![key(0, 0.0), key(1, 1.0)];
    let mut bytes = tds::write(&tree, FILE.as_ref()).unwrap();
    // The second key's angle: six and a half radians, more than a full turn.
    let second = bytes.windows(2).position(|w| w == [0x21, 0xb0]).unwrap() + 6 + 14 + 22 + 6;
    bytes[second..second + 4].copy_from_slice(&6.5f32.to_le_bytes());
    let tree = tds::parse(&bytes, FILE.as_ref()).unwrap();
    let track = &tree.nodes[0].track;
    let total: f64 = track
        .windows(2)
        .map(|w| (w[1].in_parent.rotation * w[0].in_parent.rotation.inverse()).to_rotation_vector().z)
        .sum();
    assert!((total.abs() - 6.5).abs() < 1e-5, "{total}");
}

#[test]
fn meshes_too_large_for_one_object_are_split() {
    let mut tree = NodeTree::new("big");
    let mut node = Node::new("grid", None, Pose::IDENTITY);
    let vertices: Vec<Vec3> =
        (0..300).flat_map(|x| (0..300).map(move |y| Vec3::new(x.into(), y.into(), 0.0))).collect();
    let cell = |x: u32, y: u32| {
        [[x * 300 + y, (x + 1) * 300 + y, x * 300 + y + 1], [(x + 1) * 300 + y, (x + 1) * 300 + y + 1, x * 300 + y + 1]]
    };
    let triangles: Vec<[u32; 3]> = (0..299).flat_map(|x| (0..299).flat_map(move |y| cell(x, y))).collect();
    let count = triangles.len();
    node.meshes.push(MeshData { name: "grid".into(), vertices, triangles });
    tree.push(node);
    let again = again(&tree);
    let corners = |t: &NodeTree| -> Vec<[Vec3; 3]> {
        let meshes = t.nodes.iter().flat_map(|n| &n.meshes);
        meshes.flat_map(|m| m.triangles.iter().map(|t| t.map(|i| m.vertices[i as usize]))).collect()
    };
    assert_eq!(corners(&again).len(), count);
    assert_eq!(corners(&tree), corners(&again));
    assert!(again.nodes.len() > 3 && again.nodes[1..].iter().all(|n| n.parent == Some(0)));
}

#[test]
fn invalid_trees_are_not_written() {
    let mut tree = flag([0.0; 3], [0.0; 3]);
    tree.nodes[0].parent = Some(0);
    assert!(tds::write(&tree, FILE.as_ref()).unwrap_err().to_string().contains("before its parent"));
    let mut tree = flag([0.0; 3], [0.0; 3]);
    tree.nodes[0].meshes[0].triangles[0] = [0, 1, 3];
    assert!(tds::write(&tree, FILE.as_ref()).unwrap_err().to_string().contains("does not exist"));
    let tree = flag([1e39, 0.0, 0.0], [0.0; 3]);
    assert!(tds::write(&tree, FILE.as_ref()).unwrap_err().to_string().contains("cannot hold"));
}

#[test]
fn cycles_and_missing_parents_become_roots_with_a_warning() {
    let bytes = tds::write(&waving(), FILE.as_ref()).unwrap();
    let parents: Vec<usize> =
        bytes.windows(2).enumerate().filter(|(_, w)| *w == [0x10, 0xb0]).map(|(i, _)| i).collect();
    for (wrong, said) in [(1u16, "is its own ancestor"), (77, "does not exist")] {
        let mut bytes = bytes.clone();
        // The name of the second node is `flag`: header, five bytes, two flags.
        let at = parents[1] + 6 + 5 + 4;
        bytes[at..at + 2].copy_from_slice(&wrong.to_le_bytes());
        let tree = tds::parse(&bytes, FILE.as_ref()).unwrap();
        assert_eq!(tree.nodes[1].parent, None);
        assert!(tree.warnings[0].to_string().contains(said), "{:?}", tree.warnings);
    }
}

#[test]
fn a_truncated_file_is_refused_or_read_in_part() {
    let bytes = tds::write(&waving(), FILE.as_ref()).unwrap();
    let whole = tds::parse(&bytes, FILE.as_ref()).unwrap();
    let mut refused = 0;
    for end in 0..bytes.len() {
        match tds::parse(&bytes[..end], FILE.as_ref()) {
            Ok(tree) => assert!(tree.nodes.len() <= whole.nodes.len()),
            Err(e) => {
                assert!(e.hint.is_some(), "{e}");
                refused += 1;
            }
        }
    }
    assert!(refused > bytes.len() / 2, "{refused} of {}", bytes.len());
}

#[test]
fn no_flipped_bit_panics() {
    let bytes = tds::write(&waving(), FILE.as_ref()).unwrap();
    for at in 0..bytes.len() * 8 {
        let mut bytes = bytes.clone();
        bytes[at / 8] ^= 1 << (at % 8);
        if let Ok(tree) = tds::parse(&bytes, FILE.as_ref()) {
            assert!(tree.in_world().iter().all(Pose::is_finite));
        }
    }
}

#[test]
fn a_3ds_file_is_recognized_by_its_content_and_loads_as_a_mesh() {
    let bytes = tds::write(&waving(), FILE.as_ref()).unwrap();
    assert_eq!(mesh::detect(&bytes, "flag".as_ref()).unwrap(), mesh::MeshFormat::Tds);
    let loaded = mesh::parse(&bytes, Path::new("flag"), None, mesh::UpAxis::ToZ).unwrap();
    let world = waving().in_world()[1];
    assert!(loaded.meshes[0].vertices[1].distance(world.transform_point(Vec3::X)) < 1e-5);
    let empty = mesh::parse(b"MM\x06\0\0\0", Path::new("a.3ds"), None, mesh::UpAxis::ToZ).unwrap_err();
    assert!(empty.to_string().contains("no triangles"), "{empty}");
}

fn pose() -> impl Strategy<Value = Pose> {
    let angle = -3.0..3.0;
    ([-2.0..2.0, -2.0..2.0, -2.0..2.0], [angle.clone(), angle.clone(), angle])
        .prop_map(|(xyz, rpy)| Pose::from_xyz_rpy(xyz, rpy))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_tree_round_trips(nodes in prop::collection::vec((pose(), any::<prop::sample::Index>(), pose(), any::<bool>()), 1..12)) {
        let mut tree = NodeTree::new("a");
        for (i, (in_parent, parent, moved, solid)) in nodes.into_iter().enumerate() {
            let parent = parent.index(i + 1).checked_sub(1);
            let mut node = Node::new(format!("n{i}"), parent, in_parent);
            if solid {
                let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Z];
                node.meshes.push(MeshData { name: format!("n{i}"), vertices, triangles: vec![[0, 1, 2]] });
                node.track = vec![Keyframe { time_s: 0.0, in_parent }, Keyframe { time_s: 1.0, in_parent: moved }];
            }
            tree.push(node);
        }
        // Children follow their parents in the order of the file.
        let again = again(&tree);
        for (name, world) in tree.nodes.iter().map(|n| &n.name).zip(tree.in_world()) {
            let i = again.find(name).unwrap();
            prop_assert!(apart(&again.in_world()[i], &world) < 2e-5);
        }
        for node in &tree.nodes {
            let read = &again.nodes[again.find(&node.name).unwrap()];
            prop_assert_eq!(node.parent.map(|p| &tree.nodes[p].name), read.parent.map(|p| &again.nodes[p].name));
            prop_assert_eq!(node.meshes.len(), read.meshes.len());
            for (a, b) in node.meshes.iter().flat_map(|m| &m.vertices).zip(read.meshes.iter().flat_map(|m| &m.vertices)) {
                prop_assert!(a.distance(*b) < 2e-5);
            }
            if let (Some(a), Some(b)) = (node.track.last(), read.track.last()) {
                prop_assert!(apart(&a.in_parent, &b.in_parent) < 2e-5);
            }
        }
    }
}

fn chunk(id: u16, body: &[u8]) -> Vec<u8> {
    let length = u32::try_from(body.len() + 6).unwrap();
    [&id.to_le_bytes()[..], &length.to_le_bytes(), body].concat()
}

/// A top node of the keyframer, with a name and one position key.
fn node(id: u16, name: &str, at: [f32; 3]) -> Vec<u8> {
    let header = chunk(0xb010, &[name.as_bytes(), &[0, 0, 0, 0, 0, 0xff, 0xff]].concat());
    let key = chunk(0xb020, &[&[0; 10][..], &1u32.to_le_bytes(), &[0; 6], &floats(&at)].concat());
    chunk(id, &[header, key].concat())
}

/// An object with three vertices and one face.
fn object(name: &str) -> Vec<u8> {
    let vertices = chunk(0x4110, &[&3u16.to_le_bytes()[..], &floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.])].concat());
    let faces = chunk(0x4120, &[1, 0, 0, 0, 1, 0, 2, 0, 0, 0]);
    let mesh = chunk(0x4100, &[vertices, faces].concat());
    chunk(0x4000, &[name.as_bytes(), &[0], &mesh[..]].concat())
}

/// Searching all nodes for each camera, or for each object, would take 10¹⁰ comparisons here.
#[test]
fn many_thousands_of_cameras_lights_and_objects_are_read_quickly() {
    const MANY: usize = 60_000;
    let mut nodes = Vec::new();
    for i in 0..MANY {
        nodes.extend(node(0xb003, &format!("c{i}"), [0.0; 3]));
        nodes.extend(node(0xb005, &format!("l{i}"), [0.0; 3]));
    }
    for i in (0..MANY).step_by(2) {
        // The target is to the right; a second target with the same name, to the left, is ignored.
        nodes.extend(node(0xb004, &format!("c{i}"), [1.0, 0.0, 0.0]));
        nodes.extend(node(0xb004, &format!("c{i}"), [-1.0, 0.0, 0.0]));
    }
    let objects: Vec<u8> = (0..MANY).flat_map(|i| object(&format!("o{i}"))).collect();
    let bytes = chunk(0x4d4d, &[chunk(0x3d3d, &objects), chunk(0xb000, &nodes)].concat());
    let start = std::time::Instant::now();
    let tree = tds::parse(&bytes, FILE.as_ref()).unwrap();
    let took = start.elapsed();
    // Targets have no children, so they are dropped.
    assert_eq!(tree.nodes.len(), 3 * MANY);
    let look = |i: usize| tree.nodes[2 * i].in_parent.transform_vector(-Vec3::Z);
    assert_eq!(
        (tree.nodes[MANY].name.as_str(), tree.nodes[2 * MANY].name.as_str()),
        (&*format!("c{}", MANY / 2), "o0")
    );
    for i in [0, 2, MANY / 2, MANY - 2] {
        assert!(look(i).distance(Vec3::X) < 1e-6 && look(i + 1).distance(-Vec3::Z) < 1e-6, "{i}: {:?}", look(i));
    }
    assert!(took.as_secs() < 15, "{took:?}");
}

#[test]
fn nodes_of_one_name_are_written_quickly() {
    let mut tree = NodeTree::new("a");
    tree.nodes = vec![Node::new("bolt", None, Pose::IDENTITY); 65_000];
    let start = std::time::Instant::now();
    let bytes = tds::write(&tree, FILE.as_ref()).unwrap();
    let took = start.elapsed();
    assert!(took.as_secs() < 15, "{took:?}");
    assert_eq!(tds::parse(&bytes, FILE.as_ref()).unwrap().nodes[64_999].name, "bolt_65000");
}
