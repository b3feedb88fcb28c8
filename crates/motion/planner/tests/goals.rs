//! Goals and constraints in space: several goals, task space regions, kept orientations, straight lines, shorter paths by a
//! deadline. Every path is swept in the exact scene.

use std::time::Duration;

use crate::common::robots::{Random, cabinet, free_values, state_at, within_limits};
use elbowroom_kinematics::ChainState;
use elbowroom_planner::{
    CoverModel, CoverObstacles, CoverRrtConnect, GoalLimits, JointPath, LinearMove, LinearMoveEnd,
    OrientationConstraint, PathConstraint, PointGoal, RrtConnect, RrtConnectError, RrtConnectSettings, TaskSpaceRegion,
};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState, SweepOptions};
use elbowroom_spatial::{Pose, Rotation, Vec3};

const ROBOT: RobotId = RobotId(0);

/// Covers of the robot and of the obstacles around it.
fn covers(scene: &Scene) -> (CoverModel, CoverObstacles) {
    let state = SceneState::new(scene);
    let model = CoverModel::new(scene, &state, ROBOT, 0.0).unwrap();
    let obstacles = CoverObstacles::new(&model, scene, &state, 0.0);
    (model, obstacles)
}

fn planner<'m>(scene: &'m Scene, (model, obstacles): &'m (CoverModel, CoverObstacles)) -> CoverRrtConnect<'m> {
    CoverRrtConnect::new(RrtConnect::new(scene, ROBOT).unwrap(), model, obstacles)
}

fn assert_free(scene: &Scene, start: &SceneState, path: &JointPath) {
    let mut exact = Checker::new(scene, CheckerOptions::default());
    let hit = exact.sweep_path(start, ROBOT, &path.waypoints, &SweepOptions::default()).unwrap();
    assert!(hit.is_none_or(|h| !h.1.certain), "{hit:?}");
}

fn tip(scene: &Scene, q: &[f64]) -> Pose {
    let r = &scene.robots()[0];
    let mut state = ChainState::new(&r.robot.chain);
    state.q.copy_from_slice(q);
    r.robot.chain.forward(&mut state);
    r.base_in_world * state.link_in_root(r.robot.chain.tip())
}

/// Configurations along a path, `n` per segment.
fn along(path: &JointPath, n: usize) -> impl Iterator<Item = Vec<f64>> + '_ {
    path.waypoints.windows(2).flat_map(move |w| {
        (0..=n).map(move |i| {
            let share = i as f64 / n as f64;
            w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * share).collect()
        })
    })
}

fn settings(max_states: u64) -> RrtConnectSettings {
    RrtConnectSettings { max_states, time_limit: Duration::from_mins(1), ..RrtConnectSettings::default() }
}

#[test]
fn the_first_of_several_goals_is_reached_and_invalid_ones_are_left_out() {
    let scene = cabinet();
    let mut random = Random(3);
    let from = free_values(&mut random, &scene, ROBOT).unwrap();
    let start = state_at(&scene, ROBOT, &from);
    let near: Vec<f64> = from.iter().map(|v| v + 0.01).collect();
    let goals = [
        free_values(&mut random, &scene, ROBOT).unwrap(),
        near.clone(),
        free_values(&mut random, &scene, ROBOT).unwrap(),
    ];
    let beyond = vec![9.0; from.len()];
    let covers = covers(&scene);
    let mut planner = planner(&scene, &covers);
    let path = planner.plan_to_any(&start, &goals, &settings(200_000)).unwrap();
    assert_eq!(path.waypoints, [from.clone(), near.clone()]);
    let path = planner.plan_to_any(&start, &[&beyond, &goals[0], &goals[2]], &settings(200_000)).unwrap();
    let reached = path.waypoints.last().unwrap();
    assert!(*reached == goals[0] || *reached == goals[2]);
    assert_free(&scene, &start, &path);
    let error = planner.plan_to_any(&start, &[&beyond, &beyond], &settings(200_000)).unwrap_err();
    assert!(matches!(error, RrtConnectError::OutOfLimits { .. }), "{error}");
    let none: [Vec<f64>; 0] = [];
    let error = planner.plan_to_any(&start, &none, &settings(200_000)).unwrap_err();
    assert!(error.to_string().contains("there is no goal"), "{error}");
}

