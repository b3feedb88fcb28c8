//! Proofs by one value of a joint: thin plates that fold through each other at every roll, and rods that pass beside
//! each other.

use std::sync::Arc;
use std::time::Duration;

use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
use elbowroom_planner::{
    CoverModel, CoverObstacles, CoverRrtConnect, JointPath, RrtConnect, RrtConnectError, RrtConnectSettings,
};
use elbowroom_proximity::tessellate::tessellate;
use elbowroom_proximity::{Cuboid, Shape, Sphere, TriMesh};
use elbowroom_robot::{Collider, Robot, RobotId};
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::{Pose, Vec3};

/// An upper arm along z, and a forearm that folds back onto it at the elbow value π and turns about its own axis.
fn folding_arm(upper_arm: Shape, forearm: Shape, forearm_offset: Vec3) -> Robot {
    let joint = |name: &str, i: usize, at: Vec3, axis: Vec3, lower: f64, upper: f64| Joint {
        name: name.into(),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(at),
        axis,
        limits: Limits { lower, upper, ..Limits::symmetric(1.0) },
        mimic: None,
    };
    let joints = vec![
        joint("waist", 0, Vec3::ZERO, Vec3::Z, -3.0, 3.0),
        joint("elbow", 1, Vec3::Z * 0.6, Vec3::Y, -1.0, 5.0),
        joint("roll", 2, Vec3::ZERO, Vec3::Z, -3.3, 3.3),
    ];
    let links = ["base", "upper_arm", "elbow", "forearm"].map(String::from).to_vec();
    let mut robot = Robot::new(Chain::new("folding", links, joints).unwrap());
    let mut add = |link: usize, shape: Shape, at: Vec3| {
        robot.colliders[link].push(Collider { name: String::new(), shape, in_link: Pose::from_translation(at) });
    };
    add(1, upper_arm, Vec3::Z * 0.3);
    // Ensures that the forearm is not the upper arm's neighbour.
    add(2, Shape::Sphere(Sphere { radius: 0.01 }), Vec3::Y * 0.3);
    add(3, forearm, forearm_offset + Vec3::Z * 0.3);
    robot
}

fn plate(half_extents: Vec3) -> Shape {
    let (vertices, triangles) = tessellate(&Shape::Cuboid(Cuboid { half_extents }), 1e-3);
    Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()))
}

fn plan(robot: Robot, from: &[f64], to: &[f64]) -> Result<JointPath, RrtConnectError> {
    let mut builder = Scene::builder();
    builder.robot("arm", robot, Pose::IDENTITY);
    let scene = builder.build().unwrap();
    let mut start = SceneState::new(&scene);
    start.set_q(&scene, RobotId(0), from).unwrap();
    let model = CoverModel::new(&scene, &start, RobotId(0), 0.0).unwrap();
    let obstacles = CoverObstacles::new(&model, &scene, &start, 0.0);
    let exact = RrtConnect::new(&scene, RobotId(0)).unwrap();
    let settings = RrtConnectSettings { time_limit: Duration::from_secs(6), ..RrtConnectSettings::default() };
    CoverRrtConnect::new(exact, &model, &obstacles).plan(&start, to, &settings)
}

#[test]
fn thin_plates_that_meet_at_every_roll_separate() {
    // 6 mm thick: too thin for spheres inside to prove much.
    let thin = || plate(Vec3::new(0.05, 0.003, 0.2));
    let error = plan(folding_arm(thin(), thin(), Vec3::ZERO), &[0.0, 2.0, 0.3], &[0.5, 4.3, -0.4]).unwrap_err();
    let RrtConnectError::Disconnected { joints, .. } = &error else { panic!("{error}") };
    assert_eq!(joints, &["elbow"], "{error}");
    assert!(error.to_string().contains("`elbow` cannot get from start to goal"), "{error}");
}

#[test]
fn boxes_that_meet_at_every_roll_separate() {
    let solid = || Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.05, 0.02, 0.2) });
    let error = plan(folding_arm(solid(), solid(), Vec3::ZERO), &[0.0, 2.0, 0.3], &[0.5, 4.3, -0.4]).unwrap_err();
    assert!(matches!(error, RrtConnectError::Disconnected { .. }), "{error}");
}

#[test]
fn a_rod_that_passes_at_one_roll_separates_nothing() {
    let rod = || plate(Vec3::new(0.01, 0.01, 0.2));
    let path = plan(folding_arm(rod(), rod(), Vec3::X * 0.03), &[0.0, 2.0, 0.0], &[0.5, 4.3, 0.0]).unwrap();
    assert!(path.waypoints.len() > 2, "{path:?}");
}
