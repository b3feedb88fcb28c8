//! Comparison of the region-distance query with the monitor that created it, and of its motion bound with sampled
//! motions.

use std::sync::Arc;

use crate::common::{arm, arm_volumes, configuration, gantry, parts};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::{
    AccessClass, Configuration, ConfigurationParts, Grant, Guards, Life, Monitor, Occupancy, Region,
    RegionDistanceQuery, RegionId, RegionKind, RobotSlot, SlotId, Snapshot, SourceId, SourceState, Volume, ZoneArbiter,
};
use elbowroom_proximity::{HalfSpace, Shape};
use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};
use proptest::prelude::*;

fn regions() -> Vec<Region> {
    vec![
        Region::sphere("ball", Vec3::new(0.9, 0.2, 0.8), 0.2),
        Region::cuboid("crate", Vec3::new(-0.5, 0.7, 0.1), Vec3::new(0.4, 0.2, 0.9), Rotation::from_rpy(0.3, 0.1, 1.0))
            .guards(Guards::TOOL),
        Region::cylinder("post", Vec3::new(0.2, -0.9, 0.0), 0.1, 2.0, Rotation::IDENTITY).guards(Guards::TCP),
        Region::solid("floor", Shape::HalfSpace(HalfSpace), Pose::IDENTITY).follow(SourceId(0)),
        Region::sphere("report", Vec3::X, 0.5).monitored(),
        Region::sphere("later", Vec3::X, 0.5).life(Life::Temporary),
    ]
}

fn source() -> SourceState {
    let pose = Pose::new(Rotation::from_rpy(0.1, -0.2, 0.3), Vec3::new(0.1, 0.2, -0.4));
    SourceState { pose, motion: FrameMotion::REST, stamp_s: 0.0 }
}

fn monitor() -> Monitor {
    let parts = ConfigurationParts { sources: vec!["belt".into()], ..parts(arm(), arm_volumes(), regions()) };
    Monitor::new(Configuration::new(parts).unwrap(), None).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn it_agrees_with_the_monitor(q in prop::array::uniform6(-2.0..2.0_f64), limit in 0.0..1.5_f64) {
        let (mut monitor, sources) = (monitor(), [source()]);
        let queried: Vec<_> = {
            let mut query = monitor.region_distance(&sources);
            prop_assert_eq!(query.regions(), [0, 1, 2, 3].map(RegionId));
            query.set_q(&[0.3; 6]);
            query.set_q(&q);
            query.distances(limit).collect()
        };
        monitor.tick(&Snapshot { sources: &sources, ..Snapshot::stationary(0.0, &q) });
        for region in (0..4).map(RegionId) {
            let found = queried.iter().find(|a| a.0 == region).map(|a| a.1);
            match (found, monitor.distance(region, limit)) {
                (Some(a), Some(b)) => prop_assert!(a <= b && a >= b - 1e-9, "{a} {b}"),
                (a, b) => prop_assert_eq!(a, b),
            }
        }
    }

    #[test]
    fn no_guarded_point_travels_farther_than_the_bound(
        from in prop::array::uniform6(-2.0..2.0_f64),
        to in prop::array::uniform6(-2.0..2.0_f64),
        fraction in 0.0..1.0_f64,
        slides in any::<bool>(),
    ) {
        let tip = Vec3::new(0.1, -0.2, 0.15);
        let (chain, volumes) =
            if slides { (gantry(), vec![Volume::tcp(LinkId(6), tip)]) } else { (arm(), arm_volumes()) };
        let regions = vec![Region::sphere("far", Vec3::X * 9.0, 0.1).guards(Guards { tcp: true, tool: true, arm: true })];
        let monitor = Monitor::new(configuration(chain.clone(), volumes.clone(), regions), None).unwrap();
        let bound = monitor.region_distance(&[]).motion_bound(&from, &to);
        let mut state = ChainState::new(&chain);
        let mut points = |t: f64| -> Vec<Vec3> {
            for i in 0..6 {
                state.q[i] = from[i] + (to[i] - from[i]) * t;
            }
            chain.forward(&mut state);
            let corners = volumes.iter().flat_map(|v| {
                let b = v.shape.aabb(&Pose::IDENTITY);
                let pose = state.link_in_root(v.link) * v.in_link;
                // Centres of faces are points of capsules and boxes.
                [b.min.x, b.max.x].map(|x| pose.transform_point(Vec3::X * x)).into_iter()
                    .chain([b.min.z, b.max.z].map(|z| pose.transform_point(Vec3::Z * z)))
            });
            corners.collect()
        };
        // Length of the path within a fraction of the motion, by a polyline.
        let (mut travelled, mut before) = (vec![0.0; points(0.0).len()], points(0.0));
        for n in 1..=200 {
            let now = points(fraction * f64::from(n) / 200.0);
            travelled.iter_mut().zip(now.iter().zip(&before)).for_each(|(g, (a, b))| *g += a.distance(*b));
            before = now;
        }
        let longest = travelled.into_iter().fold(0.0, f64::max);
        prop_assert!(longest <= bound * fraction * (1.0 + 1e-9) + 1e-12, "{longest} {bound}");
        prop_assert!(bound.is_finite());
    }
}

