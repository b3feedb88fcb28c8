//! Moving objects: their poses, and contacts with robots.

use crate::common::{parse, rail, run};
use elbowroom_cell::MovingObject;
use elbowroom_proximity::ccd::RigidMotion;
use elbowroom_sim::{RunOptions, simulate};
use elbowroom_spatial::{Rotation, Vec3};
use proptest::prelude::*;

/// A waiting carriage (a ball of 50 mm at the origin), and an object.
fn waiting(tick_ms: f64, object: &str) -> String {
    let head = format!("version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = {tick_ms}\n");
    format!("{head}{}{object}\n[program.r]\nsteps = [{{ wait = 5 }}]\n", rail("r", 0.0))
}

fn ball(radius: f64, at: [f64; 3], motion: &str) -> String {
    format!("[object.ball]\nshape = \"sphere\"\nradius = {radius}\nat = {at:?}\n{motion}\n")
}

fn moving_object(object: &str) -> MovingObject {
    parse(&waiting(2.0, object)).moving_objects[0].clone()
}

/// Reference position: integrates along the segments one after the other.
fn reference_position(corners: &[Vec3], speed: f64, repeat: &str, mut seconds: f64) -> Vec3 {
    let mut points = corners.to_vec();
    loop {
        for motion in points.windows(2) {
            let duration = motion[0].distance(motion[1]) / speed;
            if seconds < duration {
                return motion[0] + (motion[1] - motion[0]) * (seconds / duration);
            }
            seconds -= duration;
        }
        match repeat {
            "no" => return points[points.len() - 1],
            "loop" if points[0] == points[points.len() - 1] => {}
            "loop" => points = [&points[points.len() - 1..], corners].concat(),
            _ => points.reverse(),
        }
        if repeat == "loop" && points.len() == corners.len() + 1 && points[0] != corners[0] {
            // The segment back to the start once, then closed rounds.
            let duration = points[0].distance(points[1]) / speed;
            if seconds < duration {
                return points[0] + (points[1] - points[0]) * (seconds / duration);
            }
            seconds -= duration;
            points = [corners, &corners[..1]].concat();
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_pose_of_an_object_is_at_its_arc_length_along_the_path(
        corners in proptest::collection::vec([-900_i32..900, -900..900, -900..900], 2..6),
        speed in 10.0..900.0_f64,
        start in 0.0..2.0_f64,
        repeat in prop::sample::select(vec!["no", "loop", "ping-pong"]),
        angular_velocity in [-90_i32..90, -90..90, -90..90],
        times in proptest::collection::vec(0.0..60.0_f64, 20),
    ) {
        prop_assume!(corners.windows(2).all(|w| w[0] != w[1]));
        let metres = |c: &[i32; 3]| Vec3::from(c.map(f64::from)) * 1e-3;
        let points: Vec<Vec3> = corners.iter().map(metres).collect();
        let motion = format!(
            "rpy = [0, 0, 90]\nmotion = {{ via = {:?}, speed = {speed}, start = {start}, repeat = \"{repeat}\", turn = {angular_velocity:?} }}",
            &corners[1..]
        );
        let at = corners[0].map(f64::from);
        let moving_object = moving_object(&ball(20.0, at, &motion));
        let angular_velocity = Vec3::from(angular_velocity.map(|w| f64::from(w).to_radians()));
        let length: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        for t in times {
            let seconds = (t - start).max(0.0);
            let pose = moving_object.pose(t);
            let expected = reference_position(&points, speed * 1e-3, repeat, seconds);
            prop_assert!(pose.translation.distance(expected) < 1e-9, "{t} s: {:?} {expected:?}", pose.translation);
            let turning = if repeat == "no" { seconds.min(length / (speed * 1e-3)) } else { seconds };
            let turned = Rotation::from_rotation_vector(angular_velocity * turning)
                * Rotation::from_rpy(0.0, 0.0, 90_f64.to_radians());
            prop_assert!((turned * Vec3::X).distance(pose.rotation * Vec3::X) < 1e-9);
            // The velocity is the velocity of the next instant, and the bound of the motion holds.
            let (m, dt) = (moving_object.motion(t), 1e-7);
            let ahead = moving_object.pose(t + dt);
            let corner_near = (moving_object.motion(t + dt).velocity - m.velocity).length() > 1e-12;
            if !corner_near {
                prop_assert!(((ahead.translation - pose.translation) / dt - m.velocity).length() < 1e-5);
                let change = (ahead.rotation * Vec3::X - pose.rotation * Vec3::X) / dt;
                prop_assert!((change - m.angular_velocity.cross(pose.rotation * Vec3::X)).length() < 1e-4);
            }
            let motion = moving_object.motion_between(t, t + 0.3);
            let (a, b) = (moving_object.pose(t), moving_object.pose(t + 0.3));
            for p in [Vec3::ZERO, Vec3::X * 0.4, Vec3::new(0.0, -0.3, 0.2)] {
                let travelled = a.transform_point(p).distance(b.transform_point(p));
                prop_assert!(travelled <= motion.speed(0.4, 0.0, 1.0) + 1e-12);
                if let Some(s) = motion.constant_twist() {
                    for part in [0.0, 0.4, 1.0] {
                        let (x, y) = (s.pose(part).transform_point(p), motion.pose(part).transform_point(p));
                        prop_assert!(x.distance(y) < 1e-9, "the twist is not constant");
                    }
                }
            }
        }
    }
}

#[test]
fn an_object_on_a_belt_moves_with_the_belt() {
    let belt = "follow = { encoder = \"belt\" }\n[encoder.belt]\ndirection = [0, 2, 0]\nspeed = 200\nat = 50\nstart = 1\nend = 3";
    let moving_object = moving_object(&ball(20.0, [700.0, 0.0, 0.0], belt));
    for (t, y, v) in [(0.0, 0.05, 0.0), (1.0, 0.05, 0.2), (2.5, 0.35, 0.2), (3.0, 0.45, 0.0), (9.0, 0.45, 0.0)] {
        assert!(moving_object.pose(t).translation.distance(Vec3::new(0.7, y, 0.0)) < 1e-12, "{t}");
        assert_eq!(moving_object.motion(t).velocity, Vec3::Y * v, "{t}");
    }
    let cell = parse(&waiting(2.0, &ball(20.0, [700.0, 0.0, 0.0], belt)));
    assert_eq!(cell.objects[0].in_world.translation.y, 0.05, "query and plan use its initial pose");
}

fn first_contact(text: &str) -> Option<f64> {
    let outcome = run(text);
    let list = &outcome.recording.robots[0].collisions;
    assert_eq!(outcome.has_violation(), !list.is_empty());
    list.first().map(|c| {
        assert_eq!((c.a.as_str(), c.b.as_str()), ("r/link_1", "ball"));
        c.t_s
    })
}

#[test]
fn a_stationary_robot_collides_when_the_object_arrives() {
    // 1000 mm of travel, contact at a distance of 80 mm.
    let motion = |start: f64| format!("motion = {{ via = [[0, 1000, 0]], speed = 500, start = {start} }}");
    for (tick_ms, start) in [(2.0, 0.5), (2.0, 0.1234), (50.0, 0.5), (7.0, 0.31)] {
        let t = first_contact(&waiting(tick_ms, &ball(30.0, [0.0, -1000.0, 0.0], &motion(start)))).unwrap();
        let exact = start + 0.92 / 0.5;
        assert!((t - exact).abs() < 5e-5, "{t} {exact}");
    }
    // At 81 mm there is no contact.
    let past = "motion = { via = [[81, 1000, 0]], speed = 500 }";
    assert_eq!(first_contact(&waiting(2.0, &ball(30.0, [81.0, -1000.0, 0.0], past))), None);
}

#[test]
fn a_contact_within_one_tick_is_detected() {
    let fast = |x: f64| {
        let via = format!("motion = {{ via = [[{x}, 6000, 0]], speed = 20000, start = 0.51 }}");
        waiting(20.0, &ball(1.0, [x, -6000.0, 0.0], &via))
    };
    let cell = parse(&fast(0.0));
    let radius = |t: f64| cell.moving_objects[0].pose(t).translation.length();
    assert!((0..250).all(|tick| radius(f64::from(tick) * 0.02) > 0.051), "a tick detects it: the test is void");
    let t = first_contact(&fast(0.0)).expect("400 mm per tick, not detected");
    assert!((t - (0.51 + 5.949 / 20.0)).abs() < 3e-5, "{t}");
    assert_eq!(first_contact(&fast(51.5)), None);
}

#[test]
fn a_fast_robot_does_not_tunnel_through_a_fixed_object() {
    let text = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\ntick_ms = 250\n[robot.r]\n\
                base = { at = [0, 0, 0], rpy = [0, 90, 0] }\nlinks = [{ sphere = { radius = 5 } }]\n\
                dh = [{ kind = \"prismatic\", min = 0, max = 9000, speed = 3000, acceleration = 20000 }]\n\
                [object.ball]\nshape = \"sphere\"\nradius = 1\nat = [4321, 3, 0]\n\
                [program.r]\nsteps = [{ move = \"joint\", to = [9000] }]\n";
    let outcome = run(text);
    let track = &outcome.recording.robots[0];
    assert!(track.samples.iter().all(|s| (s.tcp.x - 4.321).abs() > 0.02), "a tick detects it: the test is void");
    assert_eq!(track.collisions.len(), 1);
    let t = track.collisions[0].t_s;
    let after = track.samples.iter().position(|s| s.t_s > t).unwrap();
    assert!(track.samples[after - 1].tcp.x < 4.321 && track.samples[after].tcp.x > 4.321);
}

#[test]
fn belts_stop_and_restart() {
    let belt = |more: &str| {
        let text =
            format!("follow = {{ encoder = \"belt\" }}\n[encoder.belt]\ndirection = [0, 1, 0]\nspeed = 500\n{more}");
        waiting(2.0, &ball(30.0, [0.0, -500.0, 0.0], &text))
    };
    let t = first_contact(&belt("")).unwrap();
    assert!((t - 0.84).abs() < 2e-4, "{t}");
    assert_eq!(first_contact(&belt("end = 0.8")), None);
    assert!(first_contact(&belt("end = 0.85")).is_some());
    // From 600 on to 1000, then again from 0: it jumps past the robot without contact.
    assert_eq!(first_contact(&belt("at = 600\nwrap = 1000\nend = 1.6")), None);
    assert!(first_contact(&belt("at = 600\nwrap = 1000\nend = 1.7")).is_some());
}

#[test]
fn a_stationary_link_collides_too() {
    let text = "version = 1\nunits = { length = \"m\", angle = \"rad\" }\n[robot.r]\nbase_link = { sphere = { radius = 0.1 } }\n\
                dh = [{ d = 1, min = -1, max = 1, speed = 1 }]\n\
                [object.ball]\nshape = \"sphere\"\nradius = 0.1\nat = [2, 0, 0]\nmotion = { via = [[-2, 0, 0]], speed = 1 }\n\
                [object.far]\nshape = \"sphere\"\nradius = 0.1\nat = [2, 9, 0]\n\
                [program.r]\nsteps = [{ wait = 3 }]\n";
    let outcome = run(text);
    let c = &outcome.recording.robots[0].collisions;
    assert_eq!((c.len(), c[0].a.as_str(), c[0].b.as_str()), (1, "r/base", "ball"));
    assert!((c[0].t_s - 1.8).abs() < 1e-4);
}

#[test]
fn a_rotating_object_sweeps_its_circle() {
    let bar = "[object.ball]\nshape = \"box\"\nsize = [1000, 20, 20]\nat = [0, 300, 0]\nmotion = { turn = [0, 0, 90], start = 1 }\n";
    let t = first_contact(&waiting(2.0, bar)).unwrap();
    // The bar touches the ball where its axis is 60 mm (10 + 50) from the centre: sin(a) = 60 / 300 before it points
    // there.
    let angle = 90.0 - (60.0_f64 / 300.0).asin().to_degrees();
    assert!((t - (1.0 + angle / 90.0)).abs() < 1e-3, "{t}");
}

#[test]
fn the_recording_has_the_poses() {
    let text = waiting(5.0, &ball(30.0, [500.0, -300.0, 0.0], "motion = { via = [[500, 300, 0]], speed = 200 }"));
    let cell = parse(&text);
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    let (track, robot) = (&outcome.recording.objects[0], &outcome.recording.robots[0]);
    assert_eq!((track.name.as_str(), track.poses.len()), ("ball", robot.samples.len()));
    for (pose, sample) in track.poses.iter().zip(&robot.samples) {
        assert_eq!(*pose, cell.moving_objects[0].pose(sample.t_s));
    }
}
