//! Regression tests for cells and tables that users reported.

use crate::common::{HEAD, parse, rail, run};
use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;
use elbowroom_sim::check::{check, recordings};
use elbowroom_sim::motion::{PlanStep, PlannedPaths, plan};
use elbowroom_sim::{RunOptions, simulate};

#[test]
fn a_stop_is_planned_for_a_path_that_bends_towards_the_region() {
    for (warning, reaction_ms) in [(1, 4), (50, 4), (1, 40)] {
        let text = format!(
            "{HEAD}[monitor]\nstopping_distance = true\nreaction_ms = {reaction_ms}\n\
             [robot.r]\ndh = [{{ a = 900, min = -170, max = 170, speed = 180 }}]\nstart = [150]\n\
             [region.ball]\nshape = \"sphere\"\ncentre = [900, 0, 0]\nradius = 200\nwarning = {warning}\n\
             guards = [\"tcp\"]\n\
             [program.r]\nsteps = [{{ move = \"joint\", to = [-150] }}]\n"
        );
        let region = &run(&text).recording.regions[0];
        assert!(!region.entered && region.min_distance_m.unwrap() < 0.002, "{:?}", region.min_distance_m);
    }
}

/// A monitor has only the regions of its robot, with its own indices.
#[test]
fn the_reason_of_an_override_names_the_region_of_the_cell() {
    let sphere = |name: &str, x: f64, robot: &str| {
        format!(
            "[region.{name}]\nshape = \"sphere\"\ncentre = [{x}, 0, 0]\nradius = 100\nwarning = 100\nguards = [\"tcp\"]\n\
             robots = [\"{robot}\"]\n"
        )
    };
    let text = format!(
        "{HEAD}{}{}{}{}[program.a]\nsteps = [{{ move = \"joint\", to = [1000] }}]\n",
        rail("a", 0.0),
        rail("b", 900.0),
        sphere("far", 5000.0, "b"),
        sphere("near", 900.0, "a"),
    );
    let recording = run(&text).recording;
    let regions: Vec<_> = recording.robots[0].samples.iter().filter_map(|s| s.reason.region()).collect();
    assert!(!regions.is_empty());
    assert!(regions.iter().all(|r| recording.regions[r.0].name == "near"), "{regions:?}");
}

#[test]
fn a_robot_that_starts_inside_an_exchange_region_occupies_it_from_the_first_tick() {
    let text = format!(
        "{HEAD}{}{}\
         [region.shared]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 100\nwarning = 100\nguards = [\"tcp\"]\n\
         kind = \"exchange\"\n\
         [program.a]\nsteps = [{{ move = \"joint\", to = [1000] }}]\n",
        rail("a", 0.0),
        rail("b", 900.0)
    );
    let outcome = run(&text);
    assert!(!outcome.recording.regions[0].entered && outcome.recording.robots[0].finished);
    let first = outcome.recording.events.iter().find(|e| e.event.name() == "granted").unwrap();
    assert!(first.t_s == 0.0 && first.robot == "a");
}

const STOPPING: &str = "[monitor]\nstopping_distance = true\ndirection_aware = true\n";

/// The answer of `check` for the only pair, and whether a run with this many repetitions enters the region.
fn excluded_and_entered(cell: &Cell, repeat: u32) -> (bool, String, bool) {
    let entry = check(cell).unwrap().remove(0);
    let options = RunOptions { repeat, ..RunOptions::default() };
    let outcome = simulate(cell, &options).unwrap();
    (entry.excluded, entry.reason, outcome.recording.regions[0].entered)
}

/// A cell whose program is a recording.
fn recorded(text: &str, csv: &str) -> Cell {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("recording.csv"), csv).unwrap();
    Cell::parse(dir.path().join("cell.toml"), text).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_recording_that_begins_in_motion_is_joined_from_rest_and_stops_before_a_wall() {
    // A metre per second from the first row on, 0.3 m before the wall; the stop alone takes 0.5 m.
    let text = format!(
        "{HEAD}{}stop_time = 1.0\n[region.wall]\nshape = \"box\"\nbase = [450, 0, -500]\nsize = [200, 1000, 1000]\nwarning = 50\n\
         {STOPPING}[program.a]\ntrajectory = \"recording.csv\"\n",
        rail("a", 0.0)
    );
    let cell = recorded(&text, "t_s,joint_1\n0,0\n1,1\n2,2\n");
    let (excluded, _, entered) = excluded_and_entered(&cell, 1);
    assert!(excluded && !entered);
    let samples = simulate(&cell, &RunOptions::default()).unwrap().recording.robots.remove(0).samples;
    let fastest_first = samples.windows(2).take(5).map(|s| (s[1].q[0] - s[0].q[0]) / 0.004).fold(0.0, f64::max);
    assert!(fastest_first < 5.0 * 0.004 * 4.0 + 1e-9, "it starts from rest: {fastest_first} m/s within five ticks");
    let warning = recordings(&cell).remove(0).to_string();
    assert!(warning.contains("moves at 1000 mm/s in its first row: the robot starts from rest"), "{warning}");
}

