//! Requirements on inverse kinematics beyond success rates: all branches, nearest first, limits, singular poses, exact errors.

use crate::common;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::common::{RandomGeometry, SplitMix, disguised_wrist_arm, robots, serial};
use elbowroom_kinematics::dh::ClassicalRow;
use elbowroom_kinematics::inverse::{IkError, IkMethod, IkOptions, IkSolver, IkTask};
use elbowroom_kinematics::{Chain, ChainState, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_spatial::{Pose, Rotation, Vec3};

fn errors(chain: &Chain, q: &[f64], target: &Pose) -> (f64, f64) {
    let mut state = ChainState::new(chain);
    state.q.copy_from_slice(q);
    chain.forward(&mut state);
    let tip = state.link_in_root(chain.tip());
    (tip.translation.distance(target.translation), (tip.rotation.inverse() * target.rotation).angle())
}

fn tip_at(chain: &Chain, q: &[f64]) -> Pose {
    let mut state = ChainState::new(chain);
    state.q.copy_from_slice(q);
    chain.forward(&mut state);
    state.link_in_root(chain.tip())
}

fn solver(chain: &Chain) -> IkSolver {
    IkSolver::new(chain, chain.tip(), Pose::IDENTITY, IkOptions::default())
}

fn same_modulo_turns(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| {
        let d = a - b;
        (d - TAU * (d / TAU).round()).abs() < tolerance
    })
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn spherical_wrists_are_detected_in_any_frames() {
    let mut random = SplitMix(2);
    for _ in 0..300 {
        let chain = disguised_wrist_arm(&mut random, PI);
        let mut solver = solver(&chain);
        assert_eq!(solver.method(), IkMethod::SphericalWrist);
        for _ in 0..5 {
            let (mut q, mut seed) = (vec![0.0; 6], vec![0.0; 6]);
            random.state(&chain, &mut q);
            random.state(&chain, &mut seed);
            let target = tip_at(&chain, &q);
            let all = solver.solve_all(&target, &seed);
            assert!(all.len() <= 8);
            for answer in &all {
                let (m, rad) = errors(&chain, answer, &target);
                assert!(m <= 1e-12 && rad <= 1e-12, "{m} {rad}");
                assert!(answer.iter().all(|v| v.abs() <= PI));
            }
            assert!(all.windows(2).all(|w| distance(&w[0], &seed) <= distance(&w[1], &seed) + 1e-12));
            assert!(all.iter().any(|a| same_modulo_turns(a, &q, 1e-6)), "the one it was made from: {q:?} {all:?}");
            assert_eq!(solver.solve(&target, &seed).unwrap().q, all[0]);
        }
    }
}

#[test]
fn real_spherical_wrists_give_all_branches() {
    for (name, path) in robots() {
        let chain = common::load(&path);
        let mut solver = solver(&chain);
        if solver.method() != IkMethod::SphericalWrist {
            continue;
        }
        let mut random = SplitMix(8);
        let (mut q, seed) = (vec![0.0; chain.dof()], vec![0.0; chain.dof()]);
        for _ in 0..100 {
            random.state(&chain, &mut q);
            let all = solver.solve_all(&tip_at(&chain, &q), &seed);
            let moving: Vec<usize> = chain.path(chain.tip()).into_iter().filter_map(|j| chain.q_index(j)).collect();
            let pick = |v: &[f64]| moving.iter().map(|&i| v[i]).collect::<Vec<_>>();
            assert!(all.iter().any(|a| same_modulo_turns(&pick(a), &pick(&q), 1e-6)), "{name} {q:?} {all:?}");
        }
    }
}

#[test]
fn singular_poses_have_solutions() {
    for name in ["comau_ns16arc", "kuka_kr150_2", "abb_irb2400", "staubli_tx60", "fanuc_m10ia", "ur5e", "panda"] {
        let Some(chain) = common::robot(name) else {
            return;
        };
        let mut solver = solver(&chain);
        let (lower, upper) = (chain.lower(), chain.upper());
        let n = chain.dof();
        let mut random = SplitMix(4);
        for k in 0..60 {
            let mut q = vec![0.0; n];
            random.state(&chain, &mut q);
            match k % 4 {
                0 => q[4] = 0.0,                                                            // wrist stretched
                1 => q[2] = 0.0,                                                            // elbow
                2 => q.iter_mut().for_each(|v| *v = 0.0),                                   // everything at zero
                _ => q.clone_from(&if k % 8 == 3 { lower.clone() } else { upper.clone() }), // in the corner of the limits
            }
            for i in 0..n {
                q[i] = q[i].clamp(lower[i], upper[i]);
            }
            let target = tip_at(&chain, &q);
            let mut seed = vec![0.0; n];
            random.state(&chain, &mut seed);
            for seed in [&seed, &q] {
                let answer = solver.solve(&target, seed).unwrap_or_else(|e| panic!("{name} {k} {q:?}: {e}"));
                let (m, rad) = errors(&chain, &answer.q, &target);
                assert!(m <= 1e-9 && rad <= 2e-9, "{name} {m} {rad}");
                assert!((0..n).all(|i| answer.q[i] >= lower[i] && answer.q[i] <= upper[i]));
            }
        }
    }
}

#[test]
fn a_seed_on_the_solution_is_the_solution() {
    for (name, path) in robots() {
        let chain = common::load(&path);
        let mut solver = solver(&chain);
        let mut random = SplitMix(6);
        let mut q = vec![0.0; chain.dof()];
        for _ in 0..50 {
            random.state(&chain, &mut q);
            let target = tip_at(&chain, &q);
            let answer = solver.solve(&target, &q).unwrap_or_else(|e| panic!("{name} {q:?}: {e}"));
            assert!(distance(&answer.q, &q) < 1e-6, "{name} {q:?} {:?}", answer.q);
            let mut near: Vec<f64> = q.iter().map(|v| v + random.between(-1e-4, 1e-4)).collect();
            for ((v, lo), hi) in near.iter_mut().zip(chain.lower()).zip(chain.upper()) {
                *v = v.clamp(lo, hi);
            }
            assert!(solver.refine(&target, &mut near), "{name} {q:?}");
        }
    }
}

#[test]
fn full_turns_follow_the_seed_within_the_limits() {
    let mut random = SplitMix(12);
    let chain = disguised_wrist_arm(&mut random, 3.0 * PI);
    let mut solver = solver(&chain);
    for _ in 0..200 {
        let (mut q, mut seed) = (vec![0.0; 6], vec![0.0; 6]);
        random.state(&chain, &mut q);
        random.state(&chain, &mut seed);
        let answer = solver.solve(&tip_at(&chain, &q), &seed).unwrap();
        for (v, s) in answer.q.iter().zip(&seed) {
            assert!(v.abs() <= 3.0 * PI);
            assert!((v - s).abs() <= PI + 1e-9 || v.abs() > PI, "no nearer turn was within: {v} {s}");
        }
    }
    let endless: Vec<_> = chain
        .joints()
        .iter()
        .map(|j| {
            let kind = if j.kind == JointKind::Fixed { JointKind::Fixed } else { JointKind::Continuous };
            (kind, j.origin, j.axis, j.limits)
        })
        .collect();
    let chain = serial(&endless);
    let mut solver = IkSolver::new(&chain, chain.tip(), Pose::IDENTITY, IkOptions::default());
    let q = [0.3, -0.4, 0.5, 0.6, 0.7, 0.8];
    let seed: Vec<f64> = q.iter().map(|v| v + 40.0 * TAU + 0.01).collect();
    let answer = solver.solve(&tip_at(&chain, &q), &seed).unwrap();
    assert!(distance(&answer.q, &seed) < 0.1, "{answer:?}");
}

#[test]
fn errors_name_the_cause() {
    let mut random = SplitMix(20);
    let chain = disguised_wrist_arm(&mut random, PI);
    let mut closed = solver(&chain);
    let far = Pose::from_translation(Vec3::X * 100.0);
    match closed.solve(&far, &[0.0; 6]) {
        Err(IkError::Unreachable { position_error_m, .. }) => assert!(position_error_m > 90.0),
        other => panic!("{other:?}"),
    }
    assert!(closed.solve_all(&far, &[0.0; 6]).is_empty());
    for seed in [&[0.0; 5][..], &[0.0; 7], &[f64::NAN; 6], &[f64::INFINITY; 6]] {
        assert!(matches!(closed.solve(&Pose::IDENTITY, seed), Err(IkError::SeedLength | IkError::SeedNotFinite)));
        assert!(closed.solve_all(&Pose::IDENTITY, seed).is_empty());
    }
    let nowhere = Pose::from_translation(Vec3::splat(f64::NAN));
    assert!(matches!(closed.solve(&nowhere, &[0.0; 6]), Err(IkError::TargetNotFinite)));
    let mut q = [0.0; 6];
    assert!(!closed.refine(&nowhere, &mut q) && !closed.refine(&far, &mut q));

    // A planar arm that reaches the target only with an elbow beyond its limits.
    let z = Vec3::Z;
    let stiff = serial(&[
        (JointKind::Revolute, Pose::IDENTITY, z, Limits::symmetric(3.0)),
        (JointKind::Revolute, Pose::from_translation(Vec3::X), z, Limits::range(-0.1, 0.1)),
        (JointKind::Fixed, Pose::from_translation(Vec3::X), z, Limits::UNLIMITED),
    ]);
    let options = IkOptions { task: IkTask::Position, ..IkOptions::default() };
    let mut planar = IkSolver::new(&stiff, stiff.tip(), Pose::IDENTITY, options);
    match planar.solve(&Pose::from_translation(Vec3::new(1.0, 0.5, 0.0)), &[0.0; 2]) {
        Err(IkError::Limits { joint, value, upper, .. }) => {
            assert!(joint == "j1" && value.abs() > upper);
        }
        other => panic!("{other:?}"),
    }
    // The target is off the arm's plane: within reach, but without a solution.
    match planar.solve(&Pose::from_translation(Vec3::new(1.0, 0.5, 0.2)), &[0.0; 2]) {
        Err(IkError::NoConvergence { position_error_m, .. }) => assert!(position_error_m > 0.15),
        other => panic!("{other:?}"),
    }
}

/// The remaining error is the error of the closest pose found, not of the seed.
#[test]
fn a_target_beyond_reach_is_as_far_as_the_arm_ends_before_it() {
    let z = Vec3::Z;
    let planar = serial(&[
        (JointKind::Revolute, Pose::IDENTITY, z, Limits::symmetric(3.0)),
        (JointKind::Revolute, Pose::from_translation(Vec3::X), z, Limits::symmetric(3.0)),
        (JointKind::Revolute, Pose::from_translation(Vec3::X), z, Limits::symmetric(3.0)),
        (JointKind::Fixed, Pose::from_translation(Vec3::X * 0.1), z, Limits::UNLIMITED),
    ]);
    for task in [IkTask::Pose, IkTask::Position] {
        let options = IkOptions { task, ..IkOptions::default() };
        let mut solver = IkSolver::new(&planar, planar.tip(), Pose::IDENTITY, options);
        // The seed points in the opposite direction: 5.1 m from the target.
        match solver.solve(&Pose::from_translation(Vec3::X * 3.0), &[PI - 0.2, 0.0, 0.0]) {
            Err(IkError::Unreachable { position_error_m, angle_error_rad }) => {
                assert!((position_error_m - 0.9).abs() < 1e-3, "{task:?}: {position_error_m}");
                assert!(task == IkTask::Position || angle_error_rad < 1e-2, "{angle_error_rad}");
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn extreme_numbers_terminate_without_success() {
    let mut random = SplitMix(21);
    let wrist = disguised_wrist_arm(&mut random, PI);
    let as_endless = |chain: &Chain, drop_wrist: bool| {
        let mut joints = chain.joints().to_vec();
        for joint in joints.iter_mut().filter(|j| j.kind != JointKind::Fixed) {
            joint.kind = JointKind::Continuous;
        }
        if drop_wrist {
            joints[4].origin = joints[4].origin * Pose::from_translation(Vec3::splat(0.1));
        }
        Chain::new("endless", chain.links().to_vec(), joints).unwrap()
    };
    for chain in [wrist.clone(), as_endless(&wrist, false), as_endless(&wrist, true)] {
        let mut solver = solver(&chain);
        for _ in 0..300 {
            let odd = |random: &mut SplitMix| {
                [0.0, -0.0, 1e-300, 1.0, -3.0, 1e6, -1e16, 1e100, -1e300, f64::MAX, f64::NAN, f64::INFINITY]
                    [random.below(12)]
            };
            let seed: [f64; 6] = std::array::from_fn(|_| odd(&mut random));
            let target = if random.below(2) == 0 {
                Pose::from_translation(Vec3::new(odd(&mut random), odd(&mut random), odd(&mut random)))
            } else {
                tip_at(&chain, &std::array::from_fn::<f64, 6, _>(|_| random.between(-PI, PI)))
            };
            if let Ok(answer) = solver.solve(&target, &seed) {
                let (m, rad) = errors(&chain, &answer.q, &target);
                assert!(m <= 1e-9 && rad <= 1e-9, "{seed:?} {target:?} {answer:?}");
            }
            for q in solver.solve_all(&target, &seed) {
                assert!(errors(&chain, &q, &target).0 <= 1e-9);
            }
            let mut q = seed;
            if solver.refine(&target, &mut q) {
                assert!(errors(&chain, &q, &target).0 <= 1e-9);
            }
        }
    }
}

#[test]
fn fewer_than_six_axes_reach_positions_and_possible_poses() {
    let (y, z) = (Vec3::Y, Vec3::Z);
    let limits = Limits::symmetric(3.0);
    let chain = serial(&[
        (JointKind::Revolute, Pose::from_translation(z * 0.3), z, limits),
        (JointKind::Revolute, Pose::IDENTITY, y, limits),
        (JointKind::Prismatic, Pose::from_translation(z * 0.2), z, Limits::range(0.0, 0.5)),
        (JointKind::Fixed, Pose::from_translation(z * 0.1), z, Limits::UNLIMITED),
    ]);
    let q = [0.5, 0.7, 0.3];
    let target = tip_at(&chain, &q);
    let mut pose = solver(&chain);
    assert_eq!(pose.method(), IkMethod::Numeric);
    let answer = pose.solve(&target, &[0.1; 3]).unwrap();
    assert!(answer.position_error_m < 1e-12 && answer.angle_error_rad < 1e-12);
    let turned = Pose::new(Rotation::from_rpy(0.0, 2.0, 0.0), target.translation);
    assert!(pose.solve(&turned, &[0.1; 3]).is_err());
    let options = IkOptions { task: IkTask::Position, ..IkOptions::default() };
    let answer = IkSolver::new(&chain, chain.tip(), Pose::IDENTITY, options).solve(&turned, &[0.1; 3]).unwrap();
    assert!(answer.position_error_m < 1e-9 && answer.angle_error_rad > 0.1, "{answer:?}");
}

#[test]
fn locked_joints_stay_and_joints_off_the_path_keep_their_seed() {
    let limits = Limits::symmetric(3.0);
    let (y, z) = (Vec3::Y, Vec3::Z);
    let up = Pose::from_translation(z * 0.4);
    let mut joints: Vec<_> = [z, y, z, y, z, y, z].map(|axis| (JointKind::Revolute, up, axis, limits)).to_vec();
    joints[2].3 = Limits::range(0.25, 0.25);
    let chain = serial(&joints);
    let mut solver = solver(&chain);
    let target = tip_at(&chain, &[0.1, 0.5, 0.25, 0.8, -0.4, 0.9, 0.2]);
    let answer = solver.solve(&target, &[0.0; 7]).unwrap();
    assert_eq!(answer.q[2], 0.25);

    // A gripper on the third link: its joint does not move the tip.
    let mut joints = chain.joints().to_vec();
    let mut links = chain.links().to_vec();
    links.push("finger".into());
    let finger = Joint { name: "finger".into(), parent: LinkId(3), child: LinkId(8), ..joints[0].clone() };
    joints.insert(0, finger);
    let gripping = Chain::new("gripping", links, joints).unwrap();
    let mut seed = vec![0.0; 8];
    seed[0] = 1.234;
    let mut solver = IkSolver::new(&gripping, gripping.link("l7").unwrap(), Pose::IDENTITY, IkOptions::default());
    let again = solver.solve(&target, &seed).unwrap();
    assert_eq!((again.q[0], &again.q[1..]), (1.234, &answer.q[..]));
}

#[test]
fn mimic_joints_on_the_path_are_followed() {
    let limits = Limits::symmetric(2.5);
    let (y, z) = (Vec3::Y, Vec3::Z);
    let up = Pose::from_translation(z * 0.4);
    let mut joints =
        serial(&[z, y, y, z, y, z, y].map(|axis| (JointKind::Revolute, up, axis, limits))).joints().to_vec();
    joints[2].mimic = Some(Mimic { joint: JointId(1), multiplier: -0.5, offset: 0.2 });
    let chain = Chain::new("mimic", (0..8).map(|i| format!("l{i}")).collect(), joints).unwrap();
    assert_eq!(chain.dof(), 6);
    let mut solver = solver(&chain);
    assert_eq!(solver.method(), IkMethod::Numeric);
    let mut random = SplitMix(30);
    let (mut q, mut seed, mut found) = (vec![0.0; 6], vec![0.0; 6], 0);
    for _ in 0..200 {
        random.state(&chain, &mut q);
        random.state(&chain, &mut seed);
        let target = tip_at(&chain, &q);
        if let Ok(answer) = solver.solve(&target, &seed) {
            let (m, rad) = errors(&chain, &answer.q, &target);
            assert!(m < 1e-9 && rad < 1e-9);
            found += 1;
        }
    }
    assert!(found >= 198, "{found}");
}

#[test]
fn the_same_input_gets_the_same_solution() {
    let rows: Vec<ClassicalRow> = (0..7)
        .map(|i| ClassicalRow {
            joint: format!("j{i}"),
            kind: JointKind::Revolute,
            a: 0.0,
            alpha: if i % 2 == 0 { FRAC_PI_2 } else { -FRAC_PI_2 },
            d: 0.2,
            theta: 0.0,
            limits: Limits::symmetric(2.0),
        })
        .collect();
    let chain = Chain::from_dh("seven", &rows).unwrap();
    let target = tip_at(&chain, &[0.3, 1.0, -0.7, 1.2, 0.4, -0.9, 1.1]);
    let (mut first, mut used) = (solver(&chain), solver(&chain));
    let _ = used.solve(&Pose::from_translation(Vec3::splat(0.3)), &[0.5; 7]);
    let (a, b) = (first.solve(&target, &[0.0; 7]).unwrap(), used.solve(&target, &[0.0; 7]).unwrap());
    assert_eq!(a, b);
    let all = first.solve_all(&target, &[0.0; 7]);
    assert!(all.len() > 1 && all.len() <= 16);
    for q in all {
        let (m, rad) = errors(&chain, &q, &target);
        assert!(m < 1e-9 && rad < 1e-9);
    }
}

/// The arm, or a tenth of it, with joints up to 0.4 mrad and 0.4 mm off, or exact, and limits of which some end at `q`.
fn inexact(chain: &Chain, q: &[f64], random: &mut SplitMix) -> Chain {
    let mut joints = chain.joints().to_vec();
    let (size, scale) = ([0.0, 1e-6, 4e-4][random.below(3)], [1.0, 0.1][random.below(2)]);
    for (joint, q) in joints.iter_mut().zip(q) {
        let direction = |random: &mut SplitMix| random.pose().rotation * Vec3::X;
        let axis = direction(random);
        let off = Pose::new(Rotation::from_axis_angle(axis, random.between(-size, size)), direction(random) * size);
        joint.origin.translation = joint.origin.translation * scale;
        joint.origin = joint.origin * off;
        let beyond =
            |random: &mut SplitMix| if random.unit() < 0.3 { 0.0 } else { 10f64.powf(random.between(-8.0, 0.0)) };
        joint.limits = Limits { lower: q - beyond(random), upper: q + beyond(random), ..joint.limits };
    }
    Chain::new(chain.name(), chain.links().to_vec(), joints).unwrap()
}

/// The value of a joint for which a quantity of the form `a + b·cos(value − s)` is extreme: `s` or half a turn from it.
fn extreme(chain: &Chain, q: &[f64], joint: usize, quantity: impl Fn(&ChainState) -> f64) -> f64 {
    let at = |value: f64| {
        let mut state = ChainState::new(chain);
        state.q.copy_from_slice(q);
        state.q[joint] = value;
        chain.forward(&mut state);
        quantity(&state)
    };
    let (front, side, back) = (at(0.0), at(FRAC_PI_2), at(PI));
    (side - 0.5 * (front + back)).atan2(0.5 * (front - back))
}

#[test]
fn the_closed_form_never_proves_that_a_pose_is_out_of_reach_which_is_not() {
    let mut random = SplitMix(31);
    let (mut closed, mut single) = (0, 0);
    for round in 0..6000 {
        let ideal = disguised_wrist_arm(&mut random, PI);
        let mut q = vec![0.0; 6];
        random.state(&ideal, &mut q);
        let near =
            |random: &mut SplitMix| [0.0, 1e-7, 1e-5, 1e-3, 0.02, 0.1][random.below(6)] * random.between(-1.0, 1.0);
        if round % 3 > 0 {
            let axis = |state: &ChainState, joint: usize| {
                state.link_in_root(LinkId(joint + 1)).rotation * ideal.joints()[joint].axis
            };
            q[4] = extreme(&ideal, &q, 4, |state| axis(state, 3).dot(axis(state, 5))) + near(&mut random);
        }
        if round % 3 > 1 {
            let center = |state: &ChainState, link: usize| state.link_in_root(LinkId(link)).translation;
            let squared = |state: &ChainState| center(state, 5).distance(center(state, 2)).powi(2);
            q[2] = extreme(&ideal, &q, 2, squared) + PI * random.below(2) as f64 + near(&mut random);
        }
        let chain = inexact(&ideal, &q, &mut random);
        let mut solver = solver(&chain);
        // The search begins at a solution: none is found only if none is searched.
        let all = solver.solve_all(&tip_at(&chain, &q), &q);
        assert!(!all.is_empty(), "round {round}: {q:?}");
        closed += usize::from(solver.method() == IkMethod::SphericalWrist);
        single += usize::from(all.len() == 1);
    }
    assert!(closed > 3000 && single > 1000, "{closed} {single}");
}
