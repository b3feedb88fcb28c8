//! Regression tests for cells and tables that users reported.

use crate::common::{HEAD, rail, run};

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

/// A monitor has the regions of its robot alone and counts them by itself.
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
