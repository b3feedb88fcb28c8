//! The laws beyond Romanelli 2011: direction, recovery, stopping distance, rate, speed zones, dynamic regions.

use crate::common::{RandomGeometry, XorshiftStar, arm, arm_volumes, configuration, gantry, parts};
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{
    Configuration, ConfigurationParts, Guards, Laws, Monitor, OverrideReason, Region, RegionId, RegionKind, Snapshot,
    SourceId, SourceState, StoppingSettings, Volume, VolumeId,
};
use elbowroom_proximity::separation;
use elbowroom_spatial::{FrameMotion, Obb, Pose, Rotation, Vec3};

fn point_monitor(regions: Vec<Region>, laws: Laws) -> Monitor {
    let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO)];
    let regions = regions.into_iter().map(|r| r.guards(Guards::TCP)).collect();
    let parts = ConfigurationParts { laws, ..parts(gantry(), volumes, regions) };
    Monitor::new(Configuration::new(parts).unwrap(), None).unwrap()
}

fn ball() -> Region {
    Region::sphere("ball", Vec3::ZERO, 0.5).warning(0.2)
}

fn direction_aware() -> Laws {
    Laws { direction_aware: true, ..Laws::default() }
}

/// Brakes that begin 24 ticks late.
fn late_brakes() -> StoppingSettings {
    StoppingSettings {
        reaction_s: 0.048,
        period_s: 0.002,
        joint_deceleration: vec![2.0; 6],
        joint_acceleration: vec![2.0; 6],
    }
}

/// Override of one tick at x on the x axis with the program speed `speed` along x.
fn override_at(m: &mut Monitor, now_s: f64, x: f64, speed: f64) -> f64 {
    let (q, intent) = ([x, 0.0, 0.0, 0.0, 0.0, 0.0], [speed, 0.0, 0.0, 0.0, 0.0, 0.0]);
    m.tick(&Snapshot { intent: Some(&intent), ..Snapshot::stationary(now_s, &q) }).speed_override
}

#[test]
fn a_robot_stopped_at_a_border_is_free_to_leave_and_only_to_leave() {
    let mut m = point_monitor(vec![ball()], direction_aware());
    assert!((override_at(&mut m, 0.0, 0.6, -0.3) - 0.5).abs() < 1e-12, "towards");
    assert_eq!(override_at(&mut m, 1.0, 0.6, 0.3), 1.0, "away");
    assert!((override_at(&mut m, 2.0, 0.6, 0.0) - 0.5).abs() < 1e-12, "without an intended motion");
    let mut plain = point_monitor(vec![ball()], Laws::default());
    assert!(
        (override_at(&mut plain, 0.0, 0.6, 0.3) - 0.5).abs() < 1e-12,
        "the law of the paper does not depend on the direction"
    );
}

#[test]
fn a_robot_inside_may_leave_slowly() {
    let mut m = point_monitor(vec![ball()], direction_aware());
    assert_eq!(override_at(&mut m, 0.0, 0.4, -0.3), 0.0, "deeper");
    assert!((override_at(&mut m, 1.0, 0.4, 0.3) - 0.1).abs() < 1e-12, "out");
}

/// A robot within rounding of the border, and within the smallest decrease of the depth, must be able to leave.
#[test]
fn a_robot_at_the_very_border_is_free_to_leave() {
    // The plate is thin as well: passing through it does not count as leaving.
    let plate = Region::cuboid("plate", Vec3::new(0.5, 0.0, -0.5), Vec3::new(1e-3, 1.0, 1.0), Rotation::IDENTITY);
    let regions = [(ball(), 0.5), (plate.warning(0.2).guards(Guards::TCP), 0.5005)];
    for (region, border) in regions {
        for depth in [0.0, 1e-17, 1e-16, 1e-15, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6, 4.9e-6, 5.1e-6, -1e-16, -1e-13, -1e-9]
        {
            let mut m = point_monitor(vec![region.clone()], direction_aware());
            let x = border - depth;
            assert!(override_at(&mut m, 0.0, x, 0.3) >= 0.1 - 1e-12, "{} at depth {depth}: held", region.name);
            assert!(override_at(&mut m, 1.0, x, -0.3) < 1e-6, "{} at depth {depth}: let in", region.name);
        }
    }
}

