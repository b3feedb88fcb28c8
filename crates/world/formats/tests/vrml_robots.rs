//! Robots of the data as VRML 2: after writing and reading, every link has its triangles where the URDF has them.

use std::fmt::Write;
use std::path::Path;

use crate::common::solids::{corners, random_q};
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_formats::{joints, vrml};
use elbowroom_kinematics::{Chain, ChainState, JointId, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::Xorshift;
use elbowroom_testkit::{extent, folder};

/// Number of random joint states of a robot.
const STATES: usize = 20;
/// Largest difference of a corner, m.
const SAME_M: f64 = 1e-7;

/// Writes a robot as VRML 2: each link as a `Transform` in that of its parent, with its meshes in millimetres in a scaled
/// `Transform` of its own.
fn write(robot: &Robot) -> String {
    let mut text = String::from("#VRML V2.0 utf8\n");
    let root = robot.chain.root().0;
    link(robot, root, &Pose::IDENTITY, &mut text);
    text
}

fn link(robot: &Robot, index: usize, in_parent: &Pose, text: &mut String) {
    let chain = &robot.chain;
    let name = &chain.links()[index];
    let turn = in_parent.rotation.to_rotation_vector();
    let axis = turn.try_normalize().unwrap_or(Vec3::Z);
    // A centre that the rotation must leave in place.
    let center = Vec3::new(0.3, -0.2, 0.1);
    let shift = in_parent.translation - center + in_parent.rotation * center;
    writeln!(
        text,
        "DEF {name} Transform {{\n  translation {}\n  rotation {} {:?}\n  center {}\n  children [",
        numbers(shift),
        numbers(axis),
        turn.length(),
        numbers(center)
    )
    .unwrap();
    writeln!(text, "  DEF {name}_solid Transform {{ scale 0.001 0.001 0.001 children [").unwrap();
    for collider in &robot.colliders[index] {
        if let Shape::Mesh(mesh) = &collider.shape {
            text.push_str("Shape { geometry IndexedFaceSet { coord Coordinate { point [\n");
            for vertex in mesh.vertices() {
                writeln!(text, "{},", numbers(collider.in_link.transform_point(*vertex) * 1000.0)).unwrap();
            }
            text.push_str("] } coordIndex [\n");
            for [a, b, c] in mesh.triangles() {
                writeln!(text, "{a}, {b}, {c}, -1,").unwrap();
            }
            text.push_str("] } }\n");
        }
    }
    text.push_str("] }\n");
    for joint in chain.joints().iter().filter(|j| j.parent.0 == index) {
        link(robot, joint.child.0, &joint.origin, text);
    }
    text.push_str("] }\n");
}

fn numbers(v: Vec3) -> String {
    format!("{:?} {:?} {:?}", v.x, v.y, v.z)
}

/// The joint values of another chain whose joints have the same names.
fn same_q(from: &Chain, q: &[f64], to: &Chain) -> Vec<f64> {
    let mut values = vec![0.0; to.dof()];
    for (JointId(id), value) in from.active_joints().iter().zip(q) {
        let same = to.joint(&from.joints()[*id].name).expect("the joint");
        values[to.q_index(same).expect("free")] = *value;
    }
    values
}

/// A link of a robot and the same link of its copy.
struct Link {
    id: LinkId,
    copy: LinkId,
    /// Corners of the triangles in the frames of the two links.
    corners: [Vec<[Vec3; 3]>; 2],
}

fn links(urdf: &Robot, wrl: &Robot) -> Vec<Link> {
    let link = |(i, name): (usize, &String)| {
        let copy = wrl.chain.link(&format!("{name}_solid")).expect("a link for each Transform");
        let corners = [corners(&urdf.colliders[i]), corners(&wrl.colliders[copy.0])];
        assert_eq!(corners[0].len(), corners[1].len(), "{name}");
        Link { id: LinkId(i), copy, corners }
    };
    urdf.chain.links().iter().enumerate().map(link).collect()
}

/// Largest distance of a corner of any link between the two robots in one state, m.
fn apart(urdf: &Chain, wrl: &Chain, links: &[Link], q: &[f64]) -> f64 {
    let state = |chain: &Chain, q: Vec<f64>| {
        let mut state = ChainState::new(chain);
        state.q = q;
        chain.forward(&mut state);
        state
    };
    let (a, b) = (state(urdf, q.to_vec()), state(wrl, same_q(urdf, q, wrl)));
    let mut worst: f64 = 0.0;
    for link in links {
        let (x, y) = (a.link_in_root(link.id), b.link_in_root(link.copy));
        let pairs = link.corners[0].iter().flatten().zip(link.corners[1].iter().flatten());
        let off = pairs.map(|(v, w)| x.transform_point(*v).distance(y.transform_point(*w)));
        worst = off.fold(worst, f64::max);
    }
    worst
}

fn has_meshes(robot: &Robot) -> bool {
    robot.colliders.iter().flatten().any(|c| matches!(c.shape, Shape::Mesh(_)))
}

fn load(path: &Path) -> Robot {
    robot::load(path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}")).robot
}

#[test]
fn robots_of_the_data_are_the_same_as_vrml() {
    let dir = tempfile::tempdir().unwrap();
    let mut random = Xorshift(0x9e37_79b9_7f4a_7c15);
    let (mut robots, mut triangles, mut worst) = (0, 0, [0.0_f64; 2]);
    let all = folder::robots(&["urdf"]);
    let count = all.len();
    for path in all {
        if robots == extent::amount(4, usize::MAX) {
            break;
        }
        let urdf = load(&path);
        if !has_meshes(&urdf) {
            continue;
        }
        let file = dir.path().join("robot.wrl");
        std::fs::write(&file, write(&urdf)).unwrap();
        std::fs::write(joints::default_path(&file), joints::to_toml(&urdf.chain)).unwrap();
        let wrl = load(&file);
        assert_eq!(wrl.chain.dof(), urdf.chain.dof(), "{}", path.display());
        let links = links(&urdf, &wrl);
        let apart = |q: &[f64]| apart(&urdf.chain, &wrl.chain, &links, q);
        let at_zero = apart(&vec![0.0; urdf.chain.dof()]);
        let moved = (0..STATES).map(|_| apart(&random_q(&mut random, &urdf.chain))).fold(0.0, f64::max);
        assert!(at_zero < SAME_M && moved < SAME_M, "{}: {at_zero:.1e} m, {moved:.1e} m", path.display());
        worst = [worst[0].max(at_zero), worst[1].max(moved)];
        triangles += links.iter().map(|l| l.corners[0].len()).sum::<usize>();
        robots += 1;
    }
    eprintln!(
        "{robots} robots as VRML, {triangles} triangles: off by {:.1e} m at zero, {:.1e} m in {STATES} states each",
        worst[0], worst[1]
    );
    assert!(count == 0 || robots >= extent::amount(4, 20), "only {robots} robots");
}

/// Files of other programs.
#[test]
fn files_of_other_programs_load_or_say_why_not() {
    let Some(meshes) = folder::data_part("mesh") else { return };
    let read = |name: &str| {
        let file = meshes.join(name);
        vrml::parse(&std::fs::read(&file).unwrap(), &file)
    };
    let wuson = read("formats_a/Wuson.wrl").unwrap();
    let off = elbowroom_formats::mesh::load(&meshes.join("formats_a/Wuson.off"), None).unwrap();
    assert_eq!(wuson.meshes[0].triangles.len(), off.meshes[0].triangles.len());
    // The OFF file has +y up, the VRML file -z.
    let (a, b) = (wuson.aabb(), off.aabb());
    let turned = [Vec3::new(a.min.x, -a.max.z, a.min.y), Vec3::new(a.max.x, -a.min.z, a.max.y)];
    assert!(turned[0].distance(b.min) < 1e-6 && turned[1].distance(b.max) < 1e-6, "{a:?} {b:?}");
    assert!(read("formats_a/HelloWorld.wrl").is_ok());
    let old = read("al5d_klampt_wrl/AL5D/part1.wrl").unwrap_err().to_string();
    assert!(old.contains("part1.wrl:1: is VRML 1.0") && old.contains("VRML97"), "{old}");
}