#[test]
fn configurations_of_a_region_have_their_tip_in_it() {
    let scene = cabinet();
    let link = scene.robots()[0].robot.chain.tip();
    let mut random = Random(8);
    let start = state_at(&scene, ROBOT, &[0.0; 7]);
    for _ in 0..6 {
        let known = free_values(&mut random, &scene, ROBOT).unwrap();
        let in_link = Pose::from_translation(Vec3::new(0.0, 0.02, 0.2));
        let pose = TaskSpaceRegion::at_pose(link, in_link, tip(&scene, &known) * in_link);
        let region = TaskSpaceRegion {
            half_extents_m: Vec3::new(0.05, 0.0, 0.1),
            half_angles_rad: Vec3::new(0.0, 0.3, 1.0),
            ..pose
        };
        let (exact, wide) =
            (pose.configurations(&scene, &start, ROBOT, 0, 1), region.configurations(&scene, &start, ROBOT, 4, 1));
        assert!(!exact.is_empty() && wide.len() > exact.len(), "{} and {}", exact.len(), wide.len());
        for q in exact.iter().chain(&wide) {
            assert!(within_limits(&scene, ROBOT, q) && region.contains(&(tip(&scene, q) * in_link)));
        }
        for q in &exact {
            let off = pose.centre_in_world.inverse_mul(&(tip(&scene, q) * in_link));
            assert!(off.translation.length() < 1e-8 && off.rotation.angle() < 1e-8);
        }
    }
    let far = TaskSpaceRegion::at_pose(link, Pose::IDENTITY, Pose::from_translation(Vec3::X * 9.0));
    assert!(far.configurations(&scene, &start, ROBOT, 0, 1).is_empty());
}

/// The place of a point, computed by forward kinematics of the whole chain.
fn place(scene: &Scene, point: &PointGoal, q: &[f64]) -> Vec3 {
    let r = &scene.robots()[0];
    let mut state = ChainState::new(&r.robot.chain);
    state.q.copy_from_slice(q);
    r.robot.chain.forward(&mut state);
    (r.base_in_world * state.link_in_root(point.link)).transform_point(point.point_in_link)
}

#[test]
fn configurations_of_a_point_have_it_at_its_place_and_paths_reach_one_of_them() {
    let scene = cabinet();
    let chain = &scene.robots()[0].robot.chain;
    let covers = covers(&scene);
    let mut random = Random(4);
    let mut reached = 0;
    for links_before_the_tip in [0, 1, 2, 3, 0, 1, 2, 3] {
        let from = free_values(&mut random, &scene, ROBOT).unwrap();
        let start = state_at(&scene, ROBOT, &from);
        let link = (0..links_before_the_tip)
            .fold(chain.tip(), |link, _| chain.parent_joint(link).map_or(link, |j| chain.joints()[j.0].parent));
        let mut point = PointGoal { link, point_in_link: Vec3::new(0.03, -0.04, 0.05), in_world: Vec3::ZERO };
        point.in_world = place(&scene, &point, &free_values(&mut random, &scene, ROBOT).unwrap());
        let found = point.configurations(&scene, &start, ROBOT, 32, GoalLimits::default()).unwrap();
        assert!(found.len() > 4, "{}", found.len());
        let moves = point.moved_by(&scene, ROBOT);
        let distance = |q: &[f64]| q.iter().zip(&from).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        assert!(found.windows(2).all(|w| distance(&w[0]) <= distance(&w[1])));
        for q in &found {
            assert!(within_limits(&scene, ROBOT, q) && place(&scene, &point, q).distance(point.in_world) < 1e-6);
        }
        // The joints behind the link need not move.
        let rests =
            |q: &Vec<f64>| (0..from.len()).all(|i| moves.contains(&chain.active_joints()[i]) || q[i] == from[i]);
        assert!(found.iter().any(rests));
        let path = planner(&scene, &covers).plan_to_any(&start, &found, &settings(200_000));
        let Ok(path) = path else { continue };
        assert_free(&scene, &start, &path);
        assert!(place(&scene, &point, path.waypoints.last().unwrap()).distance(point.in_world) < 1e-6);
        reached += 1;
    }
    assert!(reached >= 6, "{reached}");
    let far = PointGoal { link: chain.tip(), point_in_link: Vec3::ZERO, in_world: Vec3::X * 9.0 };
    let start = SceneState::new(&scene);
    assert!(
        far.configurations(&scene, &start, ROBOT, 4, GoalLimits::default()).unwrap_err().to_string().contains("m and")
    );
    let unknown = PointGoal { in_world: Vec3::splat(f64::NAN), ..far };
    assert!(
        unknown
            .configurations(&scene, &start, ROBOT, 4, GoalLimits::default())
            .unwrap_err()
            .to_string()
            .contains("not finite")
    );
}

