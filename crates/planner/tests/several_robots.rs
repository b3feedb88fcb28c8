//! Several robots planned together: merged to one robot, every path checked in the scene that they came from.

use std::time::Duration;

use elbowroom_planner::{CoverModel, CoverObstacles, CoverRrtConnect, RrtConnect, RrtConnectSettings};
use elbowroom_robot::{RobotId, example};
use elbowroom_scene::{Checker, CheckerOptions, MergedRobots, Scene, SceneState, SweepOptions};
use elbowroom_spatial::Pose;

/// Arms opposite to each other, nearer than their reach, and a third that stays.
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
    // Both stretch towards the other, on either side of it, and change sides.
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
