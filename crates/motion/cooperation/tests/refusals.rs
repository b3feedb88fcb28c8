//! Bad input: refused or held with a reason, and nothing moves.

use elbowroom_cooperation::{CooperationError, CooperationSettings, Hold, PoseRefusal, VirtualRobot};
use elbowroom_robot::ObjectId;
use elbowroom_spatial::{Pose, Vec3};

use crate::common::{DT_S, Pair, part_pose};

fn all_q(robot: &VirtualRobot<'_>) -> Vec<Vec<f64>> {
    (0..2).map(|member| robot.q(member).to_vec()).collect()
}

#[test]
fn steps_without_a_duration_or_with_wrong_overrides_move_nothing() {
    let pair = Pair::new(2, 0.6);
    let mut robot = pair.robot(CooperationSettings::default());
    robot.desire(0.0, &Pose::new(part_pose(&pair).rotation, Vec3::Z)).unwrap();
    let before = all_q(&robot);
    for dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(robot.step(dt_s, &[1.0, 1.0]).hold, Some(Hold::Input));
    }
    assert_eq!(robot.step(DT_S, &[1.0]).hold, Some(Hold::Input));
    assert_eq!(all_q(&robot), before);
}

#[test]
fn an_override_that_is_not_a_number_stands() {
    let pair = Pair::new(2, 0.6);
    let mut robot = pair.robot(CooperationSettings::default());
    let start = part_pose(&pair);
    robot.desire(0.0, &Pose::new(start.rotation, start.translation + Vec3::Y * 0.1)).unwrap();
    let before = all_q(&robot);
    for speed_override in [f64::NAN, -1.0, 0.0] {
        for _ in 0..50 {
            assert_eq!(robot.step(DT_S, &[speed_override; 2]).hold, Some(Hold::Override));
        }
    }
    assert_eq!(all_q(&robot), before);
    let half = |robot: &mut VirtualRobot<'_>| (0..100).map(|_| robot.step(DT_S, &[0.5; 2]).rate).fold(0.0, f64::max);
    assert_eq!(half(&mut robot), 0.5);
}

#[test]
fn poses_that_are_not_usable_are_refused() {
    let pair = Pair::new(2, 0.6);
    let mut robot = pair.robot(CooperationSettings::default());
    let start = part_pose(&pair);
    assert_eq!(robot.desire(0.0, &Pose::from_translation(Vec3::X * f64::NAN)), Err(PoseRefusal::NotFinite));
    assert_eq!(robot.desire(f64::NAN, &start), Err(PoseRefusal::NotFinite));
    robot.desire(1.0, &start).unwrap();
    assert_eq!(robot.desire(1.0, &start), Err(PoseRefusal::Time));
    let full = (0..100_000).map(|k| robot.desire(2.0 + f64::from(k), &start)).find_map(Result::err);
    assert_eq!(full, Some(PoseRefusal::Full));
}

#[test]
fn virtual_robots_that_make_no_sense_are_refused() {
    let pair = Pair::new(2, 0.6);
    let new = |members, work_piece, holder, settings| {
        VirtualRobot::new(&pair.scene, pair.state(), work_piece, members, holder, settings).map(|_| ()).unwrap_err()
    };
    let (part, settings) = (ObjectId(0), CooperationSettings::default());
    let one = vec![pair.members[0].clone()];
    assert_eq!(new(one, part, (0, 1), settings), CooperationError::Members);
    let twice = vec![pair.members[0].clone(), pair.members[0].clone()];
    assert_eq!(new(twice, part, (0, 1), settings), CooperationError::Members);
    assert_eq!(new(pair.members.clone(), part, (0, 99), settings), CooperationError::NoSuchGrasp);
    assert!(matches!(new(pair.members.clone(), part, (0, 0), settings), CooperationError::NotGrasped { .. }));
    assert!(matches!(new(pair.members.clone(), ObjectId(7), (0, 1), settings), CooperationError::Scene(_)));
    // The second arm would stop before its pre-grasp, 5 mm from the bar.
    let mut near = pair.members.clone();
    near[1].grasps[3].approach = near[1].grasps[3].approach * (1.0 / 12.0);
    let expected = CooperationError::ShortApproach { member: 1, grasp: 3 };
    assert_eq!(new(near.clone(), part, (0, 1), settings), expected);
    let smaller = CooperationSettings { gap_m: 0.004, ..settings };
    assert!(VirtualRobot::new(&pair.scene, pair.state(), part, near, (0, 1), smaller).is_ok());
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let settings = CooperationSettings { speed_m_s: bad, ..settings };
        assert_eq!(new(pair.members.clone(), part, (0, 1), settings), CooperationError::Settings);
    }
}