#[test]
fn goals_of_a_point_keep_an_axis_and_leave_held_joints_where_they_are() {
    let scene = cabinet();
    let chain = &scene.robots()[0].robot.chain;
    let mut random = Random(11);
    let (mut kept_goals, mut held_goals) = (0, 0);
    for _ in 0..20 {
        let from = free_values(&mut random, &scene, ROBOT).unwrap();
        let start = state_at(&scene, ROBOT, &from);
        let forearm = chain.joints()[chain.parent_joint(chain.tip()).unwrap().0].parent;
        let mut point = PointGoal { link: forearm, point_in_link: Vec3::new(0.03, -0.04, 0.05), in_world: Vec3::ZERO };
        // A place that the first three joints reach.
        let mut to = free_values(&mut random, &scene, ROBOT).unwrap();
        to[3..].copy_from_slice(&from[3..]);
        point.in_world = place(&scene, &point, &to);
        let held = GoalLimits { moving: Some(&[0, 1, 2]), kept: None };
        for q in point.configurations(&scene, &start, ROBOT, 32, held).unwrap() {
            assert!(within_limits(&scene, ROBOT, &q) && q[3..] == from[3..]);
            assert!(place(&scene, &point, &q).distance(point.in_world) < 1e-6);
            held_goals += 1;
        }
        let mut state = ChainState::new(chain);
        state.q.copy_from_slice(&from);
        chain.forward(&mut state);
        let axis = state.link_in_root(chain.tip()).rotation.z_axis();
        let in_world = scene.robots()[0].base_in_world.rotation * axis;
        let mut kept = OrientationConstraint::new(&scene, ROBOT, chain.tip(), Vec3::Z, in_world, 0.1);
        let limits = GoalLimits { moving: None, kept: Some(&mut kept) };
        let found = point.configurations(&scene, &start, ROBOT, 32, limits).unwrap();
        assert!(found.iter().all(|q| within_limits(&scene, ROBOT, q)));
        assert!(found.iter().all(|q| place(&scene, &point, q).distance(point.in_world) < 1e-6));
        // All of them keep the axis, or none was found that does.
        let keeping = found.iter().filter(|q| kept.distance_m(q, 0.0) > 0.0).count();
        assert!(keeping == found.len() || keeping == 0, "{keeping} of {}", found.len());
        kept_goals += keeping;
    }
    assert!(held_goals >= 20 && kept_goals > 100, "{held_goals} {kept_goals}");
}