#[test]
fn a_tool_exchanged_into_a_region_is_a_possible_entry() {
    let tools = "[robot.a.tools.gripper]\ntcp = { at = [0, 0, 100] }\nbox = { at = [0, 0, 50], size = [60, 60, 100] }\n\
                 [robot.a.tools.torch]\ntcp = { at = [0, 0, 700] }\nbox = { at = [0, 0, 350], size = [60, 60, 700] }\n\
                 mounted = false\n";
    for (kind, at, possible) in [("forbidden", 100, true), ("exchange", 100, true), ("forbidden", -200, false)] {
        let cell = parse(&format!(
            "{HEAD}{}start = [-1000]\n{tools}\
             [region.wall]\nkind = \"{kind}\"\nshape = \"box\"\nbase = [600, 0, -500]\nsize = [100, 1000, 1000]\nwarning = 50\n\
             {STOPPING}[program.a]\nsteps = [{{ move = \"joint\", to = [{at}] }}, {{ tool = \"torch\" }}, {{ wait = 0.1 }}, \
             {{ move = \"joint\", to = [-1000] }}]\n",
            rail("a", 0.0)
        ));
        let (excluded, reason, entered) = excluded_and_entered(&cell, 1);
        assert_eq!((!excluded, reason.contains("exchanges its tool for \"torch\" inside")), (possible, possible));
        // A single robot gets the grant of an exchange region.
        assert_eq!(entered, possible && kind == "forbidden", "{kind} at {at}");
    }
}

#[test]
fn a_region_on_a_robot_that_evades_moves_at_an_unknown_speed() {
    let cell = parse(&format!(
        "{HEAD}max_s = 8\n{}{}\
         [object.cart]\nshape = \"box\"\nat = [0, -3000, 0]\nsize = [300, 300, 300]\n\
         motion = {{ via = [[0, -900, 0]], speed = 400 }}\n\
         [region.hand]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 100\nrobots = [\"a\"]\n\
         follow = {{ robot = \"b\", frame = \"flange\" }}\n\
         [avoidance.b]\nobjects = [\"cart\"]\n[monitor]\nstopping_distance = true\n[program.a]\nsteps = [{{ wait = 7 }}]\n",
        rail("a", 0.0),
        rail("b", -1000.0)
    ));
    let (excluded, reason, _) = excluded_and_entered(&cell, 1);
    assert!(!excluded && reason.starts_with("the region moves"), "{reason}");
}

#[test]
fn the_way_back_to_the_start_of_a_repeated_recording_is_checked() {
    // Around the ball, slowly; a repetition goes back past it, faster than its warning zone allows.
    let text = format!(
        "{HEAD}[robot.a]\ndh = [{{ kind = \"prismatic\", min = -3000, max = 3000, speed = 1000, acceleration = 4000, alpha = 90 }}, \
         {{ kind = \"prismatic\", min = -3000, max = 3000, speed = 1000, acceleration = 4000 }}]\n\
         links = [[], {{ sphere = {{ radius = 50 }} }}]\nstop_time = 1.0\n\
         [region.ball]\nshape = \"sphere\"\ncentre = [0, -500, 500]\nradius = 100\nwarning = 20\n\
         [program.a]\ntrajectory = \"recording.csv\"\n"
    );
    let cell = recorded(&text, "t_s,joint_1,joint_2\n0,0,0\n20,1,0\n40,1,1\n");
    let (excluded, reason, entered) = excluded_and_entered(&cell, 2);
    assert!(!excluded && entered, "{reason}");
}

#[test]
fn every_kind_of_move_ends_where_the_next_one_begins() {
    let text = format!(
        "{HEAD}[robot.r]\ndh = [{{ a = 900, min = -170, max = 170, speed = 180 }}, {{ a = 600, min = -170, max = 170, speed = 180 }}]\n\
         links = [[], {{ sphere = {{ radius = 30 }} }}]\nstart = [0, 30]\n[program.r]\nsteps = [\n\
         {{ move = \"joint\", to = [20, 60] }},\n{{ wait = 0.1 }},\n{{ move = \"planned\", to = [-40, 50] }},\n{{ override = 50 }},\n\
         {{ move = \"linear\", to = [-45, 55] }},\n{{ move = \"planned\", to = [0, 30] }},\n]\n"
    );
    let cell = Cell::parse("moves.toml", &text).unwrap();
    let plan = plan(&PlannedPaths::new(&cell), RobotId(0), 1, &mut Vec::new()).unwrap();
    let ends: Vec<[i64; 2]> = plan
        .steps
        .iter()
        .filter_map(PlanStep::end)
        .map(|q| [0, 1].map(|joint: usize| q[joint].to_degrees().round() as i64))
        .collect();
    assert_eq!(ends, [[20, 60], [-40, 50], [-45, 55], [0, 30]]);
}
