//! Comparison of the sweep between two snapshots with an oracle that samples the motion.

use crate::common::{RandomGeometry, XorshiftStar, arm, arm_volumes, configuration, joint, parts};
use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_monitor::{
    Configuration, ConfigurationParts, EventKind, Guards, Monitor, Region, RegionId, RegionSweep, Snapshot, SourceId,
    SourceState, Volume,
};
use elbowroom_proximity::{Shape, separation};
use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};

/// Smallest distance over samples of the straight motion.
fn sampled(config: &Configuration, from: &[f64; 6], to: &[f64; 6], region: &Region, steps: u32) -> f64 {
    let mut state = elbowroom_kinematics::ChainState::new(config.chain());
    let at = region.anchor * region.shape_in_anchor;
    let mut smallest = f64::INFINITY;
    for i in 0..=steps {
        let u = f64::from(i) / f64::from(steps);
        let ends = state.q.iter_mut().zip(from.iter().zip(to));
        ends.for_each(|(q, (a, b))| *q = a + (b - a) * u);
        config.chain().forward(&mut state);
        for v in config.volumes().iter().filter(|v| v.part.counts_for(region.guards)) {
            let pose = state.link_in_root(v.link) * v.in_link;
            smallest = smallest.min(separation(&v.shape, &pose, &region.shape, &at).distance);
        }
    }
    smallest
}

fn thin(r: &mut XorshiftStar) -> Region {
    let at = r.direction() * r.between(0.3, 1.5) + Vec3::Z * 0.6;
    let turn = Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0));
    match r.bits() % 3 {
        0 => Region::sphere("s", at, r.between(0.001, 0.01)),
        1 => Region::cylinder("c", at, r.between(0.1, 0.4), 0.002, turn),
        _ => Region::cuboid("b", at, Vec3::new(0.002, r.between(0.1, 0.6), r.between(0.1, 0.6)), turn),
    }
}

#[test]
fn the_closest_approach_agrees_with_samples() {
    let mut r = XorshiftStar(7);
    let (mut passed, mut free) = (0, 0);
    for _ in 0..600 {
        let region = thin(&mut r).guards(if r.bits().is_multiple_of(2) { Guards::TCP } else { Guards::ARM });
        let config = configuration(arm(), arm_volumes(), vec![region.clone()]);
        let from: [f64; 6] = std::array::from_fn(|_| r.between(-1.5, 1.5));
        let to = from.map(|q| q + r.between(-0.2, 0.2));
        let mut sweep = RegionSweep::new(&config);
        assert!(sweep.closest_approach(&config, RegionId(0), 0.0, 1e-6).is_none(), "the motion is not known");
        sweep.advance(&config, &from, &[], 0.01);
        sweep.advance(&config, &to, &[], 0.01);
        let ends = [sampled(&config, &from, &from, &region, 1), sampled(&config, &to, &to, &region, 1)];
        assert!((sweep.distance(&config, RegionId(0), 10.0).unwrap() - ends[1]).abs() < 1e-9);
        let steps = 400;
        let sampled_m = sampled(&config, &from, &to, &region, steps);
        let between_m = sweep.travel_bound_of(RegionId(0)) / f64::from(steps);
        if let Some(closest) = sweep.closest_approach(&config, RegionId(0), 0.0, 1e-6) {
            passed += 1;
            assert!(closest.distance_m <= 0.0 && ends[0].min(ends[1]) >= 0.0, "{closest:?}");
            assert!(sampled_m <= between_m, "no sample is near a contact: {sampled_m}");
            let there: [f64; 6] = std::array::from_fn(|i| from[i] + (to[i] - from[i]) * closest.fraction);
            assert!(sampled(&config, &there, &there, &region, 1) <= 0.0);
        } else {
            free += 1;
            assert!(sampled_m > 0.0 || ends[0].min(ends[1]) <= 0.0, "missed: {sampled_m}, {ends:?}");
        }
    }
    assert!(passed > 20 && free > 100, "{passed} {free}");
}

fn rail() -> Chain {
    let slide = joint("x", JointKind::Prismatic, 0, Vec3::ZERO, Vec3::X, 10.0);
    Chain::new("rail", vec!["base".into(), "carriage".into()], vec![slide]).unwrap()
}