#[test]
fn paths_become_shorter_until_the_limit_and_stay_free() {
    let scene = cabinet();
    let mut random = Random(5);
    let (mut improved, mut shortest, mut gained) = (0, 0, 0.0);
    let covers = covers(&scene);
    for _ in 0..12 {
        let (from, to) =
            (free_values(&mut random, &scene, ROBOT).unwrap(), free_values(&mut random, &scene, ROBOT).unwrap());
        let start = state_at(&scene, ROBOT, &from);
        let answer = planner(&scene, &covers).plan_anytime(&start, &[&to], &settings(300_000));
        let Ok(answer) = answer else { continue };
        assert_free(&scene, &start, &answer.path);
        assert_eq!((&answer.path.waypoints[0], answer.path.waypoints.last().unwrap()), (&from, &to));
        let lengths: Vec<f64> = answer.improvements.iter().map(|i| i.1).collect();
        assert!(lengths.windows(2).all(|w| w[1] < w[0]), "{lengths:?}");
        assert_eq!(*lengths.last().unwrap(), answer.path.length_rad);
        improved += usize::from(lengths.len() > 1);
        shortest += usize::from(answer.is_shortest);
        gained += 1.0 - lengths[lengths.len() - 1] / lengths[0];
    }
    println!("{improved} became shorter by {gained:.2} in all, {shortest} are straight");
    assert!(improved >= 3 && gained > 0.15, "{improved}, {gained}");
}

#[test]
fn a_kept_orientation_is_kept_everywhere_on_the_path() {
    let scene = cabinet();
    let link = scene.robots()[0].robot.chain.tip();
    let mut random = Random(13);
    let tolerance = 0.15;
    let covers = covers(&scene);
    let constraint = OrientationConstraint::new(&scene, ROBOT, link, Vec3::Z, Vec3::X, tolerance);
    // Configurations with the tip forward: projected configurations that are free.
    let mut exact = Checker::new(&scene, CheckerOptions::default());
    let mut forward = Vec::new();
    while forward.len() < 16 {
        let mut q = free_values(&mut random, &scene, ROBOT).unwrap();
        if constraint.clone().project(&mut q) && within_limits(&scene, ROBOT, &q) {
            let state = state_at(&scene, ROBOT, &q);
            if exact.within(&state, 1e-3).is_none() {
                forward.push(q);
            }
        }
    }
    let (mut found, mut bent, mut shorter) = (0, 0, 0);
    for ends in forward.chunks(2) {
        let start = state_at(&scene, ROBOT, &ends[0]);
        let planner = || {
            let exact = RrtConnect::new(&scene, ROBOT).unwrap().with_constraint(constraint.clone());
            CoverRrtConnect::new(exact, &covers.0, &covers.1)
        };
        let limits = RrtConnectSettings { time_limit: Duration::from_secs(4), ..settings(1_000_000) };
        let path = match planner().plan(&start, &ends[1], &limits) {
            Ok(path) => path,
            Err(RrtConnectError::NotFound { .. } | RrtConnectError::Disconnected { .. }) => continue,
            Err(e) => panic!("{e}"),
        };
        found += 1;
        bent += usize::from(path.waypoints.len() > 2);
        let shortened = planner().plan_anytime(&start, &[&ends[1]], &settings(100_000)).map(|answer| answer.path);
        shorter += usize::from(shortened.as_ref().is_ok_and(|other| other.length_rad < path.length_rad));
        for path in [Some(path), shortened.ok()].iter().flatten() {
            assert_free(&scene, &start, path);
            for q in along(path, 200) {
                let axis = tip(&scene, &q).rotation * Vec3::Z;
                let angle = axis.cross(Vec3::X).length().atan2(axis.dot(Vec3::X));
                assert!(angle <= tolerance, "{angle}");
            }
        }
    }
    println!("{found} of 8 found, {bent} with corners, {shorter} become shorter");
    assert!(found >= 6 && bent >= 3 && shorter >= 2, "{found} found, {bent} with corners, {shorter} become shorter");
}

