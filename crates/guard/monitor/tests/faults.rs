//! Input that must stop the robot.

use crate::common::{XorshiftStar, arm, arm_volumes, configuration, gantry, parts};
use elbowroom_kinematics::{Chain, Joint, LinkId};
use elbowroom_monitor::{
    Configuration, ConfigurationParts, EventKind, Fault, Monitor, OverrideReason, Region, RegionId, Snapshot, SourceId,
    SourceState, Volume,
};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

fn monitor() -> Monitor {
    let region = Region::sphere("s", Vec3::new(1.0, 0.0, 1.0), 0.1).warning(0.2);
    Monitor::new(configuration(arm(), arm_volumes(), vec![region]), None).unwrap()
}

const Q: [f64; 6] = [0.1, -0.3, 0.2, 0.0, 0.5, 0.0];

/// The fault of the second of two snapshots.
fn fault_of<'a>(change: impl Fn(&mut Snapshot<'a>)) -> Option<Fault> {
    let mut m = monitor();
    assert!(m.tick(&Snapshot::stationary(1.0, &Q)).speed_override > 0.0);
    let mut s = Snapshot::stationary(1.01, &Q);
    change(&mut s);
    match m.tick(&s) {
        report if report.speed_override > 0.0 => None,
        report => match report.reason {
            OverrideReason::Fault(fault) => Some(fault),
            _ => None,
        },
    }
}

#[test]
fn every_fault_is_named() {
    const NAN: [f64; 6] = [f64::NAN; 6];
    const FAR: [f64; 6] = [0.1, -0.3, 2.6, 0.0, 0.5, 0.0];
    const JUMP: [f64; 6] = [1.1, -0.3, 0.2, 0.0, 0.5, 0.0];
    const FAST: [f64; 6] = [0.0, 0.0, 0.0, 0.0, 0.0, -8.0];
    assert_eq!(fault_of(|_| {}), None);
    assert_eq!(fault_of(|s| s.stamp_s = 0.985), Some(Fault::Backwards));
    assert_eq!(fault_of(|s| (s.now_s, s.stamp_s) = (1.05, 1.02)), Some(Fault::Stale));
    assert_eq!(fault_of(|s| s.stamp_s = 1.02), Some(Fault::Backwards), "from the future");
    assert_eq!(fault_of(|s| s.now_s = f64::INFINITY), Some(Fault::NotFinite));
    assert_eq!(fault_of(|s| s.q = &NAN), Some(Fault::NotFinite));
    assert_eq!(fault_of(|s| s.intent = Some(&NAN)), Some(Fault::NotFinite));
    assert_eq!(fault_of(|s| s.q = &NAN[..5]), Some(Fault::WrongLength));
    assert_eq!(fault_of(|s| s.qd = &NAN[..5]), Some(Fault::WrongLength));
    assert_eq!(fault_of(|s| s.q = &FAR), Some(Fault::BeyondLimits { joint: 2, overshoot: 2.6 - 2.5 }));
    assert_eq!(fault_of(|s| s.q = &JUMP), Some(Fault::TooFast { joint: 0 }));
    assert_eq!(fault_of(|s| s.qd = &FAST), Some(Fault::TooFast { joint: 5 }));
    assert_eq!(fault_of(|s| s.programmed_override = f64::NAN), Some(Fault::ProgrammedOverride));
    assert_eq!(fault_of(|s| s.programmed_override = 1.01), Some(Fault::ProgrammedOverride));
}

#[test]
fn numbers_that_no_program_demands_stop_the_robot() {
    for size in [1e5, 1e12, 1e18, 1e100, 1e154, 1e200, 1e308, f64::MAX] {
        for joint in 0..6 {
            for sign in [-1.0, 1.0] {
                let (mut demand, mut rise) = ([0.0; 6], [0.0; 6]);
                demand[joint] = sign * size;
                rise[joint] = sign * size * 1e3_f64.min(f64::MAX / size);
                assert_eq!(fault_of(|s| s.intent = Some(&demand)), Some(Fault::TooFast { joint }), "{demand:?}");
                assert_eq!(fault_of(|s| s.qdd = &rise), Some(Fault::TooFast { joint }), "{rise:?}");
            }
        }
    }
    // A program that is slowed down may demand this.
    assert_eq!(fault_of(|s| s.intent = Some(&[30.0; 6])), None);
    assert_eq!(fault_of(|s| s.qdd = &[500.0; 6]), None);
}

