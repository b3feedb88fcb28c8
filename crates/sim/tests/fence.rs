//! Regions and planned ways: a robot that was driven off its path comes back around a region, not up to its border.

mod common;

use common::{GANTRY, HEAD, WALL, run};
use elbowroom_avoidance::AvoiderState;
use elbowroom_sim::RunOutcome;

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
    assert!(
        track.samples.iter().any(|s| s.state == AvoiderState::Detouring)
            && track.plans.iter().any(|p| p.search_s.is_some())
    );
    assert!(!outcome.has_violation() && !wall.entered, "{:?}", robot.collisions);
    assert!(robot.finished, "it stands at {:?}", robot.samples.last().unwrap().q);
    let end = &robot.samples.last().unwrap().q;
    assert!((end[0] - 1.0).abs() < 1e-6 && end[1].abs() < 1e-6, "{end:?}");
}

#[test]
fn who_was_driven_up_to_a_border_gets_off_it_again() {
    // The pusher comes while the ball is so near to the wall that it evades up to it.
    let start = GANTRY.replace("[-1400, 0]", "[-200, 0]");
    let pusher = PUSHER.replace("[3000,", "[1900,").replace("-800,", "-500,").replace(" 50,", " -160,");
    let outcome = run(&format!("{HEAD}{start}{WALL}{pusher}"));
    let (robot, wall) = (&outcome.recording.robots[0], &outcome.recording.regions[0]);
    let stood = robot.samples.iter().find(|s| s.speed_override < 1e-3).expect("it comes to the border");
    assert!(stood.q[1].abs() > 0.1, "off the path: {:?}", stood.q);
    assert!(robot.finished, "it stands at {:?}", robot.samples.last().unwrap().q);
    assert!(!outcome.has_violation() && !wall.entered, "{:?}", robot.collisions);
}
