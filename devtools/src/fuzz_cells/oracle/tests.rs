//! Tests of the oracle: it must find planted violations, and nothing else.

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;
use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Cylinder, Shape, Sphere, separation};
use elbowroom_sim::{RunOptions, RunOutcome, simulate};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::frame::Frame;
use super::solid::OracleSolid;
use super::{Arm, Finding, Findings, Promises, check};
use crate::fuzz_cells::random::Random;

const HEAD: &str =
    "version = 1\nunits = { length = \"m\", angle = \"rad\" }\ntick_ms = 4\n[monitor]\nstopping_distance = true\n";

fn rail(name: &str, y: f64, from: f64, to: f64) -> String {
    format!(
        "[robot.{name}]\nbase = {{ at = [0, {y}, 0], rpy = [0, 1.5707963267948966, 0] }}\nstart = [{from}]\n\
         dh = [{{ kind = \"prismatic\", min = -3, max = 3, speed = 2, acceleration = 8 }}]\n\
         links = [{{ sphere = {{ radius = 0.02 }} }}]\n[program.{name}]\nsteps = [{{ move = \"joint\", to = [{to}] }}]\n"
    )
}

fn plate(x: f64, thickness: f64, kind: &str) -> String {
    format!(
        "[region.plate]\nshape = \"box\"\nbase = [{x}, 0, -0.5]\nsize = [{thickness}, 2, 1]\nkind = \"{kind}\"\nwarning = 0.3\n"
    )
}

fn run(text: &str, monitored: bool) -> (Cell, RunOutcome) {
    let cell = Cell::parse("test.toml", &format!("{HEAD}{text}")).unwrap();
    let outcome = simulate(&cell, &RunOptions { apply_override: monitored, ..RunOptions::default() }).unwrap();
    (cell, outcome)
}

fn findings(text: &str, monitored: bool) -> Vec<Finding> {
    let (cell, outcome) = run(text, monitored);
    check(&cell, &outcome.recording, &Promises::none(&cell), outcome.has_violation()).list
}

fn vector(random: &mut Random, most: f64) -> Vec3 {
    let [x, y, z] = random.vector(most);
    Vec3::new(x, y, z)
}

fn pose(random: &mut Random) -> Pose {
    Pose::new(Rotation::from_rotation_vector(vector(random, 2.0)), vector(random, 1.0))
}

fn shape(random: &mut Random) -> Shape {
    let (radius, half_length) = (random.between(0.01, 0.3), random.between(0.01, 0.3));
    match random.whole(0, 4) {
        0 => Shape::Sphere(Sphere { radius }),
        1 => Shape::Capsule(Capsule { half_length, radius }),
        2 => Shape::Cylinder(Cylinder { half_length, radius }),
        3 => Shape::Cuboid(Cuboid { half_extents: Vec3::new(radius, half_length, random.between(0.001, 0.3)) }),
        _ => {
            let points: Vec<Vec3> = (0..8).map(|_| vector(random, 0.4)).collect();
            Shape::Hull(std::sync::Arc::new(ConvexHull::from_points(&points).unwrap()))
        }
    }
}

#[test]
fn distances_are_those_of_the_kernels() {
    let mut random = Random::of_case(3, 0);
    let mut apart = 0;
    for _ in 0..3000 {
        let (a, b, pa, pb) = (shape(&mut random), shape(&mut random), pose(&mut random), pose(&mut random));
        let theirs = separation(&a, &pa, &b, &pb).distance;
        let ours = OracleSolid::eroded(&a, 0.0).distance(
            &Frame::of(&pa),
            &OracleSolid::eroded(&b, 0.0),
            &Frame::of(&pb),
            10.0,
        );
        assert!(ours.lower <= theirs + 1e-9 && theirs <= ours.upper.max(0.0) + 1e-9, "{ours:?} {theirs} {a:?} {b:?}");
        assert!(ours.upper - ours.lower < 1e-6 || ours.upper <= 0.0, "{ours:?} {a:?} {b:?}");
        apart += usize::from(theirs > 0.0);
    }
    assert!(apart > 1000);
}

