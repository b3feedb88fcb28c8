//! Regions as path constraints in a run: after an evasion, a robot returns to its path around a region, not up to its
//! border.

use crate::common::{GANTRY, HEAD, WALL, run};
use elbowroom_avoidance::AvoiderState;
use elbowroom_sim::RunOutcome;

/// A wide box that crosses the path: the robot must evade to y = 300 mm. Then the box moves away.
const OBSTACLE: &str = r#"
[object.cart]
shape = "box"
at = [-800, -900, 0]
size = [3000, 400, 400]
motion = { via = [[-800, 50, 0], [-800, -1400, 0]], speed = 400, start = 0.2 }
[avoidance.gantry]
objects = ["cart"]
[program.gantry]
steps = [{ move = "joint", to = [1000, 0], speed = 15 }]
"#;

fn max_path_deviation_m(outcome: &RunOutcome) -> f64 {
    outcome.recording.robots[0].samples.iter().map(|s| s.q[1].abs()).fold(0.0, f64::max)
}

#[test]
fn the_return_path_leads_around_a_region() {
    // Without the obstacle the program runs unhindered.
    let program = &OBSTACLE[OBSTACLE.find("[program").unwrap()..];
    let alone = run(&format!("{HEAD}{GANTRY}{WALL}{program}"));
    assert!(alone.recording.robots[0].finished && alone.recording.robots[0].min_override == 1.0);

    let outcome = run(&format!("{HEAD}{GANTRY}{WALL}{OBSTACLE}"));
    let (robot, wall) = (&outcome.recording.robots[0], &outcome.recording.regions[0]);
    // It evaded so far that the straight path to the goal leads through the wall.
    assert!(max_path_deviation_m(&outcome) > 0.2, "{}", max_path_deviation_m(&outcome));
    let track = robot.avoidance.as_ref().unwrap();
    assert!(
        track.samples.iter().any(|s| s.state == AvoiderState::Detouring)
            && track.plans.iter().any(|p| p.search_s.is_some())
    );
    assert!(!outcome.has_violation() && !wall.entered, "{:?}", robot.collisions);
    assert!(robot.finished, "it stopped at {:?}", robot.samples.last().unwrap().q);
    let end = &robot.samples.last().unwrap().q;
    assert!((end[0] - 1.0).abs() < 1e-6 && end[1].abs() < 1e-6, "{end:?}");
}

#[test]
fn a_path_is_followed_after_the_time_that_its_plan_takes() {
    let first = |plan_ms: u32| {
        let obstacle =
            OBSTACLE.replacen("[avoidance.gantry]\n", &format!("[avoidance.gantry]\nplan_ms = {plan_ms}\n"), 1);
        assert_ne!(obstacle, OBSTACLE);
        let outcome = run(&format!("{HEAD}{GANTRY}{WALL}{obstacle}"));
        let robot = &outcome.recording.robots[0];
        let track = robot.avoidance.as_ref().unwrap();
        let planned_s = track.plans.iter().find(|p| p.search_s.is_some()).unwrap().t_s;
        let detours = track.samples.iter().map(|s| s.state == AvoiderState::Detouring);
        let followed = robot.samples.iter().zip(detours).find(|(_, detours)| *detours).unwrap().0.t_s;
        assert!(robot.finished && !outcome.has_violation(), "{:?}", robot.collisions);
        (planned_s, followed)
    };
    let (at_once, later) = (first(0), first(300));
    assert!(at_once.1 - at_once.0 < 0.02, "{at_once:?}");
    assert!((later.1 - later.0 - 0.3).abs() < 0.02 && later.0 == at_once.0, "{later:?}");
}

#[test]
fn a_robot_that_evades_towards_a_border_is_not_stopped_at_it() {
    // The cart crosses while the robot is so close to the wall that it would evade up to its border.
    let start = GANTRY.replace("[-1400, 0]", "[-200, 0]");
    let cart = OBSTACLE.replace("[3000,", "[1900,").replace("-800,", "-500,").replace(" 50,", " -160,");
    let outcome = run(&format!("{HEAD}{start}{WALL}{cart}"));
    let (robot, wall) = (&outcome.recording.robots[0], &outcome.recording.regions[0]);
    assert!(max_path_deviation_m(&outcome) > 0.1, "{}", max_path_deviation_m(&outcome));
    let stopped = robot.samples.iter().find(|s| s.speed_override < 1e-3);
    assert!(stopped.is_none(), "stopped at {:?}", stopped.map(|s| &s.q));
    assert!(robot.finished, "it stopped at {:?}", robot.samples.last().unwrap().q);
    assert!(!outcome.has_violation() && !wall.entered, "{:?}", robot.collisions);
}
