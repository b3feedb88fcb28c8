//! Robots with several tools: on two flanges, and exchanged on one.

use crate::common::{HEAD, parse, run, run_free};
use elbowroom_sim::check::check;
use elbowroom_spatial::Vec3;

/// An arm with a slide at its end and two tools: a short one and a long one. `flanges` and `steps` differ.
fn cell(tools: &str, more: &str, steps: &str) -> String {
    format!(
        "{HEAD}[robot.arm]\n\
         dh = [{{ a = 400, min = -170, max = 170, speed = 90 }}, {{ a = 300, min = -170, max = 170, speed = 90 }}, \
         {{ kind = \"prismatic\", min = -400, max = 0, speed = 500 }}]\n\
         links = [[], {{ capsule = {{ from = [-300, 0, 0], to = [0, 0, 0], radius = 40 }} }}, \
         {{ capsule = {{ from = [0, 0, 0], to = [0, 0, 300], radius = 20 }} }}]\n\
         base = {{ at = [0, 0, 600] }}\nstart = [0, 0, -100]\n{tools}\n{more}\n\
         [program.arm]\nsteps = [\n{steps}\n]\n"
    )
}

const SHORT: &str =
    "[robot.arm.tools.short]\ntcp = { at = [0, 0, -20] }\nbox = { at = [0, 0, -10], size = [40, 40, 20] }\n";
/// A tool that reaches 400 mm outwards.
const LONG: &str =
    "[robot.arm.tools.long]\ntcp = { at = [400, 0, 0] }\nbox = { at = [250, 0, 0], size = [300, 30, 30] }\n";

/// A post that only the long tool reaches, at 30 degrees.
fn post(what: &str) -> String {
    let (y, x) = 30.0_f64.to_radians().sin_cos();
    format!("{what}\nbase = [{:.3}, {:.3}, 0]\nradius = 60\nheight = 1000\n", 1000.0 * x, 1000.0 * y)
}

fn object() -> String {
    post("[object.post]\nshape = \"cylinder\"").replace("base =", "at =").replace(", 0]\nradius", ", 500]\nradius")
}

fn region() -> String {
    post("[region.post]\nshape = \"cylinder\"\nwarning = 50") + "[monitor]\nstopping_distance = true\n"
}

const SWING: &str = "{ move = \"joint\", to = [60, 0, -100] },";
const USE_LONG: &str = "{ tool = \"long\" },";

#[test]
fn linear_moves_lead_the_tcp_of_the_active_tool() {
    // The long tool on the forearm, which is a second flange.
    let tools = format!("{SHORT}{LONG}flange = \"link_2\"\n");
    let line = "{ move = \"linear\", to = { at = [450, 300, 500], rpy = [0, 0, 60] }, speed = 200 },";
    let text = cell(&tools, "", &format!("{{ move = \"joint\", to = [20, 40, -80] }},\n{line}\n{USE_LONG}\n{SWING}"));
    let outcome = run(&text);
    let track = &outcome.recording.robots[0];
    assert!(track.finished && track.flange == "short", "{:?}", track.ending);
    let (cell, mut state) = (parse(&text), elbowroom_kinematics::ChainState::new(&parse(&text).robots[0].robot.chain));
    let changed = outcome.recording.events.iter().find(|e| e.event.name() == "tool").expect("the event").t_s;
    let mut on_target = false;
    for s in &track.samples {
        state.q.copy_from_slice(&s.q);
        cell.robots[0].robot.chain.forward(&mut state);
        let link = |name: &str| state.link_in_root(cell.robots[0].robot.chain.link(name).unwrap());
        let short = link("link_3").transform_point(Vec3::Z * -0.02);
        let long = link("link_2").transform_point(Vec3::X * 0.4);
        let expected = if s.t_s < changed { short } else { long } + Vec3::Z * 0.6;
        assert!(s.tcp.distance(expected) < 1e-12, "{} s: {:?}, not {expected:?}", s.t_s, s.tcp);
        on_target |= s.t_s < changed && s.tcp.distance(Vec3::new(0.45, 0.3, 0.5)) < 1e-6;
    }
    assert!(on_target, "the line did not end at its target");
}

#[test]
fn mounted_tools_count_whichever_is_active() {
    let tools = format!("{SHORT}{LONG}flange = \"link_2\"\n");
    for steps in [SWING.to_owned(), format!("{USE_LONG}\n{SWING}")] {
        let hit = run_free(&cell(&tools, &region(), &steps));
        assert!(hit.recording.regions[0].entered, "{steps}");
        let held = run(&cell(&tools, &region(), &steps));
        let ending = &held.recording.robots[0].ending;
        assert!(!held.recording.regions[0].entered && ending.part.as_deref() == Some("long"), "{ending:?}");
        let object = run_free(&cell(&tools, &object(), &steps));
        assert_eq!(object.recording.robots[0].collisions[0].a, "arm/long");
    }
}