#[test]
fn an_actual_approach_is_limited_whatever_the_program_intends() {
    let mut m = point_monitor(vec![ball()], direction_aware());
    let (q, qd, intent) =
        ([0.6, 0.0, 0.0, 0.0, 0.0, 0.0], [-0.2, 0.0, 0.0, 0.0, 0.0, 0.0], [0.3, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let report = m.tick(&Snapshot { qd: &qd, intent: Some(&intent), ..Snapshot::stationary(0.0, &q) });
    assert!((report.speed_override - 0.5).abs() < 1e-12);
}

/// Random arms, regions and intents: whenever the override exceeds the override of the paper, every distance within
/// a warning zone grows.
#[test]
fn a_decreasing_distance_never_clears_an_alarm() {
    let mut r = XorshiftStar(5);
    let (mut cleared, mut held) = (0, 0);
    for case in 0..20_000 {
        let rotation = Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0));
        let at = Vec3::new(r.between(0.2, 1.2), r.between(-0.8, 0.8), r.between(0.1, 1.6));
        let region = match case % 3 {
            0 => Region::sphere("s", at, 0.15),
            1 => Region::cylinder("c", at, 0.1, 0.3, rotation),
            _ => Region::cuboid("b", at, Vec3::new(0.2, 0.15, 0.3), rotation),
        };
        let parts = parts(arm(), arm_volumes(), vec![region.warning(0.3)]);
        let with_law = ConfigurationParts { laws: direction_aware(), ..parts.clone() };
        let mut m = Monitor::new(Configuration::new(with_law).unwrap(), None).unwrap();
        let mut plain = Monitor::new(Configuration::new(parts).unwrap(), None).unwrap();
        let q: [f64; 6] = std::array::from_fn(|_| r.between(-1.5, 1.5));
        let intent: [f64; 6] = std::array::from_fn(|_| r.between(-1.0, 1.0));
        let s = Snapshot { intent: Some(&intent), ..Snapshot::stationary(0.0, &q) };
        let paper = plain.tick(&s);
        let (factor, Some(nearest)) = (m.tick(&s).speed_override, paper.governing) else { continue };
        if factor <= paper.speed_override {
            held += 1;
            continue;
        }
        cleared += 1;
        if nearest.distance_m == 0.0 {
            continue; // Leaving from inside: other tests check the depth.
        }
        let mut distance_after = |dt: f64| {
            let q = std::array::from_fn::<f64, 6, _>(|i| q[i] + intent[i] * dt);
            plain_distance(&mut plain, 10.0 + dt, &q)
        };
        let d = nearest.distance_m;
        assert!(distance_after(1e-4) > d, "case {case}: the distance {d} decreases, but the override is {factor}");
    }
    println!("{cleared} released, {held} held");
    assert!(cleared > 500 && held > 500);
}

fn plain_distance(m: &mut Monitor, now_s: f64, q: &[f64; 6]) -> f64 {
    m.tick(&Snapshot::stationary(now_s, q));
    m.distance(RegionId(0), f64::INFINITY).unwrap()
}

