//! A monitor that keeps what it knows of regions reports the same as one that measures every region in every tick.

use std::sync::Arc;

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::{Capsule, ConvexHull, HalfSpace, Shape, Sphere, TriMesh};
use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};

use crate::common::{RandomGeometry, XorshiftStar, arm, arm_volumes, parts};
use crate::{
    AccessClass, Configuration, ConfigurationParts, Event, EventKind, Laws, Life, Monitor, OverrideReason, Region,
    RegionId, RegionKind, RobotSlot, SlotId, Snapshot, SourceId, SourceState, StoppingSettings, TickReport, VirtualTcp,
    Volume, VolumeId, ZoneArbiter,
};

const TICK_S: f64 = 0.002;

/// A solid of about `size` (m), of any kind.
fn shape(r: &mut XorshiftStar, size: f64) -> Shape {
    let corners = |r: &mut XorshiftStar| (0..12).map(|_| r.vec3(size)).collect::<Vec<Vec3>>();
    match r.below(4) {
        0 => Shape::Capsule(Capsule { half_length: size, radius: 0.4 * size }),
        1 => Shape::Hull(Arc::new(ConvexHull::from_points(&corners(r)).expect("points in space"))),
        2 => {
            let hull = ConvexHull::from_points(&corners(r)).expect("points in space");
            let mesh = TriMesh::new(hull.vertices().to_vec(), hull.triangles().to_vec()).expect("a closed mesh");
            Shape::Mesh(Arc::new(mesh))
        }
        _ => Shape::Sphere(Sphere { radius: size }),
    }
}

fn region(r: &mut XorshiftStar, i: usize) -> Region {
    let at = r.direction() * r.between(0.3, 1.7) + Vec3::Z * 0.6;
    let turn = Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0));
    let size = r.between(0.02, 0.2);
    let name = format!("{i}");
    let region = match i % 5 {
        0 => Region::sphere(name, at, size),
        1 => Region::cylinder(name, at, size, 2.0 * size, turn),
        2 => Region::cuboid(
            name,
            at,
            Vec3::new(2.0 * size, if i.is_multiple_of(2) { 4e-3 } else { 2.0 * size }, size),
            turn,
        ),
        _ => Region::solid(name, shape(r, size), Pose::new(turn, at)),
    };
    let region = region.warning(if r.below(4) == 0 { 0.0 } else { r.between(0.02, 0.2) });
    let hysteresis_m = [1e-3, 0.0, 0.03][r.below(3)];
    let region = Region { hysteresis_m, ..region };
    let region = match r.below(8) {
        0 => region.monitored(),
        1 => region.kind(RegionKind::Monitored { slow_to: Some(r.between(0.0, 0.9)) }),
        2 => region.kind(RegionKind::Exchange { slot: SlotId(0) }),
        _ => region,
    };
    match r.below(10) {
        0 => region.life(Life::Temporary),
        1 => region.follow(SourceId(0)),
        _ => region,
    }
}

fn laws(r: &mut XorshiftStar) -> Laws {
    let stopping = StoppingSettings {
        reaction_s: 0.01,
        period_s: TICK_S,
        joint_deceleration: vec![10.0; 6],
        joint_acceleration: vec![5.0; 6],
    };
    Laws {
        direction_aware: r.below(2) == 0,
        stopping_distance: (r.below(2) == 0).then_some(stopping),
        override_rate: if r.below(3) == 0 { 5.0 } else { 0.0 },
        ..Laws::default()
    }
}

/// Two monitors of the same world; the second one measures every region near in every tick, with exact requests.
struct Twins {
    monitor: Monitor,
    oracle: Monitor,
    part: VolumeId,
}

impl Twins {
    fn new(r: &mut XorshiftStar, regions: usize, laws: &Laws) -> Self {
        let mut regions: Vec<Region> = (0..regions).map(|i| region(r, i)).collect();
        // A floor beside the arm: it has no finite box.
        let floor = Region::solid("floor", Shape::HalfSpace(HalfSpace), Pose::from_translation(Vec3::Z * -0.2));
        regions.push(floor.warning(0.3));
        let mut volumes = arm_volumes();
        volumes.push(Volume::gripped("part", LinkId(6), Shape::Sphere(Sphere { radius: 0.1 })));
        let part = VolumeId(volumes.len() - 1);
        let sources = vec!["belt".into()];
        let parts = ConfigurationParts { laws: laws.clone(), sources, ..parts(arm(), volumes, regions) };
        let configuration = Configuration::new(parts).expect("valid");
        let monitor = || {
            let arbiter = Arc::new(ZoneArbiter::new(&["r"], &["shared"]));
            Monitor::new(configuration.clone(), Some((arbiter, RobotSlot(0)).into())).expect("valid")
        };
        let mut oracle = monitor();
        oracle.clearances.measures_all = true;
        Self { monitor: monitor(), oracle, part }
    }

    /// A tick of both; returns the report, and how many pairs each has measured.
    fn tick(&mut self, s: &Snapshot<'_>, only_closest_matters: bool) -> (TickReport, [u32; 2]) {
        let [mut report, mut expected] = [self.monitor.tick(s), self.oracle.tick(s)];
        let pairs = [report.measured_pairs, expected.measured_pairs];
        (report.measured_pairs, expected.measured_pairs) = (0, 0);
        assert_eq!(report, expected);
        assert_eq!(sorted_events(&self.monitor), sorted_events(&self.oracle));
        for region in (0..self.monitor.configuration().regions().len()).map(RegionId) {
            assert_eq!(self.monitor.is_inside(region), self.oracle.is_inside(region));
            assert_eq!(self.monitor.is_warned(region), self.oracle.is_warned(region));
            assert_eq!(self.monitor.exchange_state(region), self.oracle.exchange_state(region));
        }
        let [found, expected] = [&self.monitor, &self.oracle].map(|m| sorted_tcps(m, s));
        let names = |tcps: &[VirtualTcp]| tcps.iter().map(|t| t.region).collect::<Vec<_>>();
        assert_eq!(names(&found), names(&expected));
        if only_closest_matters {
            assert_eq!(found, expected);
        }
        (report, pairs)
    }
}