fn plate() -> Region {
    let mut plate = Region::cuboid("plate", Vec3::ZERO, Vec3::new(0.004, 1.0, 1.0), Rotation::IDENTITY);
    plate.output = Some(7);
    plate.guards(Guards::TCP).monitored()
}

fn tick(m: &mut Monitor, i: u32, x: f64) -> (Vec<EventKind>, u64) {
    let report = m.tick(&Snapshot::stationary(0.004 * f64::from(i), &[x]));
    (m.events().iter().map(|e| e.kind).collect(), report.outputs)
}

#[test]
fn an_output_is_on_for_one_tick_where_a_plate_was_passed() {
    use EventKind::{InsideIn, InsideOut, OutputOff, OutputOn, WarnIn, WarnOut};
    let tcp = vec![Volume::tcp(elbowroom_kinematics::LinkId(1), Vec3::ZERO)];
    let mut m = Monitor::new(configuration(rail(), tcp, vec![plate()]), None).unwrap();
    assert_eq!(tick(&mut m, 0, -0.024), (vec![], 0));
    assert_eq!(tick(&mut m, 1, -0.008), (vec![], 0));
    assert_eq!(tick(&mut m, 2, 0.008), (vec![WarnIn, InsideIn, OutputOn(7)], 1 << 7));
    assert!(m.is_inside(RegionId(0)));
    assert_eq!(tick(&mut m, 3, 0.024), (vec![InsideOut, WarnOut, OutputOff(7)], 0));
    // The robot moves back again. Then no snapshot arrives until the input is stale, so the motion is not known.
    assert_eq!(tick(&mut m, 4, 0.010), (vec![], 0));
    let late = m.tick(&Snapshot::stationary(0.2, &[-0.010]));
    assert!(m.events().is_empty() && late.outputs == 0);
}

#[test]
fn after_a_fault_the_motion_is_not_known() {
    let tcp = vec![Volume::tcp(elbowroom_kinematics::LinkId(1), Vec3::ZERO)];
    let mut m = Monitor::new(configuration(rail(), tcp, vec![plate()]), None).unwrap();
    tick(&mut m, 0, -0.008);
    assert_eq!(tick(&mut m, 1, f64::NAN).0, [EventKind::Fault]);
    assert_eq!(tick(&mut m, 2, 0.008), (vec![EventKind::Recovered], 0));
}

#[test]
fn a_region_that_passes_is_reported_and_one_that_jumps_is_not() {
    let tcp = vec![Volume::tcp(elbowroom_kinematics::LinkId(1), Vec3::ZERO)];
    let parts =
        ConfigurationParts { sources: vec!["belt".into()], ..parts(rail(), tcp, vec![plate().follow(SourceId(0))]) };
    let mut m = Monitor::new(Configuration::new(parts).unwrap(), None).unwrap();
    let mut at = |i: u32, x: f64, speed: f64| {
        let now_s = 0.004 * f64::from(i);
        let motion = FrameMotion { velocity: Vec3::X * speed, ..FrameMotion::REST };
        let source = SourceState { pose: Pose::from_translation(Vec3::X * x), motion, stamp_s: now_s };
        m.tick(&Snapshot { sources: &[source], ..Snapshot::stationary(now_s, &[0.0]) });
        m.events().iter().any(|e| e.kind == EventKind::InsideIn)
    };
    assert!(!at(0, -0.020, 4.0) && !at(1, -0.004, 4.0) && at(2, 0.012, 4.0) && !at(3, 0.028, 4.0));
    // The reading wraps around to the start of the belt.
    assert!(!at(4, -2.0, 4.0));
}

#[test]
fn a_point_that_passes_a_point_is_reported() {
    let point = Shape::Sphere(elbowroom_proximity::Sphere { radius: 0.0 });
    let region = Region::solid("dot", point, Pose::IDENTITY).guards(Guards::TCP).monitored();
    let tcp = vec![Volume::tcp(elbowroom_kinematics::LinkId(1), Vec3::ZERO)];
    let mut m = Monitor::new(configuration(rail(), tcp, vec![region]), None).unwrap();
    tick(&mut m, 0, -0.004);
    assert!(tick(&mut m, 1, 0.0037).0.contains(&EventKind::InsideIn));
}
