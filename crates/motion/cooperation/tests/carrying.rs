//! The work-piece on its way: carried by one arm, handed over, never off its path.

use elbowroom_cooperation::{CooperationSettings, HandOverPhase, Hold, HoldLimit, VirtualRobot};
use elbowroom_robot::ObjectId;
use elbowroom_scene::{Checker, CheckerOptions};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;

use crate::common::{DT_S, PER_ROW, Pair, Reach, carry, desire_in_step, motion, part_pose, straight};

#[test]
fn a_short_motion_needs_one_arm() {
    let pair = Pair::new(2, 0.6);
    let start = part_pose(&pair);
    let way = straight(start, Pose::new(start.rotation, start.translation + Vec3::new(-0.03, 0.05, 0.02)), 0.1);
    let outcome = carry(&pair, CooperationSettings::default(), &way);
    assert!(outcome.share > 0.999_999 && outcome.hand_overs.is_empty() && outcome.stopped_s == 0.0, "{outcome:?}");
    assert!(outcome.deviation_m < 1e-9 && outcome.contacts == 0, "{outcome:?}");
}

#[test]
fn the_bar_crosses_to_where_only_the_other_arm_reaches() {
    let pair = Pair::new(2, 0.6);
    let start = part_pose(&pair);
    let end = Pose::new(start.rotation, Vec3::new(0.3, 0.0, 0.45));
    let mut reach = Reach::new(&pair);
    assert!(!reach.holds(&pair, 0, &end) && reach.holds(&pair, 1, &end), "a motion that needs both");
    let outcome = carry(&pair, CooperationSettings::default(), &straight(start, end, 0.05));
    assert!(outcome.share > 0.999_999, "{outcome:?}");
    let from_to: Vec<(usize, usize)> = outcome.hand_overs.iter().map(|(_, h)| (h.from, h.to)).collect();
    assert_eq!(from_to, [(0, 1)]);
    let (_, handed_over) = outcome.hand_overs[0];
    assert!(handed_over.reason.limit.is_some() && handed_over.reason.receiver_holds_s > 0.5, "{handed_over:?}");
    assert!(outcome.deviation_m < 1e-9 && outcome.contacts == 0, "{outcome:?}");
    assert!(outcome.stopped_s == 0.0, "handed over on its way: {outcome:?}");
}

#[test]
fn an_arm_that_its_monitor_stops_is_not_asked_to_take_over() {
    let pair = Pair::new(2, 0.6);
    let start = part_pose(&pair);
    let way = straight(start, Pose::new(start.rotation, Vec3::new(0.3, 0.0, 0.45)), 0.05);
    let mut robot = pair.robot(CooperationSettings::default());
    let mut run = |steps: std::ops::Range<usize>, of_the_other: f64| {
        let mut phases = 0;
        for k in steps {
            desire_in_step(&mut robot, &way, k);
            robot.step(DT_S, &[1.0, of_the_other]);
            phases += usize::from(robot.phase().is_some());
        }
        (phases, robot.on_path().1, robot.holder())
    };
    let steps = way.len() * PER_ROW + 1000;
    let (phases, left_s, holder) = run(0..steps, 0.0);
    assert!(phases == 0 && left_s > 0.3 && holder == 0, "{phases} steps of hand-overs, {left_s} s left");
    let (phases, left_s, holder) = run(steps..3 * steps, 1.0);
    assert!(phases > 0 && left_s < 1e-6 && holder == 1, "{phases} steps of hand-overs, {left_s} s left");
}

#[test]
fn random_motions_never_leave_their_path_and_nothing_touches() {
    let pair = Pair::new(2, 0.6);
    let start = part_pose(&pair);
    let mut random = SplitMix(7);
    let (mut share, mut hand_overs) = (0.0, 0);
    for _ in 0..5 {
        let way = motion(&mut random, &pair, start, 0.4, 2);
        let outcome = carry(&pair, CooperationSettings::default(), &way);
        assert!(outcome.deviation_m < 1e-9 && outcome.contacts == 0, "{outcome:?}");
        assert!(outcome.largest_speed_share < 1.0 + 1e-9, "{outcome:?}");
        assert!(outcome.share > 0.999 || outcome.last_hold.is_some(), "a stop has a reason: {outcome:?}");
        share += outcome.share / 5.0;
        hand_overs += outcome.hand_overs.len();
    }
    assert!(share > 0.5 && hand_overs >= 5, "{share} with {hand_overs} hand-overs");
}

#[test]
fn where_no_arm_reaches_the_bar_stops_in_time_and_says_why() {
    let pair = Pair::new(2, 0.6);
    let start = part_pose(&pair);
    let way = straight(start, Pose::new(start.rotation, start.translation + Vec3::Z * 1.5), 0.1);
    let outcome = carry(&pair, CooperationSettings::default(), &way);
    assert!(outcome.share < 0.6, "{outcome:?}");
    assert!(matches!(outcome.last_hold, Some(Hold::Limit(..))), "{outcome:?}");
    assert!(outcome.largest_rate_change <= DT_S / CooperationSettings::default().ramp_s + 1e-9, "no jerk: {outcome:?}");
}

#[test]
fn a_pose_a_metre_away_is_approached_at_the_speed_of_the_settings() {
    let pair = Pair::new(2, 0.6);
    let start = part_pose(&pair);
    let turn = Rotation::from_axis_angle(Vec3::Z, 1.0);
    let jump = vec![start, Pose::new(turn * start.rotation, start.translation + Vec3::new(0.8, 0.0, 0.6))];
    let settings = CooperationSettings::default();
    let outcome = carry(&pair, settings, &jump);
    assert!(outcome.largest_speed_m_s <= settings.speed_m_s * (1.0 + 1e-6), "{outcome:?}");
    assert!(outcome.deviation_m < 1e-9 && outcome.contacts == 0, "{outcome:?}");
}

