//! Volumes that are attached and detached while the robot runs.

use crate::common;
use crate::common::{RandomGeometry, XorshiftStar, arm, arm_volumes, configuration, parts};
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{
    AttachError, Configuration, ConfigurationParts, Fault, Guards, Laws, Monitor, OverrideReason, Presence, Region,
    RegionId, RegionSweep, Snapshot, StoppingSettings, TickReport, Volume, VolumeId,
};
use elbowroom_proximity::{Cuboid, Shape, separation};
use elbowroom_spatial::{Pose, Rotation, Vec3};

/// A long part, held at one end.
fn part() -> Shape {
    Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.5, 0.03, 0.05) })
}

fn in_link() -> Pose {
    Pose::new(Rotation::from_rpy(0.3, -0.2, 1.1), Vec3::new(0.3, 0.25, 0.1))
}

fn with_part(presence: Presence) -> Vec<Volume> {
    let in_link = if presence == Presence::Always { in_link() } else { Pose::IDENTITY };
    let part = Volume { presence, in_link, ..Volume::gripped("part", LinkId(6), part()) };
    arm_volumes().into_iter().chain([part]).collect()
}

fn part_id() -> VolumeId {
    VolumeId(arm_volumes().len())
}

fn regions(r: &mut XorshiftStar) -> Vec<Region> {
    let region = |i: usize| {
        let at = r.direction() * r.between(0.9, 1.9) + Vec3::Z * 0.6;
        let turn = Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0));
        let region = match i % 3 {
            0 => Region::sphere(format!("{i}"), at, 0.1),
            1 => Region::cylinder(format!("{i}"), at, 0.1, 0.2, turn),
            _ => Region::cuboid(format!("{i}"), at, Vec3::splat(0.2), turn),
        };
        region.warning(0.1)
    };
    (0..30).map(region).collect()
}

fn laws() -> [Laws; 3] {
    let stopping = StoppingSettings {
        reaction_s: 0.01,
        period_s: 0.002,
        joint_deceleration: vec![10.0; 6],
        joint_acceleration: vec![5.0; 6],
    };
    let stopping = Laws { stopping_distance: Some(stopping), ..Laws::default() };
    [Laws::default(), stopping.clone(), Laws { direction_aware: true, override_rate: 5.0, ..stopping }]
}

/// The reports of a run of `seconds` in which the robot applies the override, but creeps when it should stop.
fn run(monitor: &mut Monitor, from_s: f64, seconds: f64) -> Vec<TickReport> {
    let (mut applied, mut t) = (0.0, 3.0 * from_s);
    let ticks = (seconds / 0.002).round() as u32;
    let mut reports = Vec::new();
    for i in 0..ticks {
        let q = [t.sin(), 0.5 * (1.3 * t).sin(), (0.7 * t).cos(), 0.2 * t.sin(), t.cos(), 0.0];
        let speed = [t.cos(), 0.65 * (1.3 * t).cos(), -0.7 * (0.7 * t).sin(), 0.2 * t.cos(), -t.sin(), 0.0];
        let qd = speed.map(|v| v * applied);
        let at = Snapshot::stationary(from_s + 0.002 * f64::from(i), &q);
        let report = monitor.tick(&Snapshot { qd: &qd, intent: Some(&speed), ..at });
        applied = report.speed_override;
        t += 0.002 * applied.max(0.1);
        reports.push(report);
    }
    reports
}

fn monitor(laws: &Laws, volumes: Vec<Volume>, regions: &[Region]) -> Monitor {
    let parts = ConfigurationParts { laws: laws.clone(), ..parts(arm(), volumes, regions.to_vec()) };
    Monitor::new(Configuration::new(parts).unwrap(), None).unwrap()
}

#[test]
fn an_attached_volume_counts_as_one_that_was_always_there() {
    let mut differs = 0;
    for seed in 1..=4 {
        let regions = regions(&mut XorshiftStar(seed));
        for laws in laws() {
            let mut always = monitor(&laws, with_part(Presence::Always), &regions);
            let mut attached = monitor(&laws, with_part(Presence::Detached), &regions);
            attached.attach(part_id(), &in_link()).unwrap();
            let expected = run(&mut always, 0.0, 4.0);
            assert!(expected == run(&mut attached, 0.0, 4.0), "seed {seed}, {laws:?}");
            let mut never = monitor(&laws, arm_volumes(), &regions);
            let mut detached = monitor(&laws, with_part(Presence::Attached), &regions);
            detached.detach(part_id()).unwrap();
            let without = run(&mut never, 0.0, 4.0);
            assert!(without == run(&mut detached, 0.0, 4.0), "seed {seed}, {laws:?}");
            differs += usize::from(expected != without);
        }
    }
    assert!(differs >= 6, "the part makes a difference in {differs} of 12 runs only");
}

