//! Converts a robot to a tree of nodes, for export as 3DS.

use std::f64::consts::{FRAC_PI_3, TAU};

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind};
use elbowroom_proximity::tessellate::tessellate;
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::Pose;

use crate::mesh_data::MeshData;
use crate::nodetree::{Keyframe, Node, NodeTree};

/// Largest distance of triangles from curved surfaces, m.
const MAX_CHORD_ERROR_M: f64 = 1e-4;
/// Largest rotation between two keys, rad, so that its direction is unambiguous.
const MAX_KEY_STEP_RAD: f64 = FRAC_PI_3;
/// Limit that replaces the limit of an unlimited prismatic joint, m.
const UNLIMITED_M: f64 = 1.0;

/// Converts a robot to a tree: links as nodes at zero joint values, geometry as meshes, and each joint as a track.
///
/// A track goes from zero to the upper limit, to the lower limit and back, with one key per second. A continuous joint
/// makes one whole turn.
///
/// So the file contains axes and limits of joints, and [`load`](super::load) can read the robot from it. Data that a tree
/// cannot contain are lost: names, speeds and mimics of joints (but see [`joints::to_toml`](crate::joints::to_toml)), the
/// direction of a joint whose range is below zero, and the exact surface of spheres, cylinders and capsules (0.1 mm).
///
/// ```
/// use elbowroom_formats::{robot, tds};
/// use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
/// use elbowroom_robot::Robot;
/// let row = ClassicalRow {
///     joint: "turn".into(), kind: JointKind::Revolute, a: 0.3, alpha: 0.0, d: 0.5, theta: 0.0,
///     limits: Limits::symmetric(2.5),
/// };
/// let robot = Robot::new(Chain::from_dh("one", &[row])?);
/// let bytes = tds::write(&robot::to_tree(&robot), "one.3ds".as_ref())?;
/// # assert!(bytes.len() > 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_tree(robot: &Robot) -> NodeTree {
    let chain = &robot.chain;
    let mut tree = NodeTree::new(chain.name());
    let mut node_of = vec![0; chain.links().len()];
    let root = chain.root();
    node_of[root.0] = tree.push(node(chain, root.0, None, &robot.colliders[root.0]));
    for &id in chain.topological_order() {
        let joint = &chain.joints()[id.0];
        let child = joint.child.0;
        let mut node = node(chain, child, Some(node_of[joint.parent.0]), &robot.colliders[child]);
        node.in_parent = joint.origin;
        node.track = track(chain, id, joint);
        node_of[child] = tree.push(node);
    }
    tree
}

fn node(chain: &Chain, link: usize, parent: Option<usize>, colliders: &[Collider]) -> Node {
    let name = &chain.links()[link];
    let mut node = Node::new(name, parent, Pose::IDENTITY);
    node.meshes = meshes(name, colliders);
    node
}

/// Colliders as triangles in the link's frame, named after the link and numbered if there are several.
pub(super) fn meshes(link: &str, colliders: &[Collider]) -> Vec<MeshData> {
    let mesh = |(i, collider): (usize, &Collider)| {
        let (vertices, triangles) = tessellate(&collider.shape, MAX_CHORD_ERROR_M);
        let vertices = vertices.into_iter().map(|v| collider.in_link.transform_point(v)).collect();
        let name = if colliders.len() == 1 { link.to_owned() } else { format!("{link}_{}", i + 1) };
        MeshData { name, vertices, triangles }
    };
    colliders.iter().enumerate().map(mesh).collect()
}

fn track(chain: &Chain, id: JointId, joint: &Joint) -> Vec<Keyframe> {
    let stops = match joint.kind {
        JointKind::Fixed => return Vec::new(),
        JointKind::Continuous => vec![0.0, TAU],
        JointKind::Revolute | JointKind::Prismatic => {
            let end = |x: f64| if x.is_finite() { x } else { UNLIMITED_M.copysign(x) };
            vec![0.0, end(joint.limits.upper), end(joint.limits.lower), 0.0]
        }
    };
    let mut values = vec![0.0];
    for ends in stops.windows(2) {
        let distance = ends[1] - ends[0];
        let parts = if joint.kind.turns() { (distance.abs() / MAX_KEY_STEP_RAD).ceil().max(1.0) } else { 1.0 };
        values.extend((1..=parts as usize).map(|i| ends[0] + distance * i as f64 / parts));
    }
    let key =
        |(second, value): (usize, f64)| Keyframe { time_s: second as f64, in_parent: chain.child_in_parent(id, value) };
    values.into_iter().enumerate().map(key).collect()
}
