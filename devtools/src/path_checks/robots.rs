//! Paths of real robots among boxes.

use elbowroom_kinematics::JointLimits;
use std::time::{Duration, Instant};

use elbowroom_planner::{CoverModel, CoverObstacles, CoverRrtConnect, RrtConnect, RrtConnectError, RrtConnectSettings};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState};
use elbowroom_spatial::Pose;
use elbowroom_testkit::random::SplitMix;

use super::course::{Course, along};
use crate::cross_validation::world::{self, Files};

/// Robots of the data, each with the size of its surroundings, m.
const ROBOTS: [(&str, f64); 6] = [
    ("panda", 1.0),
    ("ur5e", 1.0),
    ("fanuc_moveit", 1.4),
    ("staubli_rx160", 1.6),
    ("kuka_lbr_iiwa_14_r820", 1.0),
    ("abb_irb2400", 1.8),
];
/// Time between rows of a motion, s.
const PERIOD: f64 = 0.004;

pub fn known(name: &str) -> bool {
    ROBOTS.iter().any(|robot| robot.0 == name)
}

/// Plans between random free states.
pub fn course(files: &Files, pairs: usize) -> Result<Course, String> {
    fn text(e: impl std::fmt::Display) -> String {
        e.to_string()
    }
    let robot = world::load(files, true)?;
    let size = ROBOTS.iter().find(|known| known.0 == files.name).map_or(1.0, |known| known.1);
    let speed = |i: usize| robot.chain.joints()[robot.chain.active_joints()[i].0].limits.velocity.unwrap_or(1.0);
    let limits = |speed: f64| JointLimits::new(speed, 4.0 * speed, 40.0 * speed);
    let limits: Vec<JointLimits> = (0..robot.chain.dof()).map(speed).map(limits).collect();
    let scene = world::scene(&files.name, robot, around(size))?;
    let mut course = Course::new(&files.name, files.urdf.clone(), scene.clone());
    let (options, mut state) = (RrtConnectSettings::default(), SceneState::new(&scene));
    let model = CoverModel::new(&scene, &state, RobotId(0), 0.0).map_err(text)?;
    let obstacles = CoverObstacles::new(&model, &scene, &state, 0.0);
    let mut connect = CoverRrtConnect::new(RrtConnect::new(&scene, RobotId(0)).map_err(text)?, &model, &obstacles);
    let mut states = free(&scene, 2 * pairs)?.into_iter();
    while let (Some(from), Some(to)) = (states.next(), states.next()) {
        course.asked += 1;
        state.set_q(&scene, RobotId(0), &from).map_err(text)?;
        let clock = Instant::now();
        let route = match connect.plan(&state, &to, &options) {
            Ok(route) => route,
            Err(RrtConnectError::NotFound { .. }) => {
                course.planning.push(clock.elapsed());
                continue;
            }
            Err(RrtConnectError::Disconnected { .. }) => {
                course.disconnected += 1;
                course.planning.push(clock.elapsed());
                continue;
            }
            Err(e) => return Err(format!("{}: {e}", files.name)),
        };
        course.found += 1;
        course.straight += usize::from(route.waypoints.len() == 2);
        course.corners += route.waypoints.len().saturating_sub(2);
        course.planning.push(route.planning_time);
        course.simplifying.push(route.simplification_time);
        let clock = Instant::now();
        let timed = connect.time_parametrize(&state, route, &limits, PERIOD, &options).map_err(text)?;
        course.timing.push(clock.elapsed());
        course.stops += timed.stops;
        course.paths.push(along(&timed.path.waypoints));
        course.paths.push(timed.trajectory);
    }
    Ok(course)
}

/// Returns a floor, a shelf in front, and posts at the side with a beam across.
fn around(size: f64) -> Vec<Object> {
    let cuboid = |name: &str, at: [f64; 3], full: [f64; 3]| Object {
        name: name.into(),
        shape: Shape::Cuboid(Cuboid { half_extents: full.map(|x| 0.5 * size * x).into() }),
        in_world: Pose::from_translation(at.map(|x| size * x).into()),
    };
    vec![
        cuboid("floor", [0.0, 0.0, -0.06], [3.0, 3.0, 0.1]),
        cuboid("low board", [0.6, 0.0, 0.25], [0.3, 0.8, 0.02]),
        cuboid("high board", [0.6, 0.0, 0.6], [0.3, 0.8, 0.02]),
        cuboid("back", [0.76, 0.0, 0.5], [0.02, 0.8, 1.0]),
        cuboid("side", [0.6, 0.41, 0.5], [0.3, 0.02, 1.0]),
        cuboid("post", [-0.4, 0.5, 0.5], [0.06, 0.06, 1.2]),
        cuboid("beam", [-0.4, 0.0, 0.9], [0.06, 1.1, 0.06]),
    ]
}

/// Returns random states without contact; an error if the robot has hardly any.
fn free(scene: &Scene, count: usize) -> Result<Vec<Vec<f64>>, String> {
    let mut checker = Checker::new(scene, CheckerOptions::default());
    let mut state = SceneState::new(scene);
    let chain = &scene.robots()[0].robot.chain;
    let each: Vec<(f64, f64)> = chain.lower().into_iter().zip(chain.upper()).collect();
    let (mut random, mut free) = (SplitMix(2), Vec::new());
    let begin = Instant::now();
    while free.len() < count {
        if begin.elapsed() > Duration::from_secs(20) {
            return Err(format!("{}: only {} free states in 20 s", scene.robots()[0].name, free.len()));
        }
        let q: Vec<f64> = each.iter().map(|(low, high)| within(*low, *high, &mut random)).collect();
        state.set_q(scene, RobotId(0), &q).map_err(|e| e.to_string())?;
        if checker.within(&state, 1e-3).is_none() {
            free.push(q);
        }
    }
    Ok(free)
}

/// Returns a random value within limits; half a turn in each direction without limits.
fn within(low: f64, high: f64, random: &mut SplitMix) -> f64 {
    let turn = std::f64::consts::PI;
    let (low, high) = (if low.is_finite() { low } else { -turn }, if high.is_finite() { high } else { turn });
    low + (high - low) * random.unit()
}
