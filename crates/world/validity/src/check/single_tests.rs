//! Comparison of the kernel for one configuration with the kernel for sixteen: the same spheres touch.

use elbowroom_proximity::{Cuboid, Cylinder, Shape, Sphere};
use elbowroom_robot::example;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::Random;
use fearless_simd::dispatch;

use super::ValidityChecker;
use super::block::BlockModel;
use super::block_request::BlockRequest;
use super::motion_table::MotionTable;
use super::workspace::Workspace;
use crate::lanes::{LANES, detected_simd_level};
use crate::model::CoveredRobot;
use crate::obstacles::{BroadPhase, ObstacleSet, RoundedSolid};
use crate::validity::Validity;

/// Lanes in which spheres touch, by the kernel for blocks.
fn touching(robot: &CoveredRobot, obstacles: &ObstacleSet, q: &[Vec<f64>]) -> u32 {
    let motion = MotionTable::new(robot);
    let mut workspace = Workspace::new(robot, &motion);
    let boxes: Vec<_> = obstacles.outer.iter().map(RoundedSolid::bounds).collect();
    let tree = BroadPhase::new(&boxes, robot.reach_m);
    for lane in 0..LANES {
        assert!(workspace.set_lane(robot, lane, &q[lane % q.len()]));
    }
    workspace.set_no_motion();
    let model = BlockModel { robot, obstacles, tree: &tree, motion: &motion, skipped: &[] };
    let request = BlockRequest { chords: false, active: 0xffff };
    dispatch!(detected_simd_level(), simd => model.check(simd, &mut workspace, request, None)).touching
}

#[test]
fn one_configuration_touches_what_it_touches_in_a_block() {
    let mut random = Random(3);
    let robot = example::arm().unwrap();
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let (mut free, mut touched) = (0, 0);
    for count in [0, 1, 5, 20, 200, 3000] {
        let mut obstacles = ObstacleSet::default();
        for i in 0..count {
            let size = 0.3 / f64::from(count).cbrt();
            let half_extents = Vec3::new(size, 0.5 * size, 0.2 * size);
            let shape = match i % 3 {
                0 => Shape::Sphere(Sphere { radius: 0.5 * size }),
                1 => Shape::Cuboid(Cuboid { half_extents }),
                _ => Shape::Cylinder(Cylinder { radius: 0.3 * size, half_length: size }),
            };
            let at = Vec3::new(random.between(-1.5, 1.5), random.between(-1.5, 1.5), random.between(-0.5, 1.5));
            let rotation = Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), random.between(-3.0, 3.0));
            obstacles.add_shape(&shape, &Pose::new(rotation, at), 0.0);
        }
        let mut checker = ValidityChecker::new(&covered, &obstacles);
        for _ in 0..25 {
            let q: Vec<Vec<f64>> =
                (0..LANES).map(|_| (0..covered.dof()).map(|_| random.between(-3.0, 3.0)).collect()).collect();
            let lanes = touching(&covered, &obstacles, &q);
            for (lane, q) in q.iter().enumerate() {
                let is_free = checker.state(q).unwrap() == Validity::Free;
                assert_eq!(is_free, lanes >> lane & 1 == 0, "{count} obstacles, {q:?}");
                free += usize::from(is_free);
                touched += usize::from(!is_free);
            }
        }
    }
    assert!(free > 100 && touched > 100, "{free} free, {touched} not");
}
