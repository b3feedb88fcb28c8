//! The example `pallet`: its program is valid, the cart crosses its path, and the arm evades it.

use std::path::PathBuf;

use elbowroom_avoidance::AvoiderState;
use elbowroom_cell::Cell;
use elbowroom_sim::{AvoidanceSample, RunOptions, RunOutcome, RunSummary, simulate};

fn file() -> PathBuf {
    elbowroom_testkit::folder::examples().join("pallet/cell.toml")
}

fn run(text: &str, avoidance: bool) -> RunOutcome {
    let cell = Cell::parse(file(), text).unwrap_or_else(|e| panic!("{e}"));
    assert!(cell.warnings.is_empty(), "{:?}", cell.warnings);
    simulate(&cell, &RunOptions { avoidance, ..RunOptions::default() }).unwrap_or_else(|e| panic!("{e}"))
}

/// The whole program at its own ticks with `ELBOWROOM_LONG=1`, as the guide to avoidance runs it.
///
/// Otherwise only the first carton, up to its place on the pallet, at ticks of 10 ms: the arm evades without and with a
/// load, and each tick of evasion is costly.
fn evading() -> String {
    if elbowroom_testkit::extent::is_long_run() {
        return std::fs::read_to_string(file()).unwrap();
    }
    until("release = \"carton_5\"").replace("tick_ms = 4", "tick_ms = 10")
}

/// The cell with the steps of its program before the one that contains `end`.
fn until(end: &str) -> String {
    let text = std::fs::read_to_string(file()).unwrap();
    let kept: Vec<&str> = text.lines().take_while(|line| !line.contains(end)).collect();
    assert!(kept.len() > 5 && kept.iter().any(|line| line.contains("steps = [")));
    kept.join("\n") + "\n]\n"
}

#[test]
fn the_program_succeeds_without_the_cart_and_collides_with_it() {
    let text = std::fs::read_to_string(file()).unwrap();
    let (begin, end) = (text.find("[object.cart]").unwrap(), text.find("[program.kr150]").unwrap());
    let alone = run(&format!("{}{}", &text[..begin], &text[end..]), true);
    let robot = &alone.recording.robots[0];
    assert!(robot.finished && !alone.has_violation(), "{:?}", robot.collisions);

    let met = run(&text, false);
    let robot = &met.recording.robots[0];
    assert!(robot.finished && met.has_violation() && robot.avoidance.is_none());
    assert!(robot.collisions.iter().all(|c| c.b == "cart"), "{:?}", robot.collisions);
}

#[test]
fn the_arm_evades_the_cart_and_completes_its_program() {
    let text = evading();
    let outcome = run(&text, true);
    let robot = &outcome.recording.robots[0];
    assert!(robot.finished && !outcome.has_violation(), "{:?}", robot.collisions);
    let track = robot.avoidance.as_ref().unwrap();
    assert_eq!(track.samples.len(), robot.samples.len());
    assert!(track.samples.iter().any(|s| s.state == AvoiderState::Evading));
    assert!(track.samples.iter().all(|s| s.nearest_m > 0.04), "the cart is closer than the clearance");
    let summary = RunSummary::from(&outcome.recording).robots[0].avoidance.clone().unwrap();
    assert!(summary.evading_s > 0.1 && summary.off_path_s > 0.1 && summary.min_distance_m.is_some_and(|m| m > 0.04));
    let occurred = |what: &str| outcome.recording.events.iter().any(|e| e.event.name() == what);
    assert!(occurred("evade") && occurred("on_path"));
    // Without an obstacle nearby the robot is exactly on its program, so both runs end at the same configuration.
    let unevaded = run(&text, false);
    assert!(unevaded.has_violation(), "nothing had to be evaded");
    assert_eq!(robot.samples.last().unwrap().q, unevaded.recording.robots[0].samples.last().unwrap().q);
    // The run is deterministic: a run that ends earlier, shortly after the first evasion, has the same start.
    let first = track.samples.iter().position(|s| s.state == AvoiderState::Evading).unwrap();
    let end_s = (robot.samples[first].t_s + 1.0).ceil();
    let shorter = run(&text.replacen("tick_ms", &format!("max_s = {end_s}\ntick_ms"), 1), true);
    let q = |o: &RunOutcome| o.recording.robots[0].samples.iter().map(|s| s.q.clone()).collect::<Vec<_>>();
    let (all, begun) = (q(&outcome), q(&shorter));
    let evading = shorter.recording.robots[0].avoidance.as_ref().unwrap();
    assert!(
        evading.samples.iter().any(|s| s.state == AvoiderState::Evading),
        "nothing was evaded in the first {end_s} s"
    );
    assert!(begun.len() < all.len());
    assert_eq!(all[..begun.len()], begun[..]);
}

