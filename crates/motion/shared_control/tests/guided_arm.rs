//! A whole arm whose tool is guided: it follows, glides, and stops before anything touches.

use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState, Selection};
use elbowroom_shared_control::force::{
    ArmField, ArmForces, Aureole, BodySettings, FieldPair, ForceLaw, ForceProfile, Response, VirtualBody,
};
use elbowroom_shared_control::{ArmLimit, GuidedArm, Limit, NavigatorError, NavigatorSettings, SurfaceNavigator};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;

use crate::common::arm::{self, DT_S, START, guided, scene};
use crate::common::point;

fn moved_by(pose: Pose, offset: Vec3) -> Pose {
    Pose::new(pose.rotation, pose.translation + offset)
}

#[test]
fn the_arm_follows_its_tool_in_free_space() {
    let (scene, start) = scene(None);
    let mut arm = guided(&scene, start, false);
    let desired = moved_by(start, Vec3::new(-0.05, 0.06, 0.04));
    for _ in 0..1500 {
        let before = arm.q().to_vec();
        arm.step(Some(&desired), DT_S, 1.0);
        assert!(before.iter().zip(arm.q()).all(|(a, b)| (a - b).abs() <= 1.5 * DT_S * (1.0 + 1e-6)));
    }
    assert!(arm.tool_in_world().translation.distance(desired.translation) < 1e-6, "{:?}", arm.tool_in_world());
}

#[test]
fn the_tool_glides_and_nothing_of_the_arm_ever_touches() {
    let (scene, start) = scene(Some(0.02));
    let mut arm = guided(&scene, start, true);
    let mut random = SplitMix(4);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let (mut state, mut glided) = (SceneState::new(&scene), 0);
    let mut desired = start;
    for k in 0..3000 {
        if k % 100 == 0 {
            desired = moved_by(start, point(&mut random, 0.15) - Vec3::Z * 0.1);
        }
        let step = arm.step(Some(&desired), DT_S, 1.0);
        glided += usize::from(step.limit == Some(ArmLimit::Tool(Limit::Surface)));
        state.set_q(&scene, RobotId(0), arm.q()).unwrap();
        let nearest = checker.distance(&state).unwrap();
        assert!(nearest.metres >= NavigatorSettings::default().least_gap_m - 1e-6, "{nearest:?} after {step:?}");
    }
    assert!(glided > 500, "{glided} of 3000 steps along the surface");
}

#[test]
fn what_is_not_protected_stops_the_arm_with_the_pair() {
    let (scene, start) = scene(Some(0.02));
    let mut arm = guided(&scene, start, false);
    let mut limit = None;
    for _ in 0..1500 {
        limit = arm.step(Some(&moved_by(start, Vec3::Z * -0.1)), DT_S, 1.0).limit;
    }
    let Some(ArmLimit::Contact(a, b)) = limit else { panic!("{limit:?}") };
    assert_eq!((scene.name(a).as_str(), scene.name(b).as_str()), ("arm/tool0", "work"));
    assert!(arm.tool_in_world().translation.z > start.translation.z - 0.02);
}

#[test]
fn beyond_its_reach_the_arm_stands_and_says_so() {
    let (scene, start) = scene(None);
    let mut arm = guided(&scene, start, false);
    let mut limit = None;
    for _ in 0..8000 {
        limit = arm.step(Some(&moved_by(start, Vec3::X * 5.0)), DT_S, 1.0).limit;
    }
    assert!(matches!(limit, Some(ArmLimit::Reach | ArmLimit::JointSpeed(_))), "{limit:?}");
}

#[test]
fn a_navigator_elsewhere_is_refused() {
    let (scene, start) = scene(None);
    let (robot, flange, tcp_in_flange, tool) = arm::arm();
    let elsewhere = moved_by(start, Vec3::X * 0.01);
    let navigator = SurfaceNavigator::new(tool, vec![], elsewhere, NavigatorSettings::default()).unwrap();
    let solver = IkSolver::new(&robot.chain, flange, tcp_in_flange, IkOptions::default());
    let mut state = SceneState::new(&scene);
    state.set_q(&scene, RobotId(0), &START).unwrap();
    assert_eq!(
        GuidedArm::new(navigator, solver, (&scene, RobotId(0)), state, vec![1.5; 6]).err(),
        Some(NavigatorError::NotAtTool)
    );
}

