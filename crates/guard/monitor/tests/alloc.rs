//! Test that a tick does not allocate. It runs without the test harness, because the counter includes all threads of
//! the process.

mod common;
mod rail;

use std::sync::Arc;

use common::{RandomGeometry, XorshiftStar, arm, arm_volumes, parts};
use elbowroom_interlock::wire::{MAX_BYTES, decode_state, encode_grants};
use elbowroom_interlock::{Arbiter, ArbiterSettings, Boot, Micros, RobotSettings, StateMessage};
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{
    AccessClass, Configuration, ConfigurationParts, EventKind, GridSpace, Laws, Life, Monitor, OutputGrid,
    OutputGridAxis, OverrideReason, Region, RegionKind, RobotSlot, SlotId, Snapshot, StoppingSettings, Volume,
    VolumeId, ZoneArbiter,
};
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use rail::{Carriage, REGION, SLOT};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn main() {
    let mut r = XorshiftStar(3);
    let regions = (0..1000).map(|i| {
        let at = r.vec3(1.5);
        let turn = Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0));
        let region = match i % 3 {
            0 => Region::sphere(format!("{i}"), at, 0.05),
            1 => Region::cylinder(format!("{i}"), at, 0.05, 0.1, turn),
            _ => Region::cuboid(format!("{i}"), at, Vec3::splat(0.1), turn),
        };
        let region = region.warning(0.1).life(if i % 2 == 0 { Life::Permanent } else { Life::Temporary });
        if i % 5 == 0 { region.kind(RegionKind::Monitored { slow_to: Some(0.5) }) } else { region }
    });
    let all =
        Laws { direction_aware: true, stopping_distance: Some(stopping()), override_rate: 5.0, ..Laws::default() };
    let regions: Vec<Region> = regions.collect();
    for laws in [Laws::default(), all] {
        let mut volumes = arm_volumes();
        volumes.push(Volume::gripped("part", LinkId(6), Shape::Sphere(Sphere { radius: 0.1 })));
        let part = VolumeId(volumes.len() - 1);
        let grids = grids();
        let parts = ConfigurationParts { laws, grids, ..parts(arm(), volumes, regions.clone()) };
        let mut m = Monitor::new(Configuration::new(parts).unwrap(), None).unwrap();
        let switchable = m.region("1").unwrap();
        let counter = AllocationCounter::start();
        let (mut pairs, mut applied, mut t, mut carried) = (0, 0.0, 0.0_f64, 0);
        let (mut cell_changes, mut before) = (0, 0);
        for i in 0..5000 {
            let now_s = 0.002 * f64::from(i);
            let q = [t.sin(), 0.5 * (1.3 * t).sin(), (0.7 * t).cos(), 0.2 * t.sin(), t.cos(), 0.0];
            let speed = [t.cos(), 0.65 * (1.3 * t).cos(), -0.7 * (0.7 * t).sin(), 0.2 * t.cos(), -t.sin(), 0.0];
            let qd = speed.map(|v| v * applied);
            m.switch(switchable, i % 7 < 3, AccessClass::Programmer).unwrap();
            match i % 100 {
                10 => m.attach(part, &Pose::from_translation(Vec3::X * 0.4)).unwrap(),
                60 => m.detach(part).unwrap(),
                _ => {}
            }
            carried += u32::from(m.is_attached(part));
            let report = m.tick(&Snapshot { qd: &qd, intent: Some(&speed), ..Snapshot::stationary(now_s, &q) });
            assert!(!matches!(report.reason, OverrideReason::Fault(_)), "{}", report.reason);
            pairs += report.measured_pairs;
            cell_changes += u32::from(report.outputs != before);
            before = report.outputs;
            // The robot applies the override, but creeps when it should stop.
            applied = report.speed_override;
            t += 0.002 * applied.max(0.1);
            assert!(m.events().len() < 8000);
        }
        let changes = counter.changes();
        assert!(pairs > 5000 && carried == 2500 && cell_changes > 10, "{cell_changes}");
        assert_eq!(changes, 0);
    }
    exchange();
    guarded();
}

/// A grid of the working area, and one of two joints.
fn grids() -> Vec<OutputGrid> {
    let axis = |count: u32| OutputGridAxis { from: -1.0, to: 1.0, count };
    let tcp = GridSpace::Tcp { frame_in_world: Pose::IDENTITY };
    let grid =
        |name: &str, space, axes, output| OutputGrid { name: name.into(), space, axes, output, hysteresis: 1e-3 };
    vec![
        grid("area", tcp, vec![axis(10), axis(10), axis(10)], 0),
        grid("sector", GridSpace::Joints(vec![0, 2]), vec![axis(20), axis(20)], 32),
    ]
}

