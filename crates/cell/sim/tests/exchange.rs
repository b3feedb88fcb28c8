//! Exchange regions in whole cells: never two robots inside.

use crate::common::run;
use elbowroom_sim::{Outcome, RunOutcome};

/// Two carriages in opposite directions; each carries two balls that reach the regions A and B in opposite order.
fn opposite(laws: &str, start_b: f64) -> String {
    let robot = |name: &str, z: f64, start: f64, first: &str, second: &str| {
        format!(
            "[robot.{name}]\nbase = {{ at = [0, 0, {z}], rpy = [0, 90, 0] }}\n\
             dh = [{{ kind = \"prismatic\", min = -5000, max = 5000, speed = 1000, acceleration = 8000 }}]\n\
             links = [[{{ sphere = {{ at = {first}, radius = 50 }} }}, {{ sphere = {{ at = {second}, radius = 50 }} }}]]\n\
             stop_time = 0.1\nstart = [{start}]\n"
        )
    };
    let region = |name: &str, y: f64| {
        format!(
            "[region.{name}]\nshape = \"box\"\nbase = [0, {y}, -500]\nsize = [200, 200, 1200]\nwarning = 500\n\
             kind = \"exchange\"\n"
        )
    };
    format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n[monitor]\n{laws}\n{}{}{}{}\
         [program.a]\nsteps = [{{ move = \"joint\", to = [2500] }}]\n\
         [program.b]\nsteps = [{{ move = \"joint\", to = [-2500] }}]\n",
        robot("a", 0.0, -2500.0, "[0, 0, 0]", "[0, 3000, -450]"),
        robot("b", 150.0, start_b, "[0, 0, 450]", "[0, 3000, 0]"),
        region("A", 0.0),
        region("B", 3000.0),
    )
}

/// Number of ticks with two robots inside one region, from the recorded joint values alone.
///
/// A ball is inside if its centre is within its radius of the box, along x.
fn both_inside(outcome: &RunOutcome, offsets_m: [[f64; 2]; 2]) -> usize {
    let robots = &outcome.recording.robots;
    let ticks = robots[0].samples.len();
    let inside = |robot: usize, region: usize, tick: usize| {
        let x = robots[robot].samples[tick].q[0] + offsets_m[robot][region];
        x.abs() < 0.15 - 1e-9
    };
    (0..ticks).filter(|t| (0..2).any(|region| inside(0, region, *t) && inside(1, region, *t))).count()
}

#[test]
fn a_robot_that_cannot_stop_outside_keeps_its_grant() {
    for start_b in [2500.0, 2495.0, 2460.0, 2400.0, 2200.0] {
        let outcome = run(&opposite("stopping_distance = true", start_b));
        let together = both_inside(&outcome, [[0.0, -0.45], [0.45, 0.0]]);
        assert_eq!(together, 0, "b starts at {start_b}: both inside in {together} ticks");
        let regions = &outcome.recording.regions;
        assert!(regions.iter().all(|r| !r.entered), "b starts at {start_b}: a robot entered without the grant");
        assert!(outcome.recording.robots.iter().all(|r| r.finished), "b starts at {start_b}: a robot was left waiting");
    }
}

const LAWS: &str = "[monitor]\nstopping_distance = true\n";

/// A carriage on a rail with a ball at its origin and one `other` mm along the rail.
fn carriage(name: &str, base: [f64; 3], yaw: f64, other: f64, start: f64, to: f64) -> String {
    format!(
        "[robot.{name}]\nbase = {{ at = {base:?}, rpy = [0, 90, {yaw}] }}\n\
         dh = [{{ kind = \"prismatic\", min = -5000, max = 5000, speed = 1000, acceleration = 8000 }}]\n\
         links = [[{{ sphere = {{ at = [0, 0, 0], radius = 50 }} }}, {{ sphere = {{ at = [0, 0, {other}], radius = 50 }} }}]]\n\
         stop_time = 0.1\nstart = [{start}]\n\
         [program.{name}]\nsteps = [{{ move = \"joint\", to = [{to}] }}]\n"
    )
}

fn exchanged(name: &str, at: [f64; 3], width: f64, warning: f64) -> String {
    format!(
        "[region.{name}]\nshape = \"box\"\nbase = {at:?}\nsize = [{width}, {width}, 1500]\nwarning = {warning}\n\
         kind = \"exchange\"\n"
    )
}

/// Three robots around a ring of three regions: each reaches the next region while its tail is in its own.
fn ring(laws: &str) -> String {
    let mut text = format!("version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n{laws}");
    for (i, (robot, region)) in [("a", "A"), ("b", "B"), ("c", "C")].into_iter().enumerate() {
        let angle = 120.0 * i as f64;
        let [x, y] = [866.025 * angle.to_radians().cos(), 866.025 * angle.to_radians().sin()];
        text += &carriage(robot, [x, y, 150.0 * i as f64], angle + 150.0, -1000.0, -500.0, 4000.0);
        text += &exchanged(region, [x, y, -300.0], 450.0, 200.0);
    }
    text
}

/// Two robots that start inside one region each, and need the other region.
fn inside_each_other(laws: &str) -> String {
    format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n{laws}{}{}{}{}",
        carriage("a", [0.0, 0.0, 0.0], 0.0, 350.0, 0.0, 1500.0),
        carriage("b", [700.0, 0.0, 150.0], 180.0, 350.0, 0.0, 1500.0),
        exchanged("A", [0.0, 0.0, -300.0], 400.0, 100.0),
        exchanged("B", [700.0, 0.0, -300.0], 400.0, 100.0),
    )
}

#[test]
fn regions_are_granted_without_deadlock_in_a_ring_of_robots() {
    for laws in ["", LAWS] {
        let outcome = run(&ring(laws));
        let r = &outcome.recording;
        let left: Vec<&str> = r.robots.iter().filter(|r| !r.finished).map(|r| r.name.as_str()).collect();
        assert!(left.is_empty(), "{laws}{left:?} are deadlocked");
        assert!(r.deadlocks.is_empty() && !outcome.has_violation());
        assert!(r.robots.iter().all(|r| r.ending == elbowroom_sim::RobotEnding::default()));
    }
}

#[test]
fn robots_that_wait_for_each_other_are_a_deadlock() {
    for laws in ["", LAWS] {
        let outcome = run(&inside_each_other(laws));
        let r = &outcome.recording;
        assert!(outcome.has_violation(), "{laws}two robots are deadlocked without a violation");
        let [deadlock] = &r.deadlocks[..] else { panic!("{laws}{:?}", r.deadlocks) };
        assert_eq!(deadlock.robots, ["a", "b"]);
        assert_eq!(deadlock.regions, ["B", "A"]);
        assert!(deadlock.t_s < r.duration_s);
        for (robot, region) in r.robots.iter().zip(["B", "A"]) {
            let e = &robot.ending;
            assert_eq!((e.outcome, e.by.as_deref()), (Outcome::Deadlock, Some(region)), "{laws}{e:?}");
            assert!(e.part.is_some() && e.point.is_some() && e.stopped_at_s.is_some());
        }
    }
}

#[test]
fn two_robots_that_start_inside_one_region_are_a_deadlock() {
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n{}{}{}",
        carriage("a", [0.0, 0.0, 0.0], 0.0, 100.0, -100.0, 2000.0),
        carriage("b", [0.0, 400.0, 0.0], 0.0, 100.0, 100.0, 2000.0),
        exchanged("shared", [0.0, 0.0, -500.0], 1000.0, 300.0),
    );
    let outcome = run(&text);
    let [deadlock] = &outcome.recording.deadlocks[..] else { panic!("{:?}", outcome.recording.deadlocks) };
    assert_eq!((&deadlock.robots[..], &deadlock.regions[..]), (&["a".into(), "b".into()][..], &["shared".into()][..]));
}

