//! The stopping-distance law in whole cells: robots that decelerate less than their programs accelerate, with reaction
//! times, and on paths that bend towards regions.

use crate::common::{ARM, HEAD, run};
use elbowroom_cell::Cell;
use elbowroom_monitor::{EventKind, OverrideReason};
use elbowroom_sim::check::{check, recordings};
use elbowroom_sim::{RunEvent, RunOptions, simulate};
use elbowroom_testkit::random;

fn carriage(stop_time: f64, reaction_ms: f64, to: f64) -> String {
    format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 2\n\
         [monitor]\nstopping_distance = true\nreaction_ms = {reaction_ms}\n\
         [robot.a]\nbase = {{ at = [0, 0, 0], rpy = [0, 90, 0] }}\n\
         dh = [{{ kind = \"prismatic\", min = -5000, max = 5000, speed = 2000, acceleration = 8000 }}]\n\
         links = [[{{ sphere = {{ radius = 50 }} }}]]\nstop_time = {stop_time}\nstart = [0]\n\
         [region.wall]\nshape = \"box\"\nbase = [{to}, 0, -500]\nsize = [1000, 1000, 1000]\nwarning = 1\n\
         [program.a]\nsteps = [{{ move = \"joint\", to = [4000] }}]\n"
    )
}

#[test]
fn a_carriage_stops_before_a_wall_at_any_deceleration_and_delay() {
    for stop_time in [0.05, 0.1, 0.25, 0.5, 1.0, 1.5] {
        for reaction_ms in [2.0, 20.0, 60.0] {
            // 300 mm from the wall at the start, while the carriage still accelerates; and far away.
            for to in [850.0, 2550.0] {
                let region = &run(&carriage(stop_time, reaction_ms, to)).recording.regions[0];
                let least = region.min_distance_m.unwrap();
                let what = format!("stop time {stop_time} s, reaction {reaction_ms} ms, wall at {to} mm: {least} m");
                assert!(!region.entered && least > 0.0, "{what}");
                assert!(least < 0.002, "it stops close to the border, {what}");
            }
        }
    }
}

/// The reaction time is not a multiple of the tick: within a tick the robot first continues as commanded before.
#[test]
fn a_robot_that_brakes_as_stated_is_not_taken_for_one_that_brakes_less() {
    for tick_ms in [4.0, 12.0, 40.0] {
        for reaction_ms in [5.0, 13.0, 30.0, 47.0] {
            for stop_time in [0.25, 0.5, 1.0] {
                let cell = carriage(stop_time, reaction_ms, 1750.0)
                    .replace("tick_ms = 2\n", &format!("tick_ms = {tick_ms}\n"))
                    .replace("warning = 1\n", "warning = 1\nlife = \"temporary\"\nrobots = [\"a\"]\n");
                // The wall appears suddenly, while the carriage has its full speed.
                let switch = "[robot.b]\nbase = { at = [0, 5000, 0] }\n\
                              dh = [{ kind = \"prismatic\", min = 0, max = 100, speed = 100 }]\n\
                              [program.b]\nsteps = [{ wait = 0.9 }, { region = \"wall\", active = true }]\n";
                let recording = run(&format!("{cell}{switch}")).recording;
                let failed =
                    recording.events.iter().find(|e| e.event == RunEvent::Monitor(EventKind::Fault)).map(|e| e.t_s);
                let what = format!("tick {tick_ms} ms, reaction {reaction_ms} ms, stop time {stop_time} s");
                assert_eq!(failed, None, "{what}");
                let stopped = recording.robots[0].samples.iter().any(|s| s.speed_override == 0.0);
                assert!(stopped, "{what}");
            }
        }
    }
}

/// The simulation satisfies the assumptions of the law.
///
/// After a slow-down the stop time falls by at least one second per second, also while the program accelerates; and the
/// deceleration does not exceed the stated one.
#[test]
fn an_accelerating_program_is_braked_no_less() {
    // Without the law and with a thin zone: it is commanded to stop while its program still accelerates.
    let without_law = carriage(0.5, 2.0, 850.0).replace("stopping_distance = true", "stopping_distance = false");
    let outcome = run(&without_law.replace("warning = 1\n", "warning = 200\n"));
    let samples = &outcome.recording.robots[0].samples;
    let (tick_s, deceleration) = (0.002, 2.0 / 0.5);
    let speed = |i: usize| (samples[i + 1].q[0] - samples[i].q[0]) / tick_s;
    let mut braked = 0;
    for i in 1..samples.len() - 2 {
        let change = (speed(i + 1) - speed(i)) / tick_s;
        assert!(change > -deceleration * 1.02 || speed(i + 1) < 0.02, "{change} m/s² at {} s", samples[i].t_s);
        // If it is faster than commanded, it brakes. An answer counts one tick later.
        let commanded = |i: usize| samples[i.saturating_sub(1)].speed_override * samples[i].programmed_speed;
        if (i - 1..=i + 1).all(|k| speed(k) > commanded(k) + 0.02 && samples[k].programmed_speed > 0.1) {
            braked += 1;
            assert!(change < -deceleration * 0.98, "{change} m/s² at {} s", samples[i].t_s);
        }
    }
    assert!(braked > 20, "{braked}");
}

#[test]
fn an_override_takes_effect_after_the_reaction_time() {
    let outcome = run(&carriage(0.1, 60.0, 2550.0));
    let samples = &outcome.recording.robots[0].samples;
    let begins = samples.iter().position(|s| s.t_s > 0.5 && s.speed_override < 1.0).unwrap();
    let speed = |i: usize| (samples[i + 1].q[0] - samples[i].q[0]) / 0.002;
    let cruising = speed(begins);
    assert!(cruising > 1.9);
    for i in begins..begins + 29 {
        assert!((speed(i) - cruising).abs() < 1e-6, "it reacted {} ms after", (i - begins) * 2);
    }
    assert!(speed(begins + 45) < 0.98 * cruising);
}

#[test]
fn six_axis_arms_that_brake_softly_stay_outside() {
    let mut random = random::Random(7);
    let (mut slowed, mut cells) = (0, 0);
    for case in 0..60 {
        let stop_time = [0.3, 0.5][case % 2];
        let ranges = [150.0, 60.0, 60.0, 120.0, 90.0, 180.0];
        let [from, to]: [Vec<String>; 2] =
            std::array::from_fn(|_| ranges.iter().map(|r| format!("{:.2}", random.between(-r, *r))).collect());
        let at: Vec<String> =
            [1000.0, 1000.0, 700.0].iter().map(|r| format!("{:.1}", random.between(-r, *r))).collect();
        let text = format!(
            "{HEAD}[monitor]\nstopping_distance = true\n[robot.r]\n{ARM}stop_time = {stop_time}\nstart = [{}]\n\
             [region.ball]\nshape = \"sphere\"\ncentre = [{}]\nradius = 200\nwarning = 10\n\
             [program.r]\nsteps = [{{ move = \"joint\", to = [{}] }}]\n",
            from.join(", "),
            at.join(", "),
            to.join(", ")
        );
        let outcome = run(&text);
        let region = &outcome.recording.regions[0];
        if region.inside_spans.iter().any(|s| s.from_s == 0.0) {
            continue;
        }
        cells += 1;
        slowed += usize::from(outcome.recording.robots[0].min_override < 0.9);
        assert!(!region.entered, "entered:\n{text}");
    }
    assert!(cells > 30 && slowed > 8, "{cells} cells, {slowed} slowed");
}

/// A robot with two prismatic joints, and a recording with a right angle at 1.9 m/s between two rows.
const TURNS: &str = "t_s,joint_1,joint_2\n0,0.92,-1.5\n0.8,0.92,0.02\n1.5,2.25,0.02\n";

fn table(name: &str, y: f64) -> String {
    let slide = "kind = \"prismatic\", min = -9000, max = 9000, speed = 2000, acceleration = 8000";
    format!(
        "[robot.{name}]\nbase = {{ at = [0, {y}, 0], rpy = [0, 90, 0] }}\n\
         dh = [{{ {slide}, alpha = -90, theta = 0 }}, {{ {slide} }}]\nlinks = [[], {{ sphere = {{ radius = 50 }} }}]\n\
         stop_time = 0.5\n[program.{name}]\ntrajectory = \"{name}.csv\"\n"
    )
}

fn with_recordings(text: &str, recordings: &[(&str, &str)]) -> (tempfile::TempDir, Cell) {
    let dir = tempfile::tempdir().unwrap();
    for (name, rows) in recordings {
        std::fs::write(dir.path().join(format!("{name}.csv")), rows).unwrap();
    }
    let cell = Cell::parse(dir.path().join("c.toml"), text).unwrap_or_else(|e| panic!("{e}"));
    (dir, cell)
}

const WALL: &str = "[region.wall]\nshape = \"box\"\nbase = [1500, 0, -500]\nsize = [1000, 4000, 1000]\n";

#[test]
fn a_recording_that_turns_sharply_towards_a_wall_stops_before_it() {
    for &tick_ms in elbowroom_testkit::extent::amount(&[1, 8][..], &[1, 2, 4, 8]) {
        for reaction_ms in [1, 8, 40] {
            for at in [1480, 1500, 1560, 1700, 2000] {
                let head = HEAD.replace("tick_ms = 4", &format!("tick_ms = {tick_ms}"));
                let text = format!(
                    "{head}[monitor]\nstopping_distance = true\ndirection_aware = true\nreaction_ms = {reaction_ms}\n{}{}warning = 1\n",
                    table("a", 0.0),
                    WALL.replace("1500, 0", &format!("{at}, 0")),
                );
                let (_dir, cell) = with_recordings(&text, &[("a", TURNS)]);
                let run = simulate(&cell, &RunOptions::default()).unwrap().recording;
                let least = run.regions[0].min_distance_m.unwrap();
                let what = format!("tick {tick_ms} ms, reaction {reaction_ms} ms, wall at {at} mm: {least} m");
                assert!(!run.regions[0].entered && least > 0.0, "{what}");
            }
        }
    }
}

#[test]
fn a_recording_above_the_stated_acceleration_is_reported_and_taken_into_account() {
    let text = format!(
        "{HEAD}[monitor]\nstopping_distance = true\ndirection_aware = true\n{}{WALL}warning = 1\n",
        table("a", 0.0)
    )
    .replace("tick_ms = 4\n", "");
    let (_dir, cell) = with_recordings(&text, &[("a", TURNS)]);
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    assert!(!outcome.recording.regions[0].entered);
    assert!(
        outcome.recording.robots[0].samples.iter().all(|s| !matches!(s.reason, OverrideReason::Fault(_))),
        "a fault"
    );
    let notes: Vec<String> = outcome.notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        notes,
        recordings(&cell).iter().map(ToString::to_string).collect::<Vec<_>>(),
        "check and run say the same"
    );
    for joint in ["joint_1", "joint_2"] {
        let note = notes.iter().find(|n| n.contains(joint) && n.contains("accelerates")).unwrap();
        for words in ["c.toml:", "program.a", "0.800 s", "8000 mm/s²", "more rows"] {
            assert!(note.contains(words), "{words}: {note}");
        }
    }
    let entry = &check(&cell).unwrap()[0];
    assert!(entry.excluded && entry.reason.contains("recording"), "{}", entry.reason);
    // A recording that is faster than the joint limit.
    let (_dir, cell) = with_recordings(&text, &[("a", "t_s,joint_1,joint_2\n0,0,0\n1,0,3\n2,0,6\n")]);
    let note = recordings(&cell)[0].to_string();
    assert!(note.contains("joint_2") && note.contains("3000 mm/s") && note.contains("2000 mm/s"), "{note}");
}

#[test]
fn recordings_never_meet_in_an_exchange_region() {
    let text = format!(
        "{HEAD}[monitor]\nstopping_distance = true\ndirection_aware = true\n{}{}{WALL}warning = 30\nkind = \"exchange\"\n",
        table("a", 0.0),
        table("b", 300.0)
    )
    .replace("tick_ms = 4\n", "");
    let (_dir, cell) = with_recordings(&text, &[("a", TURNS), ("b", "t_s,joint_1,joint_2\n0,1.3,0\n3,1.5,0\n")]);
    let run = simulate(&cell, &RunOptions::default()).unwrap().recording;
    // The first one starts 30 mm from the region, the second one inside.
    assert!(run.regions[0].inside_spans.iter().all(|s| s.robot.0 == 1), "{:?}", run.regions[0].inside_spans);
}

/// A carriage inside a box: 30 mm deep from a face beside it, and the program leaves straight ahead.
fn inside(to: f64, box_at: [f64; 3]) -> String {
    let [x, y, z] = box_at;
    format!(
        "{HEAD}[monitor]\ndirection_aware = true\nstopping_distance = true\n\
         [robot.a]\nbase = {{ at = [0, 0, 0], rpy = [0, 90, 0] }}\n\
         dh = [{{ kind = \"prismatic\", min = -5000, max = 5000, speed = 1000, acceleration = 4000 }}]\n\
         links = [[{{ sphere = {{ radius = 50 }} }}]]\nstart = [0]\n\
         [region.box]\nshape = \"box\"\nbase = [{x}, {y}, {z}]\nsize = [600, 600, 600]\nwarning = 100\n\
         [program.a]\nsteps = [{{ move = \"joint\", to = [{to}] }}]\n"
    )
}

#[test]
fn a_robot_inside_leaves_straight_ahead_though_another_face_is_nearer() {
    // The ball (50 mm) around the origin reaches 30 mm into the box across its face y = 20; the end of the box is 300
    // mm ahead.
    let outcome = run(&inside(1000.0, [0.0, 320.0, -300.0]));
    assert!(outcome.recording.robots[0].finished, "held inside");
    // At 10 % inside, and at full speed outside.
    assert!(outcome.recording.duration_s > 3.0 && outcome.recording.duration_s < 12.0);
}

#[test]
fn a_robot_inside_is_stopped_where_its_program_leads_deeper() {
    // The nearest face is 20 mm behind; the program leads through the box.
    let outcome = run(&inside(1000.0, [280.0, 0.0, -300.0]));
    assert!(!outcome.recording.robots[0].finished);
    let last = outcome.recording.robots[0].samples.last().unwrap();
    assert!(last.q[0].abs() < 1e-6, "it moved {} m deeper", last.q[0]);
}

/// A point on a circle leaves a ball that it almost touches, more or less steeply.
///
/// The rounding of distances causes neither an entry nor a hold.
#[test]
fn a_robot_that_leaves_a_border_that_it_all_but_touches_does_not_enter_it() {
    for apart in [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13] {
        for (degrees, behind) in [(-70_i32, 15_i32), (-20, 40), (0, 60), (35, 90), (80, 30), (10, 5)] {
            let angle = f64::from(degrees).to_radians();
            // Outwards, and back from where it goes.
            let towards = angle - f64::from(behind).to_radians();
            let (x, y) =
                (0.6 * angle.cos() + (0.2 + apart) * towards.cos(), 0.6 * angle.sin() + (0.2 + apart) * towards.sin());
            let text = format!(
                "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\ntick_ms = 4\nmax_s = 20\n[robot.a]\n\
                 dh = [{{ a = 0.6, min = -3, max = 3, speed = 2, acceleration = 8 }}]\nlinks = [[]]\nstart = [{angle:?}]\n\
                 [region.ball]\nshape = \"sphere\"\ncentre = [{x:?}, {y:?}, 0]\nradius = 0.2\nwarning = 0.1\nguards = [\"tcp\"]\n\
                 [monitor]\nstopping_distance = true\ndirection_aware = true\nreaction_ms = 20\n\
                 [program.a]\nsteps = [{{ move = \"joint\", to = [{:?}] }}]\n",
                angle + 1.0
            );
            let recording = run(&text).recording;
            let region = &recording.regions[0];
            assert!(!region.entered, "{apart} m, {degrees} degrees: {:?}", region.min_distance_m);
            assert!(recording.robots[0].finished, "{apart} m, {degrees} degrees, {behind} behind: held");
        }
    }
}
