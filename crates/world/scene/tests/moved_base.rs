//! A scene with a robot at another place answers like a scene that was built with the robot there.

use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Reason, Scene, SceneError};
use elbowroom_spatial::{Pose, Vec3};

use crate::common::{Random, RandomGeometry, all_distances, random_state, scene_of};

fn proven(scene: &Scene) -> usize {
    let entries = scene.allowed_collision_matrix().entries().iter();
    entries.filter(|entry| matches!(entry.reason, Reason::OutOfReach { .. })).count()
}

#[test]
fn every_distance_is_that_of_the_robot_at_its_new_place() {
    let mut r = Random(7);
    // Far apart, so that pairs of the two arms are proven out of reach of each other, which is no longer true later.
    let far = scene_of(3, |_| ()).with_base(RobotId(1), Pose::from_translation(Vec3::X * 9.0)).unwrap();
    let mut builder = Scene::builder();
    for robot in far.robots() {
        builder.robot(robot.name.clone(), robot.robot.clone(), robot.base_in_world);
    }
    far.objects().iter().for_each(|object| {
        builder.object(object.clone());
    });
    let far = builder.build().unwrap();
    let (mut hits, mut free, mut proofs_lost) = (0, 0, 0);
    for _ in 0..60 {
        let mut base = r.pose(0.4);
        base.translation += Vec3::X * 0.6;
        let scene = far.with_base(RobotId(1), base).unwrap();
        assert_eq!(scene.robots()[1].base_in_world.translation, base.translation);
        proofs_lost += proven(&far) - proven(&scene);
        let state = random_state(&scene, &mut r);
        let expected = all_distances(&scene, &state, |_| 0.0).into_iter().map(|found| found.2);
        let expected = expected.fold(f64::INFINITY, f64::min);
        let mut checker = Checker::new(&scene, CheckerOptions::default());
        let found = checker.distance(&state).unwrap().metres;
        assert!((found - expected).abs() <= 1e-7, "{found} m, directly {expected} m");
        assert!(expected.abs() < 1e-9 || (checker.collides(&state).is_some() == (expected == 0.0)));
        if expected == 0.0 { hits += 1 } else { free += 1 }
    }
    assert!(hits > 5 && free > 5 && proofs_lost > 100, "{hits} {free} {proofs_lost}");
}

#[test]
fn a_robot_that_is_not_there_and_a_pose_that_is_none_are_refused() {
    let scene = scene_of(3, |_| ());
    let nowhere = Pose::from_translation(Vec3::X * f64::NAN);
    assert!(
        matches!(scene.with_base(RobotId(0), nowhere), Err(SceneError::PoseNotFinite(name)) if name.contains("meshes"))
    );
    assert!(matches!(scene.with_base(RobotId(2), Pose::IDENTITY), Err(SceneError::NoSuchRobot { index: 2, count: 2 })));
}
