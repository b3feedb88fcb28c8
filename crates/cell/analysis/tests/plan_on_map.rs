//! Paths through the free cells of a map: what they are, and why there is none.

use elbowroom_analysis::map::{MapRequest, map};
use elbowroom_analysis::plan::{PathAnswer, PathGoal, PathPlanner, PathRequest, plan};
use elbowroom_cell::{Cell, TcpTarget};
use elbowroom_formats::FormatError;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::ObjectId;
use elbowroom_spatial::Pose;

use crate::common::parse;

/// An arm of three joints that reaches 1 m, a post before it, and room for tables.
const ARM: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ d = 400, alpha = 90, min = -170, max = 170, speed = 90 },
      { a = 500, min = -30, max = 150, speed = 90 }, { a = 450, min = -150, max = 30, speed = 90 }]
links = [[], { capsule = { from = [-500, 0, 0], to = [0, 0, 0], radius = 50 } },
         { capsule = { from = [-450, 0, 0], to = [0, 0, 0], radius = 40 } }]
start = [-60, 20, -40]
[object.post]
shape = "box"
at = [700, 0, 400]
size = [100, 100, 800]
"#;

const START: [f64; 3] = [-1.0, 0.3, -0.6];
const GOAL: [f64; 3] = [1.0, 0.3, -0.6];

fn asked(cell: &Cell, from: &[f64], to: &[f64]) -> Result<PathAnswer, FormatError> {
    let planner = PathPlanner::Grid;
    plan(cell, &PathRequest { planner, from: Some(from.into()), to: to.into(), ..PathRequest::default() })
}

#[test]
fn a_path_goes_around_through_free_cells_and_its_samples_too() {
    let cell = parse(ARM);
    let answer = asked(&cell, &START, &GOAL).unwrap();
    let motion = answer.motion.as_ref().expect("the arm can fold");
    assert!(motion.waypoints.len() > 2 && answer.map_time.is_some() && answer.found);
    let map = map(&cell, &MapRequest::default()).unwrap();
    let is_free = |q: &[f64]| map.obstacles.iter().all(|o| !o.blocks.is_blocked(q));
    for pair in motion.waypoints.windows(2) {
        for share in (0..=100).map(|n| f64::from(n) / 100.0) {
            let q: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(a, b)| a + (b - a) * share).collect();
            assert!(is_free(&q), "{q:?}");
        }
    }
    let (first, last) = (&motion.rows[0].1, &motion.rows[motion.rows.len() - 1].1);
    assert_eq!((&first[..], &last[..]), (&START[..], &GOAL[..]));
    // The straight path leads through the post.
    assert!(!is_free(&[0.0, 0.3, -0.6]));
}

#[test]
fn joints_that_are_not_in_the_map_stay_where_they_are() {
    let wrist = ARM
        .replace("speed = 90 }]\nlinks", "speed = 90 },\n      { a = 100, min = -90, max = 90, speed = 90 }]\nlinks");
    let wrist = wrist.replace("radius = 40 } }]", "radius = 40 } },\n         { sphere = { radius = 30 } }]");
    let cell = parse(&wrist.replace("start = [-60, 20, -40]", "start = [-60, 20, -40, 0]"));
    let with = |q: [f64; 3], wrist: f64| [q[0], q[1], q[2], wrist];
    let answer = asked(&cell, &with(START, 0.4), &with(GOAL, 0.4)).unwrap();
    assert!(answer.motion.expect("a path").rows.iter().all(|(_, q)| q[3] == 0.4));
    let moved = asked(&cell, &with(START, 0.4), &with(GOAL, 0.0)).unwrap_err().to_string();
    assert!(moved.contains("`joint_4`") && moved.contains("--planner rrt-connect"), "{moved}");
    // A map with the wrist at its start says nothing of others.
    let held = parse(&format!("{}\n[map.arm]\nothers = \"start\"\n", wrist.replace("-40]", "-40, 0]")));
    let elsewhere = asked(&held, &with(START, 0.4), &with(GOAL, 0.4)).unwrap_err().to_string();
    assert!(elsewhere.contains("others = \"any\""), "{elsewhere}");
    assert!(asked(&held, &with(START, 0.0), &with(GOAL, 0.0)).unwrap().found);
}

