//! A whole arm whose tool is guided: it follows, glides, and stops before anything touches.

use elbowroom_kinematics::ChainState;
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState, Selection};
use elbowroom_shared_control::force::{
    ArmField, ArmForces, Aureole, BodySettings, Field, FieldPair, ForceLaw, Response, VirtualBody,
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
        let mut torques = [0.0; 6];
        forces.joint_torques(&Pose::IDENTITY, &mut torques);
        // By the principle of virtual work, from finite differences.
        let (robot, flange, tcp_in_flange, _) = arm::arm();
        let mut state = ChainState::new(&robot.chain);
        for (joint, torque) in torques.iter().enumerate() {
            let mut z = |h: f64| {
                state.q.copy_from_slice(arm.q());
                state.q[joint] += h;
                robot.chain.forward(&mut state);
                (state.link_in_root(flange) * tcp_in_flange).translation.z
            };
            let expected = felt.z * (z(1e-6) - z(-1e-6)) / 2e-6;
            assert!((torque - expected).abs() < 1e-3, "joint {joint}: {torque} N·m instead of {expected}");
        }
    }
}

#[test]
fn a_whole_arm_in_a_field_makes_no_energy_and_keeps_its_gap() {
    let (scene, start) = scene(Some(0.05));
    let aureole = Some(Aureole { reaction_s: 0.05, deceleration_m_s2: 5.0 });
    let law = ForceLaw { aureole, field: Field::Khatib, ..ForceLaw::spring(0.03, 8000.0) };
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