/// An arm with a virtual mass and one field.
fn in_field(scene: &Scene, start: Pose, pair: FieldPair, law: ForceLaw) -> GuidedArm<'_> {
    let (_, flange, tcp_in_flange, _) = arm::arm();
    let mut arm = guided(scene, start, true);
    let body = VirtualBody::new(BodySettings::default()).unwrap();
    let field = ArmField::new(law, pair).unwrap();
    arm.set_forces(ArmForces::new(
        Response::Admittance(body),
        vec![field],
        (scene, RobotId(0)),
        (flange, tcp_in_flange.translation),
    ));
    arm
}

#[test]
fn a_field_holds_the_tool_off_and_the_hand_feels_it() {
    let (scene, start) = scene(Some(0.05));
    let law = ForceLaw { damping_n_s_m: 20.0, ..ForceLaw::spring(0.02, 4000.0) };
    let robot = Selection::Robot(RobotId(0));
    let work = Selection::Object(ObjectId(0));
    let mut state = SceneState::new(&scene);
    state.set_q(&scene, RobotId(0), &START).unwrap();
    let distance_m =
        Checker::new(&scene, CheckerOptions::default()).between(robot, work).distance(&state).unwrap().metres;
    for pair in [FieldPair::Surface(0), FieldPair::Scene(robot, work)] {
        let mut arm = in_field(&scene, start, pair, law);
        // The hand presses deep into the work.
        let hand = moved_by(start, Vec3::Z * -0.06);
        for _ in 0..2000 {
            arm.step(Some(&hand), DT_S, 1.0);
        }
        let sunk = start.translation.z - arm.tool_in_world().translation.z;
        // 800 (0.06 − s) = 4000 (0.02 − (d − s)), with the distance d at the start.
        let expected = (800.0 * 0.06 - 4000.0 * (0.02 - distance_m)) / 4800.0;
        assert!((sunk - expected).abs() < 1e-5, "{pair:?}: {sunk} m instead of {expected}");
        let forces = arm.forces().unwrap();
        let felt = forces.force_on_hand();
        assert!((felt - forces.sample().force_n).length() < 1e-3, "{felt:?}, {:?}", forces.sample().force_n);
    }
}

#[test]
fn joint_torques_are_the_slopes_of_the_potential() {
    let (scene, start) = scene(Some(0.05));
    let work = Selection::Object(ObjectId(0));
    let forearm = scene.robots()[0].robot.chain.link("link_3").unwrap_or(elbowroom_kinematics::LinkId(3));
    for (link, range_m) in [(forearm, 1.0), (arm::arm().1, 0.2)] {
        let one = Selection::Link { robot: RobotId(0), link };
        let law = ForceLaw::spring(range_m, 300.0);
        let mut arm = in_field(&scene, start, FieldPair::Scene(one, work), law);
        arm.step(Some(&start), DT_S, 1.0);
        let mut state = SceneState::new(&scene);
        let q = START;
        let mut checker = Checker::new(&scene, CheckerOptions::default());
        let mut potential_j = |q: &[f64]| {
            state.set_q(&scene, RobotId(0), q).unwrap();
            let distance_m = checker.between(one, work).distance(&state).unwrap().metres;
            law.potential_j(distance_m, range_m)
        };
        let torques = arm.forces().unwrap().joint_torques().to_vec();
        assert!(torques.iter().any(|t| t.abs() > 1.0), "{torques:?}");
        for (joint, torque) in torques.iter().enumerate() {
            let mut at = |h: f64| {
                let mut moved = q;
                moved[joint] += h;
                potential_j(&moved)
            };
            let expected = (at(-1e-5) - at(1e-5)) / 2e-5;
            assert!(
                (torque - expected).abs() < 1e-2 * expected.abs().max(1.0),
                "{joint}: {torque}, not {expected} N·m"
            );
        }
    }
}

#[test]
fn turning_in_a_field_and_back_outside_of_it_gives_the_hand_nothing() {
    let (scene, start) = scene(Some(0.02));
    let law = ForceLaw::spring(0.03, 4000.0);
    let (robot, work) = (Selection::Robot(RobotId(0)), Selection::Object(ObjectId(0)));
    let mut arm = in_field(&scene, start, FieldPair::Scene(robot, work), law);
    let tilted = Pose::new(Rotation::from_rotation_vector(Vec3::Y * 0.3) * start.rotation, start.translation);
    // Tilt, withdraw, tilt back, return.
    let cycle = [start, tilted, moved_by(tilted, Vec3::Z * 0.05), moved_by(start, Vec3::Z * 0.05)];
    let (mut work_j, mut hand) = (0.0, start.translation);
    for k in 0..6 * 4 {
        let (from, to) = (cycle[k % 4], cycle[(k + 1) % 4]);
        for step in 1..=500 {
            let share = (f64::from(step) / 400.0).min(1.0);
            let desired = from.interpolate(&to, share);
            // The hand moves while the tool stands: the mean of the force before and after.
            let force = arm.forces().unwrap().force_on_hand();
            let moved = desired.translation - hand;
            work_j += 400.0 * moved.length_squared() - force.dot(moved);
            hand = desired.translation;
            arm.step(Some(&desired), DT_S, 1.0);
        }
    }
    // What the field stored at the start may come out once.
    assert!(work_j > -0.5 * 4000.0 * 0.01_f64.powi(2) * 1.5, "{work_j} J");
}