#[test]
fn a_hand_obeys_its_override_and_says_where_it_would_go() {
    let pair = Pair::new(2, 0.6);
    let start = part_pose(&pair);
    let way = straight(start, Pose::new(start.rotation, Vec3::new(0.3, 0.0, 0.45)), 0.05);
    let mut robot = pair.robot(CooperationSettings::default());
    let mut halted = None;
    for k in 0..way.len() * PER_ROW {
        desire_in_step(&mut robot, &way, k);
        robot.step(DT_S, &[1.0; 2]);
        if robot.phase() == Some(HandOverPhase::Approaching) {
            let before: Vec<Vec<f64>> = [0, 1].map(|member| robot.q(member).to_vec()).to_vec();
            for _ in 0..20 {
                assert_eq!(robot.step(DT_S, &[1.0, 0.0]).hold, Some(Hold::Override));
            }
            assert_eq!(before, [0, 1].map(|member| robot.q(member).to_vec()).to_vec());
            let mut intent = vec![0.0; 6];
            robot.intent(1, DT_S, &mut intent);
            halted = Some(intent);
            break;
        }
    }
    let intent = halted.expect("a hand-over");
    assert!(intent.iter().any(|v| v.abs() > 1e-3), "{intent:?}");
}

#[test]
fn a_hand_that_is_stopped_on_its_way_back_does_not_hold_up_the_work_piece() {
    let pair = Pair::new(2, 0.6);
    let start = part_pose(&pair);
    let way = straight(start, Pose::new(start.rotation, Vec3::new(0.3, 0.0, 0.45)), 0.05);
    let mut robot = pair.robot(CooperationSettings::default());
    let mut k = 0;
    let mut step = |robot: &mut VirtualRobot<'_>, of_giver: f64| {
        desire_in_step(robot, &way, k);
        robot.step(DT_S, &[of_giver, 1.0]);
        k += 1;
    };
    while robot.phase() != Some(HandOverPhase::Retreating) {
        step(&mut robot, 1.0);
    }
    (0..25).for_each(|_| step(&mut robot, 1.0));
    assert_eq!(robot.phase(), Some(HandOverPhase::Retreating), "10 mm from its grasp");
    let (stopped, path_s) = (robot.q(0).to_vec(), robot.path_s());
    (0..100).for_each(|_| step(&mut robot, 0.0));
    assert!(robot.phase().is_none() && robot.path_s() > path_s + 0.1, "{} s from {path_s}", robot.path_s());
    assert_eq!(robot.q(0), stopped);
    (0..200).for_each(|_| step(&mut robot, 0.0));
    assert!(robot.on_path().0.translation.distance(robot.part_in_world().translation) < 1e-9);
    let mut state = pair.state();
    state.attach_at(&pair.scene, ObjectId(0), robot.attachment().unwrap().clone()).unwrap();
    (0..2).for_each(|m| state.set_q(&pair.scene, pair.members[m].robot, robot.q(m)).unwrap());
    assert!(Checker::new(&pair.scene, CheckerOptions::default()).collides(&state).is_none());
}

#[test]
fn a_pause_stops_the_work_piece_on_its_path_until_the_next_pose() {
    let pair = Pair::new(2, 0.6);
    let (start, settings) = (part_pose(&pair), CooperationSettings::default());
    let mut robot = pair.robot(settings);
    let end = Pose::new(start.rotation, start.translation + Vec3::Y * 0.1);
    robot.desire(0.0, &end).unwrap();
    let steps = |robot: &mut VirtualRobot<'_>, count: usize| (0..count).map(|_| robot.step(DT_S, &[1.0; 2])).last();
    steps(&mut robot, 50);
    robot.pause();
    steps(&mut robot, (settings.ramp_s / DT_S).ceil() as usize + 8);
    let stopped = robot.part_in_world();
    assert_eq!(robot.step(DT_S, &[1.0; 2]).hold, Some(Hold::Paused));
    steps(&mut robot, 50);
    assert_eq!(robot.part_in_world(), stopped);
    assert!(stopped.translation.distance(end.translation) > 0.02);
    robot.desire(2.0, &end).unwrap();
    steps(&mut robot, 500);
    assert!(robot.part_in_world().translation.distance(end.translation) < 1e-9);
}

#[test]
fn a_part_that_is_near_a_table_can_leave_it_and_does_not_come_nearer() {
    let start = part_pose(&Pair::new(2, 0.6));
    // The bar lies along x, 1 mm above the table.
    let at = start.translation - Vec3::Z * (0.02 + 0.001 + 0.05);
    let pair = Pair::among(2, 0.6, Some((at, Vec3::new(0.03, 0.1, 0.05))));
    let settings = CooperationSettings::default();
    let up = straight(start, Pose::new(start.rotation, start.translation + Vec3::Z * 0.05), 0.1);
    let lifted = carry(&pair, settings, &up);
    assert!(lifted.share > 0.999_999 && lifted.contacts == 0, "{lifted:?}");
    let down = straight(start, Pose::new(start.rotation, start.translation - Vec3::Z * 0.05), 0.1);
    let pressed = carry(&pair, settings, &down);
    assert!(pressed.share < 0.01 && pressed.contacts == 0, "{pressed:?}");
    assert!(matches!(pressed.last_hold, Some(Hold::Limit(0, HoldLimit::Contact(..)))), "{pressed:?}");
}
