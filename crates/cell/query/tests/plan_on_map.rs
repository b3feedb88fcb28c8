//! Paths through the free cells of a map, and the reasons if no path is found.

use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel, TcpTarget};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::{ChainState, TrajectoryRow};
use elbowroom_planner::RrtConnectSettings;
use elbowroom_query::map::{MapRequest, map};
use elbowroom_query::plan::{PathAnswer, PathGoal, PathPlanner, PathRequest, plan};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, SceneState, Selection};
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

fn asked(cell: &Cell, from: &[f64], to: &[f64]) -> Result<PathAnswer, Diagnostic> {
    let planner = PathPlanner::Grid;
    plan(cell, &PathRequest { planner, from: Some(from.into()), to: to.into(), ..PathRequest::default() })
}

#[test]
fn a_path_goes_around_through_free_cells_and_its_samples_too() {
    let cell = parse(ARM);
    let answer = asked(&cell, &START, &GOAL).unwrap();
    let timed = answer.timed.as_ref().expect("the arm can fold");
    assert!(timed.path.waypoints.len() > 2 && answer.map_time.is_some() && answer.found);
    let map = map(&cell, &MapRequest::default()).unwrap();
    let is_free = |q: &[f64]| map.obstacles.iter().all(|o| !o.blocks.is_blocked(q));
    for pair in timed.path.waypoints.windows(2) {
        for share in (0..=100).map(|n| f64::from(n) / 100.0) {
            let q: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(a, b)| a + (b - a) * share).collect();
            assert!(is_free(&q), "{q:?}");
        }
    }
    assert_eq!((timed.trajectory.first(), timed.trajectory.last()), (Some(&START[..]), Some(&GOAL[..])));
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
    assert!(answer.timed.expect("a path").trajectory.rows().iter().all(|row| row.q[3] == 0.4));
    let moved = asked(&cell, &with(START, 0.4), &with(GOAL, 0.0)).unwrap_err().to_string();
    assert!(moved.contains("`joint_4`") && moved.contains("planner rrt-connect"), "{moved}");
    // The map is valid for the present wrist: a finger that would touch the shelf if it were turned down is held level.
    let finger =
        wrist.replace("sphere = { radius = 30 }", "capsule = { from = [0, 0, 0], to = [200, 0, 0], radius = 20 }");
    let shelf = "[object.shelf]\nshape = \"box\"\nat = [0, 0, 200]\nsize = [3000, 3000, 20]\n";
    let cell = parse(&format!("{}{shelf}", finger.replace("-40]", "-40, 0]")));
    let swept = map(&cell, &MapRequest::default()).unwrap();
    assert!(swept.obstacles[1].blocks.is_blocked(&START));
    assert!(asked(&cell, &with(START, 0.3), &with(GOAL, 0.3)).unwrap().found);
}