/// With the recovery law each robot leaves slowly along its program: the same cell has no deadlock.
#[test]
fn two_robots_that_start_inside_one_region_leave_it_where_their_programs_lead_out() {
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n{LAWS}direction_aware = true\n{}{}{}",
        carriage("a", [0.0, 0.0, 0.0], 0.0, 100.0, -100.0, 2000.0),
        carriage("b", [0.0, 400.0, 0.0], 0.0, 100.0, 100.0, 2000.0),
        exchanged("shared", [0.0, 0.0, -500.0], 1000.0, 300.0),
    );
    let r = run(&text).recording;
    assert!(r.deadlocks.is_empty() && r.robots.iter().all(|r| r.finished), "{:?}", r.deadlocks);
    // Slowly, as long as the other robot may be inside.
    let fast = |robot: usize| r.robots[robot].samples.iter().any(|s| s.q[0] < 0.4 && s.speed_override > 0.11);
    assert!(!(fast(0) && fast(1)), "both at speed inside");
}

/// Between the two regions the robots cannot stop: a robot in the first region keeps it until it is in the second one.
///
/// So one robot gets both regions before the other robot.
#[test]
fn a_gap_too_short_to_stop_in_joins_two_claims() {
    let robot = |name: &str, y: f64, other: f64, start: f64| {
        carriage(name, [0.0, y, 0.0], 0.0, other, start, -start)
            .replace("speed = 1000", "speed = 1500")
            .replace("stop_time = 0.1", "stop_time = 0.5")
    };
    let region = |name: &str, x: f64| {
        format!(
            "[region.{name}]\nshape = \"box\"\nbase = [{x}, 75, -500]\nsize = [200, 2000, 1000]\nwarning = 50\n\
             kind = \"exchange\"\n"
        )
    };
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n{LAWS}direction_aware = true\n{}{}{}{}",
        robot("a", 0.0, -700.0, -2500.0),
        robot("b", 150.0, 700.0, 2500.0),
        region("first", -450.0),
        region("second", 450.0),
    );
    let r = run(&text).recording;
    assert!(r.deadlocks.is_empty() && r.robots.iter().all(|r| r.finished), "{:?}", r.deadlocks);
}