#[test]
fn frames_are_those_of_the_kernels_and_lever_arms_bound_them() {
    let text = "[robot.r]\nbase = { at = [1, 2, 3], rpy = [0.3, 0.2, 0.1] }\ndh = [\n\
        { a = 0.3, alpha = 1.5, d = 0.2, theta = 0.3 }, { kind = \"prismatic\", a = 0.1, alpha = -0.7, min = -1, max = 1 },\n\
        { a = 0.2, alpha = 0.4, d = -0.1, theta = 1 } ]\nlinks = [[], [], { sphere = { radius = 0.1 } }]\n";
    let cell = Cell::parse("test.toml", &format!("{HEAD}{text}")).unwrap();
    let robot = &cell.robots[0];
    let (arm, chain) = (Arm::new(robot), &robot.robot.chain);
    let mut random = Random::of_case(4, 0);
    let mut state = ChainState::new(chain);
    for _ in 0..200 {
        let q: Vec<f64> = (0..3).map(|_| random.between(-1.0, 1.0)).collect();
        let to: Vec<f64> = q.iter().map(|q| (q + random.between(-0.1, 0.1)).clamp(-1.0, 1.0)).collect();
        state.q.copy_from_slice(&q);
        chain.forward(&mut state);
        let (frames, later) = (arm.frames(&q), arm.frames(&to));
        for link in 0..chain.links().len() {
            let theirs = robot.base_in_world * state.link_in_root(elbowroom_kinematics::LinkId(link));
            let point = vector(&mut random, 0.3);
            assert!((theirs.transform_point(point) - frames[link].point(point)).length() < 1e-12);
            let bound: f64 = arm
                .lever_arms(link, point.length())
                .iter()
                .zip(q.iter().zip(&to))
                .map(|(l, (a, b))| l * (b - a).abs())
                .sum();
            assert!((later[link].point(point) - frames[link].point(point)).length() <= bound + 1e-12);
        }
    }
}

#[test]
fn whoever_drives_in_has_entered_and_whoever_stops_before_has_not() {
    let text = rail("a", 0.0, -2.0, 2.0) + &plate(0.0, 0.5, "forbidden");
    assert_eq!(findings(&text, true), []);
    let found = findings(&text, false);
    let [Finding::Entry { robot: 0, region: 0, t_s, speed }] = found.as_slice() else { panic!("{found:?}") };
    assert!(*t_s > 0.5 && (speed - 2.0).abs() < 1e-6);
}

#[test]
fn a_plate_that_is_jumped_between_two_samples_is_entered() {
    // 8 mm per tick, through a region of 1 mm; the sphere has no size.
    let text =
        (rail("a", 0.0, -2.003, 2.0) + &plate(0.0, 0.001, "forbidden")).replace("radius = 0.02", "radius = 0.0001");
    let (cell, outcome) = run(&text, false);
    let inside = |x: f64| x.abs() < 0.0006;
    assert!(!outcome.recording.robots[0].samples.iter().any(|s| inside(s.q[0])), "a sample fell into the plate");
    let found = check(&cell, &outcome.recording, &Promises::none(&cell), true).list;
    assert!(matches!(found.as_slice(), [Finding::Entry { .. }]), "{found:?}");
}

#[test]
fn whoever_starts_inside_has_not_entered() {
    let text = rail("a", 0.0, 0.1, 2.0) + &plate(0.0, 0.5, "forbidden");
    assert_eq!(findings(&text, false), []);
}

#[test]
fn a_region_that_runs_into_a_robot_that_stands_was_not_entered() {
    let text = rail("a", 0.0, 0.0, 0.0)
        + "[encoder.belt]\nspeed = 0.5\nat = -1\n"
        + &plate(0.0, 0.1, "forbidden")
        + "follow = { encoder = \"belt\" }\n";
    let text = text.replace("steps = [{ move = \"joint\", to = [0] }]", "steps = [{ wait = 3 }]");
    let (cell, outcome) = run(&text, true);
    assert!(outcome.recording.regions[0].entered, "it never came there");
    assert_eq!(check(&cell, &outcome.recording, &Promises::none(&cell), true).list, []);
}

#[test]
fn two_in_one_exchange_region_are_seen() {
    let text = rail("a", 0.0, -2.0, 2.0) + &rail("b", 0.5, 2.0, -2.0) + &plate(0.0, 0.5, "exchange");
    assert_eq!(findings(&text, true), []);
    let found = findings(&text, false);
    assert!(matches!(found.as_slice(), [Finding::TwoInside { region: 0, robots: [0, 1], .. }]), "{found:?}");
}

