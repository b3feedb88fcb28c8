//! Regions that robots exchange: never two inside, in whole cells.

mod common;

use common::run;
use elbowroom_cell::RunOutcome;

/// Two carriages go opposite ways; each carries two balls that reach the regions A and B in opposite order.
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

/// Instants at which two robots are inside one region, by the recorded joint values alone: a ball is inside where its
/// centre is within its radius of the box, along x.
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
fn a_robot_that_cannot_stop_outside_does_not_give_its_grant_back() {
    for start_b in [2500.0, 2495.0, 2460.0, 2400.0, 2200.0] {
        let outcome = run(&opposite("stopping_distance = true", start_b));
        let together = both_inside(&outcome, [[0.0, -0.45], [0.45, 0.0]]);
        assert_eq!(together, 0, "b starts at {start_b}: both inside in {together} ticks");
        let regions = &outcome.recording.regions;
        assert!(regions.iter().all(|r| !r.entered), "b starts at {start_b}: somebody entered without the grant");
        assert!(
            outcome.recording.robots.iter().all(|r| r.finished),
            "b starts at {start_b}: somebody was left waiting"
        );
    }
}