/// One robot holds the region, and is blocked by the region that the other robot carries.
#[test]
fn a_cycle_through_a_region_that_a_robot_carries_is_a_deadlock_too() {
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n{LAWS}{}{}{}\
         [region.hand]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 100\nrobots = [\"b\"]\n\
         follow = {{ robot = \"a\" }}\n",
        carriage("a", [0.0, 0.0, 0.0], 0.0, 0.0, -1800.0, 2000.0),
        carriage("b", [0.0, 100.0, 0.0], 0.0, 0.0, 1000.0, -2000.0),
        exchanged("x", [0.0, 0.0, -500.0], 600.0, 100.0),
    );
    let outcome = run(&text);
    let [deadlock] = &outcome.recording.deadlocks[..] else { panic!("{:?}", outcome.recording.deadlocks) };
    assert_eq!(deadlock.robots, ["a", "b"]);
    assert!(outcome.has_violation() && outcome.recording.robots.iter().all(|r| r.ending.outcome == Outcome::Deadlock));
}

/// A robot that accelerates harder than it brakes, at rest just beyond the warning zone and at full override, cannot be
/// proven to stop outside. It returns the grant nevertheless.
#[test]
fn a_robot_that_ends_beyond_the_warning_zone_releases_the_region() {
    let quick = carriage("first", [0.0, 0.0, 0.0], 0.0, 0.0, -1500.0, 400.0)
        .replace("acceleration = 8000", "acceleration = 27000")
        .replace("stop_time = 0.1", "stop_time = 0.8");
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 4\n{LAWS}reaction_ms = 55\n{quick}{}{}",
        carriage("second", [0.0, 0.0, 0.0], 90.0, 0.0, -5000.0, 1000.0),
        exchanged("shared", [0.0, 0.0, -500.0], 400.0, 50.0),
    );
    let r = run(&text).recording;
    assert!(r.robots.iter().all(|r| r.finished), "{:?}", r.robots.iter().map(|r| &r.ending).collect::<Vec<_>>());
}

#[test]
fn a_robot_that_follows_another_through_two_regions_does_not_wait_for_both() {
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n{LAWS}{}{}{}{}",
        carriage("first", [0.0, 0.0, 0.0], 0.0, -400.0, -600.0, 3000.0),
        carriage("second", [0.0, 0.0, 150.0], 0.0, -400.0, -900.0, 3000.0),
        exchanged("A", [0.0, 0.0, -300.0], 400.0, 100.0),
        exchanged("B", [650.0, 0.0, -300.0], 400.0, 100.0),
    );
    let outcome = run(&text);
    let r = &outcome.recording;
    assert!(r.robots.iter().all(|r| r.finished) && !outcome.has_violation());
    let inside = |robot: usize, tick: usize, at: f64| {
        [0.0, -0.4].iter().any(|ball| (r.robots[robot].samples[tick].q[0] + ball - at).abs() < 0.25)
    };
    let both = (0..r.robots[0].samples.len()).filter(|t| inside(0, *t, 0.65) && inside(1, *t, 0.0)).count();
    assert!(both > 0, "the second waited until the first had left both regions");
}

#[test]
fn the_outcome_of_a_robot_is_reported() {
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n{LAWS}{}{}{}\
         [region.wall]\nshape = \"box\"\nbase = [1000, 0, -500]\nsize = [200, 200, 1000]\nwarning = 100\nrobots = [\"a\"]\n",
        carriage("a", [0.0, 0.0, 0.0], 0.0, 100.0, 0.0, 2000.0),
        carriage("b", [0.0, 2000.0, 0.0], 0.0, 100.0, 0.0, 500.0),
        carriage("c", [0.0, 2000.0, 0.0], 0.0, 100.0, 900.0, 600.0),
    );
    let outcome = run(&text);
    let [a, b, c] = [0, 1, 2].map(|i| &outcome.recording.robots[i].ending);
    assert_eq!((a.outcome, a.by.as_deref()), (Outcome::Stopped, Some("wall")));
    let point = a.point.expect("a point");
    assert!(point.x > 0.8 && point.x < 0.9 && a.part.is_some() && a.stopped_at_s.is_some_and(|t| t > 0.5), "{a:?}");
    assert_eq!((b.outcome, c.outcome), (Outcome::Collided, Outcome::Collided));
    assert!(b.by.as_deref().is_some_and(|by| by.starts_with("c/")) && b.part.is_some(), "{b:?}");
}