#[test]
fn why_there_is_no_path_is_said() {
    let no_path = |cell: &str, from: &[f64], to: &[f64]| {
        let answer = asked(&parse(cell), from, to).unwrap();
        assert!(!answer.found && answer.motion.is_none());
        answer.reason.expect("a reason")
    };
    // From beside the post towards it: first free, then near it in a blocked cell, then in it.
    let coarse = parse(&format!("{ARM}[map.arm]\nstep = 10\n"));
    let goals = (0..100).map(|n| [1.0 - 0.01 * f64::from(n), 0.3, -0.6]);
    let answers: Vec<_> = goals.map(|goal| asked(&coarse, &START, &goal)).collect();
    let near = answers.iter().position(|a| a.as_ref().is_ok_and(|a| !a.found)).expect("a blocked cell");
    let hit = answers.iter().position(Result::is_err).expect("a contact");
    assert!(answers[..near].iter().all(|a| a.as_ref().is_ok_and(|a| a.found)) && near < hit);
    let reason = answers[near].as_ref().ok().and_then(|a| a.reason.clone()).unwrap();
    assert!(reason.contains("goal is in a blocked cell") && reason.contains("[map.arm]"), "{reason}");
    assert!(answers[hit].as_ref().unwrap_err().to_string().contains("`post` are in collision"));
    // Right before the column; the upper arm does not come over it.
    let wall = "[object.wall]\nshape = \"box\"\nat = [1650, 0, 900]\nsize = [2900, 20, 3000]\n";
    let stiff = ARM.replace("min = -170, max = 170", "min = -80, max = 80").replace("max = 150", "max = 60");
    let apart = no_path(&format!("{stiff}{wall}"), &START, &GOAL);
    assert!(apart.contains("are not joined"), "{apart}");
}

#[test]
fn what_a_map_does_not_know_is_tested_afterwards() {
    let free = ARM.split("[object.post]").next().unwrap();
    let refused = |more: &str| {
        let answer = plan(
            &parse(&format!("{free}{more}")),
            &PathRequest {
                planner: PathPlanner::Grid,
                robot: Some("arm".into()),
                from: Some(START.into()),
                to: GOAL[..].into(),
                ..PathRequest::default()
            },
        );
        answer.unwrap().reason.expect("no path")
    };
    let region = "[region.press]\nshape = \"box\"\nfrom = [700, -100, 0]\nto = [900, 100, 800]\n";
    let closed = refused(region);
    assert!(closed.contains("near to a region") && closed.contains("--planner rrt-connect"), "{closed}");
    let other = "[robot.post]\ndh = [{ kind = \"prismatic\", min = 0, max = 100, speed = 100 }]\n\
                 links = [{ sphere = { radius = 300 } }]\nbase = { at = [800, 0, 400], rpy = [0, 0, 0] }\n";
    let hit = refused(other);
    assert!(hit.contains("post/") && hit.contains("arm/"), "{hit}");
    // What concerns others does not concern the path: a robot that stands in an object.
    let apart = "[robot.post]\ndh = [{ kind = \"prismatic\", min = 0, max = 100, speed = 100 }]\n\
                 links = [{ sphere = { radius = 300 } }]\nbase = { at = [5000, 0, 400], rpy = [0, 0, 0] }\n\
                 [object.bench]\nshape = \"box\"\nat = [5000, 0, 400]\nsize = [100, 100, 100]\n";
    let cell = parse(&format!("{free}{apart}"));
    let request = PathRequest {
        robot: Some("arm".into()),
        from: Some(START.into()),
        to: GOAL[..].into(),
        ..PathRequest::default()
    };
    assert!(plan(&cell, &PathRequest { planner: PathPlanner::Grid, ..request }).unwrap().found);
    assert!(asked(&parse(free), &START, &GOAL).unwrap().motion.is_some_and(|m| m.waypoints.len() == 2));
}

#[test]
fn of_the_solutions_for_a_pose_one_that_is_reached_is_taken() {
    let cell = parse(ARM);
    let at = |q: &[f64]| {
        let robot = &cell.robots[0];
        let mut state = ChainState::new(&robot.robot.chain);
        state.q.copy_from_slice(q);
        robot.robot.chain.forward(&mut state);
        robot.base_in_world * state.link_in_root(robot.flange) * robot.tcp_in_flange
    };
    let to = PathGoal::Tcp(TcpTarget::from(at(&GOAL)));
    let request = PathRequest { planner: PathPlanner::Grid, from: Some(START.into()), to, ..PathRequest::default() };
    let motion = plan(&cell, &request).unwrap().motion.expect("a path");
    let end = at(&motion.rows[motion.rows.len() - 1].1);
    assert!((end.translation - at(&GOAL).translation).length() < 1e-5);
}

#[test]
fn objects_that_are_elsewhere_are_refused() {
    let (cell, planner) = (parse(ARM), PathPlanner::Grid);
    let placed = vec![(ObjectId(0), Pose::IDENTITY)];
    let request = PathRequest { planner, placed, to: GOAL[..].into(), ..PathRequest::default() };
    assert!(plan(&cell, &request).unwrap_err().to_string().contains("--planner rrt-connect"));
}

#[test]
fn a_map_of_other_than_three_joints_is_refused() {
    let two = parse(&format!("{ARM}[map.arm]\njoints = [\"joint_1\", \"joint_2\"]\n"));
    let message = asked(&two, &START, &GOAL).unwrap_err().to_string();
    assert!(
        message.contains("has 2 joints") && message.contains("joints = [\"joint_1\", \"joint_2\", \"joint_3\"]"),
        "{message}"
    );
}
