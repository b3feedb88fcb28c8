//! Regions count gripped parts, from the grip to the release.

use crate::common::{HEAD, parse, run, run_free};
use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;
use elbowroom_proximity::separation;
use elbowroom_sim::check::check;
use elbowroom_sim::{Outcome, PartKind, Recording, RegionPoses, RunOptions, RunOutcome, simulate};
use elbowroom_testkit::random::Random;

/// An arm with a slide at its end, which carries a bar of this length (mm) from 0 to 60 degrees, 420 mm above the floor.
fn cell(bar_mm: f64, more: &str, with_grip: bool) -> String {
    let grip = if with_grip { ["{ grip = \"bar\" },", "{ release = \"bar\" },"] } else { [""; 2] };
    format!(
        "{HEAD}[robot.arm]\n\
         dh = [{{ a = 400, min = -170, max = 170, speed = 90 }}, {{ a = 300, min = -170, max = 170, speed = 90 }}, \
         {{ kind = \"prismatic\", min = -400, max = 0, speed = 500 }}]\n\
         links = [[], {{ capsule = {{ from = [-300, 0, 0], to = [0, 0, 0], radius = 40 }} }}, \
         {{ capsule = {{ from = [0, 0, 0], to = [0, 0, 300], radius = 20 }} }}]\n\
         base = {{ at = [0, 0, 600] }}\nstart = [0, 0, -100]\n\
         [object.bar]\nshape = \"box\"\nat = [700, 0, 250]\nsize = [{bar_mm}, 60, 100]\n{more}\n\
         [program.arm]\nsteps = [\n{{ move = \"joint\", to = [0, 0, -270] }},\n{}\n\
         {{ move = \"joint\", to = [0, 0, -100] }},\n{{ move = \"joint\", to = [60, 0, -100] }},\n{}\n\
         {{ move = \"joint\", to = [0, 0, -100] }},\n]\n",
        grip[0], grip[1]
    )
}

/// A post that the end of a bar of 700 mm hits, and the arm does not.
fn post(more: &str) -> String {
    let (y, x) = 30.0_f64.to_radians().sin_cos();
    format!(
        "[region.post]\nshape = \"cylinder\"\nbase = [{:.3}, {:.3}, 0]\nradius = 60\nheight = 1000\nwarning = 50\n{more}\n",
        1000.0 * x,
        1000.0 * y
    )
}

const STOPPING: &str = "[monitor]\nstopping_distance = true\n";

/// Smallest distance (m) of any solid of the robot from the first region over all ticks of a run.
///
/// The bar is such a solid from its grip to its release. Computed from the recorded joint values and the recorded poses
/// of the bar, without a monitor.
fn brute_force_m(cell: &Cell, r: &Recording) -> f64 {
    let at = |name: &str| r.events.iter().find(|e| e.event.name() == name).map(|e| e.t_s);
    let (grip, release) = (at("grip").unwrap_or(f64::INFINITY), at("release").unwrap_or(f64::INFINITY));
    let (robot, region) = (&cell.robots[0], &r.regions[0]);
    let RegionPoses::Fixed(region_in_world) = &region.poses else { panic!("it moves") };
    let mut state = ChainState::new(&robot.robot.chain);
    let mut least = f64::INFINITY;
    for (tick, sample) in r.robots[0].samples.iter().enumerate() {
        state.q.copy_from_slice(&sample.q);
        robot.robot.chain.forward(&mut state);
        for (link, colliders) in robot.robot.colliders.iter().enumerate() {
            for c in colliders {
                let in_world = robot.base_in_world * state.link_in_root(elbowroom_kinematics::LinkId(link)) * c.in_link;
                least = least.min(separation(&c.shape, &in_world, &region.shape, region_in_world).distance);
            }
        }
        if (grip..=release).contains(&sample.t_s) {
            let (bar, pose) = (&cell.objects[0], &r.objects[0].poses[tick]);
            least = least.min(separation(&bar.shape, pose, &region.shape, region_in_world).distance);
        }
    }
    least
}