/// Returns the region of `plate`, carried by a cart along the rails, from behind the first robot.
fn carried_plate(speed: f64) -> String {
    let cart = format!(
        "[object.cart]\nshape = \"sphere\"\nradius = 0.01\nat = [-2.6, 0, 0]\nmotion = {{ via = [[9, 0, 0]], speed = {speed} }}\n"
    );
    cart + &plate(0.0, 0.5, "exchange") + "follow = { object = \"cart\" }\n"
}

#[test]
fn two_that_drive_into_a_region_that_moves_are_seen_and_two_that_it_runs_over_are_not() {
    // Both robots cross the plate, which moves slowly.
    let text = rail("a", 0.0, -1.0, -3.0) + &rail("b", 0.5, -1.2, -2.9) + &carried_plate(0.1);
    let found = findings(&text, false);
    assert!(matches!(found.as_slice(), [Finding::TwoInside { region: 0, robots: [0, 1], .. }]), "{found:?}");
    assert_eq!(findings(&text, true), []);
    // Neither robot moves.
    let still = |name: &str, y: f64| rail(name, y, 0.0, 0.0).replace("{ move", "{ wait = 6 }, { move");
    let (cell, outcome) = run(&(still("a", 0.0) + &still("b", 0.5) + &carried_plate(0.6)), false);
    let findings = check(&cell, &outcome.recording, &Promises::none(&cell), outcome.has_violation());
    assert_eq!((findings.list.len(), findings.unforeseen_entries), (0, 1));
}

#[test]
fn a_deadlock_must_be_reported() {
    // Both start in the region and want to continue in it: it can be granted to neither.
    let text = rail("a", 0.0, -0.1, 2.0) + &rail("b", 0.5, 0.1, -2.0) + &plate(0.0, 0.5, "exchange");
    let (cell, mut outcome) = run(&text, true);
    assert!(outcome.recording.robots.iter().all(|r| !r.finished), "no deadlock");
    let reported = |outcome: &RunOutcome, has_violation| {
        let findings = check(&cell, &outcome.recording, &Promises::none(&cell), has_violation);
        assert_eq!(findings.deadlocks, 1);
        findings.list.is_empty()
    };
    assert!(reported(&outcome, outcome.has_violation()) && !reported(&outcome, false));
    outcome.recording.deadlocks.clear();
    assert!(!reported(&outcome, true));
}

#[test]
fn who_stops_harder_than_it_can_is_seen() {
    let text = rail("a", 0.0, -2.0, 2.0) + &plate(0.0, 0.5, "forbidden");
    let (cell, mut outcome) = run(&text, true);
    let samples = &mut outcome.recording.robots[0].samples;
    let fast = samples.iter().position(|s| s.q[0] > -1.0).unwrap();
    let there = samples[fast].q.clone();
    samples[fast..].iter_mut().for_each(|s| s.q.clone_from(&there));
    let found = check(&cell, &outcome.recording, &Promises::none(&cell), true).list;
    assert!(matches!(found.as_slice(), [Finding::TooHard { robot: 0, joint: 0, .. }]), "{found:?}");
}

/// Makes a carriage that drives along x at up to 2 m/s, and a region 1 m from an object's axis at (0, 0.8, 0).
fn turning(turn: f64, steps: &str) -> String {
    let moves = "steps = [{ move = \"joint\", to = [2.5] }]";
    rail("a", 0.0, -2.5, 2.5).replace(moves, &format!("steps = [{steps}]"))
        + &format!(
            "[object.table]\nshape = \"sphere\"\nradius = 0.01\nat = [0, 0.8, 0]\nmotion = {{ turn = [0, 0, {turn}] }}\n\
             [region.orb]\nshape = \"sphere\"\ncentre = [1, 0, 0]\nradius = 0.3\nwarning = 0.05\nfollow = {{ object = \"table\" }}\n"
        )
}