#[test]
fn why_there_is_no_path_is_said() {
    let no_path = |cell: &str, from: &[f64], to: &[f64]| {
        let answer = asked(&parse(cell), from, to).unwrap();
        assert!(!answer.found && answer.timed.is_none());
        answer.reason.expect("a reason")
    };
    // From beside the post towards it: first in free cells, then near it in a blocked cell that is left for a free one,
    // then in it.
    let cell = parse(&format!("{ARM}[map.arm]\nstep = 10\n"));
    let map = map(&cell, &MapRequest::default()).unwrap();
    let goals: Vec<_> = (0..100).map(|n| [1.0 - 0.01 * f64::from(n), 0.3, -0.6]).collect();
    let answers: Vec<_> = goals.iter().map(|goal| asked(&cell, &START, goal)).collect();
    let hit = answers.iter().position(Result::is_err).expect("a contact");
    let near = answers[..hit].iter().filter(|a| a.as_ref().is_ok_and(|a| !a.found)).count();
    let is_blocked = |goal: &&[f64; 3]| map.obstacles[0].blocks.is_blocked(&goal[..]);
    assert!(goals[..hit].iter().filter(is_blocked).count() > 0 && near == 0, "{near} of {hit}");
    assert!(answers[hit].as_ref().unwrap_err().to_string().contains("`post` are in collision"));
    // Without a free cell near the end.
    let coarse = parse(&format!("{ARM}[map.arm]\nstep = 45\n"));
    let reason = asked(&coarse, &START, &goals[hit - 1]).unwrap().reason.expect("no path");
    assert!(reason.contains("is in a blocked cell") && reason.contains("[map.arm]"), "{reason}");
    // Right before the column; the upper arm does not come over it.
    let wall = "[object.wall]\nshape = \"box\"\nat = [1650, 0, 900]\nsize = [2900, 20, 3000]\n";
    let stiff = ARM.replace("min = -170, max = 170", "min = -80, max = 80").replace("max = 150", "max = 60");
    let apart = no_path(&format!("{stiff}{wall}"), &START, &GOAL);
    assert!(apart.contains("do not connect"), "{apart}");
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
    assert!(closed.contains("one of the regions press") && closed.contains("planner rrt-connect"), "{closed}");
    let other = "[robot.post]\ndh = [{ kind = \"prismatic\", min = 0, max = 100, speed = 100 }]\n\
                 links = [{ sphere = { radius = 300 } }]\nbase = { at = [800, 0, 400], rpy = [0, 0, 0] }\n";
    let hit = refused(other);
    assert!(hit.contains("post/") && hit.contains("arm/"), "{hit}");
    // A robot inside an object does not affect the path of another robot.
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
    assert!(asked(&parse(free), &START, &GOAL).unwrap().timed.is_some_and(|timed| timed.path.waypoints.len() == 2));
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
    let timed = plan(&cell, &request).unwrap().timed.expect("a path");
    let end = at(timed.trajectory.last().unwrap());
    assert!((end.translation - at(&GOAL).translation).length() < 1e-5);
}

#[test]
fn objects_count_where_they_are_at_the_time() {
    let waypoints = |cell: &Cell, placed: Vec<(ObjectId, Pose)>| {
        let planner = PathPlanner::Grid;
        let from = Some(START.into());
        let request = PathRequest { planner, placed, from, to: GOAL[..].into(), ..PathRequest::default() };
        plan(cell, &request).unwrap().timed.expect("a path").path.waypoints
    };
    let cell = parse(ARM);
    let at = |x, y| vec![(ObjectId(0), Pose::from_xyz_rpy([x, y, 0.4], [0.0; 3]))];
    assert_eq!(waypoints(&cell, at(5.0, 0.0)).len(), 2);
    let elsewhere = parse(&ARM.replace("at = [700, 0, 400]", "at = [650, 150, 400]"));
    assert_eq!(waypoints(&cell, at(0.65, 0.15)), waypoints(&elsewhere, Vec::new()));
    assert_ne!(waypoints(&cell, at(0.65, 0.15)), waypoints(&cell, Vec::new()));
}

#[test]
fn a_path_keeps_its_distance_through_cells_that_are_blocked_up_to_it() {
    let cell = parse(ARM);
    let planner = PathPlanner::Grid;
    let options = RrtConnectSettings { clearance_m: 0.08, ..RrtConnectSettings::default() };
    let request =
        PathRequest { planner, options, from: Some(START.into()), to: GOAL[..].into(), ..PathRequest::default() };
    let timed = plan(&cell, &request).unwrap().timed.expect("the arm can fold");
    let scene = QueryModel::of_cell(&cell).scene(OutOfReachProofs::Omit).unwrap();
    let mut state = SceneState::new(&scene);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    for TrajectoryRow { q, .. } in timed.trajectory.rows() {
        state.set_q(&scene, RobotId(0), q).unwrap();
        let least = checker.between(Selection::Robot(RobotId(0)), Selection::Objects).distance(&state);
        assert!(least.is_none_or(|d| d.metres >= 0.08 - 1e-9), "{q:?}: {least:?}");
    }
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