fn stopping() -> StoppingSettings {
    StoppingSettings {
        reaction_s: 0.01,
        period_s: 0.002,
        joint_deceleration: vec![10.0; 6],
        joint_acceleration: vec![5.0; 6],
    }
}

/// Two arms that move through two exchange regions: granted, waiting, yielding, in a wait cycle.
fn exchange() {
    let slots = [SlotId(0), SlotId(1)];
    let arbiter = Arc::new(ZoneArbiter::new(&["a", "b"], &["left", "right"]));
    let region = |i: usize, y: f64| {
        Region::sphere(format!("{i}"), Vec3::new(0.9, y, 0.9), 0.2)
            .warning(0.3)
            .kind(RegionKind::Exchange { slot: slots[i] })
    };
    let stopping = stopping();
    let mut monitors: Vec<Monitor> = (0..2)
        .map(|robot| {
            let laws = Laws { stopping_distance: Some(stopping.clone()), ..Laws::default() };
            let regions = vec![region(0, 0.6), region(1, -0.6)];
            let parts = ConfigurationParts { laws, ..parts(arm(), arm_volumes(), regions) };
            Monitor::new(Configuration::new(parts).unwrap(), Some((arbiter.clone(), RobotSlot(robot)).into())).unwrap()
        })
        .collect();
    let counter = AllocationCounter::start();
    let (mut granted, mut waiting) = (0, 0);
    // Each robot applies its override, but creeps when it should stop.
    let mut robots = [(0.0_f64, 0.0), (2.0, 0.0)];
    for i in 0..20_000 {
        if i == 10_000 {
            (0..2).for_each(|robot| arbiter.declare(RobotSlot(robot), slots));
        }
        for (monitor, (t, applied)) in monitors.iter_mut().zip(&mut robots) {
            let q = [t.sin(), 0.9, 0.4, 0.0, 0.2, 0.0];
            let intent = [t.cos(), 0.0, 0.0, 0.0, 0.0, 0.0];
            let qd = intent.map(|v| v * *applied);
            let stationary = Snapshot::stationary(0.002 * f64::from(i), &q);
            let report = monitor.tick(&Snapshot { qd: &qd, intent: Some(&intent), ..stationary });
            *applied = report.speed_override;
            *t += 0.002 * applied.max(0.1);
            granted += monitor.events().iter().filter(|e| e.kind == EventKind::Granted).count();
            waiting += monitor.events().iter().filter(|e| e.kind == EventKind::Waiting).count();
        }
    }
    let changes = counter.changes();
    assert!(granted > 5 && waiting > 5, "granted {granted}, waiting {waiting}");
    assert_eq!(changes, 0);
}

/// A tick, including its messages, of a robot whose regions are granted on a network.
fn guarded() {
    let mut robot = Carriage::new(0, 0.0, 1.0).robot;
    let settings = ArbiterSettings::new(vec![RobotSettings::new("rail", [SLOT])], 1);
    let mut arbiter = Arbiter::new(settings, Boot(1));
    let mut message = StateMessage::with_slots(1);
    let mut bytes = Vec::with_capacity(MAX_BYTES);
    let (mut allocations, mut granted) = (0, 0);
    for tick in 0..10_000_u64 {
        // The robot moves back and forth through the region.
        let t = tick as f64 * 0.002;
        let (q, qd) = ([2.0 - 1.5 * t.cos()], [1.5 * t.sin()]);
        let now = Micros(1 + tick * 2_000);
        let counter = AllocationCounter::start();
        let snapshot = Snapshot { qd: &qd, intent: Some(&qd), ..Snapshot::stationary(now.0 as f64 * 1e-6, &q) };
        robot.tick(&snapshot, now);
        granted += robot.monitor().events().iter().filter(|e| e.kind == EventKind::Granted).count();
        let state = robot.state(now);
        decode_state(state, &mut message).expect("a state");
        allocations += counter.changes();
        // The arbiter allocates: it is not part of a robot's tick.
        let replies = arbiter.receive(&message, now).replies;
        let counter = AllocationCounter::start();
        for reply in &replies {
            assert!(encode_grants(reply, &mut bytes));
            robot.receive(&bytes).expect("grants");
        }
        allocations += counter.changes();
    }
    assert!(granted > 3 && robot.monitor().is_active(REGION), "granted {granted}");
    assert_eq!((allocations, robot.guard().must_halt(SLOT)), (0, false));
}