#[test]
fn the_stopping_law_stops_outside() {
    let laws = Laws { stopping_distance: Some(late_brakes()), ..Laws::default() };
    // Without a warning zone, the stopping law alone must keep the point outside.
    let mut m = point_monitor(vec![Region::sphere("ball", Vec3::ZERO, 0.5)], laws);
    for speed in [0.2, 1.0, 3.0] {
        let (mut x, mut sigma, dt) = (3.0, 1.0_f64, 0.002);
        // The robot reacts 24 ticks late and brakes with at most 2 m/s²; the tick itself is the rest of the 0.05 s.
        let mut queue = std::collections::VecDeque::from(vec![1.0; 24]);
        for i in 0..10_000 {
            let (q, qd) = ([x, 0.0, 0.0, 0.0, 0.0, 0.0], [-speed * sigma, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let intent = [-speed, 0.0, 0.0, 0.0, 0.0, 0.0];
            let now_s = 100.0 * speed + dt * f64::from(i);
            let s = Snapshot { qd: &qd, intent: Some(&intent), ..Snapshot::stationary(now_s, &q) };
            queue.push_back(m.tick(&s).speed_override);
            let commanded = queue.pop_front().unwrap();
            sigma = commanded.max(sigma - 2.0 / speed * dt).min(sigma + 2.0 / speed * dt);
            x -= speed * sigma * dt;
        }
        println!("{speed} m/s: at rest {:.2e} m from the region", x - 0.5);
        assert!((0.5..0.51).contains(&x), "{speed} m/s: came to rest {} m from the region", x - 0.5);
    }
}

#[test]
fn the_override_changes_at_its_largest_rate() {
    let laws = Laws { override_rate: 2.0, ..Laws::default() };
    let mut m = point_monitor(vec![ball()], laws);
    assert_eq!(override_at(&mut m, 0.0, 1.0, 0.0), 1.0);
    assert!((override_at(&mut m, 0.1, 0.6, 0.0) - 0.8).abs() < 1e-12, "falling");
    assert_eq!(override_at(&mut m, 0.2, 0.5, 0.0), 0.0, "contact stops at once");
    assert!((override_at(&mut m, 0.3, 0.9, 0.0) - 0.2).abs() < 1e-12, "rising");
}

/// The rate of change does not delay the stopping-distance law of a region that the robot leaves, whatever others request.
#[test]
fn a_slower_region_does_not_hide_the_limit_of_another_one() {
    let laws = Laws { stopping_distance: Some(late_brakes()), override_rate: 1.0, ..direction_aware() };
    let slow = |radius| {
        Region::sphere("slow", Vec3::ZERO, radius).warning(0.05).kind(RegionKind::Monitored { slow_to: Some(0.1) })
    };
    let override_beside = |regions: Vec<Region>| {
        let mut m = point_monitor(regions, laws.clone());
        let velocity = [0.001, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut tick = |now_s, x| {
            let q = [x, 0.0, 0.0, 0.0, 0.0, 0.0];
            let s = Snapshot { qd: &velocity, intent: Some(&velocity), ..Snapshot::stationary(now_s, &q) };
            let report = m.tick(&s);
            m.forget_position();
            report.speed_override
        };
        assert_eq!(tick(0.0, 3.0), 1.0);
        tick(0.002, 0.507)
    };
    for (ball, slow) in [(ball(), slow(0.49)), (ball().warning(0.0), slow(0.499))] {
        let alone = override_beside(vec![ball.clone()]);
        assert!(alone > 0.31 && alone < 0.99, "{alone}");
        assert_eq!(override_beside(vec![slow.clone(), ball.clone()]), alone);
        assert_eq!(override_beside(vec![ball, slow]), alone);
    }
}

#[test]
fn a_speed_zone_slows_and_never_stops() {
    let zone = ball().kind(RegionKind::Monitored { slow_to: Some(0.3) });
    let mut m = point_monitor(vec![zone], Laws::default());
    assert_eq!(override_at(&mut m, 0.0, 0.1, 1.0), 0.3);
    assert!((override_at(&mut m, 1.0, 0.6, 1.0) - 0.65).abs() < 1e-12);
    assert_eq!(override_at(&mut m, 2.0, 0.9, 1.0), 1.0);
}

#[test]
fn a_dynamic_region_follows_its_source_and_its_motion_counts() {
    let region = Region::sphere("follower", Vec3::X * 0.1, 0.2).warning(0.5).follow(SourceId(0)).guards(Guards::TCP);
    let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO)];
    let parts = ConfigurationParts { sources: vec!["belt".into()], ..parts(gantry(), volumes, vec![region]) };
    let mut m = Monitor::new(Configuration::new(parts).unwrap(), None).unwrap();
    let motion = FrameMotion { velocity: Vec3::Y * 0.4, acceleration: Vec3::Y * -1.0, ..FrameMotion::REST };
    let quarter = Rotation::from_rpy(0.0, 0.0, std::f64::consts::FRAC_PI_2);
    let source = SourceState { pose: Pose::new(quarter, Vec3::Y), motion, stamp_s: 0.0 };
    // The region's centre is 1 m along y, and its 0.1 m are turned from x to y.
    let q = [0.0, 0.6, 0.0, 0.0, 0.0, 0.0];
    let report = m.tick(&Snapshot { sources: &[source], ..Snapshot::stationary(0.0, &q) });
    assert!((report.speed_override - 0.3 / 0.5).abs() < 1e-12);
    let tcp = report.governing.unwrap();
    assert_eq!(report.reason, OverrideReason::Region(RegionId(0)));
    assert!((tcp.velocity + Vec3::Y * 0.4).length() < 1e-12 && (tcp.acceleration - Vec3::Y).length() < 1e-12);
}

/// The override of a robot at rest at x beside a region, with a program that moves it along x at `program` (m/s).
fn override_beside(region: Region, source: SourceState, x: f64, program: f64) -> f64 {
    let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO)];
    let region = region.follow(SourceId(0)).guards(Guards::TCP);
    let stopping = StoppingSettings {
        reaction_s: 0.01,
        period_s: 0.002,
        joint_deceleration: vec![2.0; 6],
        joint_acceleration: vec![1.0; 6],
    };
    let laws = Laws { stopping_distance: Some(stopping), stale_s: 0.1, ..direction_aware() };
    let parts = ConfigurationParts { laws, sources: vec!["cart".into()], ..parts(gantry(), volumes, vec![region]) };
    let mut m = Monitor::new(Configuration::new(parts).unwrap(), None).unwrap();
    let (q, intent) = ([x, 0.0, 0.0, 0.0, 0.0, 0.0], [program, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let snapshot =
        Snapshot { qd: &[0.0; 6], intent: Some(&intent), sources: &[source], ..Snapshot::stationary(1.0, &q) };
    m.tick(&snapshot).speed_override
}

/// The override beside a ball of 0.5 m that moves along x; it was read at x, `age_s` (s) before the robot's joint
/// values.
fn override_beside_a_ball((x, speed, age_s): (f64, f64, f64), robot_x: f64, program: f64) -> f64 {
    let motion = FrameMotion { velocity: Vec3::X * speed, ..FrameMotion::REST };
    let source = SourceState { pose: Pose::from_translation(Vec3::X * x), motion, stamp_s: 1.0 - age_s };
    override_beside(ball(), source, robot_x, program)
}

#[test]
fn the_age_of_a_source_counts_as_travel_of_its_region() {
    let mut slowed = 0;
    for i in 0..200 {
        let robot_x = 0.5 + 1e-3 * f64::from(i);
        let old = override_beside_a_ball((0.0, 1.0, 0.04), robot_x, -0.1);
        let new = override_beside_a_ball((0.04, 1.0, 0.0), robot_x, -0.1);
        let as_if_new = override_beside_a_ball((0.0, 1.0, 0.0), robot_x, -0.1);
        // The warning zone uses the region's position in the reading.
        assert!(old <= new + 0.2 + 1e-9 && old <= as_if_new, "{robot_x}: {old}, {new}, {as_if_new}");
        assert!(old == 0.0 || new > 0.0, "{robot_x}: {old}, {new}");
        slowed += i32::from(old < as_if_new);
    }
    assert!(slowed > 20, "{slowed}");
    // A ball at rest has not moved since its reading.
    assert_eq!(override_beside_a_ball((0.0, 0.0, 0.04), 0.6, -0.1), override_beside_a_ball((0.0, 0.0, 0.0), 0.6, -0.1));
}

#[test]
fn a_robot_in_a_region_that_moves_waits_until_it_stands() {
    assert!((override_beside_a_ball((0.0, 0.0, 0.0), 0.4, 0.1) - 0.1).abs() < 1e-12, "out of a ball at rest");
    assert!((override_beside_a_ball((0.0, 0.004, 0.0), 0.4, 0.1) - 0.1).abs() < 1e-12, "that trembles");
    for speed in [0.1, -0.1] {
        assert_eq!(override_beside_a_ball((0.0, speed, 0.0), 0.4, 0.1), 0.0, "{speed} m/s");
    }
}

/// A body that turns about its own axis stays in place. A plane on a hand whose joint values tremble does not move
/// faster at the robot's position.
#[test]
fn a_robot_leaves_a_region_that_turns_in_itself() {
    let turning = |about: Vec3, at: Vec3| SourceState {
        pose: Pose::from_translation(at),
        motion: FrameMotion { angular_velocity: about, ..FrameMotion::REST },
        stamp_s: 1.0,
    };
    let is_let_out = |region: Region, source: SourceState| override_beside(region, source, 0.4, 0.1) > 0.0;
    let ball_at = |center: Vec3| Region::sphere("ball", center, 0.5).warning(0.2);
    let disc = || Region::cylinder("disc", Vec3::Z * -0.5, 0.5, 1.0, Rotation::IDENTITY).warning(0.2);
    let block = Region::cuboid("block", Vec3::Z * -0.5, Vec3::splat(1.0), Rotation::IDENTITY).warning(0.2);
    // The wall is everything behind x = 0.5 in the world, with its source there.
    let wall = |source: Vec3| {
        let at = |y: f64, z: f64| Vec3::new(0.5, y, z) - source;
        Region::plane("wall", at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)).unwrap().warning(0.2)
    };
    assert!(is_let_out(ball_at(Vec3::ZERO), turning(Vec3::splat(2.0), Vec3::ZERO)));
    assert!(!is_let_out(ball_at(-Vec3::Y), turning(Vec3::Z * 2.0, Vec3::Y)), "a ball that circles");
    assert!(is_let_out(disc(), turning(Vec3::Z * 2.0, Vec3::ZERO)));
    assert!(!is_let_out(disc(), turning(Vec3::X * 2.0, Vec3::ZERO)), "a disc that tumbles");
    assert!(!is_let_out(block, turning(Vec3::Z * 2.0, Vec3::ZERO)), "a block");
    assert!(is_let_out(wall(Vec3::ZERO), turning(Vec3::splat(1e-6), Vec3::ZERO)), "a wall that trembles");
    assert!(!is_let_out(wall(Vec3::Y), turning(Vec3::Z, Vec3::Y)), "a wall that turns over the robot");
}

