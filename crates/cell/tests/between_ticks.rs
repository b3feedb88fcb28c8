//! Regions that a robot passes from one tick to the next: entered, said so, and the outputs pulse.

mod common;

use common::{HEAD, parse, run, run_free};
use elbowroom_cell::{Recording, RunOptions, simulate};

/// A carriage that crosses x = 0 at `speed` (mm/s) with a ball of 20 mm.
fn carriage(speed: u32) -> String {
    format!(
        "[robot.a]\nbase = {{ at = [0, 0, 0], rpy = [0, 90, 0] }}\nstart = [-2500]\n\
         dh = [{{ kind = \"prismatic\", min = -5000, max = 5000, speed = {speed}, acceleration = 8000 }}]\n\
         links = [[{{ sphere = {{ radius = 20 }} }}]]\n\
         [program.a]\nsteps = [{{ move = \"joint\", to = [2500] }}]\n"
    )
}

/// A plate across the way.
fn plate(thickness_mm: f64, more: &str) -> String {
    format!("[region.plate]\nshape = \"box\"\nbase = [0.5, 0, -500]\nsize = [{thickness_mm}, 2000, 1000]\n{more}\n")
}

fn events(r: &Recording, region: &str) -> Vec<(&'static str, f64)> {
    r.events.iter().filter(|e| e.region == region).map(|e| (e.event, e.t_s)).collect()
}

#[test]
fn a_thin_plate_that_is_jumped_is_entered() {
    // 16 mm from tick to tick.
    let text = format!("{HEAD}{}{}", carriage(4000), plate(4.0, "guards = [\"tcp\"]"));
    let outcome = run_free(&text);
    let r = &outcome.recording;
    let jumped = |x: &f64| (x - 0.5).abs() > 2.0;
    assert!(r.robots[0].samples.iter().all(|s| jumped(&(s.tcp.x * 1000.0))), "a tick fell into the plate: no jump");
    assert!(outcome.bad_news() && r.regions[0].entered);
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
    let told = events(&outcome.recording, "plate");
    let names: Vec<&str> = told.iter().map(|e| e.0).collect();
    assert_eq!(
        names,
        ["warn_in", "inside_in", "output_on", "output_on", "inside_out", "warn_out", "output_off", "output_off"]
    );
    assert!((told[4].1 - told[0].1 - outcome.recording.tick_s).abs() < 1e-9, "{told:?}");
    assert!(!outcome.bad_news(), "a monitored region is no bad news");
}

#[test]
fn a_warning_zone_that_is_jumped_is_told() {
    // Beside the way: the ball comes to 1 mm of it, the zone is 3 mm thick, at y = 21 .. mm.
    let more = "[region.peg]\nshape = \"sphere\"\ncentre = [0, 26, 0]\nradius = 5\nkind = \"monitored\"\nwarning = 3\n";
    let outcome = run(&format!("{HEAD}{}{more}", carriage(4000)));
    let told: Vec<&str> = events(&outcome.recording, "peg").iter().map(|e| e.0).collect();
    assert_eq!(told, ["warn_in", "warn_out"]);
    let peg = &outcome.recording.regions[0];
    assert!(!peg.entered && peg.warned_s > 0.0 && peg.warning_spans.len() == 1);
    assert!(peg.min_distance_m.is_some_and(|d| d > 0.0 && d < 0.003), "{:?}", peg.min_distance_m);
}

#[test]
fn what_is_passed_beside_is_not_entered() {
    // The ball's surface goes by at 0.1 mm.
    for y in [25.1, -25.1] {
        let more =
            format!("[region.peg]\nshape = \"sphere\"\ncentre = [0, {y}, 0]\nradius = 5\nkind = \"monitored\"\n");
        let outcome = run(&format!("{HEAD}{}{more}", carriage(1000)));
        assert_eq!(events(&outcome.recording, "peg"), []);
        assert!(!outcome.recording.regions[0].entered);
    }
}

#[test]
fn a_region_that_rides_past_a_robot_that_stands_is_told() {
    // 4 m/s past the TCP: 16 mm from tick to tick, 2 mm thick.
    let text = format!(
        "{HEAD}[robot.a]\ndh = [{{ kind = \"prismatic\", min = 0, max = 1000, speed = 1000 }}]\n\
         links = [[{{ sphere = {{ radius = 20 }} }}]]\n[program.a]\nsteps = [{{ wait = 1 }}]\n\
         [encoder.belt]\nspeed = 4000\nat = -2007\n\
         [region.blade]\nshape = \"box\"\nbase = [0, 0, -500]\nsize = [2, 1000, 1000]\nkind = \"monitored\"\n\
         guards = [\"tcp\"]\nfollow = {{ encoder = \"belt\" }}\n"
    );
    let outcome = run(&text);
    let told: Vec<&str> = events(&outcome.recording, "blade").iter().map(|e| e.0).collect();
    assert_eq!(told, ["warn_in", "inside_in", "inside_out", "warn_out"]);
    assert_eq!(outcome.recording.regions[0].inside_spans.len(), 1);
}

#[test]
fn a_belt_that_begins_again_passes_nobody() {
    let text = format!(
        "{HEAD}[robot.a]\ndh = [{{ kind = \"prismatic\", min = 0, max = 1000, speed = 1000 }}]\n\
         links = [[{{ sphere = {{ radius = 20 }} }}]]\n[program.a]\nsteps = [{{ wait = 3 }}]\n\
         [encoder.belt]\nspeed = 500\nwrap = 600\nat = 0\n\
         [region.blade]\nshape = \"box\"\nbase = [-700, 0, -500]\nsize = [2, 1000, 1000]\nkind = \"monitored\"\n\
         guards = [\"tcp\"]\nfollow = {{ encoder = \"belt\" }}\n[encoder.back]\nspeed = 1\n"
    );
    // Its travel goes from -700 to -100 and back at once: the TCP at 0 is never passed; nor at -300, where it is passed
    // forwards only.
    assert_eq!(events(&run(&text).recording, "blade"), []);
    let shifted = text.replace("[robot.a]\n", "[robot.a]\nbase = { at = [-300, 0, 0], rpy = [0, 0, 0] }\n");
    let told = events(&run(&shifted).recording, "blade");
    let times = told.iter().filter(|e| e.0 == "inside_in").count();
    // Three seconds of 1.2 s each, from 0.8 s on.
    assert_eq!(times, 2, "{told:?}");
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
    assert!(!outcome.bad_news());
    assert!(events(&outcome.recording, "plate").iter().all(|e| e.0 == "on"), "{:?}", outcome.recording.events);
}

#[test]
fn what_a_monitor_is_told_wrongly_does_not_change_what_is_recorded() {
    use elbowroom_cell::{InputFault, InputFaultKind};
    let cell = parse(&format!("{HEAD}{}{}", carriage(1000), plate(200.0, "warning = 300")));
    let jump = InputFault { robot: 0, from_s: 0.0, to_s: f64::INFINITY, kind: InputFaultKind::Frozen };
    let options = RunOptions { faults: vec![jump], ..RunOptions::default() };
    let outcome = simulate(&cell, &options).unwrap();
    let r = &outcome.recording;
    let farthest = r.robots[0].samples.iter().map(|s| s.tcp.x).fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(r.regions[0].entered, farthest > -0.12, "{farthest}");
}
