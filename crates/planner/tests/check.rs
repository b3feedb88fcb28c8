//! Paths of the map in the exact scene.

mod common;

use common::{Random, free_cell};
use elbowroom_cspace::{JointMap, Obstacle};
use elbowroom_planner::example::{ARM, grid, scene};
use elbowroom_planner::{CheckError, MappedJoints, MotionLimits, Path, PlanOptions, Planner};
use elbowroom_scene::{Checker, Options, SceneState, SweepOptions};
use elbowroom_spatial::{Pose, Vec3};

const JOINTS: MappedJoints = MappedJoints { robot: 0, joints: [0, 1, 2] };

fn obstacles() -> Vec<Obstacle> {
    let cuboid = |at: [f64; 3], yaw: f64, half: [f64; 3]| {
        Obstacle::cuboid(Pose::from_xyz_rpy(at, [0.0, 0.0, yaw]), Vec3::from(half)).unwrap()
    };
    vec![
        cuboid([1.5, 0.5, 0.3], 0.4, [0.7, 0.04, 0.9]),
        cuboid([-0.9, 0.9, 0.8], 2.3, [0.5, 0.04, 1.4]),
        Obstacle::sphere(Vec3::new(1.2, -1.0, 1.0), 0.3).unwrap(),
    ]
}

#[test]
fn what_the_map_lets_through_the_scene_lets_through() {
    let (grid, obstacles) = (grid(4.0).unwrap(), obstacles());
    let mut map = JointMap::new(ARM, &grid).unwrap();
    map.set_fixed(&obstacles);
    let scene = scene(&grid, &obstacles).unwrap();
    let (mut checker, state) = (Checker::new(&scene, Options::default()), SceneState::new(&scene));
    let mut planner = Planner::new(&grid, map.table()).unwrap();
    let limits = MotionLimits { velocity: vec![2.0; 3], acceleration: vec![6.0; 3], jerk: vec![60.0; 3] };
    let mut random = Random(41);
    let mut bent = 0;
    for _ in 0..150 {
        let (from, to) = (free_cell(map.table(), &mut random).unwrap(), free_cell(map.table(), &mut random).unwrap());
        let Ok(path) = planner.plan(grid.center(from), grid.center(to), &PlanOptions::default()) else { continue };
        bent += usize::from(path.waypoints.len() > 2);
        path.check(&mut checker, &state, JOINTS, &SweepOptions::default()).unwrap();
        let motion = planner.time(&path, &limits).unwrap();
        let driven: Vec<_> =
            (0..=100).map(|n| motion.at(motion.seconds() * f64::from(n) / 100.0).q.try_into().unwrap()).collect();
        Path::check_through(&driven, &mut checker, &state, JOINTS, &SweepOptions::default()).unwrap();
    }
    assert!(bent > 20, "{bent}");
}

#[test]
fn a_map_of_another_scene_is_found_out_and_told_where() {
    let (grid, obstacles) = (grid(4.0).unwrap(), obstacles());
    let scene = scene(&grid, &obstacles).unwrap();
    let (mut checker, state) = (Checker::new(&scene, Options::default()), SceneState::new(&scene));
    let empty = JointMap::new(ARM, &grid).unwrap();
    let mut planner = Planner::new(&grid, empty.table()).unwrap();
    // Straight through the ball.
    let path = planner.plan([-1.5, 0.6, 0.2], [0.0, 0.6, 0.2], &PlanOptions::default()).unwrap();
    let error = path.check(&mut checker, &state, JOINTS, &SweepOptions::default()).unwrap_err();
    let CheckError::Impact { waypoint: 1, share, b, certain: true, .. } = &error else { panic!("{error}") };
    assert!(*share > 0.0 && *share < 1.0 && b == "obstacle 2", "{error}");
    // A path that begins in a collision.
    let back = Path { waypoints: vec![[-0.7, 0.6, 0.2]], ..path };
    let error = back.check(&mut checker, &state, JOINTS, &SweepOptions::default()).unwrap_err();
    assert!(matches!(error, CheckError::Impact { waypoint: 0, .. }), "{error}");
}

#[test]
fn joints_that_the_robot_does_not_have_are_refused() {
    let grid = grid(10.0).unwrap();
    let scene = scene(&grid, &[]).unwrap();
    let (mut checker, state) = (Checker::new(&scene, Options::default()), SceneState::new(&scene));
    let path = Path { waypoints: vec![[0.0; 3]], length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 };
    let mut check = |robot, joints| {
        path.check(&mut checker, &state, MappedJoints { robot, joints }, &SweepOptions::default()).unwrap_err()
    };
    assert!(matches!(check(0, [0, 1, 3]), CheckError::Joint { map: 2, joint: 3, dof: 3 }));
    assert!(matches!(check(0, [0, 1, 1]), CheckError::Joint { map: 2, .. }));
    assert!(matches!(check(1, [0, 1, 2]), CheckError::Scene(_)));
}