#[test]
fn the_reported_distance_is_that_of_brute_force() {
    let mut r = XorshiftStar(9);
    let regions = regions(&mut r);
    let config = configuration(arm(), with_part(Presence::Detached), regions.clone());
    let mut m = Monitor::new(config.clone(), None).unwrap();
    let mut sweep = RegionSweep::new(&config);
    let mut of_part = 0;
    for i in 0..300 {
        let q: Vec<f64> = (0..6).map(|_| r.between(-1.5, 1.5)).collect();
        let pose = Pose::new(Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0)), r.vec3(0.4));
        let is_attached = i % 3 != 0;
        if is_attached {
            m.attach(part_id(), &pose).unwrap();
            sweep.attach(&config, part_id(), &pose).unwrap();
        } else {
            m.detach(part_id()).unwrap();
            sweep.detach(&config, part_id()).unwrap();
        }
        // The ticks are so far apart that every motion is possible.
        m.tick(&Snapshot::stationary(10.0 * f64::from(i), &q));
        assert!(sweep.advance(&config, &q, &[], 10.0));
        let query = {
            let mut query = m.region_distance(&[]);
            query.set_q(&q);
            query.distances(f64::INFINITY).collect::<Vec<_>>()
        };
        for (index, region) in regions.iter().enumerate() {
            let region_in_world = region.anchor * region.shape_in_anchor;
            let of = |(v, volume): (usize, &Volume)| {
                let in_link = match (v == part_id().0, is_attached) {
                    (true, true) => pose,
                    (true, false) => return f64::INFINITY,
                    (false, _) => volume.in_link,
                };
                let in_world = m.state().link_in_root(volume.link) * in_link;
                separation(&volume.shape, &in_world, &region.shape, &region_in_world).distance
            };
            let each: Vec<f64> = config.volumes().iter().enumerate().map(of).collect();
            let expected = each.iter().copied().fold(f64::INFINITY, f64::min);
            of_part += usize::from(expected < each[..part_id().0].iter().copied().fold(f64::INFINITY, f64::min));
            let id = RegionId(index);
            let by_query = query.iter().find(|(r, _)| *r == id).unwrap().1;
            for found in [m.distance(id, f64::INFINITY), sweep.distance(&config, id, f64::INFINITY), Some(by_query)] {
                assert!((found.unwrap() - expected).abs() < 1e-9, "{found:?}, not {expected}");
            }
        }
    }
    assert!(of_part > 1000, "the part is nearest in {of_part} cases only");
}

#[test]
fn a_part_gripped_inside_a_region_holds_the_robot_until_its_program_leads_out() {
    let region = Region::cuboid("bin", Vec3::new(1.4, 0.0, 0.6), Vec3::splat(0.3), Rotation::IDENTITY).warning(0.1);
    let rail = common::gantry();
    let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) });
    let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO), Volume::gripped("part", LinkId(6), shape)];
    for direction_aware in [false, true] {
        let laws = Laws { direction_aware, ..Laws::default() };
        let parts = ConfigurationParts { laws, ..parts(rail.clone(), volumes.clone(), vec![region.clone()]) };
        let mut m = Monitor::new(Configuration::new(parts).unwrap(), None).unwrap();
        // The hand is 0.1 m above the bin, and the part reaches into it.
        let q = [1.4, 0.0, 1.0, 0.0, 0.0, 0.0];
        let tick = |m: &mut Monitor, i: u32, up: f64| {
            let intent = [0.0, 0.0, up, 0.0, 0.0, 0.0];
            let at = Snapshot::stationary(0.002 * f64::from(i), &q);
            m.tick(&Snapshot { qd: &[0.0; 6], intent: Some(&intent), ..at })
        };
        assert!(tick(&mut m, 0, 0.2).speed_override > 0.0);
        m.attach(VolumeId(1), &Pose::from_translation(Vec3::Z * -0.2)).unwrap();
        let up = tick(&mut m, 1, 0.2);
        assert_eq!(up.governing.unwrap().volume, VolumeId(1));
        assert!(m.is_inside(RegionId(0)));
        let leaves = m.configuration().laws().recovery;
        assert_eq!(up.speed_override, if direction_aware { leaves } else { 0.0 });
        assert_eq!(tick(&mut m, 2, -0.2).speed_override, 0.0, "deeper into it");
        // After it is released there, it does not count any more.
        m.detach(VolumeId(1)).unwrap();
        let report = tick(&mut m, 3, 0.2);
        assert!(report.speed_override > leaves && !m.is_inside(RegionId(0)), "{report:?}");
    }
}