#[track_caller]
fn assert_distance(cell: &str, outcome: &RunOutcome) -> f64 {
    let expected = brute_force_m(&parse(cell), &outcome.recording);
    let found = outcome.recording.regions[0].min_distance_m.unwrap();
    // The run also measures between two ticks.
    assert!(found <= expected + 1e-9 && found > expected - 0.01, "{found} m, by brute force {expected} m");
    found
}

#[test]
fn a_bar_enters_where_the_empty_hand_does_not() {
    for laws in ["", STOPPING, "[monitor]\nstopping_distance = true\ndirection_aware = true\n"] {
        let (empty, loaded) = (cell(700.0, &post(laws), false), cell(700.0, &post(laws), true));
        let (free, hit) = (run_free(&empty), run_free(&loaded));
        assert!(!free.has_violation() && assert_distance(&empty, &free) > 0.19);
        assert!(hit.has_violation() && hit.recording.regions[0].entered);
        assert_eq!(assert_distance(&loaded, &hit), 0.0);
    }
}

#[test]
fn the_monitor_stops_the_bar_before_the_border_and_names_it() {
    for laws in [STOPPING, "[monitor]\nstopping_distance = true\ndirection_aware = true\n"] {
        let text = cell(700.0, &post(laws), true);
        let outcome = run(&text);
        let (robot, region) = (&outcome.recording.robots[0], &outcome.recording.regions[0]);
        assert!(!outcome.has_violation() && !region.entered && region.warned_s > 0.0);
        let distance = assert_distance(&text, &outcome);
        assert!(distance > 0.0 && distance < 0.01, "{distance}");
        let e = &robot.ending;
        assert_eq!((e.outcome, e.by.as_deref(), e.part.as_deref()), (Outcome::Stopped, Some("post"), Some("bar")));
        assert_eq!(e.part_kind, Some(PartKind::Load));
        assert!(e.point.unwrap().length() > 0.9, "the end of the bar: {:?}", e.point);
        // The empty hand is not held back.
        assert!(run(&cell(700.0, &post(laws), false)).recording.robots[0].finished);
    }
}

#[test]
fn it_counts_for_tool_and_arm_and_not_for_the_tcp() {
    for (guards, counts) in [("\"tool\"", true), ("\"arm\"", true), ("\"tcp\"", false)] {
        let outcome = run_free(&cell(700.0, &post(&format!("guards = [{guards}]")), true));
        assert_eq!(outcome.recording.regions[0].entered, counts, "{guards}");
    }
    // For a robot without a tool, the gripped part is the tool.
    let refused = Cell::parse("c.toml", &cell(700.0, &post("guards = [\"tool\"]"), false)).unwrap_err();
    assert!(refused.to_string().contains("no tool and no load"), "{refused}");
}

#[test]
fn random_bars_and_posts_are_never_entered_and_measured_as_by_brute_force() {
    let mut r = Random(7);
    let (mut stopped, mut finished) = (0, 0);
    for _ in 0..24 {
        let angle = r.between(0.5, 1.2);
        let far = r.between(800.0, 1250.0);
        let place = format!(
            "[region.ball]\nshape = \"sphere\"\ncentre = [{:.3}, {:.3}, {:.3}]\nradius = {:.3}\nwarning = 80\n{STOPPING}\
             direction_aware = {}\n",
            far * angle.cos(),
            far * angle.sin(),
            r.between(300.0, 600.0),
            r.between(10.0, 60.0),
            r.between(0.0, 1.0) < 0.5
        );
        let text = cell(r.between(300.0, 900.0), &place, true);
        let outcome = run(&text);
        assert!(!outcome.recording.regions[0].entered, "{text}");
        assert!(assert_distance(&text, &outcome) > 0.0, "{text}");
        if outcome.recording.robots[0].finished { finished += 1 } else { stopped += 1 }
    }
    assert!(stopped > 4 && finished > 4, "{stopped} stopped, {finished} finished");
}

