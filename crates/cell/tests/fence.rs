//! Regions and planned ways: a robot that was driven off its path comes back around a region, not up to its border.

mod common;

use common::{HEAD, parse, run};
use elbowroom_avoidance::Doing;
use elbowroom_cell::RunOutcome;
use elbowroom_cell::plan::{PathRequest, plan};
use elbowroom_planner::RouteOptions;

/// Two slides in the plane of world x and y that carry a ball; the second runs against y.
const GANTRY: &str = r#"
[robot.gantry]
base = { at = [0, 0, 0], rpy = [0, 90, 0] }
dh = [
  { kind = "prismatic", alpha = 90, min = -2000, max = 2000, speed = 1000, acceleration = 4000 },
  { kind = "prismatic", min = -2000, max = 2000, speed = 1000, acceleration = 4000 },
]
links = [[], { sphere = { radius = 50 } }]
start = [-1400, 0]
"#;

/// Beside the path along y = 0, from 30 mm off the ball upwards.
const WALL: &str = r#"
[region.wall]
shape = "box"
from = [500, 80, -200]
to = [520, 1500, 200]
warning = 20
"#;

/// Wide as it is, it drives whoever is on the path to y of 300 mm, and goes away again.
const PUSHER: &str = r#"
[object.pusher]
shape = "box"
at = [-800, -900, 0]
size = [3000, 400, 400]
motion = { via = [[-800, 50, 0], [-800, -1400, 0]], speed = 400, start = 0.2 }
[avoidance.gantry]
objects = ["pusher"]
[program.gantry]
steps = [{ move = "joint", to = [1000, 0], speed = 15 }]
"#;

fn furthest_off(outcome: &RunOutcome) -> f64 {
    outcome.recording.robots[0].samples.iter().map(|s| s.q[1].abs()).fold(0.0, f64::max)
}

#[test]
fn the_way_back_leads_around_a_region() {
    // Nobody stands in the way of the program itself.
    let (begin, end) = (PUSHER.find("[avoidance").unwrap(), PUSHER.find("[program").unwrap());
    let program = &PUSHER[end..];
    let alone = run(&format!("{HEAD}{GANTRY}{WALL}{program}"));
    assert!(alone.recording.robots[0].finished && alone.recording.robots[0].min_override == 1.0);

    let outcome = run(&format!("{HEAD}{GANTRY}{WALL}{PUSHER}"));
    let (robot, wall) = (&outcome.recording.robots[0], &outcome.recording.regions[0]);
    // It was driven off, so far that the straight way to the end leads through the wall.
    assert!(furthest_off(&outcome) > 0.2 && begin > 0, "{}", furthest_off(&outcome));
    let track = robot.avoidance.as_ref().unwrap();
    assert!(track.samples.iter().any(|s| s.doing == Doing::Rounding) && track.plans.iter().any(|p| p.1.is_some()));
    assert!(!outcome.bad_news() && !wall.entered, "{:?}", robot.collisions);
    assert!(robot.finished, "it stands at {:?}", robot.samples.last().unwrap().q);
    let end = &robot.samples.last().unwrap().q;
    assert!((end[0] - 1.0).abs() < 1e-6 && end[1].abs() < 1e-6, "{end:?}");
}

#[test]
fn who_was_driven_up_to_a_border_gets_off_it_again() {
    // The pusher comes while the ball is so near to the wall that it flees up to it.
    let start = GANTRY.replace("[-1400, 0]", "[-200, 0]");
    let pusher = PUSHER.replace("[3000,", "[1900,").replace("-800,", "-500,").replace(" 50,", " -160,");
    let outcome = run(&format!("{HEAD}{start}{WALL}{pusher}"));
    let (robot, wall) = (&outcome.recording.robots[0], &outcome.recording.regions[0]);
    let stood = robot.samples.iter().find(|s| s.speed_override < 1e-3).expect("it comes to the border");
    assert!(stood.q[1].abs() > 0.1, "off the path: {:?}", stood.q);
    assert!(robot.finished, "it stands at {:?}", robot.samples.last().unwrap().q);
    assert!(!outcome.bad_news() && !wall.entered, "{:?}", robot.collisions);
}

