//! Several robots, dynamic regions, temporary and exchange regions.

use crate::common::{ARM, HEAD, parse, rail, run, run_free};
use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;
use elbowroom_sim::{RunOptions, SilentFrom, csv, simulate};
use elbowroom_testkit::random;

/// Two carriages on crossing rails; the crossing is an exchange region.
fn crossing(wait_a: f64, wait_b: f64) -> String {
    let b = "[robot.b]\nbase = { at = [0, 0, 0], rpy = [-90, 0, 0] }\n\
         dh = [{ kind = \"prismatic\", min = -2000, max = 2000, speed = 1300, acceleration = 4000 }]\n\
         links = [{ sphere = { radius = 50 } }]\nstart = [-1200]\n";
    format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 10\n{}start = [-1200]\n{b}\
         [region.crossing]\nshape = \"box\"\nbase = [0, 0, -200]\nsize = [400, 400, 400]\nkind = \"exchange\"\nwarning = 300\n\
         [program.a]\nsteps = [{{ wait = {wait_a} }}, {{ move = \"joint\", to = [1200] }}]\n\
         [program.b]\nsteps = [{{ wait = {wait_b} }}, {{ move = \"joint\", to = [1200] }}]\n",
        rail("a", 0.0)
    )
}

#[test]
fn an_exchange_region_is_never_shared_and_all_robots_pass() {
    let mut random = random::Random(0x9e37_79b9_7f4a_7c15);
    let mut waited = 0;
    let cells = elbowroom_testkit::extent::amount(400, 1000);
    for _ in 0..cells {
        let outcome = run(&crossing(random.between(0.0, 1.5), random.between(0.0, 1.5)));
        let r = &outcome.recording;
        assert!(r.robots.iter().all(|r| r.finished), "a robot was left waiting");
        assert!(!outcome.has_violation());
        let inside = |k: usize| -> Vec<bool> {
            // Both rails lead through the origin; the region with the ball's radius is |x| < 250.
            r.robots[k].samples.iter().map(|s| s.tcp.length() < 0.25 - 1e-9).collect()
        };
        let (a, b) = (inside(0), inside(1));
        assert!(a.iter().zip(&b).all(|(a, b)| !(a & b)), "both inside");
        waited += usize::from(r.robots.iter().any(|r| r.min_override < 1.0));
    }
    assert!(waited * 10 > cells * 3, "the timings hardly ever met: {waited}");
}

#[test]
fn without_the_monitor_they_meet_in_the_crossing() {
    let outcome = run_free(&crossing(0.3, 0.0));
    assert!(outcome.has_violation());
}

#[test]
fn a_robot_that_becomes_silent_inside_keeps_the_region_blocked() {
    let cell = parse(&crossing(0.0, 0.6));
    let options =
        RunOptions { silent_from: vec![SilentFrom { robot: RobotId(0), t_s: 1.35 }], ..RunOptions::default() };
    let outcome = simulate(&cell, &options).unwrap();
    let r = &outcome.recording;
    assert!(r.robots[0].samples.last().unwrap().tcp.length() < 0.25, "it fell silent elsewhere");
    assert!(!r.robots[1].finished && !r.robots[0].finished);
    assert!(r.robots[1].samples.iter().all(|s| s.tcp.length() > 0.25));
    assert!(r.robots[1].collisions.is_empty());
}

#[test]
fn temporary_regions_count_only_while_they_are_on() {
    let text = |first: &str| {
        format!(
            "{HEAD}{}[region.gate]\nshape = \"sphere\"\ncentre = [800, 0, 0]\nradius = 100\nwarning = 200\nlife = \"temporary\"\n\
             [program.r]\nsteps = [{first}{{ move = \"joint\", to = [1500] }}, {{ region = \"gate\", active = true }}, {{ move = \"joint\", to = [0] }}]\n",
            rail("r", 0.0)
        )
    };
    let outcome = run(&text(""));
    let r = &outcome.recording;
    let switched = r.events.iter().find(|e| e.event.name() == "on").unwrap();
    assert_eq!((switched.robot.as_str(), switched.region.as_str()), ("r", "gate"));
    for s in &r.robots[0].samples {
        let law = if s.t_s < switched.t_s { 1.0 } else { (((s.tcp.x - 0.8).abs() - 0.15).max(0.0) / 0.2).min(1.0) };
        assert!((s.speed_override - law).abs() < 1e-9, "{} s: {} {law}", s.t_s, s.speed_override);
    }
    assert!(!r.robots[0].finished && !r.regions[0].entered);
    assert_eq!(r.regions[0].active, [(0.0, false), (switched.t_s, true)]);
    let both = run(&text("{ region = \"gate\", active = true }, "));
    assert!(both.recording.robots[0].samples.last().unwrap().tcp.x < 0.65);
    assert_eq!(both.recording.events.iter().filter(|e| e.event.name() == "on").count(), 1, "on twice is on once");
}

