//! The override law in a run, recomputed from the rows alone.

use crate::common::{ARM, HEAD, parse, rail, run, run_free};
use elbowroom_cell::{CellRegionId, ProgramBody, StepAction};
use elbowroom_sim::RunSummary;
use elbowroom_spatial::Vec3;

fn figure_12(extra: &str) -> String {
    format!(
        "{HEAD}[robot.arm]\n{ARM}start = [-35, 0, 0, 0, 40, 0]\n\
         [region.column]\nshape = \"cylinder\"\nbase = [1200, 0, 0]\nradius = 150\nheight = 2000\nwarning = 250\nguards = [\"tcp\"]\n\
         {extra}\n[program.arm]\nsteps = [\n\
         {{ move = \"joint\", to = {{ at = [1200, -600, 900], rpy = [180, 0, 0] }}, speed = 50 }},\n\
         {{ move = \"linear\", to = {{ at = [1200, 600, 900], rpy = [180, 0, 0] }}, speed = 500 }},\n]\n"
    )
}

/// Distance to the vertical cylinder of [`figure_12`], by a separate formula.
fn to_column(p: Vec3) -> f64 {
    let out = (p.x - 1.2).hypot(p.y) - 0.15;
    let up = (p.z - 2.0).max(-p.z);
    if out <= 0.0 && up <= 0.0 { 0.0 } else { out.max(0.0).hypot(up.max(0.0)) }
}

#[test]
fn the_override_is_the_law_at_every_row_and_the_arm_stops_at_the_border() {
    let outcome = run(&figure_12(""));
    let track = &outcome.recording.robots[0];
    let mut slowed = 0;
    for s in &track.samples {
        let law = (to_column(s.tcp) / 0.25).clamp(0.0, 1.0);
        assert!((s.speed_override - law).abs() < 1e-9, "at {} s: {} against {law}", s.t_s, s.speed_override);
        if law < 1.0 {
            slowed += 1;
            assert_eq!(s.region, Some(CellRegionId(0)));
            assert!((s.distance_m.unwrap() - to_column(s.tcp)).abs() < 1e-9);
        }
    }
    assert!(slowed > 100);
    let rest = to_column(track.samples.last().unwrap().tcp);
    assert!(rest > 0.0 && rest < 0.002, "stopped {rest} m from the column");
    assert!(!track.finished && !outcome.has_violation() && track.stopped_s > 0.5);
    assert!(outcome.recording.events.iter().any(|e| e.event.name() == "stop" && e.region == "column"));
    let region = &outcome.recording.regions[0];
    let least = track.samples.iter().map(|s| to_column(s.tcp)).fold(f64::INFINITY, f64::min);
    assert!((region.min_distance_m.unwrap() - least).abs() < 1e-9 && !region.entered);
}

#[test]
fn speed_follows_the_law_within_what_the_deceleration_bound_explains() {
    let outcome = run(&figure_12(""));
    let worst = outcome.recording.robots[0]
        .samples
        .iter()
        .filter(|s| s.programmed_speed > 0.05 && s.speed_override > 0.0 && s.speed_override < 1.0)
        .map(|s| (s.tcp_speed / s.programmed_speed - s.speed_override).abs())
        .fold(0.0, f64::max);
    // One tick of latency at 2 1/s is 0.8 %.
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn without_the_monitor_the_region_is_entered_and_reported_as_a_violation() {
    let outcome = run_free(&figure_12(""));
    let recording = &outcome.recording;
    assert!(recording.robots[0].finished && outcome.has_violation() && recording.regions[0].entered);
    assert_eq!(recording.regions[0].min_distance_m, Some(0.0));
    assert!(recording.robots[0].samples.iter().all(|s| s.speed_override == 1.0 && s.region.is_none()));
    assert!(recording.events.iter().any(|e| e.event.name() == "inside_in"));
    let json = serde_json::to_value(RunSummary::from(recording)).unwrap();
    assert_eq!(json["regions"][0]["entered"], true);
    assert_eq!(json["ticks"].as_u64().unwrap() as usize, recording.robots[0].samples.len());
}

#[test]
fn linear_moves_keep_the_tcp_on_the_line_at_the_programmed_speed() {
    let outcome = run_free(&figure_12(""));
    let samples = &outcome.recording.robots[0].samples;
    let on_line: Vec<_> = samples.iter().skip_while(|s| s.tcp.distance(Vec3::new(1.2, -0.6, 0.9)) > 1e-9).collect();
    assert!(on_line.len() > 200);
    for s in &on_line {
        assert!((s.tcp.x - 1.2).abs() < 1e-9 && (s.tcp.z - 0.9).abs() < 1e-9, "{:?}", s.tcp);
    }
    let fastest = on_line.iter().map(|s| s.tcp_speed).fold(0.0, f64::max);
    assert!((fastest - 0.5).abs() < 1e-3, "{fastest}");
}

#[test]
fn joints_keep_their_speeds_and_the_trace_is_the_integrated_motion() {
    let cell = parse(&figure_12(""));
    let outcome = run(&figure_12(""));
    let samples = &outcome.recording.robots[0].samples;
    for w in samples.windows(2) {
        assert!((w[1].t_s - w[0].t_s - 0.004).abs() < 1e-12);
        for (j, l) in cell.robots[0].limits.iter().enumerate() {
            let v = (w[1].q[j] - w[0].q[j]) / 0.004;
            assert!(v.abs() <= l.velocity * 1.001, "joint {j} at {v}");
        }
    }
}

#[test]
fn two_regions_combine_by_the_minimum_and_the_programmed_override_multiplies() {
    let text = format!(
        "{HEAD}{}\
         [region.a]\nshape = \"sphere\"\ncentre = [1000, 0, 0]\nradius = 100\nwarning = 800\nguards = [\"tcp\"]\n\
         [region.b]\nshape = \"sphere\"\ncentre = [1000, 300, 0]\nradius = 100\nwarning = 900\nguards = [\"tcp\"]\n\
         [program.r]\noverride = 60\nsteps = [{{ move = \"joint\", to = [1500] }}]\n",
        rail("r", 0.0)
    );
    let outcome = run(&text);
    let zone = |p: Vec3, c: Vec3, w: f64| (((p.distance(c) - 0.1).max(0.0)) / w).clamp(0.0, 1.0);
    for s in &outcome.recording.robots[0].samples {
        let law = zone(s.tcp, Vec3::X, 0.8).min(zone(s.tcp, Vec3::new(1.0, 0.3, 0.0), 0.9)) * 0.6;
        assert!((s.speed_override - law).abs() < 1e-12);
    }
    assert!(!outcome.recording.robots[0].finished);
}

#[test]
fn the_programs_of_the_parsed_cell_are_in_si() {
    let cell = parse(&figure_12(""));
    let ProgramBody::Steps(steps) = &cell.robots[0].program.as_ref().unwrap().body else { panic!() };
    let StepAction::Linear { speed, .. } = steps[1].action else { panic!() };
    assert_eq!(speed, 0.5);
}
