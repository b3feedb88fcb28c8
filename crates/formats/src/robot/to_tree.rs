//! A robot as a tree of nodes, to be written as 3DS.

use std::f64::consts::{FRAC_PI_3, TAU};

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind};
use elbowroom_proximity::tessellate::tessellate;
use elbowroom_scene::{Body, Robot};
use elbowroom_spatial::Pose;

use crate::mesh::MeshData;
use crate::nodetree::{Key, Node, NodeTree};

/// Triangles are no farther (m) from curved surfaces.
const CHORD_M: f64 = 1e-4;
/// Between two keys a joint turns no farther (rad), so that the way round stays clear.
const STEP_RAD: f64 = FRAC_PI_3;
/// Stands for an endless slide (m).
const ENDLESS_M: f64 = 1.0;

/// The links as nodes at zero joint values, their solids as meshes, and each joint as a track: from zero to its upper
/// limit, to its lower limit and back, one key per second. A joint that turns endlessly makes one whole turn.
///
/// So the file says where the axes are and how far joints go, and [`load`](super::load) reads the robot from it. What
/// a tree cannot say is lost: names, speeds and mimics of joints (but see [`joints::to_toml`](crate::joints::to_toml)),
/// a joint's sense where it only goes below zero, and the exact surface of spheres, cylinders and capsules (0.1 mm).
///
/// ```
/// use elbowroom_formats::{robot, tds};
/// use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
/// use elbowroom_scene::Robot;
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
    node_of[root.0] = tree.push(node(chain, root.0, None, &robot.bodies[root.0]));
    for &id in chain.topological_order() {
        let joint = &chain.joints()[id.0];
        let child = joint.child.0;
        let mut node = node(chain, child, Some(node_of[joint.parent.0]), &robot.bodies[child]);
        node.in_parent = joint.origin;
        node.track = track(chain, id, joint);
        node_of[child] = tree.push(node);
    }
    tree
}

fn node(chain: &Chain, link: usize, parent: Option<usize>, bodies: &[Body]) -> Node {
    let name = &chain.links()[link];
    let mut node = Node::new(name, parent, Pose::IDENTITY);
    node.meshes = meshes(name, bodies);
    node
}

/// Solids as triangles in the link's frame; called after the link, and numbered where there are several.
pub(super) fn meshes(link: &str, bodies: &[Body]) -> Vec<MeshData> {
    let mesh = |(i, body): (usize, &Body)| {
        let (vertices, triangles) = tessellate(&body.shape, CHORD_M);
        let vertices = vertices.into_iter().map(|v| body.in_link.transform_point(v)).collect();
        let name = if bodies.len() == 1 { link.to_owned() } else { format!("{link}_{}", i + 1) };
        MeshData { name, vertices, triangles }
    };
    bodies.iter().enumerate().map(mesh).collect()
}

fn track(chain: &Chain, id: JointId, joint: &Joint) -> Vec<Key> {
    let stops = match joint.kind {
        JointKind::Fixed => return Vec::new(),
        JointKind::Continuous => vec![0.0, TAU],
        JointKind::Revolute | JointKind::Prismatic => {
            let end = |x: f64| if x.is_finite() { x } else { ENDLESS_M.copysign(x) };
            vec![0.0, end(joint.limits.upper), end(joint.limits.lower), 0.0]
        }
    };
    let mut values = vec![0.0];
    for ends in stops.windows(2) {
        let way = ends[1] - ends[0];
        let parts = if joint.kind.turns() { (way.abs() / STEP_RAD).ceil().max(1.0) } else { 1.0 };
        values.extend((1..=parts as usize).map(|i| ends[0] + way * i as f64 / parts));
    }
    let key =
        |(second, value): (usize, f64)| Key { time_s: second as f64, in_parent: chain.child_in_parent(id, value) };
    values.into_iter().enumerate().map(key).collect()
}