fn sorted_events(monitor: &Monitor) -> Vec<Event> {
    let mut events = monitor.events().to_vec();
    events.sort_by_key(|e| (e.region.map(|r| r.0), format!("{:?}", e.kind)));
    events
}

fn sorted_tcps(monitor: &Monitor, s: &Snapshot<'_>) -> Vec<VirtualTcp> {
    let mut tcps: Vec<VirtualTcp> = monitor.virtual_tcps(s).collect();
    tcps.sort_by_key(|t| t.region);
    tcps
}

/// What happened in runs.
#[derive(Debug, Default)]
struct Tally {
    /// Number of pairs that both monitors have measured.
    measured: [u32; 2],
    faults: u32,
    entries: u32,
    leaves: u32,
}

/// A run in a random world.
fn run(seed: u64, tally: &mut Tally) {
    let r = &mut XorshiftStar(seed);
    let laws = laws(r);
    let mut twins = Twins::new(r, 60, &laws);
    let only_closest_matters = !laws.direction_aware && laws.stopping_distance.is_none();
    let speed = r.between(0.1, 3.0);
    let phases: [f64; 6] = std::array::from_fn(|_| r.between(-3.0, 3.0));
    let (mut t, mut now_s, mut applied, mut stopped) = (0.0_f64, 0.0, 0.0, 0);
    for tick in 0..1500_u32 {
        // Some ticks are late, and some are too late.
        let dt_s = if tick % 40 == 0 { r.between(0.0, 0.03) } else { TICK_S };
        now_s += dt_s;
        let q: [f64; 6] = std::array::from_fn(|i| 1.3 * (t * (1.0 - 0.1 * i as f64) + phases[i]).sin());
        let intent: [f64; 6] = std::array::from_fn(|i| {
            let rate = 1.0 - 0.1 * i as f64;
            1.3 * speed * rate * (t * rate + phases[i]).cos()
        });
        let qd = intent.map(|v| v * applied);
        let belt = SourceState {
            pose: Pose::from_translation(Vec3::X * (0.2 * (0.5 * now_s).sin())),
            motion: FrameMotion { velocity: Vec3::X * (0.1 * (0.5 * now_s).cos()), ..FrameMotion::default() },
            stamp_s: now_s,
        };
        if tick % 200 == 150 {
            let region = RegionId(r.below(60));
            let on = r.below(2) == 0;
            for monitor in [&mut twins.monitor, &mut twins.oracle] {
                // Permanent regions cannot be switched.
                let _ = monitor.switch(region, on, AccessClass::Programmer);
            }
        }
        for monitor in [&mut twins.monitor, &mut twins.oracle] {
            match tick % 90 {
                30 => monitor.attach(twins.part, &Pose::from_translation(Vec3::X * 0.3)).expect("gripped"),
                70 => monitor.detach(twins.part).expect("gripped"),
                _ => {}
            }
        }
        let programmed_override = if tick % 300 < 200 { 1.0 } else { 0.4 };
        let sources = [belt];
        let s = Snapshot {
            qd: &qd,
            intent: (tick % 250 > 20).then_some(&intent),
            programmed_override,
            sources: &sources,
            ..Snapshot::stationary(now_s, &q)
        };
        let (report, pairs) = twins.tick(&s, only_closest_matters);
        let count = |kind| twins.monitor.events().iter().filter(|e| e.kind == kind).count() as u32;
        tally.measured.iter_mut().zip(pairs).for_each(|(sum, pairs)| *sum += pairs);
        tally.faults += u32::from(matches!(report.reason, OverrideReason::Fault(_)));
        tally.entries += count(EventKind::InsideIn);
        tally.leaves += count(EventKind::WarnOut);
        // The robot applies the override, and rests now and then. If it is stopped, it is moved elsewhere.
        stopped = if report.speed_override < 0.02 { stopped + 1 } else { 0 };
        applied = if tick % 500 < 30 { 0.0 } else { report.speed_override };
        if stopped > 25 {
            (t, applied, stopped) = (r.between(0.0, 100.0), 0.0, 0);
            twins.monitor.forget_position();
            twins.oracle.forget_position();
        }
        t += dt_s * speed * applied;
    }
}

/// `ELBOWROOM_RUNS`: number of runs.
#[test]
fn a_monitor_that_keeps_regions_reports_what_one_that_measures_all_regions_reports() {
    let runs: u64 = std::env::var("ELBOWROOM_RUNS").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let mut tally = Tally::default();
    for seed in 1..=runs {
        run(seed, &mut tally);
    }
    let [measured, of_all] = tally.measured;
    assert!(3 * measured < 2 * of_all, "kept regions were measured: {tally:?}");
    let per_run = |count: u32| f64::from(count) / runs as f64;
    assert!(per_run(tally.faults) < 300.0 && per_run(tally.entries) > 5.0 && per_run(tally.leaves) > 10.0, "{tally:?}");
}