#[test]
fn a_straight_line_is_followed_or_the_share_is_told() {
    let scene = cabinet();
    let link = scene.robots()[0].robot.chain.tip();
    let mut random = Random(31);
    let (mut followed, mut blocked, mut unreachable) = (0, 0, 0);
    let covers = covers(&scene);
    for _ in 0..40 {
        let from = free_values(&mut random, &scene, ROBOT).unwrap();
        let start = state_at(&scene, ROBOT, &from);
        let in_link = Pose::from_translation(Vec3::Z * 0.17);
        let begin = tip(&scene, &from) * in_link;
        let by = Vec3::from([0; 3].map(|_| 0.5 * random.unit() - 0.25));
        let turned = Rotation::from_axis_angle(Vec3::Y, random.unit() - 0.5);
        let target_in_world = Pose::new(begin.rotation * turned, begin.translation + by);
        let line = LinearMove { link, tip_in_link: in_link, target_in_world, tolerance_m: 1e-3, tolerance_rad: 2e-3 };
        match planner(&scene, &covers).plan_linear(&start, &line, &settings(1_000_000)) {
            Ok(path) => {
                followed += 1;
                assert_free(&scene, &start, &path);
                for q in along(&path, 16) {
                    let at = tip(&scene, &q) * in_link;
                    let share = (at.translation - begin.translation).dot(by) / by.length_squared();
                    let off = (at.translation - begin.translation - by * share).length();
                    assert!(off <= 1.25e-3 && (-0.01..=1.01).contains(&share), "{off} at {share}");
                }
                let last = tip(&scene, path.waypoints.last().unwrap()) * in_link;
                assert!(last.inverse_mul(&target_in_world).translation.length() < 1e-8);
            }
            Err(RrtConnectError::LinearMove { percent, end }) => {
                assert!((0.0..100.0).contains(&percent));
                blocked += usize::from(end == LinearMoveEnd::NotFree);
                unreachable += usize::from(end == LinearMoveEnd::Unreachable);
            }
            Err(e) => panic!("{e}"),
        }
    }
    assert!(followed > 5 && blocked > 2 && unreachable > 2, "{followed} {blocked} {unreachable}");
}

/// The arm has seven joints: with one of them held it still follows lines, and the held joint does not move at all.
#[test]
fn a_straight_line_leaves_a_held_joint_where_it_is() {
    let scene = cabinet();
    let chain = &scene.robots()[0].robot.chain;
    let mut random = Random(8);
    let covers = covers(&scene);
    let mut followed = 0;
    for _ in 0..30 {
        let from = free_values(&mut random, &scene, ROBOT).unwrap();
        let start = state_at(&scene, ROBOT, &from);
        let mut limits: Vec<(f64, f64)> = chain.lower().into_iter().zip(chain.upper()).collect();
        limits[2] = (from[2], from[2]);
        let by = Vec3::from([0; 3].map(|_| 0.2 * random.unit() - 0.1));
        let begin = tip(&scene, &from);
        let target_in_world = Pose::new(begin.rotation, begin.translation + by);
        let (link, tip_in_link) = (chain.tip(), Pose::IDENTITY);
        let line = LinearMove { link, tip_in_link, target_in_world, tolerance_m: 1e-3, tolerance_rad: 2e-3 };
        let exact = RrtConnect::new(&scene, ROBOT).unwrap().with_limits(limits);
        let mut planner = CoverRrtConnect::new(exact, &covers.0, &covers.1);
        if let Ok(path) = planner.plan_linear(&start, &line, &settings(1_000_000)) {
            followed += 1;
            assert!(path.waypoints.iter().all(|q| q[2] == from[2]));
            let last = tip(&scene, path.waypoints.last().unwrap());
            assert!(last.inverse_mul(&target_in_world).translation.length() < 1e-8);
        }
    }
    assert!(followed > 5, "{followed}");
}