#[test]
fn a_fault_is_reported_once_until_recovery() {
    let mut m = monitor();
    m.tick(&Snapshot::stationary(1.0, &Q));
    for i in 0..3 {
        m.tick(&Snapshot { stamp_s: 0.5, ..Snapshot::stationary(1.01, &Q) });
        let kinds: Vec<_> = m.events().iter().map(|e| e.kind).collect();
        assert_eq!(kinds, if i == 0 { vec![EventKind::Fault] } else { vec![] });
    }
    assert!(m.tick(&Snapshot::stationary(1.02, &Q)).speed_override > 0.0);
    assert!(m.events().iter().any(|e| e.kind == EventKind::Recovered));
}

#[test]
fn a_lost_source_stops_the_robot_while_its_region_is_active() {
    let region = Region::sphere("s", Vec3::ZERO, 0.1).follow(SourceId(0));
    let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO)];
    let parts = ConfigurationParts { sources: vec!["belt".into()], ..parts(gantry(), volumes, vec![region]) };
    let mut m = Monitor::new(Configuration::new(parts).unwrap(), None).unwrap();
    let source = |stamp_s: f64, x: f64| SourceState {
        pose: Pose::from_translation(Vec3::X * x),
        motion: FrameMotion::REST,
        stamp_s,
    };
    let q = [0.0; 6];
    let lost = OverrideReason::Fault(Fault::Source { region: RegionId(0) });
    let mut tick =
        |now_s: f64, s: SourceState| m.tick(&Snapshot { sources: &[s], ..Snapshot::stationary(now_s, &q) }).reason;
    assert_eq!(tick(0.0, source(0.0, 5.0)), OverrideReason::Free);
    assert_eq!(tick(0.1, source(0.05, 5.0)), lost);
    assert_eq!(tick(0.2, source(0.2, f64::NAN)), lost);
    assert_eq!(tick(0.3, source(0.31, 5.0)), lost, "from the future");
    assert_eq!(tick(0.4, source(0.4, 5.0)), OverrideReason::Free);
}

/// Numbers as from a faulty field bus: any bit pattern, or a plausible number with a flipped bit.
fn corrupted(r: &mut XorshiftStar, around: f64) -> f64 {
    match r.bits() % 4 {
        0 => f64::from_bits(r.bits()),
        1 => f64::from_bits(around.to_bits() ^ (1 << (r.bits() % 64))),
        _ => around,
    }
}

#[test]
fn ten_million_random_bit_patterns_neither_panic_nor_pass_as_valid() {
    let mut r = XorshiftStar(42);
    let mut m = monitor();
    let (mut last_now, mut last_stamp) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    let mut accepted = 0;
    let mut clock = 0.0;
    for i in 0..10_000_000_u32 {
        if i % 10_000 == 0 {
            // An accepted time stamp in the far future makes all later ones invalid.
            (m, last_now, last_stamp, clock) = (monitor(), f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0);
        }
        clock += 0.002;
        let (now_s, stamp_s) = (corrupted(&mut r, clock), corrupted(&mut r, clock));
        let q = Q.map(|v| corrupted(&mut r, v));
        let qd = [0.0; 6].map(|v| corrupted(&mut r, v));
        let v0 = corrupted(&mut r, 1.0);
        let s = Snapshot { now_s, stamp_s, q: &q, qd: &qd, programmed_override: v0, ..Snapshot::stationary(0.0, &Q) };
        let report = m.tick(&s);
        assert!((0.0..=1.0).contains(&report.speed_override));
        if report.speed_override > 0.0 {
            accepted += 1;
            assert!(q.iter().chain(&qd).chain([&now_s, &stamp_s]).all(|v| v.is_finite()));
            assert!(now_s - stamp_s <= 0.02 && stamp_s <= now_s && now_s >= last_now && stamp_s >= last_stamp);
            assert!(qd.iter().all(|v| v.abs() <= 7.5) && (0.0..=1.0).contains(&v0));
            (last_now, last_stamp) = (now_s, stamp_s);
        }
    }
    println!("10000000 snapshots, {accepted} accepted");
    assert!(accepted > 10_000);
}

