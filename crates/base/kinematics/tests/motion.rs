//! Poses compared with a direct product of matrices, velocities and Jacobians with finite differences, on random
//! trees and on every real robot.
#![allow(clippy::print_stdout)]

use crate::common;
use crate::common::{RandomGeometry, SplitMix, robots};
use elbowroom_kinematics::{Chain, ChainState, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};
use proptest::prelude::*;

type Matrix = [[f64; 4]; 4];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

fn matrix(p: &Pose) -> Matrix {
    let [a, b, c] = p.to_rows();
    [a, b, c, [0.0, 0.0, 0.0, 1.0]]
}

/// Rodrigues' formula, written out.
fn about(axis: Vec3, angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    let k = [[0.0, -axis.z, axis.y], [axis.z, 0.0, -axis.x], [-axis.y, axis.x, 0.0]];
    let mut m = [[0.0; 4]; 4];
    for i in 0..3 {
        for j in 0..3 {
            let unit = if i == j { 1.0 } else { 0.0 };
            m[i][j] = unit + s * k[i][j] + (1.0 - c) * (0..3).map(|l| k[i][l] * k[l][j]).sum::<f64>();
        }
    }
    m[3][3] = 1.0;
    m
}

/// The pose by recursion from the link to the root, with mimics resolved by name; independent of the crate's pass.
fn direct(chain: &Chain, q: &[f64], link: LinkId) -> Matrix {
    let Some(joint) = chain.joints().iter().find(|j| j.child == link) else {
        return matrix(&Pose::IDENTITY);
    };
    let before = product(&direct(chain, q, joint.parent), &matrix(&joint.origin));
    let value = direct_value(chain, q, joint);
    match joint.kind {
        JointKind::Fixed => before,
        JointKind::Prismatic => product(&before, &matrix(&Pose::from_translation(joint.axis * value))),
        _ => product(&before, &about(joint.axis, value)),
    }
}

fn direct_value(chain: &Chain, q: &[f64], joint: &Joint) -> f64 {
    match joint.mimic {
        Some(m) => m.multiplier * direct_value(chain, q, &chain.joints()[m.joint.0]) + m.offset,
        None => chain.joint(&joint.name).and_then(|id| chain.q_index(id)).map_or(0.0, |i| q[i]),
    }
}

/// A random tree: shuffled links and joints, every kind, arbitrary axes, mimics and mimics of mimics.
fn random_tree(random: &mut SplitMix) -> Chain {
    let n = 2 + random.below(9);
    let mut order: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        order.swap(i, random.below(i + 1));
    }
    let axes = [Vec3::X, -Vec3::Y, Vec3::Z, random.vector(), Vec3::new(0.0, 3.0, -4.0)];
    let mut joints: Vec<Joint> = (1..n)
        .map(|i| Joint {
            name: format!("joint {i}"),
            kind: [JointKind::Fixed, JointKind::Revolute, JointKind::Continuous, JointKind::Prismatic][random.below(4)],
            parent: LinkId(order[random.below(i)]),
            child: LinkId(order[i]),
            origin: if random.below(3) == 0 { Pose::from_translation(random.vector()) } else { random.pose() },
            axis: axes[random.below(5)],
            limits: Limits::symmetric(3.0),
            mimic: None,
        })
        .collect();
    for i in 1..joints.len() {
        let of = random.below(i);
        if random.below(3) == 0 && joints[of].kind != JointKind::Fixed {
            let (multiplier, offset) = (random.between(-2.0, 2.0), random.between(-1.0, 1.0));
            joints[i].mimic = Some(Mimic { joint: JointId(of), multiplier, offset });
        }
    }
    Chain::new("tree", (0..n).map(|i| format!("link {i}")).collect(), joints).unwrap()
}

fn random_state(random: &mut SplitMix, chain: &Chain) -> ChainState {
    let mut state = ChainState::new(chain);
    for i in 0..chain.dof() {
        state.q[i] = random.between(-3.0, 3.0);
        state.qd[i] = random.between(-2.0, 2.0);
        state.qdd[i] = random.between(-5.0, 5.0);
    }
    state
}

fn moved(chain: &Chain, state: &ChainState, dt: f64) -> ChainState {
    let mut later = state.clone();
    for i in 0..chain.dof() {
        later.q[i] = state.q[i] + state.qd[i] * dt + 0.5 * state.qdd[i] * dt * dt;
        later.qd[i] = state.qd[i] + state.qdd[i] * dt;
    }
    chain.forward_motion(&mut later);
    later
}

fn check_poses(chain: &Chain, state: &mut ChainState) {
    chain.forward(state);
    let only_poses = state.clone();
    chain.forward_motion(state);
    for link in (0..chain.links().len()).map(LinkId) {
        let (pose, expected) = (state.link_in_root(link), direct(chain, &state.q, link));
        assert_eq!(pose, only_poses.link_in_root(link));
        for (row, wanted) in pose.to_rows().iter().flatten().zip(expected.iter().flatten()) {
            assert!((row - wanted).abs() < 1e-12, "{} {row} {wanted}", chain.links()[link.0]);
        }
    }
}