#[test]
fn an_override_of_zero_stops_the_evasion_too() {
    // The run lasts up to its time limit, in which the cart comes to the arm twice.
    let text = until("grip = ").replace("tick_ms = 4", "tick_ms = 40\nmax_s = 12");
    let region = "[region.everything]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 9000\nwarning = 100\n";
    let outcome = run(&format!("{text}\n{region}"), true);
    let robot = &outcome.recording.robots[0];
    // If it were free to move, it would evade.
    let is_near = |s: &AvoidanceSample| s.nearest_m < 0.2;
    assert!(robot.avoidance.as_ref().unwrap().samples.iter().any(is_near), "the cart does not come near");
    // The program starts and is stopped; nothing moves after that.
    let stopped = &robot.samples[robot.samples.len() / 4].q;
    let first = &robot.samples[0].q;
    assert!(first.iter().zip(stopped).all(|(a, b)| (a - b).abs() < 0.02), "the arm moved at override 0");
    assert!(robot.samples.iter().skip(robot.samples.len() / 4).all(|s| s.q == *stopped), "the arm moved at override 0");
}

#[test]
fn errors_in_the_table_name_the_line() {
    let text = std::fs::read_to_string(file()).unwrap();
    let wrong = |key: &str, word: &str| {
        let line = 1 + text.lines().position(|l| l.starts_with("[avoidance.kr150]")).unwrap() + 1;
        let with = text.replace("[avoidance.kr150]", &format!("[avoidance.kr150]\n{key}"));
        let e = Cell::parse(file(), &with).unwrap_err();
        assert!(e.to_string().contains(word) && e.hint.is_some(), "{e}");
        assert_eq!(e.line, Some(line), "{e}");
    };
    wrong("speeed = 5", "speed");
    wrong("speed = 0", "speed");
    wrong("return_speed = 0", "return_speed");
    wrong("stall_timeout = -1", "stall_timeout");
    for key in ["speed", "clearance", "return_speed", "stall_timeout"] {
        for value in ["0", "-1", "nan", "inf", "-inf", "1e9", "1e300", "1e-9", "\"fast\"", "[1]"] {
            wrong(&format!("{key} = {value}"), &format!("avoidance.kr150.{key}"));
        }
    }
    wrong("speed = 5e4", "10 mm per second to 20000 mm per second");
    wrong("clearance = 1e-3", "0.1 mm to 5000 mm");
    wrong("clearance = 1500", "1000 mm range of the rules");
    wrong("stall_timeout = 3600", "0.01 to 60 s");
    for key in ["horizon", "noise", "delay_ms"] {
        for value in ["-1", "nan", "inf", "1e9", "\"long\"", "[1]"] {
            wrong(&format!("{key} = {value}"), &format!("avoidance.kr150.{key}"));
        }
    }
    wrong("horizon = 11", "0 to 10 s");
    wrong("noise = 501", "0 to 500");
    wrong("delay_ms = 2001", "0 to 2000 ms");
    wrong("rules = \"nowhere.toml\"", "nowhere.toml");
    let seen = "horizon = 2\nnoise = 12\ndelay_ms = 60";
    let seen = Cell::parse(file(), &text.replace("[avoidance.kr150]", &format!("[avoidance.kr150]\n{seen}"))).unwrap();
    let spec = seen.robots[0].avoidance.as_ref().unwrap();
    assert_eq!((spec.settings.escape.horizon_s, spec.noise_m, spec.delay_s), (2.0, 0.012, 0.06));
    let sound = "speed = 20000\nclearance = 0.1\nreturn_speed = 1\nstall_timeout = 60";
    let sound = text.replace("[avoidance.kr150]", &format!("[avoidance.kr150]\n{sound}"));
    let cell = Cell::parse(file(), &sound).unwrap();
    let settings = cell.robots[0].avoidance.as_ref().unwrap().settings;
    assert_eq!((settings.reactive.speed_m_s, settings.reactive.clearance_m), (20.0, 1e-4));
    assert_eq!((settings.return_speed_fraction, settings.stall_timeout_s), (Some(0.01), 60.0));
    let unknown = text.replace("objects = [\"cart\"]", "objects = [\"card\"]");
    assert!(Cell::parse(file(), &unknown).unwrap_err().to_string().contains("cart"));
    let unknown_robot = text.replace("[avoidance.kr150]", "[avoidance.kr15]");
    assert!(Cell::parse(file(), &unknown_robot).unwrap_err().to_string().contains("kr150"));
}
