//! Points of surfaces as ends of chains: forward kinematics, Jacobians, inverse kinematics.
#![allow(clippy::print_stdout)]

use std::f64::consts::PI;

use crate::common::awkward::awkward_chain;
use crate::common::{RandomGeometry, SplitMix, serial};
use elbowroom_kinematics::surface_ik::{OrientedPoint, PointChain, PointError, SurfaceIkOptions};
use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits, LinkId};
use elbowroom_spatial::{Pose, Vec3};
use proptest::prelude::*;

/// The oracle: point and normal by the chain's own forward kinematics.
fn place(chain: &Chain, link: LinkId, point: Vec3, normal: Vec3, q: &[f64]) -> (Vec3, Vec3) {
    let mut state = ChainState::new(chain);
    state.q.copy_from_slice(q);
    chain.forward(&mut state);
    let link_in_root = state.link_in_root(link);
    (link_in_root.transform_point(point), link_in_root.transform_vector(normal))
}

fn x(metres: f64) -> Pose {
    Pose::from_translation(Vec3::X * metres)
}

/// Two links of 0.5 m and 0.3 m in the plane, rotating about z.
fn planar(limits: Limits) -> (Chain, PointChain) {
    let turn = |origin| (JointKind::Revolute, origin, Vec3::Z, limits);
    let chain = serial(&[turn(Pose::IDENTITY), turn(x(0.5))]);
    let end = PointChain::new(&chain, LinkId(2), Vec3::X * 0.3, Some(Vec3::X), SurfaceIkOptions::default()).unwrap();
    (chain, end)
}

fn at(point: Vec3) -> OrientedPoint {
    OrientedPoint { point_in_root: point, normal_in_root: None }
}

