//! Regions that a robot passes through between two ticks count as entered, are reported, and pulse their outputs.

use crate::common::{HEAD, parse, run, run_free};
use elbowroom_sim::{Recording, RunOptions, simulate};

/// A carriage that crosses x = 0 at `speed` (mm/s) with a ball of 20 mm.
fn carriage(speed: u32) -> String {
    format!(
        "[robot.a]\nbase = {{ at = [0, 0, 0], rpy = [0, 90, 0] }}\nstart = [-2500]\n\
         dh = [{{ kind = \"prismatic\", min = -5000, max = 5000, speed = {speed}, acceleration = 8000 }}]\n\
         links = [[{{ sphere = {{ radius = 20 }} }}]]\n\
         [program.a]\nsteps = [{{ move = \"joint\", to = [2500] }}]\n"
    )
}

/// A plate across the path.
fn plate(thickness_mm: f64, more: &str) -> String {
    format!("[region.plate]\nshape = \"box\"\nbase = [0.5, 0, -500]\nsize = [{thickness_mm}, 2000, 1000]\n{more}\n")
}

fn events(r: &Recording, region: &str) -> Vec<(&'static str, f64)> {
    r.events.iter().filter(|e| e.region == region).map(|e| (e.event.name(), e.t_s)).collect()
}

#[test]
fn a_thin_plate_passed_between_ticks_is_entered() {
    // 16 mm per tick.
    let text = format!("{HEAD}{}{}", carriage(4000), plate(4.0, "guards = [\"tcp\"]"));
    let outcome = run_free(&text);
    let r = &outcome.recording;
    let jumped = |x: &f64| (x - 0.5).abs() > 2.0;
    assert!(
        r.robots[0].samples.iter().all(|s| jumped(&(s.tcp.x * 1000.0))),
        "a tick is inside the plate: the test is void"
    );
    assert!(outcome.has_violation() && r.regions[0].entered);
    assert_eq!(r.regions[0].min_distance_m, Some(0.0));
    let [stay] = r.regions[0].inside_spans.as_slice() else { panic!("{:?}", r.regions[0].inside_spans) };
    assert!((stay.to_s - stay.from_s - r.tick_s).abs() < 1e-9);
    let there = |t_s: f64| r.robots[0].samples.iter().find(|s| (s.t_s - t_s).abs() < 1e-9).unwrap().tcp.x;
    assert!(there(stay.from_s) < 0.0 && there(stay.to_s) > 0.0);
}

#[test]
fn passing_raises_events_and_outputs_for_one_tick() {
    let more = "kind = \"monitored\"\nguards = [\"tcp\"]\nwarning = 2\noutput = 3\nwarning_output = 5";
    let outcome = run(&format!("{HEAD}{}{}", carriage(4000), plate(4.0, more)));
    let found = events(&outcome.recording, "plate");
    let names: Vec<&str> = found.iter().map(|e| e.0).collect();
    assert_eq!(
        names,
        ["warn_in", "inside_in", "output_on", "output_on", "inside_out", "warn_out", "output_off", "output_off"]
    );
    assert!((found[4].1 - found[0].1 - outcome.recording.tick_s).abs() < 1e-9, "{found:?}");
    assert!(!outcome.has_violation(), "a monitored region is no violation");
}

#[test]
fn a_warning_zone_passed_between_ticks_is_reported() {
    // Beside the path: the ball comes within 1 mm, the zone is 3 mm thick, at y = 21 .. mm.
    let more = "[region.peg]\nshape = \"sphere\"\ncentre = [0, 26, 0]\nradius = 5\nkind = \"monitored\"\nwarning = 3\n";
    let outcome = run(&format!("{HEAD}{}{more}", carriage(4000)));
    let found: Vec<&str> = events(&outcome.recording, "peg").iter().map(|e| e.0).collect();
    assert_eq!(found, ["warn_in", "warn_out"]);
    let peg = &outcome.recording.regions[0];
    assert!(!peg.entered && peg.warned_s > 0.0 && peg.warning_spans.len() == 1);
    assert!(peg.min_distance_m.is_some_and(|d| d > 0.0 && d < 0.003), "{:?}", peg.min_distance_m);
}