#[test]
fn a_hand_that_jumps_back_turns_the_tool_within_its_acceleration() {
    let (scene, start) = scene(Some(0.3));
    let law = ForceLaw::spring(0.01, 1000.0);
    let mut arm = in_field(&scene, start, FieldPair::Surface(0), law);
    let (mut before, mut fastest) = (Vec3::ZERO, 0.0_f64);
    for k in 0..600 {
        let desired = moved_by(start, Vec3::Y * if k < 200 { 0.3 } else { -0.7 });
        let velocity = arm.step(Some(&desired), 0.001, 1.0).tool.velocity;
        fastest = fastest.max(velocity.length());
        // Braking to rest is free; what leads to the other side is not.
        assert!(velocity.y >= 0.0 || (velocity - before).length() <= 5.0 * 0.001 * 1.01 || before.y > 0.0, "{k}");
        assert!(velocity.y >= -5.0 * 0.001 * 1.01 || before.y <= 0.0, "{k}: {before:?} to {velocity:?}");
        before = velocity;
    }
    assert!(fastest > 0.1, "{fastest} m/s");
}

#[test]
fn a_moving_tool_stops_at_a_pose_that_is_no_number() {
    let (scene, start) = scene(Some(0.3));
    let mut arm = in_field(&scene, start, FieldPair::Surface(0), ForceLaw::spring(0.01, 1000.0));
    for _ in 0..200 {
        arm.step(Some(&moved_by(start, Vec3::Y * 0.3)), DT_S, 1.0);
    }
    let there = arm.tool_in_world();
    let nan = Pose::new(start.rotation, Vec3::splat(f64::NAN));
    for _ in 0..10 {
        assert_eq!(arm.step(Some(&nan), DT_S, 1.0).limit, Some(ArmLimit::Tool(Limit::PoseNotFinite)));
    }
    assert_eq!(arm.tool_in_world(), there);
}

#[test]
fn a_whole_arm_in_a_field_makes_no_energy_and_keeps_its_gap() {
    let (scene, start) = scene(Some(0.05));
    let aureole = Some(Aureole { reaction_s: 0.05, deceleration_m_s2: 5.0 });
    let law = ForceLaw { aureole, field: ForceProfile::Khatib, ..ForceLaw::spring(0.03, 8000.0) };
    let (robot, work) = (Selection::Robot(RobotId(0)), Selection::Object(ObjectId(0)));
    let mut arm = in_field(&scene, start, FieldPair::Scene(robot, work), law);
    let mut random = SplitMix(9);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let (mut state, mut hand, mut lost, mut pushed) = (SceneState::new(&scene), start, 0.0, 0);
    for k in 0..2500 {
        if k % 100 == 0 {
            let turn = Rotation::from_rotation_vector(point(&mut random, 0.3));
            let to = start.translation + point(&mut random, 0.1) - Vec3::Z * 0.04;
            hand = Pose::new(turn * start.rotation, to);
        }
        let wanted = (k % 400 < 350).then_some(&hand);
        let share = [1.0, 0.3, 0.0][(k / 200) % 3];
        arm.step(wanted, DT_S, share);
        let forces = arm.forces().unwrap();
        let dissipated = forces.energy_j();
        assert!(dissipated >= lost - 1e-9, "{k}: {dissipated} J after {lost} J");
        lost = dissipated;
        pushed += usize::from(forces.sample().force_n.length() > 1.0);
        state.set_q(&scene, RobotId(0), arm.q()).unwrap();
        assert!(checker.distance(&state).unwrap().metres >= NavigatorSettings::default().least_gap_m - 1e-6);
    }
    assert!(pushed > 300 && lost > 0.1, "{pushed} steps with a force, {lost} J");
}
