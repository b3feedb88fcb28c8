//! A small robot for documentation, tests and first steps.

use elbowroom_kinematics::{Chain, ChainError, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Capsule, Cylinder, Shape};
use elbowroom_spatial::{Pose, Vec3};

use crate::{Collider, Robot};

/// A three-joint arm of capsules: the first joint rotates about z, the other two about y. At joint values 0 it is
/// upright.
///
/// # Errors
/// Never fails: the chain is a constant.
pub fn arm() -> Result<Robot, ChainError> {
    let joint = |name: &str, i: usize, height: f64, axis: Vec3, bound: f64| Joint {
        name: name.into(),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(Vec3::Z * height),
        axis,
        limits: Limits::symmetric(bound),
        mimic: None,
    };
    let joints = vec![
        joint("waist", 0, 0.2, Vec3::Z, 3.0),
        joint("shoulder", 1, 0.15, Vec3::Y, 2.2),
        joint("elbow", 2, 0.45, Vec3::Y, 2.5),
    ];
    let links = ["base", "column", "upper_arm", "forearm"].map(String::from).to_vec();
    let mut robot = Robot::new(Chain::new("arm", links, joints)?);
    let along_z = |from: f64, to: f64, radius: f64| {
        let half_length = 0.5 * (to - from);
        (Shape::Capsule(Capsule { half_length, radius }), Pose::from_translation(Vec3::Z * (from + half_length)))
    };
    let base = Shape::Cylinder(Cylinder { half_length: 0.08, radius: 0.12 });
    let shapes = [
        (base, Pose::from_translation(Vec3::Z * 0.08)),
        along_z(0.0, 0.12, 0.08),
        along_z(0.05, 0.4, 0.06),
        along_z(0.05, 0.35, 0.05),
    ];
    for (colliders, (shape, in_link)) in robot.colliders.iter_mut().zip(shapes) {
        colliders.push(Collider { name: String::new(), shape, in_link });
    }
    Ok(robot)
}