#[test]
fn a_region_that_is_only_passed_is_not_entered() {
    // The ball's surface passes at 0.1 mm.
    for y in [25.1, -25.1] {
        let more =
            format!("[region.peg]\nshape = \"sphere\"\ncentre = [0, {y}, 0]\nradius = 5\nkind = \"monitored\"\n");
        let outcome = run(&format!("{HEAD}{}{more}", carriage(1000)));
        assert_eq!(events(&outcome.recording, "peg"), []);
        assert!(!outcome.recording.regions[0].entered);
    }
}

#[test]
fn a_region_that_passes_a_stationary_robot_is_reported() {
    // 4 m/s past the TCP: 16 mm per tick, 2 mm thick.
    let text = format!(
        "{HEAD}[robot.a]\ndh = [{{ kind = \"prismatic\", min = 0, max = 1000, speed = 1000 }}]\n\
         links = [[{{ sphere = {{ radius = 20 }} }}]]\n[program.a]\nsteps = [{{ wait = 1 }}]\n\
         [encoder.belt]\nspeed = 4000\nat = -2007\n\
         [region.blade]\nshape = \"box\"\nbase = [0, 0, -500]\nsize = [2, 1000, 1000]\nkind = \"monitored\"\n\
         guards = [\"tcp\"]\nfollow = {{ encoder = \"belt\" }}\n"
    );
    let outcome = run(&text);
    let found: Vec<&str> = events(&outcome.recording, "blade").iter().map(|e| e.0).collect();
    assert_eq!(found, ["warn_in", "inside_in", "inside_out", "warn_out"]);
    assert_eq!(outcome.recording.regions[0].inside_spans.len(), 1);
}

#[test]
fn a_belt_that_restarts_passes_no_robot() {
    let text = format!(
        "{HEAD}[robot.a]\ndh = [{{ kind = \"prismatic\", min = 0, max = 1000, speed = 1000 }}]\n\
         links = [[{{ sphere = {{ radius = 20 }} }}]]\n[program.a]\nsteps = [{{ wait = 3 }}]\n\
         [encoder.belt]\nspeed = 500\nwrap = 600\nat = 0\n\
         [region.blade]\nshape = \"box\"\nbase = [-700, 0, -500]\nsize = [2, 1000, 1000]\nkind = \"monitored\"\n\
         guards = [\"tcp\"]\nfollow = {{ encoder = \"belt\" }}\n[encoder.back]\nspeed = 1\n"
    );
    // The region moves from x = -700 to -100 and jumps back. It never passes a TCP at 0, and passes one at -300 only
    // while it moves forward, not when it jumps back.
    assert_eq!(events(&run(&text).recording, "blade"), []);
    let shifted = text.replace("[robot.a]\n", "[robot.a]\nbase = { at = [-300, 0, 0], rpy = [0, 0, 0] }\n");
    let found = events(&run(&shifted).recording, "blade");
    let times = found.iter().filter(|e| e.0 == "inside_in").count();
    // It passes at 0.8 s and then every 1.2 s: twice in 3 s.
    assert_eq!(times, 2, "{found:?}");
}

#[test]
fn a_region_switched_on_behind_a_robot_was_not_passed() {
    let text = format!(
        "{HEAD}{}{}",
        carriage(4000)
            .replace("steps = [", "steps = [{ move = \"joint\", to = [4] }, { region = \"plate\", active = true }, "),
        plate(4.0, "guards = [\"tcp\"]\nlife = \"temporary\"")
    );
    let outcome = run(&text);
    assert!(!outcome.has_violation());
    assert!(events(&outcome.recording, "plate").iter().all(|e| e.0 == "on"), "{:?}", outcome.recording.events);
}

#[test]
fn faults_of_the_input_do_not_change_the_recorded_positions() {
    use elbowroom_robot::RobotId;
    use elbowroom_sim::{InputFault, InputFaultKind};
    let cell = parse(&format!("{HEAD}{}{}", carriage(1000), plate(200.0, "warning = 300")));
    let jump = InputFault { robot: RobotId(0), from_s: 0.0, to_s: f64::INFINITY, kind: InputFaultKind::Frozen };
    let options = RunOptions { faults: vec![jump], ..RunOptions::default() };
    let outcome = simulate(&cell, &options).unwrap();
    let r = &outcome.recording;
    let farthest = r.robots[0].samples.iter().map(|s| s.tcp.x).fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(r.regions[0].entered, farthest > -0.12, "{farthest}");
}