#[test]
fn a_zone_follows_the_conveyor_and_releases_the_waiting_robot() {
    let text = format!(
        "{HEAD}{}[encoder.belt]\ndirection = [0, 2, 0]\nspeed = 200\nstart = 1\nend = 9\n\
         [region.part]\nshape = \"cylinder\"\nbase = [1000, 0, -500]\nradius = 200\nheight = 1000\nwarning = 300\nguards = [\"tcp\"]\n\
         follow = {{ encoder = \"belt\" }}\n\
         [program.r]\nsteps = [{{ move = \"joint\", to = [1800] }}]\n",
        rail("r", 0.0)
    );
    let outcome = run(&text);
    let r = &outcome.recording;
    assert!(r.robots[0].finished && !outcome.has_violation());
    for s in &r.robots[0].samples {
        let y = 0.2 * (s.t_s.min(9.0) - 1.0).max(0.0);
        let d = ((s.tcp.x - 1.0).hypot(s.tcp.y - y) - 0.2).max(0.0);
        assert!((s.speed_override - (d / 0.3).min(1.0)).abs() < 1e-9);
    }
    assert!(r.robots[0].min_override < 0.2);
}

#[test]
fn robots_with_zones_on_each_others_flanges_do_not_collide() {
    let arm = |name: &str, x: f64, yaw: f64, pan: f64| {
        format!(
            "[robot.{name}]\n{ARM}base = {{ at = [{x}, 0, 0], rpy = [0, 0, {yaw}] }}\nstart = [{}, 0, 0, 0, 40, 0]\n\
             [program.{name}]\nsteps = [{{ move = \"joint\", to = [{pan}, 0, 0, 0, 40, 0], speed = 40 }}]\n",
            -pan
        )
    };
    let zone = |name: &str, of: &str| {
        format!(
            "[region.{name}]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 250\nwarning = 400\nfollow = {{ robot = \"{of}\", frame = \"flange\" }}\n"
        )
    };
    let text = format!(
        "{HEAD}{}{}{}{}",
        arm("left", 0.0, 0.0, 50.0),
        arm("right", 1900.0, 180.0, -50.0),
        zone("l", "left"),
        zone("r", "right")
    );
    let free = run_free(&text);
    assert!(free.recording.robots.iter().any(|r| !r.collisions.is_empty()), "the test needs paths that collide");
    let guarded = run(&text);
    assert!(guarded.recording.robots.iter().all(|r| r.collisions.is_empty()));
    assert!(guarded.recording.robots.iter().any(|r| r.min_override < 0.5));
}

#[test]
fn collisions_are_reported_once_per_pair_with_names() {
    let text = format!(
        "{HEAD}{}[object.post]\nshape = \"cylinder\"\nat = [700, 0, 0]\nradius = 50\nheight = 500\n\
         [program.r]\nrepeat = 2\nsteps = [{{ move = \"joint\", to = [1500] }}, {{ move = \"joint\", to = [0] }}]\n",
        rail("r", 0.0)
    );
    let outcome = run(&text);
    let collisions = &outcome.recording.robots[0].collisions;
    assert_eq!(collisions.len(), 1);
    assert_eq!((collisions[0].a.as_str(), collisions[0].b.as_str()), ("r/link_1", "post"));
    let samples = &outcome.recording.robots[0].samples;
    let first = samples.iter().find(|s| (s.tcp.x - 0.7).abs() <= 0.1 + 1e-9).unwrap();
    // Between the previous tick and this one.
    let before = first.t_s - collisions[0].t_s;
    assert!((0.0..0.004).contains(&before), "{} {}", collisions[0].t_s, first.t_s);
    assert!(outcome.has_violation() && outcome.recording.robots[0].finished);
}

