//! The RX60B of the examples, read without the `formats` crate, which depends on this one.

use std::path::Path;
use std::sync::Arc;

use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::{Collider, Robot};

use elbowroom_spatial::{Pose, Vec3};

/// Origin (m), axis, lower and upper limit (rad), as in its URDF.
const JOINTS: [([f64; 3], Vec3, f64, f64); 6] = [
    ([0.0, 0.0, 0.341], Vec3::Z, -2.7925, 2.7925),
    ([0.0, 0.0, 0.0], Vec3::Y, -2.2252, 2.2252),
    ([0.0, 0.049, 0.29], Vec3::Y, -2.3474, 2.3474),
    ([0.0, 0.0, 0.1], Vec3::Z, -4.7123, 4.7123),
    ([0.0, 0.0, 0.21], Vec3::Y, -1.9111, 2.1031),
    ([0.0, 0.0, 0.0], Vec3::Z, -4.7123, 4.7123),
];

pub fn limits() -> impl Iterator<Item = (f64, f64)> {
    JOINTS.iter().map(|j| (j.2, j.3))
}

pub fn robot() -> Robot {
    let joint = |(i, (origin, axis, lower, upper)): (usize, ([f64; 3], Vec3, f64, f64))| Joint {
        name: format!("joint_{}", i + 1),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(origin.into()),
        axis,
        limits: Limits::range(lower, upper),
        mimic: None,
    };
    let names: Vec<String> = (0..7).map(|i| if i == 0 { "base_link".into() } else { format!("link_{i}") }).collect();
    let mut robot =
        Robot::new(Chain::new("rx60b", names.clone(), JOINTS.into_iter().enumerate().map(joint).collect()).unwrap());
    let folder = elbowroom_testkit::folder::examples().join("models/rx60b/meshes");
    for (colliders, name) in robot.colliders.iter_mut().zip(names) {
        let shape = Shape::Mesh(Arc::new(stl(&folder.join(format!("{name}.stl")))));
        colliders.push(Collider { name, shape, in_link: Pose::IDENTITY });
    }
    robot
}

/// Reads a binary STL: a header of 80 bytes, the number of triangles, and 50 bytes each: normal, corners, attribute.
fn stl(file: &Path) -> TriMesh {
    let bytes = std::fs::read(file).unwrap();
    let number = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    let mut known = std::collections::HashMap::new();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for t in 0..(bytes.len() - 84) / 50 {
        triangles.push(std::array::from_fn(|k| {
            let at = 84 + 50 * t + 12 + 12 * k;
            *known.entry(bytes[at..at + 12].to_vec()).or_insert_with(|| {
                vertices.push(Vec3::new(number(at), number(at + 4), number(at + 8)));
                vertices.len() as u32 - 1
            })
        }));
    }
    TriMesh::new(vertices, triangles).unwrap()
}