#[test]
fn a_tool_that_is_not_mounted_counts_from_its_change_on() {
    let tools = format!("{SHORT}{LONG}mounted = false\n");
    let back = "{ move = \"joint\", to = [0, 0, -100] },";
    let object = object();
    let without = format!("{SWING}\n{back}");
    let with = format!("{SWING}\n{back}\n{USE_LONG}\n{SWING}");
    let off_again = format!("{USE_LONG}\n{{ tool = \"short\" }},\n{SWING}");
    for steps in [&without, &off_again] {
        let free = run(&cell(&tools, &region(), steps));
        let region = &free.recording.regions[0];
        assert!(free.recording.robots[0].finished && region.min_distance_m.unwrap() > 0.19, "{steps}: {region:?}");
        assert!(run(&cell(&tools, &object, steps)).recording.robots[0].collisions.is_empty(), "{steps}");
    }
    let held = run(&cell(&tools, &region(), &with));
    let ending = &held.recording.robots[0].ending;
    assert!(!held.recording.regions[0].entered && ending.part.as_deref() == Some("long"), "{ending:?}");
    assert!(run_free(&cell(&tools, &region(), &with)).recording.regions[0].entered);
    let hit = run_free(&cell(&tools, &object, &with));
    assert_eq!(hit.recording.robots[0].collisions[0].a, "arm/long");
    // The recording shows the long tool from the change on.
    let changed = hit.recording.events.iter().find(|e| e.event.name() == "tool").unwrap().t_s;
    let chain = parse(&cell(&tools, "", SWING)).robots[0].robot.chain.clone();
    let [long, short] = ["long", "short"].map(|name| chain.link(name).unwrap());
    assert_eq!(hit.recording.robots[0].absent_links, [(0.0, vec![long]), (changed, vec![short])]);
    assert!(check(&parse(&cell(&tools, &region(), &with))).unwrap()[0].excluded);
}

#[test]
fn planned_moves_know_the_tools_of_their_time() {
    let tools = format!("{SHORT}{LONG}mounted = false\n");
    let planned = "{ move = \"planned\", to = [60, 0, -100] },";
    let outcome = run(&cell(&tools, &region(), &format!("{USE_LONG}\n{planned}")));
    let region = &outcome.recording.regions[0];
    assert!(
        outcome.recording.robots[0].finished && !region.entered && region.min_distance_m.unwrap() < 0.5,
        "{region:?}"
    );
}

/// The same step from the same place with the same active tool, while another flange carries a different tool.
#[test]
fn a_planned_move_is_searched_again_for_other_tools() {
    let wire = "[robot.arm.tools.wire]\ntcp = { at = [50, 0, 0] }\nbox = { at = [-150, 0, 60], size = [20, 20, 20] }\nflange = \"link_2\"\n";
    let tools = format!("{SHORT}{LONG}mounted = false\n{wire}");
    let steps = format!(
        "{{ tool = \"wire\" }},\n{{ move = \"planned\", to = [60, 0, -100] }},\n{USE_LONG}\n{{ move = \"planned\", to = [0, 0, -100] }},"
    );
    let twice = cell(&tools, &object(), &steps) + "repeat = 2\n";
    let outcome = run_free(&twice);
    let robot = &outcome.recording.robots[0];
    assert!(robot.finished && robot.collisions.is_empty(), "{:?} {:?}", robot.ending, robot.collisions);
}

#[test]
fn a_tool_grips_with_its_own_link() {
    let part = "[object.part]\nshape = \"box\"\nat = [1135, 0, 500]\nsize = [60, 60, 60]\n";
    let tools = format!("{SHORT}{LONG}mounted = false\n");
    let grip = "{ grip = \"part\" },";
    let carried = run(&cell(&tools, part, &format!("{USE_LONG}\n{grip}\n{SWING}")));
    let poses = &carried.recording.objects[0].poses;
    let (angle, last) = (60.0_f64.to_radians(), poses.last().unwrap().translation);
    assert!(last.distance(Vec3::new(1.135 * angle.cos(), 1.135 * angle.sin(), 0.5)) < 1e-6, "{last:?}");
    let e =
        elbowroom_sim::simulate(&parse(&cell(&tools, part, grip)), &elbowroom_sim::RunOptions::default()).unwrap_err();
    assert!(e.to_string().contains("grips \"part\", which is"), "{e}");
    let off = format!("{USE_LONG}\n{grip}\n{{ tool = \"short\" }},");
    let e =
        elbowroom_sim::simulate(&parse(&cell(&tools, part, &off)), &elbowroom_sim::RunOptions::default()).unwrap_err();
    assert!(e.to_string().contains("takes off the tool that holds \"part\""), "{e}");
}
