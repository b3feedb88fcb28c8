//! Several robots planned together, merged to one robot or by priority; every path is checked in the original scene.

use elbowroom_kinematics::JointLimits;
use std::time::Duration;

use elbowroom_planner::{
    CoverModel, CoverObstacles, CoverRrtConnect, PrioritizedMotion, PrioritizedPlanner, PrioritizedPlannerError,
    RobotGoal, RrtConnect, RrtConnectSettings,
};
use elbowroom_robot::{RobotId, example};
use elbowroom_scene::{Checker, CheckerOptions, MergedRobots, Scene, SceneState, SweepOptions};
use elbowroom_spatial::Pose;

/// Two arms opposite to each other, nearer than their reach, and a third arm that does not move.
fn scene() -> Scene {
    let mut builder = Scene::builder();
    for (name, x, y, yaw) in [("left", -0.45, 0.0, 0.0), ("right", 0.45, 0.0, 3.0), ("behind", 0.0, 0.8, 0.0)] {
        builder.robot(name, example::arm().unwrap(), Pose::from_xyz_rpy([x, y, 0.0], [0.0, 0.0, yaw]));
    }
    builder.build().unwrap()
}

#[test]
fn two_arms_pass_each_other_beside_a_third() {
    let scene = scene();
    let group = [RobotId(0), RobotId(1)];
    let merged = MergedRobots::new(&scene, &group).unwrap();
    let mut before = SceneState::new(&scene);
    // Each stretches towards the other, on opposite sides, and they change sides.
    let (one, other) = ([0.5, 1.3, 0.2], [-0.5, 1.3, 0.2]);
    for robot in group {
        before.set_q(&scene, robot, &one).unwrap();
    }
    let start = merged.state(&scene, &before).unwrap();
    let goal: Vec<f64> = [other, other].concat();
    let model = CoverModel::new(merged.scene(), &start, merged.robot(), 0.0).unwrap();
    let obstacles = CoverObstacles::new(&model, merged.scene(), &start, 0.0);
    let exact = RrtConnect::new(merged.scene(), merged.robot()).unwrap();
    let settings = RrtConnectSettings { time_limit: Duration::from_secs(30), ..RrtConnectSettings::default() };
    let path = CoverRrtConnect::new(exact, &model, &obstacles).plan(&start, &goal, &settings).unwrap();
    assert!(path.waypoints.len() > 2, "straight, they would meet");
    let mut sweep = Checker::new(merged.scene(), CheckerOptions::default());
    let hit = sweep.sweep_path(&start, merged.robot(), &path.waypoints, &SweepOptions::default()).unwrap();
    assert!(hit.is_none(), "{hit:?}");
    let mut exact = Checker::new(&scene, CheckerOptions::default());
    for w in path.waypoints.windows(2) {
        for n in 0..=400 {
            let share = f64::from(n) / 400.0;
            let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * share).collect();
            for (robot, q) in group.iter().zip(merged.split(&q)) {
                before.set_q(&scene, *robot, q).unwrap();
            }
            assert!(exact.collides(&before).is_none(), "at {q:?}");
        }
    }
}

fn limits() -> Vec<JointLimits> {
    vec![JointLimits::new(2.0, 10.0, 100.0); 3]
}

fn goal(robot: usize, q: [f64; 3]) -> RobotGoal {
    RobotGoal { robot: RobotId(robot), q: q.to_vec(), limits: limits() }
}

/// Checks the exact scene between all rows, several times each.
fn assert_free_together(scene: &Scene, start: &SceneState, motions: &[PrioritizedMotion]) {
    let mut exact = Checker::new(scene, CheckerOptions::default());
    let mut state = start.clone();
    let last = motions.iter().map(|m| (m.end_s() / PERIOD_S).round() as usize).max().unwrap();
    for tick in 0..=last {
        for part in 0..5 {
            for motion in motions {
                let ends = motion.at_tick(tick).iter().zip(motion.at_tick(tick + 1));
                let q: Vec<f64> = ends.map(|(a, b)| a + (b - a) * f64::from(part) / 5.0).collect();
                state.set_q(scene, motion.robot, &q).unwrap();
            }
            assert!(exact.collides(&state).is_none(), "at tick {tick}");
        }
    }
}

const PERIOD_S: f64 = 0.01;

#[test]
fn arms_that_cross_wait_no_longer_than_necessary() {
    let scene = scene();
    let mut start = SceneState::new(&scene);
    // Each arm sweeps through the middle from one side to the other.
    start.set_q(&scene, RobotId(0), &[1.4, 1.3, 0.2]).unwrap();
    start.set_q(&scene, RobotId(1), &[2.0, 1.3, 0.2]).unwrap();
    let goals = [goal(0, [-1.4, 1.3, 0.2]), goal(1, [-1.7, 1.3, 0.2])];
    let settings = RrtConnectSettings { time_limit: Duration::from_secs(20), ..RrtConnectSettings::default() };
    let motions = PrioritizedPlanner::new(&scene).plan(&start, &goals, PERIOD_S, &settings).unwrap();
    assert_eq!(motions.iter().map(|m| m.robot.0).collect::<Vec<_>>(), [0, 1]);
    assert_free_together(&scene, &start, &motions);
    let one_by_one: f64 = motions.iter().map(|m| m.timed.trajectory.duration_s()).sum();
    let together = motions.iter().map(PrioritizedMotion::end_s).fold(0.0, f64::max);
    assert!(together < one_by_one - 0.05, "{together} s instead of {one_by_one} s");
    for (motion, goal) in motions.iter().zip(&goals) {
        assert_eq!(motion.at_tick(usize::MAX / 2), goal.q);
    }
}

#[test]
fn a_robot_that_is_in_the_way_moves_first() {
    let scene = scene();
    let mut start = SceneState::new(&scene);
    // The right arm is stretched over the left one's goal.
    start.set_q(&scene, RobotId(0), &[1.5, 0.1, 0.1]).unwrap();
    start.set_q(&scene, RobotId(1), &[0.5, 1.4, 0.1]).unwrap();
    let goals = [goal(0, [-0.6, 1.4, 0.1]), goal(1, [2.0, 0.3, 0.3])];
    let settings = RrtConnectSettings { time_limit: Duration::from_secs(20), ..RrtConnectSettings::default() };
    let motions = PrioritizedPlanner::new(&scene).plan(&start, &goals, PERIOD_S, &settings).unwrap();
    assert_free_together(&scene, &start, &motions);
    assert!(motions[0].end_s() > motions[1].start_s);
    // No order works if each robot is in the way of the other.
    let stuck = [goal(0, [-0.6, 1.4, 0.1]), goal(1, [0.5, 1.4, 0.1])];
    assert!(PrioritizedPlanner::new(&scene).plan(&start, &stuck, PERIOD_S, &settings).is_err());
    let none = PrioritizedPlanner::new(&scene).plan(&start, &[], PERIOD_S, &settings);
    assert!(matches!(none, Err(PrioritizedPlannerError::NoGoal)));
}
