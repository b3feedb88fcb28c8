//! Comparison of 3DS files with assimp.
//!
//! Needs the program `assimp` (in the package `cmeel-assimp`, which `pin` installs), in the directory of the Python given
//! by `ELBOWROOM_PYTHON` or on the search path. Without it the test prints a message and passes.

use std::path::{Path, PathBuf};
use std::process::Command;

use elbowroom_formats::nodetree::{Keyframe, Node, NodeTree};
use elbowroom_formats::{MeshData, tds};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::folder;
use serde_json::Value;

type Matrix = [[f64; 4]; 3];

/// Path of the program; `None` and a message if it is missing.
fn assimp() -> Option<PathBuf> {
    let beside = std::env::var_os("ELBOWROOM_PYTHON").map(|p| PathBuf::from(p).with_file_name("assimp"));
    let beside = beside.filter(|p| p.is_file()).unwrap_or_else(|| "assimp".into());
    if Command::new(&beside).arg("version").output().is_ok_and(|o| o.status.success()) {
        return Some(beside);
    }
    eprintln!("skipped: no program `assimp`; name a Python that has `pin` in ELBOWROOM_PYTHON");
    None
}

/// A node as read by assimp: name, name of its parent, frame in the world (z up), triangles in the world.
struct Theirs {
    name: String,
    parent: Option<String>,
    in_world: Matrix,
    triangles: Vec<[Vec3; 3]>,
}

fn after(a: &Matrix, b: &Matrix) -> Matrix {
    let mut out = [[0.0; 4]; 3];
    for (row, left) in out.iter_mut().zip(a) {
        for (c, cell) in row.iter_mut().enumerate() {
            *cell = (0..3).map(|k| left[k] * b[k][c]).sum::<f64>() + if c == 3 { left[3] } else { 0.0 };
        }
    }
    out
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

fn matrix(value: &Value) -> Matrix {
    let n = numbers(value);
    [0, 4, 8].map(|i| [n[i], n[i + 1], n[i + 2], n[i + 3]])
}

fn point(m: &Matrix, p: Vec3) -> Vec3 {
    Vec3::from(m.map(|[x, y, z, t]| x * p.x + y * p.y + z * p.z + t))
}

fn triangles(mesh: &Value) -> Vec<[Vec3; 3]> {
    let vertices = numbers(&mesh["vertices"]);
    let corner = |i: &Value| {
        let i = 3 * i.as_u64().unwrap() as usize;
        Vec3::new(vertices[i], vertices[i + 1], vertices[i + 2])
    };
    let faces = mesh["faces"].as_array().unwrap();
    faces
        .iter()
        .filter_map(Value::as_array)
        .filter(|f| f.len() == 3)
        .map(|f| [corner(&f[0]), corner(&f[1]), corner(&f[2])])
        .collect()
}

fn read(program: &Path, file: &Path) -> Vec<Theirs> {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out.assjson");
    let status = Command::new(program).arg("export").arg(file).arg(&out).arg("-fassjson").output().unwrap();
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stdout));
    let scene: Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
    let meshes: Vec<_> = scene["meshes"].as_array().unwrap().iter().map(triangles).collect();
    // Assimp rotates y up; this rotates z up.
    let upright = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
    let root = after(&upright, &matrix(&scene["rootnode"]["transformation"]));
    let mut all = Vec::new();
    let mut waiting = vec![(&scene["rootnode"], None::<String>, root)];
    while let Some((node, parent, frame)) = waiting.pop() {
        let name = node["name"].as_str().unwrap().to_owned();
        for child in node["children"].as_array().into_iter().flatten() {
            let is_top = parent.is_none() && name.starts_with("<3DS");
            let in_world = after(&frame, &matrix(&child["transformation"]));
            waiting.push((child, (!is_top).then(|| name.clone()), in_world));
        }
        let shown = numbers(&node["meshes"]).into_iter().flat_map(|m| &meshes[m as usize]);
        let triangles = shown.map(|t| t.map(|v| point(&frame, v))).collect();
        if !name.starts_with("<3DS") {
            all.push(Theirs { name, parent, in_world: frame, triangles });
        }
    }
    all
}

/// Triangles of a node in the world.
fn ours(node: &Node, in_world: &Pose) -> Vec<[Vec3; 3]> {
    let of = |m: &MeshData| {
        m.triangles.iter().map(|t| t.map(|i| in_world.transform_point(m.vertices[i as usize]))).collect::<Vec<_>>()
    };
    node.meshes.iter().flat_map(of).collect()
}

/// Checks that every triangle of one list is in the other, with the same winding.
fn assert_same_triangles(a: &[[Vec3; 3]], b: &[[Vec3; 3]], tolerance: f64, name: &str) {
    assert_eq!(a.len(), b.len(), "{name}");
    let same =
        |a: &[Vec3; 3], b: &[Vec3; 3]| (0..3).any(|turn| (0..3).all(|i| a[i].distance(b[(i + turn) % 3]) < tolerance));
    for t in a {
        assert!(b.iter().any(|other| same(t, other)), "{name}: {t:?} is not among {:?}…", b.first());
    }
}

fn largest(tree: &NodeTree) -> f64 {
    tree.aabb().extent().max_element().max(1.0)
}

