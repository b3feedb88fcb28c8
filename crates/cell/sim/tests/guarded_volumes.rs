//! Guarded volumes: a TCP outside of all solids is guarded, too.

use crate::common::{HEAD, parse, rail, run};
use elbowroom_sim::{RunOptions, simulate};

const PROGRAM: &str = "[program.a]\nsteps = [{ move = \"joint\", to = [1000] }]\n";

fn region(more: &str) -> String {
    format!("[region.z]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 300\n{more}")
}

fn ball(more: &str) -> String {
    format!("{}start = [-1000]\n{more}", rail("a", 0.0))
}

#[test]
fn a_tcp_outside_of_the_solids_is_guarded_with_tool_and_arm() {
    // The carriage moves along x; its ball stays 50 mm below the sphere. The TCP, 400 mm above it, meets the centre.
    let tcp = "tool.tcp = { at = [-400, 0, 0] }\n";
    for guards in ["arm", "tool"] {
        let zone = region(&format!("guards = [\"{guards}\"]\n")).replace("[0, 0, 0]", "[0, 0, 400]");
        let text = format!("{HEAD}{}{zone}{PROGRAM}", ball(tcp));
        let outcome = run(&text);
        let z = &outcome.recording.regions[0];
        assert!(!outcome.recording.robots[0].finished && !z.entered, "{guards}: {:?}", z.min_distance_m);
        let free = simulate(&parse(&text), &RunOptions { apply_override: false, ..RunOptions::default() }).unwrap();
        assert!(free.recording.regions[0].entered, "{guards}: without the monitor it goes through");
    }
}