#[test]
fn unknown_poses_count_as_inside() {
    let monitor = monitor();
    let assert_inside = |query: &RegionDistanceQuery<'_>| {
        let all: Vec<_> = query.distances(0.0).collect();
        assert!(all.len() == 4 && all.iter().all(|a| a.1 == 0.0), "{all:?}");
    };
    // The query has no joint values yet; invalid joint values; no state of the source.
    let sources = [source()];
    let mut query = monitor.region_distance(&sources);
    assert_inside(&query);
    for q in [&[f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0][..], &[0.0; 5], &[f64::INFINITY; 6]] {
        query.set_q(&[0.0; 6]);
        query.set_q(q);
        assert_inside(&query);
    }
    let mut without_sources = monitor.region_distance(&[]);
    without_sources.set_q(&[0.0; 6]);
    assert_inside(&without_sources);
    assert!(query.motion_bound(&[f64::NAN; 6], &[0.0; 6]).is_nan());
}

#[test]
fn closed_regions_are_active_and_forbidden_or_taken_by_another_robot() {
    let mut monitor = monitor();
    let closed = |m: &Monitor| (0..6).filter(|r| m.is_closed(RegionId(*r))).collect::<Vec<_>>();
    assert_eq!(closed(&monitor), [0, 1, 2, 3]);
    monitor.switch(RegionId(5), true, AccessClass::Programmer).unwrap();
    assert_eq!(closed(&monitor), [0, 1, 2, 3, 5]);

    let (slot, other) = (SlotId(0), RobotSlot(1));
    let arbiter = Arc::new(ZoneArbiter::new(&["r", "other"], &["shared"]));
    let shared =
        Region::sphere("shared", Vec3::new(0.9, 0.0, 1.2), 0.3).warning(0.2).kind(RegionKind::Exchange { slot });
    let config = configuration(arm(), arm_volumes(), vec![shared]);
    let mut monitor = Monitor::new(config, Some((arbiter.clone(), RobotSlot(0)).into())).unwrap();
    let shared = RegionId(0);
    assert!(!monitor.is_closed(shared), "it has no holder");
    arbiter.publish(slot, RobotSlot(0), Occupancy::Outside, 0.0);
    arbiter.publish(slot, other, Occupancy::Warning, 0.0);
    assert_eq!(arbiter.request(slot, other, 0.0), Grant::Held);
    assert!(monitor.is_closed(shared) && monitor.region_distance(&[]).regions() == [shared]);
    arbiter.publish(slot, other, Occupancy::Outside, 0.0);
    assert!(!monitor.is_closed(shared));
    // The arm approaches and is granted the slot.
    monitor.tick(&Snapshot::stationary(0.0, &[0.0; 6]));
    assert!(monitor.holds(shared) && !monitor.is_closed(shared));
    // Another robot is inside without a request, as after a start.
    let arbiter = Arc::new(ZoneArbiter::new(&["r", "other"], &["shared"]));
    let config = monitor.configuration().clone();
    let monitor = Monitor::new(config, Some((arbiter.clone(), RobotSlot(0)).into())).unwrap();
    arbiter.publish(slot, other, Occupancy::Inside, 0.0);
    assert!(monitor.is_closed(shared));
}