#[test]
fn the_nine_files_are_read_as_assimp_reads_them() {
    let Some(data) = folder::data() else { return };
    let Some(program) = assimp() else { return };
    let files = folder::files_below(&data.join("mesh/3ds_assimp"));
    let files: Vec<_> = files.iter().filter(|f| f.extension().is_some_and(|e| e.eq_ignore_ascii_case("3ds"))).collect();
    assert_eq!(files.len(), 9);
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let tree = tds::parse(&std::fs::read(file).unwrap(), file).unwrap();
        let theirs = read(&program, file);
        assert_eq!(tree.nodes.len(), theirs.len(), "{name}");
        let tolerance = 1e-5 * largest(&tree);
        let (mut objects, mut triangles) = (0, 0);
        for (node, in_world) in tree.nodes.iter().zip(tree.in_world()) {
            // Assimp names objects by number if the file has no keyframer.
            let same = |t: &&Theirs| t.name == node.name || (theirs.len() == 1 && t.name == "3DSMesh_0");
            let their = theirs.iter().find(same).unwrap_or_else(|| panic!("{name}: {}", node.name));
            let parent = node.parent.map(|p| tree.nodes[p].name.clone());
            assert_eq!(parent, their.parent, "{name}: {}", node.name);
            let here = ours(node, &in_world);
            objects += node.meshes.len();
            triangles += here.len();
            if parent.as_deref() == Some("Camera01") {
                // Assimp ignores the targets of cameras, and so displaces their children. The object was saved at the
                // first frame: its vertices in the file are the ground truth.
                assert_eq!(here.len(), their.triangles.len());
                assert!(node.track.is_empty(), "its keys are in the frame of a camera that moves");
                let saved = Vec3::new(-54.409_576, -97.347_855, 1.635_066);
                assert!(here.iter().flatten().any(|v| v.distance(saved) < 1e-3), "{here:?}");
                continue;
            }
            let origin = Vec3::from(their.in_world.map(|row| row[3]));
            assert!(in_world.translation.distance(origin) < tolerance, "{name}: {}", node.name);
            assert_same_triangles(&here, &their.triangles, tolerance, &format!("{name}: {}", node.name));
        }
        eprintln!("{name}: {} nodes, {objects} objects, {triangles} triangles as assimp reads them", tree.nodes.len());
    }
}

/// Three links with rotated and scaled frames, and pivots.
fn chain() -> Vec<u8> {
    let mut tree = NodeTree::new("chain");
    for i in 0..3_u32 {
        let x = f64::from(i);
        let in_parent = Pose::from_xyz_rpy([0.3, 0.2 * x, 0.5], [0.4 * x, -0.3, 0.7]);
        let mut node = Node::new(format!("n{i}"), i.checked_sub(1).map(|p| p as usize), in_parent);
        let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y * 0.5, Vec3::Z * 0.2];
        node.meshes.push(MeshData { name: node.name.clone(), vertices, triangles: vec![[0, 1, 2], [0, 3, 1]] });
        let turned = Pose::new(in_parent.rotation * Rotation::from_axis_angle(Vec3::Z, 0.5), in_parent.translation);
        node.track = vec![Keyframe { time_s: 0.0, in_parent }, Keyframe { time_s: 1.0, in_parent: turned }];
        tree.push(node);
    }
    let mut bytes = tds::write(&tree, "chain.3ds".as_ref()).unwrap();
    let mut at = |id: [u8; 2], skip: usize, values: &[f32]| {
        let places: Vec<usize> = bytes.windows(2).enumerate().filter(|(_, w)| *w == id).map(|(i, _)| i).collect();
        for (i, place) in places.into_iter().enumerate() {
            let values = values.iter().map(|v| v * (1.0 + 0.1 * i as f32));
            let new: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
            bytes[place + skip..place + skip + new.len()].copy_from_slice(&new);
        }
    };
    at([0x13, 0xb0], 6, &[0.1, -0.2, 0.3]);
    at([0x22, 0xb0], 26, &[1.5, 1.5, 1.5]);
    bytes
}

#[test]
fn pivots_scales_and_the_master_scale_are_as_assimp_has_them() {
    let Some(program) = assimp() else { return };
    let dir = tempfile::tempdir().unwrap();
    for master in [1.0_f32, 4.0, 0.0] {
        let mut bytes = chain();
        let at = bytes.windows(6).position(|w| w == [0x00, 0x01, 10, 0, 0, 0]).unwrap();
        bytes[at + 6..at + 10].copy_from_slice(&master.to_le_bytes());
        let file = dir.path().join("chain.3ds");
        std::fs::write(&file, &bytes).unwrap();
        let tree = tds::parse(&bytes, &file).unwrap();
        let theirs = read(&program, &file);
        for (node, in_world) in tree.nodes.iter().zip(tree.in_world()) {
            let their = theirs.iter().find(|t| t.name == node.name).unwrap();
            let origin = Vec3::from(their.in_world.map(|row| row[3]));
            assert!(
                in_world.translation.distance(origin) < 1e-4,
                "{master} {}: {:?} {origin:?}",
                node.name,
                in_world.translation
            );
            assert_same_triangles(&ours(node, &in_world), &their.triangles, 1e-4, &node.name);
        }
    }
}
