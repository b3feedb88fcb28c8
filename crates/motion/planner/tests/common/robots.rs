//! Robots with more joints and with joints of other kinds, among obstacles.

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, Cuboid, Shape};
use elbowroom_robot::{Collider, Robot, RobotId, example};
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState, Selection};
use elbowroom_spatial::{Pose, Vec3};
pub use elbowroom_testkit::random::Random;

/// Joint values at which the robot is free.
pub fn free_values(random: &mut Random, scene: &Scene, robot: RobotId) -> Option<Vec<f64>> {
    let chain = &scene.robots()[robot.0].robot.chain;
    let mut checker = Checker::new(scene, CheckerOptions::default());
    (0..500).find_map(|_| {
        let each = chain.lower().into_iter().zip(chain.upper());
        let q: Vec<f64> = each.map(|(l, u)| l.max(-3.0) + (u.min(3.0) - l.max(-3.0)) * random.unit()).collect();
        let state = state_at(scene, robot, &q);
        checker.between(Selection::Robot(robot), Selection::All).within(&state, 1e-3).is_none().then_some(q)
    })
}

/// One robot at a configuration, all others at zero.
pub fn state_at(scene: &Scene, robot: RobotId, q: &[f64]) -> SceneState {
    let mut state = SceneState::new(scene);
    state.set_q(scene, robot, q).unwrap();
    state
}

pub fn within_limits(scene: &Scene, robot: RobotId, q: &[f64]) -> bool {
    let chain = &scene.robots()[robot.0].robot.chain;
    q.iter().zip(chain.lower().iter().zip(chain.upper())).all(|(q, (l, u))| *q >= l - 1e-12 && *q <= u + 1e-12)
}

fn cuboid(name: &str, at: [f64; 3], half: [f64; 3]) -> Object {
    let shape = Shape::Cuboid(Cuboid { half_extents: half.into() });
    Object { name: name.into(), shape, in_world: Pose::from_translation(at.into()) }
}

fn scene(robot: Robot, objects: Vec<Object>) -> Scene {
    let mut builder = Scene::builder();
    builder.robot("robot", robot, Pose::IDENTITY);
    for o in objects {
        builder.object(o);
    }
    builder.build().unwrap()
}

/// A serial robot of capsules along z, given by the kinds, axes and limits of its joints.
fn serial(joints: &[(JointKind, Vec3, f64, f64)], length: f64, mimic: Option<(usize, Mimic)>) -> Robot {
    let joint = |(i, (kind, axis, low, high)): (usize, &(JointKind, Vec3, f64, f64))| Joint {
        name: format!("j{i}"),
        kind: *kind,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(Vec3::Z * if i == 0 { 0.1 } else { length }),
        axis: *axis,
        limits: Limits::range(*low, *high),
        mimic: mimic.filter(|m| m.0 == i).map(|m| m.1),
    };
    let links = (0..=joints.len()).map(|i| format!("l{i}")).collect();
    let joints = joints.iter().enumerate().map(joint).collect();
    let mut robot = Robot::new(Chain::new("serial", links, joints).unwrap());
    for colliders in robot.colliders.iter_mut().skip(1) {
        let shape = Shape::Capsule(Capsule { half_length: 0.4 * length, radius: 0.03 });
        colliders.push(Collider {
            name: String::new(),
            shape,
            in_link: Pose::from_translation(Vec3::Z * 0.5 * length),
        });
    }
    robot
}

/// Seven joints, one of them continuous, in front of shelves.
pub fn cabinet() -> Scene {
    let revolute = |axis, bound: f64| (JointKind::Revolute, axis, -bound, bound);
    let continuous = (JointKind::Continuous, Vec3::Z, 0.0, 0.0);
    let (y, z) = (Vec3::Y, Vec3::Z);
    let robot = serial(
        &[
            continuous,
            revolute(y, 2.0),
            revolute(z, 2.9),
            revolute(y, 2.2),
            revolute(z, 2.9),
            revolute(y, 2.2),
            revolute(z, 2.9),
        ],
        0.17,
        None,
    );
    let boards = [0.15, 0.5, 0.85].map(|h| cuboid(&format!("board {h}"), [0.65, 0.0, h], [0.15, 0.4, 0.01]));
    let sides = [-0.41, 0.41].map(|y| cuboid(&format!("side {y}"), [0.65, y, 0.5], [0.15, 0.01, 0.4]));
    let post = cuboid("post", [-0.3, 0.3, 0.5], [0.03, 0.03, 0.6]);
    let floor = cuboid("floor", [0.0, 0.0, -0.06], [1.5, 1.5, 0.05]);
    scene(robot, boards.into_iter().chain(sides).chain([post, floor]).collect())
}

/// Two prismatic joints, a continuous joint, and an arm whose last joint mimics the one before.
pub fn crane() -> Scene {
    let prismatic = |axis, low, high| (JointKind::Prismatic, axis, low, high);
    let revolute = |axis, bound: f64| (JointKind::Revolute, axis, -bound, bound);
    let mimic = Mimic { joint: JointId(3), multiplier: -0.5, offset: 0.1 };
    let joints = [
        prismatic(Vec3::X, -1.0, 1.0),
        prismatic(Vec3::Y, -0.8, 0.8),
        (JointKind::Continuous, Vec3::Z, 0.0, 0.0),
        revolute(Vec3::Y, 2.4),
        revolute(Vec3::Y, 2.4),
    ];
    let robot = serial(&joints, 0.3, Some((4, mimic)));
    let posts = [(-0.5, 0.1), (0.4, -0.4), (0.3, 0.5), (0.0, -0.1)];
    let posts = posts.map(|(x, y)| cuboid(&format!("post {x}"), [x, y, 0.9], [0.04, 0.04, 0.5]));
    scene(robot, posts.to_vec())
}

/// The example's arm; walls on both sides of the waist and above the shoulder separate it from the other half of its
/// workspace.
pub fn halved() -> Scene {
    let walls = [
        cuboid("right", [0.65, 0.0, 1.0], [0.55, 0.005, 1.0]),
        cuboid("left", [-0.65, 0.0, 1.0], [0.55, 0.005, 1.0]),
        cuboid("above", [0.0, 0.0, 1.3], [0.1, 0.005, 0.7]),
    ];
    scene(example::arm().unwrap(), walls.to_vec())
}

/// The example's arm, and an upright sheet, a tenth of a millimetre thick, in front of it.
pub fn sheet() -> Scene {
    scene(example::arm().unwrap(), vec![cuboid("sheet", [0.55, 0.0, 0.35], [0.35, 0.000_05, 0.35])])
}