#[test]
fn a_released_bar_does_not_count() {
    // The bar is left at 15 degrees; without it the arm moves past the post.
    let text = cell(700.0, &post(STOPPING), true)
        .replace("{ move = \"joint\", to = [60, 0, -100] },", "{ move = \"joint\", to = [15, 0, -100] },")
        .replace("{ release = \"bar\" },", "{ release = \"bar\" },\n{ move = \"joint\", to = [60, 0, -100] },");
    let outcome = run(&text);
    assert!(outcome.recording.robots[0].finished, "{:?}", outcome.recording.robots[0].ending);
    assert_distance(&text, &outcome);
}

#[test]
fn a_bar_gripped_inside_a_region_holds_the_arm_until_its_program_leads_out() {
    let bin = "[region.bin]\nshape = \"box\"\nfrom = [950, -100, 0]\nto = [1200, 100, 300]\nwarning = 20\n";
    let laws = |aware: bool| format!("{bin}{STOPPING}direction_aware = {aware}\n");
    let held = run(&cell(700.0, &laws(false), true));
    let robot = &held.recording.robots[0];
    assert!(held.recording.regions[0].entered && !robot.finished);
    assert_eq!(robot.ending.part.as_deref(), Some("bar"));
    assert!(robot.ending.release.as_ref().unwrap().contains("direction_aware"));
    let q = &robot.samples.last().unwrap().q;
    assert!((q[2] + 0.27).abs() < 1e-6, "it moved with the bar inside: {q:?}");
    // Up and out of it, slowly.
    let leaves = run(&cell(700.0, &laws(true), true));
    assert!(leaves.recording.robots[0].finished && leaves.recording.regions[0].entered);
}

#[test]
fn check_knows_the_lever_of_the_bar_and_where_it_is_gripped() {
    let of = |text: &str| check(&parse(text)).unwrap().remove(0);
    let without = of(&cell(700.0, &post(""), false));
    let with = of(&cell(700.0, &post(""), true));
    let [short, long] = [&without, &with].map(|c| c.needed_warning_m.unwrap());
    assert!(long > 1.2 * short, "{short} m without the bar, {long} m with it");
    let stopping = of(&cell(700.0, &post(STOPPING), true));
    assert!(stopping.excluded, "{}", stopping.reason);
    let bin = "[region.bin]\nshape = \"box\"\nfrom = [950, -100, 0]\nto = [1200, 100, 300]\nwarning = 20\n";
    let inside = of(&cell(700.0, &format!("{bin}{STOPPING}"), true));
    assert!(!inside.excluded && inside.reason.contains("grips \"bar\" inside"), "{}", inside.reason);
    assert!(of(&cell(700.0, &format!("{bin}{STOPPING}"), false)).excluded);
}

#[test]
fn avoidance_keeps_what_is_held_clear_of_obstacles() {
    let (y, x) = 30.0_f64.to_radians().sin_cos();
    let post = format!(
        "[object.post]\nshape = \"cylinder\"\nat = [{:.3}, {:.3}, 500]\nradius = 60\nheight = 1000\n\
         [avoidance.arm]\nobjects = [\"post\"]\n",
        1000.0 * x,
        1000.0 * y
    );
    let text = cell(700.0, &post, true);
    let evaded = run(&text);
    let robot = &evaded.recording.robots[0];
    assert!(robot.finished && robot.collisions.is_empty(), "{:?}", robot.collisions);
    let without = RunOptions { avoidance: false, ..RunOptions::default() };
    let hit = simulate(&parse(&text), &without).unwrap();
    let collision = &hit.recording.robots[0].collisions[0];
    assert_eq!((collision.a.as_str(), collision.b.as_str()), ("arm/bar", "post"));
    // The empty hand needs no evasion.
    assert!(!simulate(&parse(&cell(700.0, &post, false)), &without).unwrap().has_violation());
}