/// The virtual TCP is the closest point of the whole volume, with that point's velocity and acceleration.
#[test]
fn virtual_tcps_have_the_position_velocity_and_acceleration_of_the_closest_point() {
    let mut r = XorshiftStar(11);
    let tool = Obb { pose: Pose::from_translation(Vec3::X * 0.2), half_extents: Vec3::new(0.2, 0.05, 0.04) };
    let config = configuration(
        arm(),
        vec![Volume::tool_box(LinkId(6), tool)],
        vec![Region::sphere("s", Vec3::new(0.9, 0.1, 1.0), 0.1).warning(3.0)],
    );
    let mut m = Monitor::new(config.clone(), None).unwrap();
    for case in 0..2000 {
        let q: [f64; 6] = std::array::from_fn(|_| r.between(-1.4, 1.4));
        let qd: [f64; 6] = std::array::from_fn(|_| r.between(-1.0, 1.0));
        let qdd: [f64; 6] = std::array::from_fn(|_| r.between(-3.0, 3.0));
        let t0 = 10.0 * f64::from(case);
        let snapshot = Snapshot { qd: &qd, qdd: &qdd, ..Snapshot::stationary(t0, &q) };
        let report = m.tick(&snapshot);
        let tcp = report.governing.unwrap();
        assert_eq!(m.virtual_tcps(&snapshot).collect::<Vec<_>>(), [tcp]);
        let (volume, region) = (&config.volumes()[0], &config.regions()[0]);
        let exact = separation(&volume.shape, &m.volume_in_world(VolumeId(0)), &region.shape, &region.anchor);
        assert!((exact.distance - tcp.distance_m).abs() < 1e-12);
        // The positions of the same material point a little earlier and later.
        let in_tool = m.volume_in_world(VolumeId(0)).inverse_transform_point(tcp.position);
        let mut at = |dt: f64| {
            let q = std::array::from_fn::<f64, 6, _>(|i| q[i] + qd[i] * dt + 0.5 * qdd[i] * dt * dt);
            m.tick(&Snapshot::stationary(t0 + 5.0 + dt, &q));
            m.volume_in_world(VolumeId(0)).transform_point(in_tool)
        };
        let h = 1e-4;
        let (before, middle, after) = (at(-h), at(0.0), at(h));
        assert!(((after - before) / (2.0 * h) - tcp.velocity).length() < 1e-5);
        assert!(((after - middle * 2.0 + before) / (h * h) - tcp.acceleration).length() < 1e-3);
    }
}
