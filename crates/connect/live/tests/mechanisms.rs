//! A mechanism in `live`: it is read and shown, robots wait for it, and it follows no override.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_live::network::Network;
use elbowroom_live::{Keys, Service, ServiceOptions};
use elbowroom_status::RobotStatus;
use elbowroom_testkit::network::free_address;

/// A carriage that rests 0.2 m before the place into which a door slides, and returns from it, again and again.
const CELL: &str = r#"
version = 1
name = "a sliding door"
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
[robot.door]
kind = "mechanism"
base = { at = [-1500, 0, 800], rpy = [0, 90, 0] }
dh = [{ kind = "prismatic", min = 0, max = 1500, speed = 1500 }]
links = [{ sphere = { radius = 200 } }]
[region.leaf]
shape = "sphere"
centre = [0, 0, 0]
radius = 200
warning = 800
follow = { robot = "door", frame = "link_1" }
[program.door]
steps = [{ move = "joint", to = [1500], speed = 50 }, { wait = 0.5 }, { move = "joint", to = [0], speed = 50 }, { wait = 0.5 }]
"#;

#[test]
fn a_door_is_read_and_not_guarded_and_its_robot_waits() {
    let cell = Cell::parse("door.toml", CELL).expect("a cell");
    let keys = Keys::new(&cell.name);
    let options = ServiceOptions { listen: Some(free_address()), simulate: true, ..ServiceOptions::default() };
    let service = Service::start(cell, &options).expect("a service");
    assert_eq!((service.guarded(), service.mechanisms()), (1, 1));
    // Position of the door, and override of the robot.
    let seen: Arc<Mutex<Vec<(String, f64, f64)>>> = Arc::default();
    let subscribe = |name: &str| {
        let to = seen.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            let status: RobotStatus = serde_json::from_slice(bytes).expect("a status");
            let q = status.q.first().copied().unwrap_or(f64::NAN);
            to.lock().unwrap().push((status.robot, q, status.speed_override));
        });
        service.network().subscribe(&keys.status(name), handler).expect("a key")
    };
    let _subscriptions = ["rail", "door"].map(subscribe);
    let wait = |what: &str, is_it: &dyn Fn(&(String, f64, f64)) -> bool| {
        let began = Instant::now();
        while !seen.lock().unwrap().iter().any(is_it) {
            assert!(began.elapsed() < Duration::from_secs(20), "{what}");
            std::thread::sleep(Duration::from_millis(10));
        }
        seen.lock().unwrap().clear();
    };
    for _ in 0..2 {
        wait("the door never closes", &|(robot, q, _)| robot == "door" && *q > 1.49);
        wait("the robot is not slowed down by the door", &|(robot, _, o)| robot == "rail" && *o < 0.7);
        wait("the door never opens again", &|(robot, q, _)| robot == "door" && *q < 0.01);
        wait("the robot is slowed down by a door that is gone", &|(robot, _, o)| robot == "rail" && *o == 1.0);
    }
    service.stop().expect("it ends");
}