#[test]
fn whoever_drives_into_a_region_that_turns_has_entered_and_whoever_stands_has_not() {
    let drives = turning(-0.4, "{ move = \"joint\", to = [2.5] }");
    assert_eq!(findings(&drives, true), []);
    let found = findings(&drives, false);
    assert!(matches!(found.as_slice(), [Finding::Entry { robot: 0, region: 0, .. }]), "{found:?}");
    // The robot stands in the path of the region.
    let stands = turning(1.5, "{ wait = 8 }").replace("start = [-2.5]", "start = [0]");
    let (cell, outcome) = run(&stands, true);
    assert!(outcome.recording.regions[0].entered, "it never came there");
    assert_eq!(check(&cell, &outcome.recording, &Promises::none(&cell), true).list, []);
}

#[test]
fn a_region_on_a_hand_that_turns_is_entered_too() {
    let carrier = "[robot.b]\nbase = { at = [0, 0.8, 0] }\nstart = [0]\n\
        dh = [{ a = 1, speed = 0.6, acceleration = 20, min = -7, max = 7 }]\nlinks = [{ sphere = { radius = 0.02 } }]\n\
        [program.b]\nsteps = [{ move = \"joint\", to = [-6.5] }]\n\
        [region.orb]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 0.3\nwarning = 0.05\nrobots = [\"a\"]\nfollow = { robot = \"b\" }\n";
    let text = rail("a", 0.0, -2.5, 2.5).replace("steps = [{ move", "steps = [{ wait = 1.5 }, { move") + carrier;
    assert_eq!(findings(&text, true), []);
    let found = findings(&text, false);
    assert!(matches!(found.as_slice(), [Finding::Entry { robot: 0, region: 0, .. }]), "{found:?}");
}

#[test]
fn what_check_excludes_must_not_happen_whoever_moves() {
    let text = rail("a", 0.0, -2.0, 2.0) + &plate(0.0, 0.5, "forbidden");
    let (cell, outcome) = run(&text, false);
    let found = check(&cell, &outcome.recording, &Promises::new(&cell), true).list;
    assert!(matches!(found.as_slice(), [Finding::Excluded { robot: 0, region: 0, .. }]), "{found:?}");
}

/// Makes a carriage that stops before the plate, and whose second tool reaches into it.
fn exchange_of_tools(kind: &str) -> String {
    let robot = rail("a", 0.0, -2.0, -0.75).replace(
        "to = [-0.75] }",
        "to = [-0.75] }, { wait = 0.5 }, { tool = \"torch\" }, { wait = 0.5 }, { tool = \"gripper\" }, { move = \"joint\", to = [-2] }",
    );
    let tools = "[robot.a.tools.gripper]\ntcp = { at = [0, 0, 0.1] }\n[robot.a.tools.torch]\ntcp = { at = [0, 0, 0.7] }\n\
        box = { at = [0, 0, 0.35], size = [0.1, 0.1, 0.7] }\nmounted = false\n";
    robot + tools + &plate(0.0, 0.5, kind)
}

#[test]
fn a_tool_that_is_not_mounted_is_not_inside_and_one_that_is_exchanged_is() {
    let (cell, outcome) = run(&exchange_of_tools("forbidden"), true);
    let promised = || Promises::promised(&cell, vec![(0, 0)]);
    let found = check(&cell, &outcome.recording, &promised(), true).list;
    let [Finding::Excluded { t_s, .. }] = found.as_slice() else { panic!("{found:?}") };
    let exchanged = outcome.recording.events.iter().find(|e| e.region == "torch").unwrap().t_s;
    assert_eq!(*t_s, exchanged);
    let short = exchange_of_tools("forbidden").replace("{ tool = \"torch\" }, ", "");
    let (cell, outcome) = run(&short, true);
    assert_eq!(check(&cell, &outcome.recording, &Promises::promised(&cell, vec![(0, 0)]), true).list, []);
}

#[test]
fn a_tool_that_is_exchanged_into_an_occupied_region_is_seen() {
    let other = rail("b", 0.5, 2.0, 0.0).replace("to = [0] }", "to = [0] }, { wait = 4 }");
    let (cell, outcome) = run(&(exchange_of_tools("exchange") + &other), true);
    let promised = Promises::promised(&cell, vec![(0, 0), (0, 1)]);
    let found = check(&cell, &outcome.recording, &promised, true).list;
    assert!(matches!(found.as_slice(), [Finding::TwoInside { region: 0, robots: [0, 1], .. }]), "{found:?}");
    // `check` does not exclude it, so it can be foreseen.
    let findings = check(&cell, &outcome.recording, &Promises::none(&cell), true);
    assert_eq!((findings.list.len(), findings.unforeseen_entries), (0, 1));
}