fn check_motions(chain: &Chain, state: &ChainState) {
    let h = 1e-5;
    let (before, after) = (moved(chain, state, -h), moved(chain, state, h));
    for link in (0..chain.links().len()).map(LinkId) {
        let FrameMotion { velocity, angular_velocity, acceleration, angular_acceleration } = state.link_motion(link);
        let (a, b) = (before.link_in_root(link), after.link_in_root(link));
        let (va, vb) = (before.link_motion(link), after.link_motion(link));
        let size = 1.0 + velocity.length() + acceleration.length() + angular_acceleration.length() * 4.0;
        let close = |got: Vec3, expected: Vec3, what: &str| {
            let tolerance = 2e-7 * size * (1.0 + angular_velocity.length_squared());
            assert!(got.distance(expected) < tolerance, "{what} of {}: {got:?} {expected:?}", chain.links()[link.0]);
        };
        close(velocity, (b.translation - a.translation) / (2.0 * h), "velocity");
        close(
            angular_velocity,
            (b.rotation * a.rotation.inverse()).to_rotation_vector() / (2.0 * h),
            "angular velocity",
        );
        close(acceleration, (vb.velocity - va.velocity) / (2.0 * h), "acceleration");
        close(angular_acceleration, (vb.angular_velocity - va.angular_velocity) / (2.0 * h), "angular acceleration");
    }
}

fn check_jacobian(chain: &Chain, state: &ChainState, link: LinkId, point_in_link: Vec3) {
    let mut columns = vec![[f64::NAN; 6]; chain.dof()];
    chain.jacobian(state, link, point_in_link, &mut columns);
    let sum = |row: usize| columns.iter().zip(&state.qd).map(|(c, qd)| c[row] * qd).sum::<f64>();
    let pose = state.link_in_root(link);
    let motion = state.link_motion(link);
    let velocity = motion.velocity_at(pose.transform_vector(point_in_link));
    for i in 0..3 {
        assert!((sum(i) - velocity[i]).abs() < 1e-11 * (1.0 + velocity.length()));
        assert!((sum(i + 3) - motion.angular_velocity[i]).abs() < 1e-11 * (1.0 + motion.angular_velocity.length()));
    }
    let h = 1e-6;
    for (k, column) in columns.iter().enumerate() {
        let at = |dq: f64| {
            let mut nudged = state.clone();
            nudged.q[k] += dq;
            chain.forward(&mut nudged);
            nudged.link_in_root(link)
        };
        let (a, b) = (at(-h), at(h));
        let linear = (b.transform_point(point_in_link) - a.transform_point(point_in_link)) / (2.0 * h);
        let angular = (b.rotation * a.rotation.inverse()).to_rotation_vector() / (2.0 * h);
        for i in 0..3 {
            assert!((column[i] - linear[i]).abs() < 1e-7 * (1.0 + linear.length()));
            assert!((column[i + 3] - angular[i]).abs() < 1e-7 * (1.0 + angular.length()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn random_trees_match_matrices_and_finite_differences(seed: u64) {
        let mut random = SplitMix(seed);
        let chain = random_tree(&mut random);
        let mut state = random_state(&mut random, &chain);
        check_poses(&chain, &mut state);
        check_motions(&chain, &state);
        let link = LinkId(random.below(chain.links().len()));
        check_jacobian(&chain, &state, link, random.vector());
    }

    #[test]
    fn a_moved_root_frame_moves_everything_alike(seed: u64) {
        // The tree is on a rotated base: all poses and velocities rotate with it.
        let mut random = SplitMix(seed);
        let chain = random_tree(&mut random);
        let base = random.pose();
        let mut joints = chain.joints().to_vec();
        let mut links = chain.links().to_vec();
        links.push("ground".into());
        joints.push(Joint {
            name: "mount".into(),
            kind: JointKind::Fixed,
            parent: LinkId(links.len() - 1),
            child: chain.root(),
            origin: base,
            axis: Vec3::Z,
            limits: Limits::UNLIMITED,
            mimic: None,
        });
        let hung = Chain::new("hung", links, joints).unwrap();
        let mut state = random_state(&mut random, &chain);
        let mut turned = ChainState::new(&hung);
        (turned.q, turned.qd, turned.qdd) = (state.q.clone(), state.qd.clone(), state.qdd.clone());
        chain.forward_motion(&mut state);
        hung.forward_motion(&mut turned);
        for link in (0..chain.links().len()).map(LinkId) {
            let (a, b) = (base * state.link_in_root(link), turned.link_in_root(link));
            prop_assert!((a.translation - b.translation).length() < 1e-12);
            let (a, b) = (state.link_motion(link).acceleration, turned.link_motion(link).acceleration);
            prop_assert!((base.transform_vector(a) - b).length() < 1e-11 * (1.0 + b.length()));
        }
    }
}

#[test]
fn every_real_robot_matches_matrices_and_finite_differences() {
    for (name, path) in robots() {
        let chain = common::load(&path);
        let mut random = SplitMix(11);
        for _ in 0..20 {
            let mut state = random_state(&mut random, &chain);
            random.state(&chain, &mut state.q);
            check_poses(&chain, &mut state);
            check_motions(&chain, &state);
            check_jacobian(&chain, &state, chain.tip(), random.vector());
        }
        println!("{name}: {} links, {} joints, {} free", chain.links().len(), chain.joints().len(), chain.dof());
    }
}

#[test]
fn a_short_q_gives_nan_and_not_a_pose() {
    let mut random = SplitMix(3);
    let chain = loop {
        let chain = random_tree(&mut random);
        if chain.dof() > 1 {
            break chain;
        }
    };
    let mut state = ChainState::new(&chain);
    state.q.clear();
    chain.forward_motion(&mut state);
    let moved = chain.joints()[chain.active_joints()[0].0].child;
    let pose = state.link_in_root(moved);
    assert!(!(pose.translation.is_finite() && pose.rotation.is_finite()));
}