fn request(from: [f64; 2], to: [f64; 2]) -> PathRequest {
    PathRequest { from: Some(from.to_vec()), to: to.to_vec(), ..PathRequest::default() }
}

/// How near the ball comes to the wall, m, at many points of the rows.
fn nearest(rows: &[(f64, Vec<f64>)]) -> f64 {
    let distance = |x: f64, y: f64| {
        let off = |v: f64, low: f64, high: f64| (low - v).max(v - high).max(0.0);
        off(x, 0.5, 0.52).hypot(off(y, 0.08, 1.5)) - 0.05
    };
    let between = |w: &[(f64, Vec<f64>)], t: f64| {
        let at = |i: usize| w[0].1[i] + (w[1].1[i] - w[0].1[i]) * t;
        distance(at(0), -at(1))
    };
    let points = rows.windows(2).flat_map(|w| (0..=4).map(move |n| between(w, f64::from(n) / 4.0)));
    points.fold(f64::INFINITY, f64::min)
}

#[test]
fn paths_lead_around_permanent_forbidden_regions_and_through_others() {
    let go = request([0.2, -0.4], [0.9, -0.4]);
    let asked = |region: &str| plan(&parse(&format!("{HEAD}{GANTRY}{region}")), &go).unwrap();
    let answer = asked(WALL);
    let motion = answer.motion.unwrap();
    assert!(motion.waypoints.len() > 2 && answer.regions == ["wall"]);
    let room = nearest(&motion.rows);
    assert!(room > 0.005 && room < 0.03, "{room}");
    // A clearance holds for regions, too.
    let wide = RouteOptions { clearance_m: 0.1, ..RouteOptions::default() };
    let cell = parse(&format!("{HEAD}{GANTRY}{WALL}"));
    let wide = plan(&cell, &PathRequest { options: wide, ..go.clone() }).unwrap().motion.unwrap();
    assert!(nearest(&wide.rows) > 0.1);
    // Those that are switched by programs are not active yet; those that only report forbid nothing.
    for line in ["life = \"temporary\"", "kind = \"monitored\""] {
        let answer = asked(&format!("{WALL}{line}\n"));
        assert!(answer.motion.unwrap().waypoints.len() == 2 && answer.regions.is_empty(), "{line}");
    }
}

#[test]
fn regions_stand_where_the_robots_they_follow_stand() {
    let carrier = |start: f64| {
        format!(
            "[robot.carrier]\nbase = {{ at = [0, 0, 900], rpy = [0, 90, 0] }}\n\
             dh = [{{ kind = \"prismatic\", min = -2000, max = 2000, speed = 500 }}]\nstart = [{start}]\n"
        )
    };
    let rides = "[region.rides]\nshape = \"sphere\"\ncentre = [900, 0, 0]\nradius = 100\nwarning = 50\n\
                 robots = [\"gantry\"]\nfollow = { robot = \"carrier\" }\n";
    let go = PathRequest { robot: Some("gantry".into()), ..request([0.0, 0.0], [1.0, 0.0]) };
    for (start, around) in [(500.0, true), (-1500.0, false)] {
        let cell = parse(&format!("{HEAD}{GANTRY}{}{rides}", carrier(start)));
        let motion = plan(&cell, &go).unwrap().motion.unwrap();
        assert_eq!(motion.waypoints.len() > 2, around, "{start}");
    }
}

#[test]
fn a_goal_inside_is_refused_with_the_regions_name_and_a_start_inside_is_left() {
    let cell = parse(&format!("{HEAD}{GANTRY}{WALL}"));
    let error = plan(&cell, &request([0.2, -0.4], [0.51, -0.4])).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("region `wall`") && text.contains("goal") && error.write_instead.is_some(), "{text}");
    let answer = plan(&cell, &request([0.46, -0.4], [0.9, -0.4])).unwrap();
    let motion = answer.motion.unwrap();
    assert!(motion.waypoints.len() > 2 && motion.rows[0].1 == [0.46, -0.4]);
}
