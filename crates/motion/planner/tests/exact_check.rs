//! Paths of the map in the exact scene.

use crate::common::{Random, free_cell};
use elbowroom_cspace::{ConvexObstacle, JointMap};
use elbowroom_planner::example::{ARM, grid, scene};
use elbowroom_planner::{CheckError, GridPlanner, GridPlannerSettings, KinematicLimits, MappedJoints, Path};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, SceneState, SweepOptions};
use elbowroom_spatial::{Pose, Vec3};

const JOINTS: MappedJoints = MappedJoints { robot: RobotId(0), joints: [0, 1, 2] };

fn obstacles() -> Vec<ConvexObstacle> {
    let cuboid = |at: [f64; 3], yaw: f64, half: [f64; 3]| {
        ConvexObstacle::cuboid(Pose::from_xyz_rpy(at, [0.0, 0.0, yaw]), Vec3::from(half)).unwrap()
    };
    vec![
        cuboid([1.5, 0.5, 0.3], 0.4, [0.7, 0.04, 0.9]),
        cuboid([-0.9, 0.9, 0.8], 2.3, [0.5, 0.04, 1.4]),
        ConvexObstacle::sphere(Vec3::new(1.2, -1.0, 1.0), 0.3).unwrap(),
    ]
}

#[test]
fn paths_free_in_the_map_are_free_in_the_scene() {
    let (grid, obstacles) = (grid(4.0).unwrap(), obstacles());
    let mut map = JointMap::new(ARM, &grid).unwrap();
    map.set_fixed(&obstacles);
    let scene = scene(&grid, &obstacles).unwrap();
    let (mut checker, state) = (Checker::new(&scene, CheckerOptions::default()), SceneState::new(&scene));
    let mut planner = GridPlanner::new(&grid, map.occupancy()).unwrap();
    let limits = KinematicLimits { velocity: vec![2.0; 3], acceleration: vec![6.0; 3], jerk: vec![60.0; 3] };
    let mut random = Random(41);
    let mut bent = 0;
    for _ in 0..150 {
        let (from, to) =
            (free_cell(map.occupancy(), &mut random).unwrap(), free_cell(map.occupancy(), &mut random).unwrap());
        let Ok(path) = planner.plan(grid.center(from), grid.center(to), &GridPlannerSettings::default()) else {
            continue;
        };
        bent += usize::from(path.waypoints.len() > 2);
        path.check(&mut checker, &state, JOINTS, &SweepOptions::default()).unwrap();
        let trajectory = planner.time_parametrize(&path, &limits).unwrap();
        let positions: Vec<_> = (0..=100)
            .map(|n| trajectory.at(trajectory.seconds() * f64::from(n) / 100.0).q.try_into().unwrap())
            .collect();
        Path::check_polyline(&positions, &mut checker, &state, JOINTS, &SweepOptions::default()).unwrap();
    }
    assert!(bent > 20, "{bent}");
}

#[test]
fn a_map_of_another_scene_is_detected() {
    let (grid, obstacles) = (grid(4.0).unwrap(), obstacles());
    let scene = scene(&grid, &obstacles).unwrap();
    let (mut checker, state) = (Checker::new(&scene, CheckerOptions::default()), SceneState::new(&scene));
    let empty = JointMap::new(ARM, &grid).unwrap();
    let mut planner = GridPlanner::new(&grid, empty.occupancy()).unwrap();
    // Straight through the sphere.
    let path = planner.plan([-1.5, 0.6, 0.2], [0.0, 0.6, 0.2], &GridPlannerSettings::default()).unwrap();
    let error = path.check(&mut checker, &state, JOINTS, &SweepOptions::default()).unwrap_err();
    let CheckError::Collision { waypoint: 1, share, b, certain: true, .. } = &error else { panic!("{error}") };
    assert!(*share > 0.0 && *share < 1.0 && b == "obstacle 2", "{error}");
    // A path that begins in a collision.
    let back = Path { waypoints: vec![[-0.7, 0.6, 0.2]], ..path };
    let error = back.check(&mut checker, &state, JOINTS, &SweepOptions::default()).unwrap_err();
    assert!(matches!(error, CheckError::Collision { waypoint: 0, .. }), "{error}");
}

#[test]
fn joints_that_the_robot_does_not_have_are_rejected() {
    let grid = grid(10.0).unwrap();
    let scene = scene(&grid, &[]).unwrap();
    let (mut checker, state) = (Checker::new(&scene, CheckerOptions::default()), SceneState::new(&scene));
    let path = Path { waypoints: vec![[0.0; 3]], length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 };
    let mut check = |robot, joints| {
        path.check(&mut checker, &state, MappedJoints { robot, joints }, &SweepOptions::default()).unwrap_err()
    };
    assert!(matches!(check(RobotId(0), [0, 1, 3]), CheckError::Joint { map: 2, joint: 3, dof: 3 }));
    assert!(matches!(check(RobotId(0), [0, 1, 1]), CheckError::Joint { map: 2, .. }));
    assert!(matches!(check(RobotId(1), [0, 1, 2]), CheckError::Scene(_)));
}