#[test]
fn the_override_falls_at_once_for_what_is_attached() {
    let region = Region::sphere("pillar", Vec3::new(2.0, 0.0, 0.0), 0.5).warning(0.5);
    let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.2) });
    let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO), Volume::gripped("part", LinkId(6), shape)];
    let laws = Laws { override_rate: 0.5, ..Laws::default() };
    let parts = ConfigurationParts { laws, ..parts(common::gantry(), volumes, vec![region]) };
    let mut m = Monitor::new(Configuration::new(parts).unwrap(), None).unwrap();
    let q = [0.9, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(m.tick(&Snapshot::stationary(0.0, &q)).speed_override, 1.0);
    m.attach(VolumeId(1), &Pose::IDENTITY).unwrap();
    let report = m.tick(&Snapshot::stationary(0.002, &q));
    assert!((report.speed_override - 0.8).abs() < 1e-9, "{report:?}");
    // This applies to that tick only: then the override rises at its rate.
    m.detach(VolumeId(1)).unwrap();
    let report = m.tick(&Snapshot::stationary(0.004, &q));
    assert!((report.speed_override - 0.801).abs() < 1e-9 && report.reason == OverrideReason::Rate, "{report:?}");
}

#[test]
fn a_refused_attachment_changes_nothing() {
    let mut m = Monitor::new(configuration(arm(), with_part(Presence::Detached), vec![]), None).unwrap();
    assert!(matches!(m.attach(VolumeId(0), &Pose::IDENTITY), Err(AttachError::Always(name)) if name == "l1"));
    assert!(matches!(m.detach(VolumeId(0)), Err(AttachError::Always(_))));
    assert!(matches!(m.attach(VolumeId(99), &Pose::IDENTITY), Err(AttachError::Unknown(99))));
    let nowhere = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    assert!(matches!(m.attach(part_id(), &nowhere), Err(AttachError::NotFinite(_))));
    assert!(!m.is_attached(part_id()) && !m.is_attached(VolumeId(99)) && m.is_attached(VolumeId(0)));
    let report = m.tick(&Snapshot::stationary(0.0, &[0.0; 6]));
    assert!(!matches!(report.reason, OverrideReason::Fault(Fault::NotFinite)));
}

#[test]
fn gripped_objects_are_in_the_checksum_and_not_in_that_of_the_robot() {
    let of = |volumes| configuration(arm(), volumes, vec![]);
    let (with, without) = (of(with_part(Presence::Detached)), of(arm_volumes()));
    assert!(with.checksum() != without.checksum() && with.robot_checksum() == without.robot_checksum());
    let always = of(with_part(Presence::Always));
    assert!(always.robot_checksum() != without.robot_checksum() && always.checksum() != with.checksum());
}

/// A point, and a small part 15 cm before it, pass a plate of 4 mm between two ticks, after rest before it.
#[test]
fn a_plate_passed_just_after_a_volume_was_attached_or_detached_is_reported() {
    let part = Shape::Sphere(elbowroom_proximity::Sphere { radius: 1e-3 });
    let volumes = || vec![Volume::tcp(LinkId(6), Vec3::ZERO), Volume::gripped("part", LinkId(6), part.clone())];
    let plate = Region::cuboid("plate", Vec3::new(1.0, 0.0, -1.0), Vec3::new(4e-3, 2.0, 2.0), Rotation::IDENTITY);
    let (part, ahead) = (VolumeId(1), Pose::from_translation(Vec3::X * 0.15));
    for (from, to, attaches) in [(0.993, 1.007, false), (0.84, 0.86, true)] {
        let regions = vec![plate.clone().warning(0.3).monitored().guards(Guards { tcp: true, tool: true, arm: true })];
        let mut m = Monitor::new(configuration(common::gantry(), volumes(), regions), None).unwrap();
        let tick = |m: &mut Monitor, now_s: f64, x: f64| {
            let (q, qd) = ([x, 0.0, 0.0, 0.0, 0.0, 0.0], [(to - from) / 0.015, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let report = m.tick(&Snapshot { qd: &qd, ..Snapshot::stationary(now_s, &q) });
            assert!(!matches!(report.reason, OverrideReason::Fault(_)), "{}", report.reason);
            m.is_inside(RegionId(0))
        };
        if !attaches {
            m.attach(part, &Pose::from_translation(Vec3::Y * 0.15)).unwrap();
        }
        for i in 0..5 {
            assert!(!tick(&mut m, 0.002 * f64::from(i), from));
        }
        let changed = if attaches { m.attach(part, &ahead) } else { m.detach(part) };
        changed.unwrap();
        assert!(tick(&mut m, 0.023, to), "from {from} to {to}");
    }
}