#[test]
fn objects_are_where_their_motion_says_between_ticks_too() {
    let text = turning(1.3, "{ wait = 2 }");
    let (cell, outcome) = run(&text, true);
    let place = super::place::Place::new(&cell, 0, Some(&outcome.recording));
    for i in 0..1000 {
        let t_s = 0.00173 * f64::from(i);
        let center = place.at(t_s, &[]).at;
        let by_hand = Vec3::new((1.3 * t_s).cos(), 0.8 + (1.3 * t_s).sin(), 0.0);
        assert!((center - by_hand).length() < 1e-9, "{t_s} {center:?} {by_hand:?}");
    }
}

/// A guided robot with a tool of 8 mm above a block.
fn guided(extra: &str, folder: &std::path::Path) -> (Cell, RunOutcome) {
    let rows: Vec<String> = (0..=50)
        .map(|k| {
            format!(
                "{},1.1042,0,{},0.887010833178222,0,0.46174861323503386,0,1,0",
                0.02 * f64::from(k),
                1.3588 - 0.002 * f64::from(k)
            )
        })
        .collect();
    let stream = format!("t_s,x,y,z,qx,qy,qz,qw,enable,clutch\n{}\n", rows.join("\n"));
    std::fs::write(folder.join("hand.csv"), stream).unwrap();
    let text = format!(
        "{HEAD}[robot.r0]\nmodel = \"{}/examples/models/ns16/ns16.urdf\"\nstart = [0, 0, 0, 0, 0.6108652, 0]\n\
         [robot.r0.tool]\ntcp = {{ at = [0, 0, 0.1] }}\nbox = {{ at = [0, 0, 0.05], size = [0.008, 0.008, 0.1] }}\n\
         [object.block]\nshape = \"box\"\nsize = [0.4, 0.4, 0.2]\nat = [1.15, 0, 1.2]\n\
         [operator.hand]\nrobot = \"r0\"\nstream = \"hand.csv\"\n{extra}",
        env!("CARGO_MANIFEST_DIR").trim_end_matches("/devtools")
    );
    let cell = Cell::parse(folder.join("guided.toml"), &text).unwrap();
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    (cell, outcome)
}