/// An arm of six axes with offsets everywhere.
fn six(limits: Limits) -> Chain {
    let axes = [Vec3::Z, Vec3::Y, Vec3::Y, Vec3::X, Vec3::Y, Vec3::X];
    let offsets =
        [(0.0, 0.0, 0.4), (0.15, 0.0, 0.1), (0.0, 0.02, 0.6), (0.1, 0.0, 0.1), (0.5, 0.0, 0.0), (0.1, 0.0, 0.0)];
    let joint = |(axis, (x, y, z))| (JointKind::Revolute, Pose::from_translation(Vec3::new(x, y, z)), axis, limits);
    serial(&axes.into_iter().zip(offsets).map(joint).collect::<Vec<_>>())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_point_is_that_of_forward_kinematics_and_the_jacobian_its_derivative(seed in any::<u64>()) {
        let mut random = SplitMix(seed);
        let chain = awkward_chain(&mut random);
        let link = LinkId(random.below(chain.links().len()));
        let (point, normal) = (random.vector(), random.vector().try_normalize().unwrap_or(Vec3::X));
        let mut end = PointChain::new(&chain, link, point, Some(normal * 3.0), SurfaceIkOptions::default()).unwrap();
        let mut q = vec![0.0; chain.dof()];
        random.state(&chain, &mut q);
        let here = end.place(&q);
        let (p, n) = place(&chain, link, point, normal, &q);
        prop_assert!(here.point_in_root.distance(p) < 1e-12 && here.normal_in_root.unwrap().distance(n) < 1e-12);

        let (mut three, mut five) = (vec![[f64::NAN; 3]; q.len()], vec![[f64::NAN; 5]; q.len()]);
        end.jacobian(&q, &mut three);
        let [t1, t2] = end.jacobian_with_normal(&q, &mut five).unwrap();
        prop_assert!(t1.cross(t2).distance(n) < 1e-12);
        for i in 0..q.len() {
            let h = 1e-6;
            let value = q[i];
            q[i] = value + h;
            let (p1, n1) = place(&chain, link, point, normal, &q);
            q[i] = value - h;
            let (p0, n0) = place(&chain, link, point, normal, &q);
            q[i] = value;
            let (dp, dn) = ((p1 - p0) / (2.0 * h), (n1 - n0) / (2.0 * h));
            for (k, slope) in [dp.x, dp.y, dp.z, t1.dot(dn), t2.dot(dn)].into_iter().enumerate() {
                prop_assert!((five[i][k] - slope).abs() < 1e-7, "{i} {k} {} {slope}", five[i][k]);
                prop_assert!(k >= 3 || three[i][k] == five[i][k]);
            }
            let moves = end.joints().iter().any(|j| chain.q_index(*j) == Some(i));
            prop_assert!(moves || five[i] == [0.0; 5]);
        }
    }

    /// Solutions reach the target by the chain's own forward kinematics, within its limits.
    #[test]
    fn solutions_hold_and_joints_off_the_path_stay(seed in any::<u64>()) {
        let mut random = SplitMix(seed);
        let chain = awkward_chain(&mut random);
        let link = LinkId(random.below(chain.links().len()));
        let (point, normal) = (random.vector(), random.vector().try_normalize().unwrap_or(Vec3::X));
        let mut end = PointChain::new(&chain, link, point, Some(normal), SurfaceIkOptions::default()).unwrap();
        let (mut there, mut start) = (vec![0.0; chain.dof()], vec![0.0; chain.dof()]);
        random.state(&chain, &mut there);
        random.state(&chain, &mut start);
        let (p, n) = place(&chain, link, point, normal, &there);
        let wanted = random.below(2) == 0;
        let target = OrientedPoint { point_in_root: p, normal_in_root: wanted.then_some(n * 2.0) };
        let mut q = start.clone();
        let answer = end.solve(&target, &mut q);
        let (p1, n1) = place(&chain, link, point, normal, &q);
        let angle = if wanted { n1.cross(n).length().atan2(n1.dot(n)) } else { 0.0 };
        let (metres, radians) = match answer {
            Ok(r) => (r.position_error_m, r.angle_error_rad),
            Err(PointError::NotReached { position_error_m, angle_error_rad, .. }) => (position_error_m, angle_error_rad),
            Err(e) => panic!("{e}"),
        };
        if answer.is_ok() {
            prop_assert!(p1.distance(p) <= 1.1e-6 && angle <= 1.1e-6);
        }
        prop_assert!((p1.distance(p) - metres).abs() < 1e-9 && (angle - radians).abs() < 1e-9);
        for (i, id) in chain.active_joints().iter().enumerate() {
            prop_assert!(chain.joints()[id.0].limits.contains(q[i], 0.0));
            prop_assert!(end.joints().contains(id) || q[i] == start[i]);
        }
        // The same input gives the same solution; another point in between changes nothing.
        let mut again = start.clone();
        end.set_point(Vec3::splat(0.3), None).unwrap();
        let _ = end.solve(&at(Vec3::splat(0.2)), &mut again);
        end.set_point(point, Some(normal)).unwrap();
        again.copy_from_slice(&start);
        prop_assert_eq!(end.solve(&target, &mut again), answer);
        prop_assert_eq!(again, q);
    }

    #[test]
    fn the_error_never_grows(seed in any::<u64>()) {
        let mut random = SplitMix(seed);
        let chain = awkward_chain(&mut random);
        let mut end = PointChain::new(&chain, chain.tip(), random.vector(), None, SurfaceIkOptions::default()).unwrap();
        let mut q = vec![0.0; chain.dof()];
        random.state(&chain, &mut q);
        let target = at(random.vector() * 2.0);
        let mut before = end.place(&q).point_in_root.distance(target.point_in_root);
        for _ in 0..12 {
            let remains = match end.refine(&target, &mut q, 1) {
                Ok(r) => r.position_error_m,
                Err(PointError::NotReached { position_error_m, starts: 1, .. }) => position_error_m,
                Err(e) => panic!("{e}"),
            };
            prop_assert!(remains <= before + 1e-15, "{remains} {before}");
            prop_assert!((end.place(&q).point_in_root.distance(target.point_in_root) - remains).abs() < 1e-15);
            before = remains;
        }
    }

    /// NaN and infinity are refused in every argument and change nothing.
    #[test]
    fn nan_and_infinity_are_refused(which in 0_usize..8, bad in prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY)], axis in 0_usize..3) {
        let chain = six(Limits::symmetric(2.0));
        let spoiled = |v: Vec3| { let mut a = v.to_array(); a[axis] = bad; Vec3::from(a) };
        let mut end = PointChain::new(&chain, LinkId(6), Vec3::X, Some(Vec3::Z), SurfaceIkOptions::default()).unwrap();
        let mut q = [0.1; 6];
        let mut target = OrientedPoint { point_in_root: Vec3::X, normal_in_root: Some(Vec3::X) };
        let refused = match which {
            0 => PointChain::new(&chain, LinkId(6), spoiled(Vec3::X), None, SurfaceIkOptions::default()).err(),
            1 => PointChain::new(&chain, LinkId(6), Vec3::X, Some(spoiled(Vec3::X)), SurfaceIkOptions::default()).err(),
            2 => end.set_point(Vec3::X, Some(Vec3::ZERO)).err(),
            3 => { q[axis] = bad; end.solve(&target, &mut q).err() }
            4 => { target.point_in_root = spoiled(Vec3::X); end.solve(&target, &mut q).err() }
            5 => { target.normal_in_root = Some(spoiled(Vec3::X)); end.refine(&target, &mut q, 5).err() }
            6 => { target.normal_in_root = Some(Vec3::ZERO); end.solve(&target, &mut q).err() }
            _ => end.solve(&target, &mut q[..5]).err(),
        };
        prop_assert!(refused.as_ref().is_some_and(|e| !matches!(e, PointError::NotReached { .. })), "{refused:?}");
        prop_assert!(q.iter().enumerate().all(|(i, v)| *v == 0.1 || (which == 3 && i == axis)));
    }
}

