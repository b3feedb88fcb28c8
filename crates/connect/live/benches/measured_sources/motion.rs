//! The cell, and the true motion of what is measured: functions of the time of day, which all processes share.

use std::time::{SystemTime, UNIX_EPOCH};

use elbowroom_cell::Cell;
use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};

/// Two carriages that move up and down, 3 m apart. On the way of the left one a region rides on the belt, on the way of
/// the right one another swings around the thing.
const CELL: &str = r#"
version = 1
name = "measured"
units = { length = "mm", angle = "deg" }
tick_ms = 4
[monitor]
stopping_distance = true
direction_aware = true
stale_ms = 100
[robot.left]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000, acceleration = 4000 }]
links = [{ sphere = { radius = 50 } }]
stop_time = 0.25
start = [100]
[robot.right]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000, acceleration = 4000 }]
links = [{ sphere = { radius = 50 } }]
stop_time = 0.25
start = [100]
base = { at = [3000, 0, 0] }
[encoder.belt]
direction = [0, 0, 1]
speed = 0
measured = true
[object.thing]
shape = "box"
size = [50, 50, 50]
at = [3000, 0, 1600]
measured = true
[region.on_belt]
shape = "sphere"
centre = [0, 0, 0]
radius = 200
warning = 300
robots = ["left"]
follow = { encoder = "belt", max_speed = 1000 }
[region.on_thing]
shape = "sphere"
centre = [0, 0, 100]
radius = 200
warning = 300
robots = ["right"]
follow = { object = "thing", max_speed = 1000, max_turn = 180 }
[program.left]
steps = [{ move = "joint", to = [1900] }, { move = "joint", to = [100] }]
[program.right]
steps = [{ move = "joint", to = [1900] }, { move = "joint", to = [100] }]
"#;

/// Names of the robots; the region of each is in its way.
pub const ROBOTS: [&str; 2] = ["left", "right"];
/// Radius of a carriage and of a region together, m.
pub const TOUCH_M: f64 = 0.25;
/// Centre of the region on the thing, in the frame of the thing, m.
const ARM_M: Vec3 = Vec3 { x: 0.0, y: 0.0, z: 0.1 };

pub fn cell() -> Result<Cell, Box<dyn std::error::Error>> {
    Ok(Cell::parse("measured.toml", CELL)?)
}

/// Seconds since a time of day in microseconds.
pub fn since(epoch_us: u64) -> f64 {
    (now_us() as f64 - epoch_us as f64) * 1e-6
}

/// The time of day, µs.
pub fn now_us() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |passed| passed.as_micros() as u64)
}

/// Travel (m) and speed (m/s) of the belt.
pub fn belt(t_s: f64) -> (f64, f64) {
    (1.7 + 0.6 * (0.5 * t_s).sin(), 0.3 * (0.5 * t_s).cos())
}

/// Pose and velocity of the thing, which rises, sinks and turns about the way of the right robot.
pub fn thing(t_s: f64) -> (Pose, FrameMotion) {
    let turn = 0.8 * (0.7 * t_s).sin();
    let at = Vec3::new(3.0, 0.0, 1.6 + 0.5 * (0.37 * t_s).cos());
    let motion = FrameMotion {
        velocity: Vec3::Z * (-0.185 * (0.37 * t_s).sin()),
        angular_velocity: Vec3::X * (0.56 * (0.7 * t_s).cos()),
        ..FrameMotion::REST
    };
    (Pose::new(Rotation::from_axis_angle(Vec3::X, turn), at), motion)
}

/// The centre of a robot's region.
pub fn region(robot: usize, t_s: f64) -> Vec3 {
    if robot == 0 { Vec3::Z * belt(t_s).0 } else { thing(t_s).0.transform_point(ARM_M) }
}

/// The centre of a carriage.
pub fn carriage(robot: usize, q: f64) -> Vec3 {
    Vec3::new(3.0 * robot as f64, 0.0, q)
}