#[test]
fn recordings_play_back_on_their_rows_and_obey_the_override() {
    let dir = tempfile::tempdir().unwrap();
    let rows: Vec<String> = (0..=500)
        .map(|i| format!("{},{}\n", f64::from(i) * 0.004, 0.25 * (1.0 - (f64::from(i) * 0.012).cos())))
        .collect();
    std::fs::write(dir.path().join("t.csv"), format!("t_s,joint_1\n{}", rows.concat())).unwrap();
    let text = format!(
        "{HEAD}{}[region.z]\nshape = \"sphere\"\ncentre = [700, 0, 0]\nradius = 150\nwarning = 400\nguards = [\"tcp\"]\n[program.r]\ntrajectory = \"t.csv\"\n",
        rail("r", 0.0)
    );
    let cell = Cell::parse(dir.path().join("c.toml"), &text).unwrap();
    let free = simulate(&cell, &RunOptions { apply_override: false, ..RunOptions::default() }).unwrap().recording;
    assert!(free.robots[0].finished && (free.duration_s - 2.0).abs() < 0.005);
    for s in &free.robots[0].samples {
        assert!((s.q[0] - 0.25 * (1.0 - (s.t_s * 3.0).cos())).abs() < 1e-9);
    }
    let slow = simulate(&cell, &RunOptions::default()).unwrap().recording;
    assert!(slow.robots[0].finished && slow.duration_s > 3.0);
}

#[test]
fn repeats_waits_and_overrides_take_effect() {
    let text = format!(
        "{HEAD}{}[program.r]\noverride = 50\nsteps = [{{ move = \"joint\", to = [100] }}, {{ wait = 2.5 }}, {{ override = 100 }}, {{ move = \"joint\", to = [0] }}]\n",
        rail("r", 0.0)
    );
    let once = run(&text).recording;
    assert!(once.robots[0].finished && once.duration_s > 2.5);
    let last = once.robots[0].samples.last().unwrap();
    assert_eq!((last.speed_override, last.q[0]), (1.0, 0.0));
    let twice = simulate(&parse(&text), &RunOptions { repeat: 2, ..RunOptions::default() }).unwrap().recording;
    assert!((twice.duration_s - 2.0 * once.duration_s).abs() < 0.02, "{} {}", twice.duration_s, once.duration_s);
}

#[test]
fn csv_files_have_a_row_per_robot_and_tick() {
    let outcome = run(&crossing(0.0, 0.2));
    let mut trace = Vec::new();
    csv::write_trace(&outcome.recording, &mut trace).unwrap();
    let trace = String::from_utf8(trace).unwrap();
    let mut lines = trace.lines();
    let columns = "t_s,robot,q1,tcp_x_m,tcp_y_m,tcp_z_m,tcp_speed_m_s,override,region,distance_m,part,object,point_x_m,\
                   point_y_m,point_z_m";
    assert_eq!(lines.next(), Some(columns));
    let ticks = outcome.recording.robots[0].samples.len();
    assert_eq!(lines.clone().count(), 2 * ticks);
    assert!(lines.all(|l| l.split(',').count() == 15));
    let mut events = Vec::new();
    csv::write_events(&outcome.recording, &mut events).unwrap();
    let events = String::from_utf8(events).unwrap();
    assert!(events.starts_with("t_s,robot,region,event\n") && events.contains(",crossing,warn_in"), "{events}");
}

#[test]
fn a_direction_aware_monitor_lets_a_robot_leave_a_region_that_was_switched_on_around_it() {
    let text = |law: &str| {
        format!(
            "{HEAD}{}[monitor]\n{law}\n[region.gate]\nshape = \"sphere\"\ncentre = [800, 0, 0]\nradius = 100\nwarning = 200\nlife = \"temporary\"\nguards = [\"tcp\"]\n\
             [program.r]\nsteps = [{{ move = \"joint\", to = [860] }}, {{ region = \"gate\", active = true }}, {{ move = \"joint\", to = [1500] }}]\n",
            rail("r", 0.0)
        )
    };
    assert!(!run(&text("")).recording.robots[0].finished, "the paper's law stops it permanently");
    let outcome = run(&text("direction_aware = true"));
    assert!(outcome.recording.robots[0].finished && outcome.recording.regions[0].entered);
}
