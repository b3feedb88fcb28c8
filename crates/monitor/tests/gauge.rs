//! The gauge beside the monitor that it was made by, and its bound of motion beside motion.

mod common;

use std::sync::Arc;

use common::{arm, arm_volumes, configuration, gantry, parts};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::{
    AccessClass, Board, Configuration, ConfigurationParts, Grant, Guards, Kind, Life, Monitor, Region, RegionId,
    RobotSlot, SlotId, Snapshot, Source, SourceId, Stay, Volume,
};
use elbowroom_proximity::{HalfSpace, Shape};
use elbowroom_spatial::{Motion, Pose, Rotation, Vec3};
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

fn source() -> Source {
    let pose = Pose::new(Rotation::from_rpy(0.1, -0.2, 0.3), Vec3::new(0.1, 0.2, -0.4));
    Source { pose, motion: Motion::REST, stamp_s: 0.0 }
}

fn monitor() -> Monitor {
    let parts = ConfigurationParts { sources: vec!["belt".into()], ..parts(arm(), arm_volumes(), regions()) };
    Monitor::new(Configuration::new(parts).unwrap(), None).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn it_measures_what_the_monitor_would(q in prop::array::uniform6(-2.0..2.0_f64), limit in 0.0..1.5_f64) {
        let (mut monitor, sources) = (monitor(), [source()]);
        let asked: Vec<_> = {
            let mut gauge = monitor.gauge(&sources);
            prop_assert_eq!(gauge.regions(), [0, 1, 2, 3].map(RegionId));
            gauge.place(&[0.3; 6]);
            gauge.place(&q);
            gauge.distances(limit).collect()
        };
        monitor.tick(&Snapshot { sources: &sources, ..Snapshot::still(0.0, &q) });
        for region in (0..4).map(RegionId) {
            let told = asked.iter().find(|a| a.0 == region).map(|a| a.1);
            match (told, monitor.distance(region, limit)) {
                (Some(a), Some(b)) => prop_assert!(a <= b && a >= b - 1e-9, "{a} {b}"),
                (a, b) => prop_assert_eq!(a, b),
            }
        }
    }

    #[test]
    fn no_guarded_point_goes_farther_than_it_says(
        from in prop::array::uniform6(-2.0..2.0_f64),
        to in prop::array::uniform6(-2.0..2.0_f64),
        share in 0.0..1.0_f64,
        slides in any::<bool>(),
    ) {
        let tip = Vec3::new(0.1, -0.2, 0.15);
        let (chain, volumes) =
            if slides { (gantry(), vec![Volume::tcp(LinkId(6), tip)]) } else { (arm(), arm_volumes()) };
        let regions = vec![Region::sphere("far", Vec3::X * 9.0, 0.1).guards(Guards { tcp: true, tool: true, arm: true })];
        let monitor = Monitor::new(configuration(chain.clone(), volumes.clone(), regions), None).unwrap();
        let bound = monitor.gauge(&[]).travel(&from, &to);
        let mut state = ChainState::new(&chain);
        let mut places = |t: f64| -> Vec<Vec3> {
            for i in 0..6 {
                state.q[i] = from[i] + (to[i] - from[i]) * t;
            }
            chain.forward(&mut state);
            let corners = volumes.iter().flat_map(|v| {
                let b = v.shape.aabb(&Pose::IDENTITY);
                let pose = state.link_in_root(v.link) * v.in_link;
                // Middles of faces are points of capsules and boxes.
                [b.min.x, b.max.x].map(|x| pose.transform_point(Vec3::X * x)).into_iter()
                    .chain([b.min.z, b.max.z].map(|z| pose.transform_point(Vec3::Z * z)))
            });
            corners.collect()
        };
        // The whole length of the way, by a polyline; and in a share of it.
        let (mut gone, mut before) = (vec![0.0; places(0.0).len()], places(0.0));
        for n in 1..=200 {
            let now = places(share * f64::from(n) / 200.0);
            gone.iter_mut().zip(now.iter().zip(&before)).for_each(|(g, (a, b))| *g += a.distance(*b));
            before = now;
        }
        let most = gone.into_iter().fold(0.0, f64::max);
        prop_assert!(most <= bound * share * (1.0 + 1e-9) + 1e-12, "{most} {bound}");
        prop_assert!(bound.is_finite());
    }
}

#[test]
fn what_is_not_known_is_inside() {
    let monitor = monitor();
    let inside = |gauge: &elbowroom_monitor::Gauge<'_>| {
        let all: Vec<_> = gauge.distances(0.0).collect();
        assert!(all.len() == 4 && all.iter().all(|a| a.1 == 0.0), "{all:?}");
    };
    // Nowhere yet; values that are none; regions that follow nobody.
    let sources = [source()];
    let mut gauge = monitor.gauge(&sources);
    inside(&gauge);
    for q in [&[f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0][..], &[0.0; 5], &[f64::INFINITY; 6]] {
        gauge.place(&[0.0; 6]);
        gauge.place(q);
        inside(&gauge);
    }
    let mut lost = monitor.gauge(&[]);
    lost.place(&[0.0; 6]);
    inside(&lost);
    assert!(gauge.travel(&[f64::NAN; 6], &[0.0; 6]).is_nan());
}

#[test]
fn closed_is_what_is_forbidden_now_or_in_the_hands_of_another() {
    let mut monitor = monitor();
    let closed = |m: &Monitor| (0..6).filter(|r| m.is_closed(RegionId(*r))).collect::<Vec<_>>();
    assert_eq!(closed(&monitor), [0, 1, 2, 3]);
    monitor.switch(RegionId(5), true, AccessClass::Programmer).unwrap();
    assert_eq!(closed(&monitor), [0, 1, 2, 3, 5]);

    let (slot, other) = (SlotId(0), RobotSlot(1));
    let board = Arc::new(Board::new(&["r", "other"], &["shared"]));
    let shared = Region::sphere("shared", Vec3::new(0.9, 0.0, 1.2), 0.3).warning(0.2).kind(Kind::Exchange { slot });
    let config = configuration(arm(), arm_volumes(), vec![shared]);
    let mut monitor = Monitor::new(config, Some((board.clone(), RobotSlot(0)))).unwrap();
    let shared = RegionId(0);
    assert!(!monitor.is_closed(shared), "nobody has it");
    board.publish(slot, RobotSlot(0), Stay::Outside, 0.0);
    board.publish(slot, other, Stay::Warning, 0.0);
    assert_eq!(board.request(slot, other, 0.0), Grant::Held);
    assert!(monitor.is_closed(shared) && monitor.gauge(&[]).regions() == [shared]);
    board.publish(slot, other, Stay::Outside, 0.0);
    assert!(!monitor.is_closed(shared));
    // The arm comes to it and gets it.
    monitor.tick(&Snapshot::still(0.0, &[0.0; 6]));
    assert!(monitor.holds(shared) && !monitor.is_closed(shared));
    // Inside without having asked, as after a start.
    let board = Arc::new(Board::new(&["r", "other"], &["shared"]));
    let config = monitor.configuration().clone();
    let monitor = Monitor::new(config, Some((board.clone(), RobotSlot(0)))).unwrap();
    board.publish(slot, other, Stay::Inside, 0.0);
    assert!(monitor.is_closed(shared));
}
