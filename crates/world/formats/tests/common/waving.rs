//! A small tree with meshes, hierarchy and animation.

use elbowroom_formats::MeshData;
use elbowroom_formats::nodetree::{Keyframe, Node, NodeTree};
use elbowroom_spatial::{Pose, Rotation, Vec3};

/// A pole with a moving flag.
pub fn waving() -> NodeTree {
    let mut tree = NodeTree::new("waving");
    let pole = tree.push(Node::new("pole", None, Pose::from_xyz_rpy([1.0, 2.0, 3.0], [0.1, -0.2, 0.3])));
    let rest = Pose::from_xyz_rpy([0.0, 0.5, 2.0], [0.0, 0.7, 0.0]);
    let mut flag = Node::new("flag", Some(pole), rest);
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::new(1.0, 0.5, 1.0)];
    flag.meshes.push(MeshData { name: "flag".into(), vertices, triangles: vec![[0, 1, 2], [1, 3, 2]] });
    let key = |i: i32| {
        let turn =
            Pose::new(Rotation::from_axis_angle(Vec3::Y, 0.3 * f64::from(i)), Vec3::new(0.0, 0.0, 0.1 * f64::from(i)));
        Keyframe { time_s: f64::from(i), in_parent: rest * turn }
    };
    flag.track = (0..4).map(key).collect();
    tree.push(flag);
    tree
}
