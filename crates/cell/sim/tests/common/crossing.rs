//! Random paths of an obstacle through the workspace of an arm, equal on every machine.

use std::f64::consts::PI;

use elbowroom_cell::{Cell, Drive, ObjectPath, PathRepeat};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState, Selection};
use elbowroom_sim::run::simulate;
use elbowroom_sim::{Recording, RunOptions};
use elbowroom_spatial::{Pose, Vec3};

use elbowroom_testkit::random::Random;

/// Smallest distance of the obstacle to the axis of the base, m: a pedestal cannot move away.
const PEDESTAL_M: f64 = 1.0;
/// Smallest initial distance of the obstacle to the robot, m.
const MIN_START_DISTANCE_M: f64 = 0.8;

/// This number of paths, for a program that takes this many seconds without an obstacle.
pub fn paths(
    cell: &Cell,
    object: ObjectId,
    seconds: f64,
    count: usize,
) -> Result<Vec<ObjectPath>, Box<dyn std::error::Error>> {
    let (mut random, mut paths) = (Random(2026), Vec::new());
    let scene = obstacle_scene(cell, object)?;
    while paths.len() < count {
        paths.extend(crossing(cell, &scene, seconds, &mut random)?);
    }
    Ok(paths)
}

/// The program without the obstacle.
pub fn without_obstacle(cell: &Cell) -> Result<Recording, Box<dyn std::error::Error>> {
    let mut cell = cell.clone();
    for m in &mut cell.moving_objects {
        let far = Vec3::new(100.0, 100.0, 100.0);
        m.rest_in_world.translation = far;
        m.drive = Drive::Path(ObjectPath::new(vec![far], 0.0, 0.0, PathRepeat::Once, Vec3::ZERO));
    }
    let recording = simulate(&cell, &RunOptions::default())?.recording;
    let robot = &recording.robots[0];
    if !robot.finished || !robot.collisions.is_empty() {
        return Err(format!("the program fails without the obstacle: {:?}", robot.collisions.first()).into());
    }
    Ok(recording)
}

/// A scene of the robot and the obstacle.
fn obstacle_scene(cell: &Cell, object: ObjectId) -> Result<Scene, Box<dyn std::error::Error>> {
    let mut builder = Scene::builder();
    let robot = &cell.robots[0];
    builder.robot(&robot.name, robot.robot.clone(), robot.base_in_world);
    builder.object(cell.objects[object.0].clone());
    Ok(builder.build()?)
}

/// A straight path through the workspace of the arm; `None` if it would start in the arm or cross the pedestal.
fn crossing(
    cell: &Cell,
    scene: &Scene,
    seconds: f64,
    random: &mut Random,
) -> Result<Option<ObjectPath>, Box<dyn std::error::Error>> {
    let base = cell.robots[0].base_in_world;
    let speed = random.between(0.1, 1.2);
    let (turn, climb) = (random.between(-PI, PI), random.between(-0.3, 0.3));
    let along = Vec3::new(turn.cos() * f64::cos(climb), turn.sin() * f64::cos(climb), f64::sin(climb));
    let (about, radius) = (random.between(-PI, PI), random.between(PEDESTAL_M, 2.6));
    let through = Vec3::new(radius * about.cos(), radius * about.sin(), random.between(0.6, 2.2));
    let when = random.between(0.1, 0.9) * seconds;
    let flat = Vec3::new(along.x, along.y, 0.0).try_normalize().ok_or("no direction")?;
    let base_distance = through.cross(flat).z.abs();
    let (from, to) = (through - along * (speed * when), through + along * (speed * seconds));
    let from = base.transform_point(from);
    let path = ObjectPath::new(vec![from, base.transform_point(to)], speed, 0.0, PathRepeat::Once, Vec3::ZERO);
    if base_distance < PEDESTAL_M {
        return Ok(None);
    }
    let mut state = SceneState::new(scene);
    state.set_q(scene, RobotId(0), &cell.robots[0].start)?;
    state.place(scene, ObjectId(0), Pose { translation: from, ..scene.objects()[0].in_world })?;
    let mut checker = Checker::new(scene, CheckerOptions::default());
    let near = checker
        .between(Selection::Robot(RobotId(0)), Selection::Object(ObjectId(0)))
        .within(&state, MIN_START_DISTANCE_M);
    Ok(near.is_none().then_some(path))
}