/// A first reading, so that it has not jumped. The oracle compares with the limits by itself.
#[test]
fn a_reading_is_refused_exactly_if_it_overshoots_by_more_than_its_joint_tolerates() {
    let mut random = XorshiftStar(61);
    let mut counts = [0; 2];
    for _ in 0..2000 {
        let mut joints = gantry().joints().to_vec();
        for joint in &mut joints {
            joint.limits.lower = random.between(-2.0, 0.0);
            joint.limits.upper = random.between(0.0, 2.0);
            let tolerance = [None, Some(0.0), Some(random.between(0.0, 0.2))][random.below(3)];
            joint.limits.overshoot_tolerance = tolerance;
        }
        let reading = |joint: &Joint, random: &mut XorshiftStar| {
            let limit = if random.below(2) == 0 { joint.limits.lower } else { joint.limits.upper };
            // Mostly near a limit, sometimes exactly on it, or exactly at its tolerance.
            let tolerance = joint.limits.overshoot_tolerance.unwrap_or(0.05);
            match random.below(20) {
                0 => limit,
                1 => limit + tolerance.copysign(limit),
                2 => limit + (tolerance + 2e-6).copysign(limit),
                _ => limit + random.between(-0.3, 0.06) * limit.signum(),
            }
        };
        let q: Vec<f64> = joints.iter().map(|joint| reading(joint, &mut random)).collect();
        let beyond = joints.iter().zip(&q).position(|(joint, q)| {
            let (lower, upper) = (joint.limits.lower, joint.limits.upper);
            let tolerance = joint.limits.overshoot_tolerance.unwrap_or(0.05);
            *q < lower - tolerance - 1e-6 || *q > upper + tolerance + 1e-6
        });
        let chain = Chain::new("g", gantry().links().to_vec(), joints.clone()).unwrap();
        let mut m = Monitor::new(configuration(chain, vec![Volume::tcp(LinkId(6), Vec3::ZERO)], vec![]), None).unwrap();
        let reason = m.tick(&Snapshot::stationary(0.0, &q)).reason;
        match (beyond, reason) {
            (Some(joint), OverrideReason::Fault(Fault::BeyondLimits { joint: found, overshoot })) => {
                assert_eq!(found, joint);
                let limits = joints[joint].limits;
                let by = if q[joint] > limits.upper { q[joint] - limits.upper } else { q[joint] - limits.lower };
                assert_eq!(overshoot, by, "{limits:?} {}", q[joint]);
                counts[0] += 1;
            }
            (None, OverrideReason::Free) => counts[1] += 1,
            other => panic!("{other:?} at {q:?} of {joints:?}"),
        }
    }
    assert!(counts.iter().all(|count| *count > 200), "{counts:?}");
}

#[test]
fn a_reading_that_trembles_beyond_a_limit_is_one_fault() {
    let mut m = Monitor::new(configuration(gantry(), vec![Volume::tcp(LinkId(6), Vec3::ZERO)], vec![]), None).unwrap();
    let mut faults = 0;
    let beyond = gantry().upper()[0] + 0.2;
    for i in 0..20 {
        let mut q = [0.0; 6];
        q[0] = beyond + 1e-5 * f64::from(i % 3);
        let report = m.tick(&Snapshot::stationary(0.01 * f64::from(i), &q));
        assert!(matches!(report.reason, OverrideReason::Fault(Fault::BeyondLimits { joint: 0, .. })), "{report:?}");
        faults += m.events().iter().filter(|event| event.kind == EventKind::Fault).count();
    }
    assert_eq!(faults, 1);
}

#[test]
fn a_tolerance_that_is_no_distance_makes_no_chain() {
    for tolerance in [-1e-9, f64::NAN, f64::INFINITY] {
        let mut joints = arm().joints().to_vec();
        joints[3].limits.overshoot_tolerance = Some(tolerance);
        let error = Chain::new("arm", arm().links().to_vec(), joints).unwrap_err().to_string();
        assert!(error.contains("`j4`") && error.contains("0 or more"), "{error}");
    }
}
