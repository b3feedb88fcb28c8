//! Several robots planned in one call: free together, out of regions, and refused with a reason.

use std::time::Duration;

use crate::common::{HEAD, parse};
use elbowroom_cell::region_constraint::RegionConstraints;
use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_kinematics::{JointTrajectory, TrajectoryRow};
use elbowroom_planner::{PathConstraint, RrtConnectSettings};
use elbowroom_query::plan::{RobotPathRequest, SeveralPathsAnswer, SeveralPathsRequest, plan_several};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, SceneState, SweepMove, SweepOptions};

/// Arms in one plane that face each other and sweep through the same middle.
const ARMS: &str = r"
[robot.left]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }, { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
base = { at = [-450, 0, 0], rpy = [0, 0, 0] }
start = [-60, 0]
[robot.right]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }, { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
base = { at = [450, 0, 0], rpy = [0, 0, 180] }
start = [-60, 0]
";

/// In the way of the left arm's tip, 30 degrees from its start of the sweep's end.
const REGION: &str =
    "[region.post]\nshape = \"sphere\"\ncentre = [156, 350, 0]\nradius = 60\nwarning = 50\nrobots = [\"left\"]\n";

fn request(robots: &[(&str, [f64; 2])]) -> SeveralPathsRequest {
    let one = |(robot, to): &(&str, [f64; 2])| RobotPathRequest { robot: (*robot).into(), from: None, to: to.to_vec() };
    let options = RrtConnectSettings { time_limit: Duration::from_secs(20), ..RrtConnectSettings::default() };
    SeveralPathsRequest { robots: robots.iter().map(one).collect(), options, period_s: Some(0.01) }
}

/// A continuous sweep of both robots from row to row, in the exact scene.
fn assert_free_together(cell: &Cell, answer: &SeveralPathsAnswer, robots: [RobotId; 2]) {
    let scene = QueryModel::of_cell(cell).scene(OutOfReachProofs::Omit).unwrap();
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut state = SceneState::new(&scene);
    let split = answer.robots[0].joints.len();
    for rows in answer.trajectory.rows().windows(2) {
        let (from, to) = (rows[0].q.split_at(split), rows[1].q.split_at(split));
        state.set_q(&scene, robots[0], from.0).unwrap();
        state.set_q(&scene, robots[1], from.1).unwrap();
        let moves = [SweepMove::Robot { robot: robots[0], to: to.0 }, SweepMove::Robot { robot: robots[1], to: to.1 }];
        let hit = checker.sweep(&state, &moves, &SweepOptions::default()).unwrap();
        assert!(hit.is_none(), "at {} s: {hit:?}", rows[0].t_s);
    }
}

/// The smallest distance of a robot from its regions at the rows, m.
fn least_distance(cell: &Cell, answer: &SeveralPathsAnswer) -> f64 {
    let constraints = RegionConstraints::new(cell, cell.robots.iter().map(|r| &r.start[..]), 0.0).unwrap();
    let mut constraint = constraints.of_robot(RobotId(0)).expect("a region is closed to the left arm");
    answer.trajectory.rows().iter().map(|row| constraint.distance_m(&row.q[..2], 1.0)).fold(f64::INFINITY, f64::min)
}

const THERE: [f64; 2] = [1.047, 0.0];

#[test]
fn two_arms_move_at_the_same_time_and_stay_out_of_regions() {
    let (free, closed) = (parse(&format!("{HEAD}{ARMS}")), parse(&format!("{HEAD}{ARMS}{REGION}")));
    let both = request(&[("left", THERE), ("right", THERE)]);
    let without = plan_several(&free, &both).unwrap();
    let with = plan_several(&closed, &both).unwrap();
    for (cell, answer) in [(&free, &without), (&closed, &with)] {
        assert!(answer.found && answer.robots.len() == 2, "{answer:?}");
        assert_free_together(cell, answer, [RobotId(0), RobotId(1)]);
        let (start, goal) = ([&cell.robots[0].start[..], &cell.robots[1].start].concat(), [THERE, THERE].concat());
        assert_eq!((answer.trajectory.first(), answer.trajectory.last()), (Some(&start[..]), Some(&goal[..])));
        let ends = answer.robots.iter().map(|r| r.end_s).fold(0.0, f64::max);
        assert!((answer.duration_s.unwrap() - ends).abs() < 1e-9 && answer.robots.iter().all(|r| r.cost_rad > 1.0));
    }
    assert_eq!((&with.robots[0].regions[..], with.robots[1].regions.len()), (&["post".to_owned()][..], 0));
    assert!(least_distance(&closed, &with) > 0.0);
    assert!(
        least_distance(&closed, &without) <= 0.0,
        "without the region the path leads through it: else the test is void"
    );
}

/// A wrist ball overlaps the forearm in every state. Links that always touch where they are joined stop no motion, as
/// in all commands.
#[test]
fn links_that_always_touch_at_a_joint_do_not_stop_the_robots() {
    let ball = "{ min = -170, max = 170, speed = 90 }";
    let wrist = |s: &str| {
        s.replace("speed = 90 }]", &format!("speed = 90 }}, {ball}, {ball}]"))
            .replace("radius = 40 } }]", "radius = 40 } }, { sphere = { radius = 45 } }, { sphere = { radius = 50 } }]")
            .replace("start = [-60, 0]", "start = [-60, 0, 0, 0]")
    };
    let cell = parse(&format!("{HEAD}{}", wrist(ARMS)));
    let collides = |model: QueryModel| {
        let scene = model.scene(OutOfReachProofs::Omit).unwrap();
        let mut start = SceneState::new(&scene);
        for (i, robot) in cell.robots.iter().enumerate() {
            start.set_q(&scene, RobotId(i), &robot.start).unwrap();
        }
        Checker::new(&scene, CheckerOptions::default()).collides(&start).is_some()
    };
    assert!(collides(QueryModel::without_rules(&cell)) && !collides(QueryModel::of_cell(&cell)));
    let one = |robot: &str| RobotPathRequest { robot: robot.into(), from: None, to: vec![1.047, 0.0, 0.5, -0.5] };
    let options = RrtConnectSettings { time_limit: Duration::from_secs(20), ..RrtConnectSettings::default() };
    let request = SeveralPathsRequest { robots: vec![one("left"), one("right")], options, period_s: Some(0.01) };
    let answer = plan_several(&cell, &request).unwrap();
    assert!(answer.found, "{:?}", answer.reason);
}

#[test]
fn the_oracle_detects_motions_that_meet() {
    let cell = parse(&format!("{HEAD}{ARMS}"));
    let both = request(&[("left", THERE), ("right", THERE)]);
    let mut answer = plan_several(&cell, &both).unwrap();
    let straight = |share: f64| -60_f64.to_radians() + (THERE[0] + 60_f64.to_radians()) * share;
    let row = |i: u32| {
        let at = straight(f64::from(i) / 50.0);
        TrajectoryRow { t_s: f64::from(i), q: vec![at, 0.0, at, 0.0] }
    };
    answer.trajectory = JointTrajectory::new((0..=50).map(row).collect());
    let found = std::panic::catch_unwind(|| assert_free_together(&cell, &answer, [RobotId(0), RobotId(1)]));
    assert!(found.is_err());
}

#[test]
fn columns_have_the_names_of_robots_and_joints() {
    let cell = parse(&format!("{HEAD}{ARMS}"));
    let answer = plan_several(&cell, &request(&[("right", THERE), ("left", THERE)])).unwrap();
    let mut csv = Vec::new();
    answer.write_csv(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    assert_eq!(csv.lines().next(), Some("t_s,right.joint_1,right.joint_2,left.joint_1,left.joint_2"));
    assert_eq!(csv.lines().count(), answer.trajectory.rows().len() + 1);
}

#[test]
fn a_goal_that_another_robot_does_not_leave_is_no_path() {
    let cell = parse(&format!("{HEAD}{ARMS}"));
    // Both arms stretched to the middle.
    let answer = plan_several(&cell, &request(&[("left", [0.0, 0.0]), ("right", [0.0, 0.0])])).unwrap();
    assert!(!answer.found && answer.trajectory.rows().is_empty() && answer.robots.is_empty());
    let reason = answer.reason.unwrap();
    assert!(reason.contains("left") && reason.contains("right"), "{reason}");
}

#[test]
fn wrong_requests_are_refused_with_a_hint() {
    let cell = parse(&format!("{HEAD}{ARMS}{REGION}"));
    let refused = |cell: &Cell, robots: &[(&str, [f64; 2])]| {
        let error = plan_several(cell, &request(robots)).unwrap_err();
        assert!(error.hint.is_some(), "{error}");
        error.to_string()
    };
    assert!(refused(&cell, &[("left", THERE), ("left", THERE)]).contains("two goals"));
    assert!(refused(&cell, &[("left", THERE), ("middle", THERE)]).contains("middle"));
    assert!(refused(&cell, &[("left", THERE), ("right", [9.0, 0.0])]).contains("the goal of robot \"right\""));
    // The goal of the left arm in its region, away from the right arm.
    let below = parse(&format!("{HEAD}{ARMS}{}", REGION.replace("350", "-350")));
    let inside = refused(&below, &[("left", [-30_f64.to_radians(), 0.0]), ("right", [-1.2, 0.0])]);
    assert!(inside.contains("region `post`") && inside.contains("left"), "{inside}");
    // A region that the right arm carries.
    let carried = REGION.replace("centre = [156, 350, 0]", "centre = [0, 0, 400]\nfollow = { robot = \"right\" }");
    let cell = parse(&format!("{HEAD}{ARMS}{carried}"));
    let error = refused(&cell, &[("left", THERE), ("right", THERE)]);
    assert!(error.contains("post") && error.contains("right"), "{error}");
}
