//! A recording states why a robot was stopped: part, point, region or obstacle, start, duration, and what releases it.

use crate::common::{HEAD, rail, run};
use elbowroom_sim::{Outcome, RunSummary, csv};
use elbowroom_spatial::Vec3;

/// A gate in the way of the first carriage, which the second program opens after four seconds.
fn gate(opens: bool) -> String {
    let last = if opens { ", { region = \"gate\", active = false }" } else { "" };
    format!(
        "{HEAD}{}{}[region.gate]\nshape = \"sphere\"\ncentre = [800, 30, 0]\nradius = 100\nwarning = 200\n\
         life = \"temporary\"\nrobots = [\"a\"]\n\
         [program.a]\nsteps = [{{ region = \"gate\", active = true }}, {{ move = \"joint\", to = [1500] }}]\n\
         [program.b]\nsteps = [{{ wait = 4 }}{last}]\n",
        rail("a", 0.0),
        rail("b", 900.0)
    )
}

#[test]
fn a_stop_is_recorded_with_its_cause_also_where_the_robot_goes_on() {
    let recording = run(&gate(true)).recording;
    let robot = &recording.robots[0];
    assert!(robot.finished && robot.stops.len() == 1, "{:?}", robot.stops);
    let stop = &robot.stops[0];
    assert!(stop.from_s < 3.5 && (stop.to_s - 4.0).abs() < 0.05, "{stop:?}");
    assert!((robot.stopped_s - (stop.to_s - stop.from_s)).abs() < 0.02, "{stop:?}");
    assert_eq!((stop.by.as_deref(), stop.part.as_deref()), (Some("gate"), Some("link_1")));
    // The point of the ball (50 mm) on the carriage that is closest to the gate, by its definition.
    let at = robot.samples.iter().find(|s| s.t_s == stop.from_s).unwrap();
    let (ball, centre) = (Vec3::new(at.q[0], 0.0, 0.0), Vec3::new(0.8, 0.03, 0.0));
    let nearest = ball + (centre - ball) * (0.05 / (centre - ball).length());
    assert!((stop.point.unwrap() - nearest).length() < 1e-6, "{stop:?} is not {nearest:?}");
    assert!((stop.distance_m.unwrap() - ((centre - ball).length() - 0.15)).abs() < 1e-9);
    assert_eq!(at.governing.unwrap().point, stop.point.unwrap());
    let summary = &RunSummary::from(&recording).robots[0];
    assert_eq!((summary.stops.len(), summary.stops[0].from_s, summary.ending.release.clone()), (1, stop.from_s, None));

    let stays = run(&gate(false)).recording;
    let robot = &stays.robots[0];
    assert_eq!(robot.stops.len(), 1);
    assert_eq!(robot.stops[0].to_s, stays.duration_s, "a stop without an end lasts to the end of the run");
    let release = robot.ending.release.as_deref().unwrap();
    assert!(release.contains("a program switches it off"), "{release}");
}

#[test]
fn the_trace_names_part_and_point_where_a_region_governs() {
    let recording = run(&gate(true)).recording;
    let mut trace = Vec::new();
    csv::write_trace(&recording, &mut trace).unwrap();
    let trace = String::from_utf8(trace).unwrap();
    let head: Vec<&str> = trace.lines().next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|c| *c == name).unwrap();
    let mut governed = 0;
    for line in trace.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), head.len(), "{line}");
        let number = |name: &str| cells[column(name)].parse::<f64>().ok();
        if cells[column("region")].is_empty() {
            assert!(cells[column("part")].is_empty() && number("point_x_m").is_none(), "{line}");
            continue;
        }
        governed += 1;
        assert_eq!((cells[column("part")], cells[column("object")]), ("link_1", ""), "{line}");
        let point = Vec3::from(["point_x_m", "point_y_m", "point_z_m"].map(|c| number(c).unwrap()));
        let distance = (point - Vec3::new(0.8, 0.03, 0.0)).length() - 0.1;
        assert!((distance.max(0.0) - number("distance_m").unwrap()).abs() < 1e-6, "{line}");
    }
    assert!(governed > 100, "{governed}");
}

#[test]
fn an_obstacle_that_avoidance_stops_for_is_named() {
    let text = format!(
        "{HEAD}{}[object.crate]\nshape = \"box\"\nat = [900, 0, 0]\nsize = [200, 800, 800]\n\
         [avoidance.r]\nobjects = [\"crate\"]\nreplan = false\n\
         [program.r]\nsteps = [{{ move = \"joint\", to = [1500] }}]\n",
        rail("r", 0.0)
    );
    let recording = run(&text).recording;
    let robot = &recording.robots[0];
    assert!(!robot.finished && robot.collisions.is_empty());
    let ending = &robot.ending;
    assert_eq!((ending.outcome, ending.by.as_deref()), (Outcome::Stopped, Some("crate")), "{ending:?}");
    assert_eq!(ending.release.as_deref(), Some("crate moves away"));
    let mut trace = Vec::new();
    csv::write_trace(&recording, &mut trace).unwrap();
    let trace = String::from_utf8(trace).unwrap();
    assert!(trace.lines().last().unwrap().contains(",,,,crate,"), "{}", trace.lines().last().unwrap());
}
