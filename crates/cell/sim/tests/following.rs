//! Regions that follow objects and pose files, and implausible sources.

use std::f64::consts::PI;
use std::path::Path;

use crate::common::{HEAD, rail};
use elbowroom_cell::Cell;
use elbowroom_sim::{RegionPoses, RunOptions, RunOutcome, simulate};
use elbowroom_spatial::Vec3;

const PROGRAM: &str = "[program.a]\nsteps = [{ move = \"joint\", to = [1500] }]\n";
const LAWS: &str = "[monitor]\nstopping_distance = true\ndirection_aware = true\n";

fn cell(more: &str) -> String {
    format!("{HEAD}{}start = [-1500]\n{more}{LAWS}{PROGRAM}", rail("a", 0.0))
}

fn run_at(dir: &Path, text: &str) -> RunOutcome {
    let cell = Cell::parse(dir.join("cell.toml"), text).unwrap_or_else(|e| panic!("{e}"));
    simulate(&cell, &RunOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// A folder with `poses.csv`, and a region that follows it.
fn poses(csv: &str, more: &str) -> (tempfile::TempDir, String) {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("poses.csv"), csv).unwrap();
    let region = format!(
        "[region.ride]\nshape = \"box\"\nbase = [0, 400, -200]\nsize = [200, 200, 400]\nwarning = 200\n\
         follow = {{ poses = \"poses.csv\"{more} }}\n"
    );
    (dir, cell(&region))
}

fn fault(outcome: &RunOutcome) -> bool {
    outcome.recording.events.iter().any(|e| e.event.name() == "fault")
}

/// Pose of the shape of the only region at a tick.
fn at(outcome: &RunOutcome, tick: usize) -> elbowroom_spatial::Pose {
    let RegionPoses::Moving(poses) = &outcome.recording.regions[0].poses else { panic!("it does not move") };
    poses[tick]
}

#[test]
fn a_region_follows_an_object_that_translates_and_rotates() {
    // A cart crosses the rail; its zone, 300 mm ahead of it, rotates with it.
    let object = "[object.cart]\nshape = \"box\"\nat = [0, -1700, 0]\nsize = [200, 200, 200]\n\
                  motion = { via = [[0, 3000, 0]], speed = 1000, turn = [0, 0, 90] }\n";
    let zone = "[region.ahead]\nshape = \"sphere\"\ncentre = [300, 0, 0]\nradius = 250\nwarning = 300\n\
                follow = { object = \"cart\" }\n";
    let outcome = run_at(Path::new("."), &cell(&format!("{object}{zone}")));
    // After 1 s: a quarter turn, 1 m of travel.
    let there = at(&outcome, 250).translation;
    assert!(there.distance(Vec3::new(0.0, -0.4, 0.0)) < 1e-9, "{there:?}");
    assert!(!fault(&outcome));
    let r = &outcome.recording;
    assert!(r.robots[0].finished, "it waits and continues");
    assert!(r.robots[0].min_override < 0.5, "it was slowed: {}", r.robots[0].min_override);
}

#[test]
fn a_region_follows_a_fixed_object() {
    let object = "[object.post]\nshape = \"box\"\nat = [600, 0, 0]\nrpy = [0, 0, 90]\nsize = [10, 10, 10]\n";
    let zone = "[region.near]\nshape = \"box\"\nbase = [0, 300, -200]\nsize = [100, 200, 400]\nwarning = 100\n\
                follow = { object = \"post\" }\n";
    let outcome = run_at(Path::new("."), &cell(&format!("{object}{zone}")));
    // A quarter turn moves the zone from y = 300 to x = 600 - 300.
    assert!(at(&outcome, 0).translation.distance(Vec3::new(0.3, 0.0, 0.0)) < 1e-9);
    let q = outcome.recording.robots[0].samples.last().unwrap().q[0];
    assert!(!outcome.recording.regions[0].entered && (0.1..0.15).contains(&q), "{q}");
}

#[test]
fn poses_from_a_file_move_and_turn_between_the_rows() {
    // Half a turn about z within 2 s, and 1 m along x; in the cell's units and in those of the header.
    for (header, rows) in [
        ("t_s,x,y,z,roll,pitch,yaw", "0,0,-3000,0,0,0,0\n2,1000,-3000,0,0,0,180\n"),
        ("t_s,x_m,y_m,z_m,yaw_rad,roll_rad,pitch_rad", "0,0,-3,0,0,0,0\n2,1,-3,0,3.14159265358979,0,0\n"),
        ("t_s,x_mm,y_mm,z_mm,qx,qy,qz,qw", "0,0,-3000,0,0,0,0,1\n2,1000,-3000,0,0,0,1,0\n"),
    ] {
        let (dir, text) = poses(&format!("{header}\n{rows}"), "");
        let outcome = run_at(dir.path(), &text);
        assert!(!fault(&outcome), "{header}");
        for (tick, angle) in [(0, 0.0), (125, PI / 4.0), (250, PI / 2.0), (600, PI)] {
            let t_s = tick as f64 * 0.004;
            let turned = Vec3::new(-f64::sin(angle), f64::cos(angle), 0.0) * 0.4;
            let expected = Vec3::new((t_s / 2.0).min(1.0), -3.0, 0.0) + turned;
            let is = at(&outcome, tick).translation;
            assert!(is.distance(expected) < 1e-9, "{header}, {t_s} s: {is:?}, not {expected:?}");
        }
    }
    // Without rotation, and constant before the first and after the last row.
    let (dir, text) = poses("t_s,x,y,z\n1,0,-3000,0\n2,1000,-3000,0\n", "");
    let outcome = run_at(dir.path(), &text);
    assert_eq!(at(&outcome, 100).translation.x, 0.0);
    assert_eq!(at(&outcome, 600).translation.x, 1.0);
}

#[test]
fn the_angular_velocity_of_poses_counts() {
    // A bar rotates about a point beside the rail: its end sweeps the rail at 1.5 m/s while its frame's origin is
    // fixed.
    let (dir, _) = poses("t_s,x,y,z,roll,pitch,yaw\n0,0,-900,0,0,0,-90\n4,0,-900,0,0,0,89\n", "");
    let bar = "[region.bar]\nshape = \"box\"\nbase = [0, 450, -50]\nsize = [60, 900, 100]\nfollow = { poses = \"poses.csv\" }\n";
    let cell = Cell::parse(dir.path().join("c.toml"), &cell(bar)).unwrap();
    let motion = cell.frame_sources.pose_tracks[0].motion(1.0);
    assert!((motion.angular_velocity.z - 179.0_f64.to_radians() / 4.0).abs() < 1e-9, "{motion:?}");
    let needed = elbowroom_sim::check::check(&cell).unwrap()[0].needed_warning_m.unwrap();
    // 1 m/s: 50 mm to brake, 4 mm of reaction; the bar's end, 0.9 m away, moves for (0.1 + 0.004) s meanwhile.
    let tip = motion.angular_velocity.z * f64::hypot(0.9, 0.03).hypot(0.05);
    // Plus the headway of the delay, and the reserve for sampling (docs/laws.md, section 2).
    let sum = 0.054 + 0.104 * tip;
    assert!((sum..1.003 * (sum + 2e-4)).contains(&needed), "{needed}, at least {sum}");
}

/// A box four metres from its axis of rotation approaches at 6 m/s, from far outside of the robot's reach.
#[test]
fn a_rotating_region_is_predicted_from_a_distance() {
    let text = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\ntick_ms = 2\n\
        [robot.a]\nbase = { at = [0, 0, 0], rpy = [0, 90, 0] }\n\
        dh = [{ kind = \"prismatic\", min = -9000, max = 9000, speed = 500, acceleration = 2000 }]\n\
        links = [[{ sphere = { at = [0, 0, 0], radius = 50 } }]]\nstop_time = 0.5\nstart = [-3000]\n\
        [object.t]\nshape = \"sphere\"\nradius = 10\nat = [0, -4000, 3000]\nmotion = { turn = [0, 0, 90] }\n\
        [region.w]\nshape = \"box\"\nbase = [4000, 0, -3500]\nsize = [500, 500, 1000]\nwarning = 10\n\
        follow = { object = \"t\" }\n\
        [monitor]\nstopping_distance = true\ndirection_aware = true\n\
        [program.a]\nsteps = [{ move = \"joint\", to = [3000] }]\n";
    let r = run_at(Path::new("."), text).recording;
    let reached = r.events.iter().filter(|e| e.event.name() == "inside_in");
    let samples = &r.robots[0].samples;
    let speeds: Vec<f64> = reached
        .map(|e| {
            let tick = (e.t_s / 0.002).round() as usize;
            (samples[tick].q[0] - samples[tick - 1].q[0]).abs() / 0.002
        })
        .collect();
    assert!(!speeds.is_empty() && speeds.iter().all(|v| *v < 0.01), "{speeds:?}");
}

#[test]
fn a_source_that_jumps_stops_the_robot() {
    // 3.9 m in 10 ms, onto the rail: the last plausible pose is kept.
    let csv = "t_s,x,y,z\n0,0,-3900,0\n1.0,0,-3900,0\n1.01,0,0,0\n3,0,0,0\n";
    let (dir, text) = poses(csv, "");
    let outcome = run_at(dir.path(), &text);
    let fault_at = outcome.recording.events.iter().find(|e| e.event.name() == "fault").expect("no fault");
    assert!((fault_at.t_s - 1.0).abs() < 0.01 && fault_at.region == "ride", "{fault_at:?}");
    let samples = &outcome.recording.robots[0].samples;
    let speed_override = |t_s: f64| samples[(t_s / 0.004).round() as usize].speed_override;
    assert_eq!((speed_override(0.9), speed_override(1.02), speed_override(1.2)), (1.0, 0.0, 0.0));
    // 3.9 m take 0.39 s at the plausible 10 m/s: then the reported pose is accepted.
    let events = &outcome.recording.events;
    let recovered = events.iter().find(|e| e.event.name() == "recovered");
    assert!(recovered.is_some_and(|e| (1.38..1.5).contains(&e.t_s)), "{events:?}");
    // The warning before the run has the line of the region.
    let cell = Cell::parse(dir.path().join("cell.toml"), &text).unwrap();
    let warning = cell.warnings.iter().find(|w| w.message.contains("takes that for a jump")).unwrap();
    assert!(warning.message.contains("390000 mm/s") && warning.hint.as_ref().unwrap().contains("max_speed"));
    // Accepted if the file permits the speed.
    let (dir, text) = poses(csv, ", max_speed = 400000");
    assert!(!fault(&run_at(dir.path(), &text)));
}

#[test]
fn an_encoder_that_jumps_stops_the_robot() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("belt.csv"), "t_s,travel_m\n0,0\n1.0,0\n1.01,3.9\n3,3.9\n").unwrap();
    let belt = "[encoder.belt]\ndirection = [0, 1, 0]\nfile = \"belt.csv\"\n\
                [region.ride]\nshape = \"box\"\nbase = [0, -3500, -200]\nsize = [200, 200, 400]\nwarning = 200\n\
                follow = { encoder = \"belt\" }\n";
    let outcome = run_at(dir.path(), &cell(belt));
    assert!(outcome.recording.events.iter().any(|e| e.event.name() == "fault" && e.region == "ride"));
    let cell = Cell::parse(dir.path().join("cell.toml"), &cell(belt)).unwrap();
    assert!(
        cell.warnings.iter().any(|w| w.message.contains("encoder \"belt\" moves at 390000 mm/s")),
        "{:?}",
        cell.warnings
    );
}

#[test]
fn the_limit_of_a_source_can_be_reduced() {
    let belt = |more: &str| {
        cell(&format!(
            "[encoder.belt]\ndirection = [0, 1, 0]\nspeed = 500\nwrap = 1000\n\
             [region.ride]\nshape = \"sphere\"\ncentre = [0, -3000, 0]\nradius = 100\nwarning = 100\n\
             follow = {{ encoder = \"belt\"{more} }}\n"
        ))
    };
    // The wrap of a belt is not a jump.
    let outcome = run_at(Path::new("."), &belt(""));
    assert!(!fault(&outcome) && outcome.recording.duration_s > 2.5);
    assert!(fault(&run_at(Path::new("."), &belt(", max_speed = 400"))));
}

#[test]
fn a_source_on_a_robot_may_be_as_fast_as_its_joints() {
    let fast = rail("b", 2000.0).replace("speed = 1000", "speed = 12000").replace("4000", "60000");
    let zone = "[region.hand]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 100\nwarning = 50\nfollow = { robot = \"b\" }\n";
    let program = "[program.b]\nsteps = [{ move = \"joint\", to = [1500] }]\n";
    let outcome = run_at(Path::new("."), &cell(&format!("{fast}{program}{zone}")));
    assert!(outcome.recording.robots[1].finished && !fault(&outcome));
}

#[test]
fn errors_are_reported() {
    let refused = |csv: &str, more: &str, words: &[&str]| {
        let (dir, text) = poses(csv, more);
        let e = Cell::parse(dir.path().join("cell.toml"), &text).err().unwrap_or_else(|| panic!("accepted: {csv}"));
        for w in words {
            assert!(e.to_string().contains(w), "`{w}` is missing in: {e}");
        }
    };
    let rows = "t_s,x,y,z\n0,0,0,0\n";
    refused(rows, ", encoder = \"belt\"", &["contradicts `encoder`", "follow = { robot"]);
    refused(rows, ", frame = \"flange\"", &["belongs to `robot`"]);
    refused(rows, ", max_speed = 0", &["max_speed", "above 0"]);
    refused("t_s,x,y\n0,0,0\n", "", &["poses.csv:1", "needs the columns x, y, z"]);
    refused("t_s,x,y_m,z\n0,0,0,0\n", "", &["poses.csv:1", "all in one unit"]);
    refused("t_s,x,y,z,w\n0,0,0,0,0\n", "", &["poses.csv:1", "column `w`"]);
    refused("t_s,x,y,z,roll,pitch\n0,0,0,0,0,0\n", "", &["roll, pitch, yaw"]);
    refused("t_s,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,0\n", "", &["poses.csv:2", "quaternion"]);
    refused("t_s,x,y,z\n0,0,0,0\n0,1,0,0\n", "", &["poses.csv:3", "t_s is 0 after 0"]);
    refused("t_s,x,y,z\n", "", &["no rows"]);
    refused("t_s,x,y,z\n0,0,nan,0\n", "", &["poses.csv:2", "not a finite number"]);
    let zone = "[region.z]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 10\nwarning = 10\nfollow = { object = \"crat\" }\n\
                [object.cart]\nshape = \"sphere\"\nradius = 10\n";
    let e = Cell::parse("c.toml", &cell(zone)).unwrap_err().to_string();
    assert!(e.contains("names the object \"crat\"") && e.contains("cart"), "{e}");
}

#[test]
fn disabled_watchdogs_and_unbounded_zones_are_refused() {
    let zone = |warning: &str, more: &str| {
        format!("[region.z]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 10\nwarning = {warning}\n{more}")
    };
    let parse = |text: &str| Cell::parse("c.toml", text);
    let stale = |ms: &str| cell(&zone("10", "")).replace("[monitor]\n", &format!("[monitor]\nstale_ms = {ms}\n"));
    let e = parse(&stale("1e12")).unwrap_err().to_string();
    assert!(e.contains("`monitor.stale_ms` is 1000000000000 ms") && e.contains("at most 1000"), "{e}");
    assert!(parse(&stale("1001")).is_err() && parse(&stale("100")).unwrap().warnings.is_empty());
    assert!(parse(&stale("101")).unwrap().warnings[0].message.contains("moves 101 mm"));
    let e = parse(&cell(&zone("1e9", ""))).unwrap_err().to_string();
    assert!(e.contains("`region.z.warning` is 1000000000 mm") && e.contains("up to 10000 mm"), "{e}");
    assert!(parse(&cell(&zone("10001", ""))).unwrap().warnings[0].message.contains("more than any robot needs"));
    assert!(parse(&cell(&zone("10000", ""))).unwrap().warnings.is_empty());
    let e = parse(&cell(&zone("10", "hysteresis = 1e9\n"))).unwrap_err().to_string();
    assert!(e.contains("hysteresis"), "{e}");
}

/// The first tick in which the ball of a slide moves and touches a ball that is the only region; `reach_m` is the sum
/// of both radii (m).
///
/// The region may reach a robot that is stopped: only the first instant of a contact counts.
fn moves_into(outcome: &RunOutcome, place: impl Fn(f64) -> Vec3, reach_m: f64) -> Option<usize> {
    let samples = &outcome.recording.robots[0].samples;
    let touches = |tick: usize| at(outcome, tick).translation.distance(place(samples[tick].q[0])) <= reach_m;
    let entered = |tick: &usize| touches(*tick) && !touches(tick - 1);
    (1..samples.len()).filter(entered).find(|tick| samples[*tick].q[0] != samples[tick - 1].q[0])
}

/// A ball on a turntable crosses the rail; the carriage needs a second to stop.
#[test]
fn a_robot_never_moves_into_a_region_that_turns_at_a_constant_rate() {
    let (orbit, turn) = (1200.0_f64, 85.0);
    let mut hits_without = 0;
    for phase in 0..12 {
        let (sin, cos) = (PI / 6.0 * f64::from(phase)).sin_cos();
        let text = format!(
            "{HEAD}max_s = 5\n{}start = [-1500]\nstop_time = 1.0\n\
             [object.turntable]\nshape = \"sphere\"\nradius = 10\nat = [0, -900, -1000]\nmotion = {{ turn = [0, 0, {turn}] }}\n\
             [region.orb]\nshape = \"sphere\"\ncentre = [{}, {}, 1000]\nradius = 100\nwarning = 300\n\
             follow = {{ object = \"turntable\" }}\n{LAWS}{PROGRAM}",
            rail("a", 0.0),
            orbit * cos,
            orbit * sin,
        );
        let moves_inside = |outcome: &RunOutcome| moves_into(outcome, |q| Vec3::new(q, 0.0, 0.0), 0.15);
        assert_eq!(moves_inside(&run_at(Path::new("."), &text)), None, "phase {phase}");
        let cell = Cell::parse("cell.toml", &text).unwrap();
        let free = simulate(&cell, &RunOptions { apply_override: false, ..RunOptions::default() }).unwrap();
        hits_without += usize::from(moves_inside(&free).is_some());
    }
    assert!(hits_without > 3, "only {hits_without} of 12 would enter");
}

/// A ball on the hand of an arm crosses a rail.
///
/// With a second joint, which turns back what the first one turns, the ball circles without turning itself.
#[test]
fn a_robot_never_moves_into_a_region_on_a_hand_that_circles_at_a_constant_rate() {
    for second in [false, true] {
        let mut hits_without = 0;
        for phase in 0..14 {
            let rate = "speed = 1.8, acceleration = 20";
            let (joint, link, back) =
                if second { (format!(", {{ {rate} }}"), ", []", ", -6.3") } else { (String::new(), "", "") };
            let text = format!(
                "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\ntick_ms = 4\nmax_s = 5\n\
                 [robot.a]\nbase = {{ at = [-0.1, 0, 0], rpy = [-1.5707963267948966, 0, 0] }}\n\
                 dh = [{{ kind = \"prismatic\", min = -5, max = 5, speed = 1.7, acceleration = 6.8 }}]\n\
                 links = [{{ sphere = {{ radius = 0.05 }} }}]\nstop_time = 0.8\nstart = [{}]\n\
                 [robot.b]\ndh = [{{ a = 0.7, {rate} }}{joint}]\nlinks = [{{ sphere = {{ radius = 0.02 }} }}{link}]\n\
                 [region.hand]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 0.1\nwarning = 0.1\nrobots = [\"a\"]\n\
                 follow = {{ robot = \"b\", frame = \"flange\" }}\n{LAWS}\
                 [program.a]\nsteps = [{{ move = \"joint\", to = [-4.5] }}]\n\
                 [program.b]\nsteps = [{{ move = \"joint\", to = [6.3{back}] }}]\n",
                2.0 + 0.2 * f64::from(phase),
            );
            let moves_inside = |outcome: &RunOutcome| moves_into(outcome, |q| Vec3::new(-0.1, q, 0.0), 0.15);
            assert_eq!(moves_inside(&run_at(Path::new("."), &text)), None, "second {second}, phase {phase}");
            let cell = Cell::parse("cell.toml", &text).unwrap();
            let free = simulate(&cell, &RunOptions { apply_override: false, ..RunOptions::default() }).unwrap();
            hits_without += usize::from(moves_inside(&free).is_some());
        }
        assert!(hits_without > 3, "only {hits_without} of 14 would enter");
    }
}

/// A plate turns about an object, passes a stopped carriage, disappears for some ticks and returns.
///
/// The carriage obeys 44 ms late: it must not have started to leave.
#[test]
fn a_robot_does_not_move_while_a_region_passes_over_it() {
    let text = "version = 1\nunits = { length = \"m\", angle = \"rad\" }\ntick_ms = 2\nmax_s = 5\n\
                [monitor]\nstopping_distance = true\nreaction_ms = 44\ndirection_aware = true\n\
                [robot.a]\nbase = { at = [0, 0, 0], rpy = [0, 1.5707963267948966, 2.5713] }\n\
                dh = [{ kind = \"prismatic\", min = -7, max = 7, speed = 1.5175, acceleration = 7.668 }]\nlinks = [[]]\n\
                start = [-1.3179]\nstop_time = 1.1288\n\
                [object.hub]\nshape = \"sphere\"\nradius = 0.01\nat = [-0.2415, 0.0214, -0.0656]\n\
                rpy = [-2.5355, -0.4067, 1.4461]\nmotion = { turn = [-2.4928, 3.0122, -0.3624] }\n\
                [region.plate]\nshape = \"box\"\nbase = [-0.1492, 0.15, 0.0036]\nrpy = [-0.3186, 2.1615, 1.7732]\n\
                size = [0.0084, 0.5944, 0.8225]\nwarning = 0.1527\nguards = [\"tcp\"]\nfollow = { object = \"hub\" }\n\
                [program.a]\nsteps = [{ move = \"joint\", to = [1.3179], speed = 100 }]\n";
    let outcome = run_at(Path::new("."), text);
    let samples = &outcome.recording.robots[0].samples;
    let (sin, cos) = 2.5713_f64.sin_cos();
    let is_inside = |tick: usize| {
        let tcp = Vec3::new(cos, sin, 0.0) * samples[tick].q[0];
        let from_middle = at(&outcome, tick).inverse_transform_point(tcp).abs();
        let half = Vec3::new(0.0084, 0.5944, 0.8225) * 0.5;
        (half - from_middle).min_element() >= 0.0
    };
    let moves = |tick: usize| samples[tick].q[0] != samples[tick - 1].q[0];
    let inside = (1..samples.len()).filter(|tick| is_inside(*tick)).count();
    assert!(inside > 10, "the plate passes: {inside} ticks");
    let driven = (1..samples.len()).find(|tick| is_inside(*tick) && !is_inside(tick - 1) && moves(*tick));
    assert_eq!(driven, None, "entered at {} s", driven.unwrap_or(0) as f64 * 0.002);
}

/// Each robot is inside a region that the other robot carries: both leave, in turns.
#[test]
fn two_robots_that_are_each_in_the_region_of_the_other_get_out() {
    let zone = |of: &str, other: &str| {
        format!(
            "[region.of_{of}]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 500\nwarning = 100\nrobots = [\"{other}\"]\n\
             follow = {{ robot = \"{of}\", frame = \"flange\" }}\n"
        )
    };
    let text = format!(
        "{HEAD}max_s = 300\n{}start = [0]\n{}start = [0]\n{}{}{LAWS}recovery = 10\n\
         [program.a]\nsteps = [{{ move = \"joint\", to = [1500] }}]\n[program.b]\nsteps = [{{ move = \"joint\", to = [-1500] }}]\n",
        rail("a", 0.0),
        rail("b", 400.0),
        zone("a", "b"),
        zone("b", "a"),
    );
    let outcome = run_at(Path::new("."), &text);
    let ends: Vec<f64> = outcome.recording.robots.iter().map(|robot| robot.samples.last().unwrap().q[0]).collect();
    assert!(outcome.recording.robots.iter().all(|robot| robot.finished), "{ends:?}");
}