/// The targets are reachable by construction, from a random start, on every link of an arm with narrow and with wide
/// limits.
#[test]
fn reachable_targets_are_reached() {
    for bound in [0.8, 2.0, PI, 6.0] {
        let chain = six(Limits::symmetric(bound));
        let mut random = SplitMix(3);
        for link in (1..=6).map(LinkId) {
            for wanted in [false, true] {
                let (mut q, mut reached) = (vec![0.0; 6], 0);
                for _ in 0..300 {
                    let (point, normal) = (random.vector() * 0.3, random.vector());
                    let mut end =
                        PointChain::new(&chain, link, point, Some(normal), SurfaceIkOptions::default()).unwrap();
                    random.state(&chain, &mut q);
                    let mut target = end.place(&q);
                    target.normal_in_root = target.normal_in_root.filter(|_| wanted);
                    random.state(&chain, &mut q);
                    reached += usize::from(end.solve(&target, &mut q).is_ok());
                }
                assert!(reached >= 299, "limits ±{bound}, {link:?}, normal {wanted}: {reached} of 300");
            }
        }
    }
}

#[test]
fn out_of_reach_the_nearest_configuration_and_its_distance_are_returned() {
    let (_, mut end) = planar(Limits::symmetric(PI));
    // The targets are beyond the stretched arm, inside the unreachable disc, and off its plane.
    for (target, distance) in [
        (Vec3::new(0.9, -1.2, 0.0), 1.5 - 0.8),
        (Vec3::new(0.06, 0.08, 0.0), 0.2 - 0.1),
        (Vec3::new(0.3, 0.4, -0.25), 0.25),
    ] {
        let mut q = [0.3, 1.0];
        let Err(PointError::NotReached { position_error_m, starts, .. }) = end.solve(&at(target), &mut q) else {
            panic!("{target:?} is out of reach")
        };
        assert!((position_error_m - distance).abs() < 1e-6, "{target:?} {position_error_m} {distance}");
        assert!(starts > 1);
        assert!((end.place(&q).point_in_root.distance(target) - position_error_m).abs() < 1e-12);
    }
    // The range is a quarter turn.
    let (_, mut end) = planar(Limits::range(0.0, PI / 2.0));
    let mut q = [0.3, 1.0];
    let Err(error) = end.solve(&at(Vec3::X * -0.8), &mut q) else { panic!("behind the limits") };
    let best = (0..=1000).flat_map(|i| (0..=1000).map(move |k| [f64::from(i), f64::from(k)].map(|v| v * PI / 2000.0)));
    let best = best.map(|q| end.place(&q).point_in_root.distance(Vec3::X * -0.8)).fold(f64::INFINITY, f64::min);
    let PointError::NotReached { position_error_m, .. } = error else { panic!("{error}") };
    assert!((position_error_m - best).abs() < 1e-3, "{position_error_m} {best}");
    assert!(error.to_string().contains("m and"), "{error}");
}

