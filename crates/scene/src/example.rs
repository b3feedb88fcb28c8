//! A small scene for documentation and first steps.

use elbowroom_kinematics::{Chain, ChainError, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape};
use elbowroom_spatial::{Pose, Vec3};

use crate::{Body, Object, Robot, Scene};

/// A three-joint arm of capsules: turns about z, then bends twice about y. It stands upright at zero.
///
/// # Errors
/// None in fact: the chain is a constant.
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
    let foot = Shape::Cylinder(Cylinder { half_length: 0.08, radius: 0.12 });
    let solids = [
        (foot, Pose::from_translation(Vec3::Z * 0.08)),
        along_z(0.0, 0.12, 0.08),
        along_z(0.05, 0.4, 0.06),
        along_z(0.05, 0.35, 0.05),
    ];
    for (bodies, (shape, in_link)) in robot.bodies.iter_mut().zip(solids) {
        bodies.push(Body { name: String::new(), shape, in_link });
    }
    Ok(robot)
}

/// Two such arms, `left` at the origin and `right` 1.2 m along x, a `part` (object 0) on a `table` (object 1).
///
/// ```
/// let scene = elbowroom_scene::example::two_arms();
/// assert_eq!((scene.robots().len(), scene.objects().len()), (2, 2));
/// println!("{}", scene.pairs().to_text(&scene));
/// ```
#[allow(clippy::missing_panics_doc)]
pub fn two_arms() -> Scene {
    let mut builder = Scene::builder();
    for (name, x) in [("left", 0.0), ("right", 1.2)] {
        // The chain is a constant; a test builds it.
        if let Ok(arm) = arm() {
            builder.robot(name, arm, Pose::from_translation(Vec3::X * x));
        }
    }
    let cuboid = |name: &str, at: [f64; 3], half: [f64; 3]| Object {
        name: name.into(),
        shape: Shape::Cuboid(Cuboid { half_extents: half.into() }),
        in_world: Pose::from_translation(at.into()),
    };
    builder.object(cuboid("part", [0.6, 0.0, 0.351], [0.04, 0.04, 0.05]));
    builder.object(cuboid("table", [0.6, 0.0, 0.2], [0.15, 0.5, 0.1]));
    builder.build().expect("the example is a scene")
}
