//! Proofs that no path exists: they succeed if walls divide the joint space, and never contradict a known path.

use std::time::{Duration, Instant};

use crate::common::covers::KeptCovers;
use elbowroom_kinematics::LinkId;
use elbowroom_planner::{
    CoverModel, CoverObstacles, CoverRrtConnect, JointPath, RrtConnect, RrtConnectError, RrtConnectSettings,
};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::{GeometryId, RobotId, example};
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::SplitMix;

const ROBOT: RobotId = RobotId(0);

fn scene(boxes: &[(Vec3, Vec3)]) -> Scene {
    let mut builder = Scene::builder();
    builder.robot("arm", example::arm().unwrap(), Pose::IDENTITY);
    for (i, &(at, half_extents)) in boxes.iter().enumerate() {
        let shape = Shape::Cuboid(Cuboid { half_extents });
        builder.object(Object { name: format!("box {i}"), shape, in_world: Pose::from_translation(at) });
    }
    builder.build().unwrap()
}

fn plan(scene: &Scene, from: &[f64], to: &[f64], settings: &RrtConnectSettings) -> Result<JointPath, RrtConnectError> {
    let mut start = SceneState::new(scene);
    start.set_q(scene, ROBOT, from).unwrap();
    let model = CoverModel::with_covers(scene, &start, ROBOT, 0.0, &KeptCovers).unwrap();
    let obstacles = CoverObstacles::new(&model, scene, &start, 0.0);
    CoverRrtConnect::new(RrtConnect::new(scene, ROBOT)?, &model, &obstacles).plan(&start, to, settings)
}

/// A wall in front from below the base to above the reach: the upper arm, bent forward, cannot turn through it.
const WALL: (Vec3, Vec3) = (Vec3::new(0.45, 0.0, 0.4), Vec3::new(0.3, 0.02, 1.2));

#[test]
fn a_wall_from_which_the_arm_cannot_withdraw_separates_its_sides() {
    // A roof keeps the upper arm down; a wall behind the arm blocks the other side of the circle.
    let roof = (Vec3::new(0.0, 0.0, 0.75), Vec3::new(1.5, 1.5, 0.15));
    let behind = (Vec3::new(-0.45, 0.0, 0.4), Vec3::new(0.3, 0.02, 1.2));
    let scene = scene(&[WALL, roof, behind]);
    let settings = RrtConnectSettings { time_limit: Duration::from_secs(20), ..RrtConnectSettings::default() };
    let error = plan(&scene, &[-1.2, 1.6, 0.3], &[1.2, 1.6, 0.3], &settings).unwrap_err();
    let RrtConnectError::Disconnected { joints, .. } = &error else { panic!("{error}") };
    assert!(joints.contains(&"waist".to_owned()), "{error}");
    assert!(error.to_string().contains("`waist` cannot get from start to goal"), "{error}");
}

#[test]
fn a_wall_over_which_the_arm_lifts_separates_nothing() {
    let path = plan(&scene(&[WALL]), &[-1.2, 1.6, 0.3], &[1.2, 1.6, 0.3], &RrtConnectSettings::default()).unwrap();
    assert!(path.waypoints.len() > 2);
}