#[test]
fn a_guided_tool_that_is_too_near_and_energy_that_is_made_are_found() {
    let folder = std::env::temp_dir().join(format!("elbowroom-guided-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let force = "[force.soft]\nbetween = [\"r0/tool\", \"block\"]\nlaw = \"repulsive\"\nrange = 0.02\n";
    let (cell, mut outcome) = guided(force, &folder);
    std::fs::remove_dir_all(&folder).unwrap();
    let findings = |outcome: &RunOutcome| check(&cell, &outcome.recording, &Promises::none(&cell), false).list;
    assert_eq!(findings(&outcome), []);
    let track = &mut outcome.recording.robots[0];
    let last = track.guidance.as_mut().unwrap().samples.last_mut().unwrap();
    last.force.as_mut().unwrap().energy_j -= 2.0;
    assert!(matches!(findings(&outcome)[..], [Finding::EnergyMade { robot: 0, .. }]), "{:?}", findings(&outcome));
    // The second joint leans up or down; down is the block.
    let mut near = 0;
    for by in [0.3, -0.6] {
        outcome.recording.robots[0].samples.last_mut().unwrap().q[1] += by;
        near += findings(&outcome).iter().filter(|f| matches!(f, Finding::TooNear { object: 0, .. })).count();
    }
    assert_eq!(near, 1);
}

#[test]
fn a_shaft_that_leaves_its_point_of_entry_or_its_depth_is_found() {
    let folder = std::env::temp_dir().join(format!("elbowroom-entry-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    // 60 mm behind the tip at the start.
    let port =
        "[fixture.port]\nguide = \"entry\"\ntool = \"r0\"\nat = [1.0550508, 0, 1.3932146]\ndepth = [0.02, 0.09]\n";
    let (cell, mut outcome) = guided(port, &folder);
    std::fs::remove_dir_all(&folder).unwrap();
    let found = |outcome: &RunOutcome| {
        let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
        let mut findings = Findings::default();
        super::entry::check(&cell, &outcome.recording, &arms, &mut findings);
        findings.list
    };
    assert_eq!(found(&outcome), []);
    let q = outcome.recording.robots[0].samples.last().unwrap().q.clone();
    // The last joint turns the tool about its shaft, the fifth tilts it by 0.1 mrad.
    for (joint, by, is_found) in [(5, 0.3, false), (4, 1e-4, true)] {
        let last = outcome.recording.robots[0].samples.last_mut().unwrap();
        last.q.clone_from(&q);
        last.q[joint] += by;
        assert_eq!(matches!(found(&outcome)[..], [Finding::OffEntry { robot: 0, .. }]), is_found, "joint {joint}");
    }
}

#[test]
fn a_work_piece_that_is_dropped_off_its_path_or_seen_wrongly_and_joints_that_are_too_fast_are_found() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut cell = Cell::load(root.join("examples/inspection/cell.toml")).unwrap();
    cell.timing.max_s = 1.0;
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    let found = |recording: &elbowroom_sim::Recording| {
        let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
        let mut findings = Findings::default();
        super::cooperating::check(&cell, recording, &arms, &mut findings);
        findings.list
    };
    assert_eq!(found(&outcome.recording), []);
    let last = outcome.recording.virtual_robots[0].samples.len() - 2;
    let mut dropped = outcome.recording.clone();
    dropped.virtual_robots[0].samples[last].part_in_world.translation.z += 1e-5;
    let list = found(&dropped);
    assert!(matches!(list[..], [Finding::NotHeld { robot: 0, .. }, Finding::OffPath { .. }]), "{list:?}");
    // A share that is wrong, and one that is missing.
    for wrong in [Some(0.6), None] {
        let mut seen = outcome.recording.clone();
        seen.virtual_robots[0].samples.iter_mut().for_each(|s| s.hidden_share = wrong);
        let list = found(&seen);
        assert!(matches!(list[..], [Finding::WrongView { .. }]), "{list:?}");
    }
    let mut fast = outcome.recording.clone();
    fast.robots[1].samples[last].q[0] += 1.1 * cell.robots[1].limits[0].velocity * fast.tick_s;
    let list = found(&fast);
    assert!(matches!(list[..], [Finding::TooFast { robot: 1, .. }]), "{list:?}");
}

#[test]
fn a_wrong_number_of_a_grid_is_found_and_a_right_one_is_not() {
    let grids = "[grid.space]\nfrom = [-0.31, -1, -1]\nto = [0.83, 1, 1]\ncells = [5, 2, 1]\noutput = 3\n\
                 [grid.joint]\njoints = [\"joint_1\"]\nfrom = [0.1]\nto = [0.6]\ncells = [4]\noutput = 40\nhysteresis = 0.03\n";
    let (cell, outcome) = run(&format!("{}{grids}", rail("a", 0.25, -0.5, 1.0)), true);
    let check =
        |outcome: &RunOutcome| check(&cell, &outcome.recording, &Promises::none(&cell), outcome.has_violation()).list;
    assert_eq!(check(&outcome), []);
    let samples = &outcome.recording.robots[0].samples;
    let number = |i: usize, at: u8| samples[i].outputs >> at & 7;
    let seen: Vec<u64> = (0..=4).filter(|n| (0..samples.len()).any(|i| number(i, 40) == *n)).collect();
    assert_eq!(seen, [0, 1, 2, 3, 4], "the rail passes all of them");
    for (bit, from) in [(1_u64 << 3, 0), (1 << 40, samples.len() / 2)] {
        let mut wrong = outcome.clone();
        wrong.recording.robots[0].samples[from..].iter_mut().for_each(|s| s.outputs ^= bit);
        assert!(matches!(check(&wrong)[..], [Finding::WrongCell { .. }]), "{:?}", check(&wrong));
    }
    // One division is left late: at the next border but one.
    let mut late = outcome.clone();
    let change = (1..samples.len()).find(|i| number(*i, 40) == 2 && number(i - 1, 40) == 1).unwrap();
    for s in &mut late.recording.robots[0].samples[change..change + 3] {
        s.outputs = s.outputs & !(7 << 40) | 1 << 40;
    }
    assert!(matches!(check(&late)[..], [Finding::WrongCell { .. }]), "{:?}", check(&late));
}
