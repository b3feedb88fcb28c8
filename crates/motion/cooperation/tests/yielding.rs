//! Arms without the work-piece: they wait near it and get out of its way, within the limits of their joints.

use elbowroom_cooperation::CooperationSettings;
use elbowroom_scene::{Checker, CheckerOptions, Selection};
use elbowroom_spatial::{Pose, Vec3};

use crate::common::{DT_S, Pair, part_pose};

#[test]
fn a_free_arm_waits_at_a_pre_grasp_and_follows_the_work_piece() {
    let pair = Pair::new(2, 0.6);
    let mut robot = pair.robot(CooperationSettings::default());
    let start = part_pose(&pair);
    let tool = |robot: &elbowroom_cooperation::VirtualRobot<'_>| {
        let member = &pair.members[1];
        let mut state = pair.state();
        state.set_q(&pair.scene, member.robot, robot.q(1)).unwrap();
        let tip = elbowroom_robot::GeometryId::Link { robot: member.robot, link: member.tip };
        state.pose(&pair.scene, tip).unwrap() * member.tool_in_tip
    };
    let mut overlap = 0.0;
    for k in 0..1500 {
        let t_s = f64::from(k) * DT_S;
        let offset = Vec3::Y * (0.05 * (0.8 * t_s).sin());
        robot.desire(t_s, &Pose::new(start.rotation, start.translation + offset)).unwrap();
        robot.step(DT_S, &[1.0; 2]);
        let in_part = robot.part_in_world().inverse_mul(&tool(&robot)).translation;
        let nearest =
            pair.members[1].grasps.iter().map(|g| (g.tool_in_part.translation - g.approach).distance(in_part));
        if k > 1000 {
            overlap = nearest.fold(f64::INFINITY, f64::min).max(overlap);
        }
    }
    assert!(overlap < 5e-3, "the hand is {overlap} m from every pre-grasp");
}

#[test]
fn an_arm_in_the_way_yields_and_keeps_its_limits() {
    let pair = Pair::new(2, 0.6);
    // The second arm has nothing to do: it cannot grasp the bar where it is, and stands where the bar goes.
    let mut pair = pair;
    pair.start[1] = vec![0.0, 0.5, 1.2, 0.0, 0.3, 0.0];
    pair.members[1].grasps.truncate(1);
    let settings = CooperationSettings::default();
    let mut robot = pair.robot(settings);
    let mut checker = Checker::new(&pair.scene, CheckerOptions::default());
    let start = part_pose(&pair);
    let (mut state, mut least_m, mut yields, mut times) = (pair.state(), f64::INFINITY, false, 0);
    state.attach_at(&pair.scene, elbowroom_robot::ObjectId(0), robot.attachment().unwrap().clone()).unwrap();
    let limits = &pair.members[1].limits;
    let mut before = robot.qd(1).to_vec();
    assert!(checker.collides(&state).is_none());
    for k in 0..2000 {
        let t_s = f64::from(k) * DT_S;
        let offset = Vec3::new(0.1 * t_s.min(1.2), 0.0, -0.02 * t_s.min(1.2));
        robot.desire(t_s, &Pose::new(start.rotation, start.translation + offset)).unwrap();
        robot.step(DT_S, &[1.0; 2]);
        if robot.phase().is_some() {
            break;
        }
        for (member, m) in pair.members.iter().enumerate() {
            state.set_q(&pair.scene, m.robot, robot.q(member)).unwrap();
        }
        let [a, b] = [0, 1].map(|member: usize| Selection::Robot(pair.members[member].robot));
        let gap_m = checker.between(a, b).distance(&state).unwrap().metres;
        least_m = least_m.min(gap_m);
        times += usize::from(robot.is_yielding(1) && !yields);
        yields = robot.is_yielding(1);
        for ((qd, before), l) in robot.qd(1).iter().zip(&before).zip(limits) {
            assert!(qd.abs() <= l.velocity * (1.0 + 1e-9), "{qd} of {}", l.velocity);
            let stopped_by_the_proof = *qd == 0.0;
            assert!(
                stopped_by_the_proof || (qd - before).abs() <= l.acceleration * DT_S * (1.0 + 1e-6),
                "{qd} after {before}"
            );
        }
        before.copy_from_slice(robot.qd(1));
    }
    // Pushes that come and go within half a second are one time.
    assert!((1..=2).contains(&times) && least_m > 0.0, "yielded {times} times, least distance {least_m}");
}