/// One goal is beyond the walls. The other may be reachable, but covers cannot leave it: boxes are a millimetre from
/// the forearm
/// on four sides. A proof for the first goal says nothing about the second.
#[test]
fn a_goal_that_cannot_be_left_keeps_the_question_open() {
    let roof = (Vec3::new(0.0, 0.0, 0.75), Vec3::new(1.5, 1.5, 0.15));
    let behind = (Vec3::new(-0.45, 0.0, 0.4), Vec3::new(0.3, 0.02, 1.2));
    let (from, tight, beyond) = ([-0.7, 1.6, 0.3], [-1.7, 1.6, 0.0], [1.2, 1.6, 0.3]);
    let mut builder = Scene::builder();
    builder.robot("arm", example::arm().unwrap(), Pose::IDENTITY);
    for (i, (at, half_extents)) in [WALL, roof, behind].into_iter().enumerate() {
        let shape = Shape::Cuboid(Cuboid { half_extents });
        builder.object(Object { name: format!("wall {i}"), shape, in_world: Pose::from_translation(at) });
    }
    let alone = builder.clone().build().unwrap();
    let mut state = SceneState::new(&alone);
    state.set_q(&alone, ROBOT, &tight).unwrap();
    let forearm = state.pose(&alone, GeometryId::Link { robot: ROBOT, link: LinkId(3) }).unwrap();
    for (i, side) in [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y].into_iter().enumerate() {
        let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.02, 0.02, 0.15) });
        let at = Pose::from_translation(side * 0.071 + Vec3::Z * 0.2);
        builder.object(Object { name: format!("side {i}"), shape, in_world: forearm * at });
    }
    let scene = builder.build().unwrap();
    let mut start = SceneState::new(&scene);
    start.set_q(&scene, ROBOT, &from).unwrap();
    let model = CoverModel::with_covers(&scene, &start, ROBOT, 0.0, &KeptCovers).unwrap();
    let obstacles = CoverObstacles::new(&model, &scene, &start, 0.0);
    let mut planner = CoverRrtConnect::new(RrtConnect::new(&scene, ROBOT).unwrap(), &model, &obstacles);
    let settings = |time_limit| RrtConnectSettings { time_limit, ..RrtConnectSettings::default() };
    let began = Instant::now();
    let alone = planner.plan(&start, &beyond, &settings(Duration::from_secs(20))).unwrap_err();
    assert!(matches!(alone, RrtConnectError::Disconnected { .. }), "{alone}");
    // The time would be enough for a proof if it existed.
    let settings = settings((4 * began.elapsed()).max(Duration::from_millis(600)));
    for goals in [[beyond, tight], [tight, beyond]] {
        let error = planner.plan_to_any(&start, &goals, &settings).unwrap_err();
        assert!(matches!(error, RrtConnectError::NotFound { .. }), "{error}");
    }
}

/// If the planner in the exact scene finds a path, no proof contradicts it, however short the search on covers is.
#[test]
fn no_proof_contradicts_a_path() {
    let mut random = SplitMix(7);
    let (mut paths, mut proofs) = (0, 0);
    let cases = elbowroom_testkit::extent::amount(24_usize, 60);
    for case in 0..cases {
        let boxes: Vec<_> = (0..6)
            .map(|_| {
                let at = Vec3::new(random.between(-0.9, 0.9), random.between(-0.9, 0.9), random.between(0.0, 1.3));
                (at, Vec3::new(random.between(0.02, 0.4), random.between(0.02, 0.4), random.between(0.02, 0.4)))
            })
            .collect();
        let scene = scene(&boxes);
        let mut exact = Checker::new(&scene, CheckerOptions::default());
        let mut state = SceneState::new(&scene);
        let mut free = Vec::new();
        for _ in 0..400 {
            let q = [random.between(-3.0, 3.0), random.between(-2.2, 2.2), random.between(-2.5, 2.5)];
            state.set_q(&scene, ROBOT, &q).unwrap();
            if exact.within(&state, 1e-3).is_none() {
                free.push(q);
            }
        }
        let &[from, .., to] = &free[..] else { continue };
        // Few enough configurations that the search on covers is often interrupted.
        let few = RrtConnectSettings { max_states: 64, seed: case as u64, ..RrtConnectSettings::default() };
        let answer = plan(&scene, &from, &to, &few);
        state.set_q(&scene, ROBOT, &from).unwrap();
        let many = RrtConnectSettings { max_states: 5_000, ..RrtConnectSettings::default() };
        let known = RrtConnect::new(&scene, ROBOT).unwrap().plan(&state, &to, &many).is_ok();
        let is_disconnected = matches!(answer, Err(RrtConnectError::Disconnected { .. }));
        assert!(!(known && is_disconnected), "{case}: {boxes:?} {from:?} {to:?}");
        paths += usize::from(known);
        proofs += usize::from(is_disconnected);
    }
    println!("{cases} cases, {paths} paths, {proofs} proofs");
    assert!(3 * paths > cases && proofs > 0, "{paths} paths, {proofs} proofs");
}
