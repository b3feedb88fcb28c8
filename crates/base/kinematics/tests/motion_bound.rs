//! Motion bounds compared with points of moving links.

use elbowroom_kinematics::motion_bound::{displacement_bound, max_motion_bounds, motion_bound};
use elbowroom_kinematics::{Chain, ChainState, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use proptest::prelude::*;

/// A chain with rotations, slides without limits, and mimic joints with an offset.
fn chain() -> Chain {
    use JointKind::{Continuous, Prismatic, Revolute};
    let kinds = [Revolute, Prismatic, Continuous, Revolute, Prismatic, Revolute];
    let axes = [Vec3::Z, Vec3::X, Vec3::Y, Vec3::X, Vec3::Z, Vec3::Y];
    let joint = |(i, (kind, axis)): (usize, (JointKind, Vec3))| Joint {
        name: format!("j{i}"),
        kind,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::new(Rotation::from_rpy(0.4, -0.3 * i as f64, 0.2), Vec3::new(0.1, -0.2, 0.3)),
        axis,
        limits: if kind == Prismatic {
            Limits::range(f64::NEG_INFINITY, f64::INFINITY)
        } else {
            Limits::symmetric(3.0)
        },
        mimic: match i {
            3 => Some(Mimic { joint: JointId(0), multiplier: -0.7, offset: 0.2 }),
            4 => Some(Mimic { joint: JointId(1), multiplier: 1.5, offset: -0.6 }),
            _ => None,
        },
    };
    let joints = kinds.into_iter().zip(axes).enumerate().map(joint).collect();
    Chain::new("chain", (0..7).map(|i| format!("l{i}")).collect(), joints).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]
    #[test]
    fn no_point_within_the_radius_travels_farther(
        from in prop::array::uniform4(-2.5..2.5_f64),
        to in prop::array::uniform4(-2.5..2.5_f64),
        on in prop::array::uniform3(-1.0..1.0_f64),
        link in 0..7_usize,
        share in 0.0..1.0_f64,
    ) {
        let chain = chain();
        prop_assert_eq!(chain.dof(), 4);
        let point = Vec3::from(on) * 0.5;
        let bound = displacement_bound(&chain, LinkId(link), point.length(), &from, &to);
        let mut state = ChainState::new(&chain);
        let mut place = |t: f64| {
            (0..4).for_each(|i| state.q[i] = from[i] + (to[i] - from[i]) * t);
            chain.forward(&mut state);
            state.link_in_root(LinkId(link)).transform_point(point)
        };
        let (mut travelled, mut before) = (0.0, place(0.0));
        for n in 1..=200 {
            let now = place(share * f64::from(n) / 200.0);
            travelled += now.distance(before);
            before = now;
        }
        prop_assert!(bound.is_finite() && travelled <= bound * share * (1.0 + 1e-9), "{travelled} {bound} {share}");
        // Without a slide on the path both bounds agree.
        if link == 1 {
            let bounds = motion_bound(&chain, LinkId(1), point.length(), &chain.path(LinkId(1)));
            let other: f64 = bounds.iter().map(|(j, b)| b * (from[*j] - to[*j]).abs()).sum();
            prop_assert!((bound - other).abs() <= 1e-12);
        }
    }
}

#[test]
fn nan_and_infinity_bound_nothing() {
    let chain = chain();
    assert!(displacement_bound(&chain, LinkId(6), 0.1, &[f64::NAN; 4], &[0.0; 4]).is_nan());
    assert!(!displacement_bound(&chain, LinkId(6), f64::INFINITY, &[0.0; 4], &[1.0; 4]).is_finite());
    assert!(displacement_bound(&chain, LinkId(6), 0.1, &[1.0; 4], &[1.0; 4]) < 1e-300);
}

#[test]
fn mimic_joints_add_to_the_joint_that_they_follow() {
    let chain = chain();
    let link = LinkId(4);
    let single = motion_bound(&chain, link, 0.1, &chain.path(link));
    assert_eq!(single.iter().map(|b| b.0).collect::<Vec<_>>(), [0, 2, 1, 0]);
    let per_q = max_motion_bounds(&chain, [(link, 0.1), (LinkId(0), 5.0)]);
    assert_eq!(per_q.len(), 4);
    assert_eq!((per_q[0], per_q[3]), (single[0].1 + single[3].1, 0.0));
}