#[test]
fn a_normal_can_be_required_where_there_is_one() {
    let (chain, mut end) = planar(Limits::symmetric(3.0));
    let mut q = [0.2, 0.4];
    // Elbow up or down: the normal decides.
    for elbow in [0.7, -0.7] {
        let target = end.place(&[0.5, elbow]);
        end.solve(&target, &mut q).unwrap();
        assert!((q[0] - 0.5).abs() < 1e-8 && (q[1] - elbow).abs() < 1e-8, "{q:?}");
    }
    // The opposite normal at the same point: only the error is returned.
    let target = end.place(&[0.5, 0.0]);
    let behind = OrientedPoint { normal_in_root: target.normal_in_root.map(|n| -n), ..target };
    assert!(matches!(end.solve(&behind, &mut q), Err(PointError::NotReached { .. })));
    let mut bare = PointChain::new(&chain, LinkId(2), Vec3::X, None, SurfaceIkOptions::default()).unwrap();
    assert_eq!(bare.solve(&target, &mut q), Err(PointError::NoNormal));
    assert!(bare.jacobian_with_normal(&q, &mut [[1.0; 5]; 2]).is_err());
}

#[test]
fn the_root_has_no_joints_and_an_unknown_link_is_refused() {
    let chain = six(Limits::symmetric(2.0));
    let mut fixed = PointChain::new(&chain, chain.root(), Vec3::Y, Some(Vec3::Y), SurfaceIkOptions::default()).unwrap();
    let mut q = [0.1; 6];
    assert!(fixed.joints().is_empty());
    assert!(fixed.solve(&at(Vec3::Y), &mut q).is_ok());
    let Err(PointError::NotReached { position_error_m, .. }) = fixed.solve(&at(Vec3::Z), &mut q) else {
        panic!("the root does not move")
    };
    assert!((position_error_m - 2.0_f64.sqrt()).abs() < 1e-15 && q == [0.1; 6]);
    let stranger = PointChain::new(&chain, LinkId(7), Vec3::Y, None, SurfaceIkOptions::default());
    assert!(matches!(stranger, Err(PointError::UnknownLink { link: 7, last: 6 })));
    // Too few values give NaN, not a point.
    let mut end = PointChain::new(&chain, LinkId(6), Vec3::Y, None, SurfaceIkOptions::default()).unwrap();
    assert!(end.place(&[0.0; 3]).point_in_root.x.is_nan());
}

#[test]
fn a_near_start_gives_a_near_solution() {
    let chain = six(Limits::symmetric(6.0));
    let mut random = SplitMix(8);
    let mut end =
        PointChain::new(&chain, LinkId(6), Vec3::X * 0.2, Some(Vec3::X), SurfaceIkOptions::default()).unwrap();
    let mut worst: f64 = 0.0;
    for _ in 0..500 {
        let mut q = [0.0; 6];
        random.state(&chain, &mut q);
        let near = q.map(|v| (v + random.between(-1e-3, 1e-3)).clamp(-6.0, 6.0));
        let target = end.place(&near);
        let start = q;
        if end.solve(&target, &mut q).is_ok_and(|r| r.restarts == 0) {
            let moved = q.iter().zip(start).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            worst = worst.max(moved);
        }
    }
    assert!(worst < 0.5, "{worst}");
}

#[test]
fn extreme_numbers_terminate_without_success() {
    let chain = six(Limits::symmetric(2.0));
    for length in [1e-300, 1e20, 1e200, f64::MAX] {
        let mut q = [0.1; 6];
        let mut far =
            PointChain::new(&chain, LinkId(6), Vec3::X * length, Some(Vec3::X), SurfaceIkOptions::default()).unwrap();
        let mut near = PointChain::new(&chain, LinkId(6), Vec3::X, Some(Vec3::X), SurfaceIkOptions::default()).unwrap();
        let wanted = OrientedPoint { point_in_root: Vec3::X * -length, normal_in_root: Some(Vec3::X * length) };
        for end in [&mut far, &mut near] {
            for target in [wanted, at(Vec3::X * length)] {
                if let Ok(reached) = end.solve(&target, &mut q) {
                    let place = end.place(&q).point_in_root;
                    assert!(reached.position_error_m <= 1e-6 && place.distance(target.point_in_root) <= 1e-6);
                }
                assert!(q.iter().all(|v| v.abs() <= 2.0), "{length} {q:?}");
            }
        }
    }
    let none = SurfaceIkOptions { starts: 0, ..SurfaceIkOptions::default() };
    let mut end = PointChain::new(&chain, LinkId(6), Vec3::X, None, none).unwrap();
    assert!(matches!(end.solve(&at(Vec3::X), &mut [0.0; 6]), Err(PointError::NoStarts)));
}
