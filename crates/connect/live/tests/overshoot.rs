//! Readings beyond joint limits: which are tolerated, and what the status says of the others.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::common::start_node;
use elbowroom_cell::Cell;
use elbowroom_live::network::{LocalNetwork, Network, Urgency};
use elbowroom_live::{Clock, ControllerClient, ControllerState, Keys, configuration_number};
use elbowroom_status::RobotStatus;

/// A table that turns from -90 to 90 degrees; `key` is a line of its robot.
fn table(key: &str) -> Cell {
    let text = format!(
        "version = 1\nname = \"table\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[robot.table]\n\
         dh = [{{ name = \"turn\", min = -90, max = 90, speed = 90 }}]\nlinks = [{{ sphere = {{ radius = 50 }} }}]\n{key}\n\
         [region.post]\nshape = \"sphere\"\ncentre = [0, 0, 2500]\nradius = 200\nwarning = 100\n"
    );
    Cell::parse("table.toml", &text).unwrap_or_else(|e| panic!("{e}"))
}

/// Sends a reading until a status shows this override, and returns its reason.
fn reason_at(cell: &Cell, q: f64, speed_override: f64) -> String {
    let network = LocalNetwork::default();
    let (clock, keys) = (Clock::start(), Keys::new(&cell.name));
    let _node = start_node(cell, clock, Arc::new(network.clone()));
    let last: Arc<Mutex<Option<RobotStatus>>> = Arc::default();
    let to = last.clone();
    let handler = Box::new(move |bytes: &[u8]| {
        *to.lock().unwrap() = Some(serde_json::from_slice(bytes).expect("a status"));
    });
    let _subscription = network.subscribe(&keys.status("table"), handler).unwrap();
    let mut readings = network.publisher(&keys.joint_states("table"), Urgency::RealTime).unwrap();
    let client = Arc::new(Mutex::new(ControllerClient::new(7, configuration_number(cell))));
    let answered = client.clone();
    let handler = Box::new(move |bytes: &[u8]| {
        // Late answers are refused. A controller without answers reports that it does not move.
        let _ = answered.lock().unwrap().receive(bytes);
    });
    let _answers = network.subscribe(&keys.speed_override("table"), handler).unwrap();
    let began = Instant::now();
    let is_it = |s: &RobotStatus| (s.q[0] - q).abs() < 1e-12 && s.speed_override == speed_override;
    while !last.lock().unwrap().as_ref().is_some_and(|s| is_it(s) && !s.reason.contains("stale")) {
        let shown = last.lock().unwrap().as_ref().map(|s| (s.q.clone(), s.speed_override, s.reason.clone()));
        assert!(began.elapsed() < Duration::from_secs(20), "no such status at {q}: {shown:?}");
        let state = ControllerState { q: &[q], qd: &[0.0], programmed_override: 1.0, ..ControllerState::default() };
        let reading = client.lock().unwrap().joint_state(clock.micros(), &state).to_vec();
        readings.publish(&reading);
        std::thread::sleep(Duration::from_millis(2));
    }
    let status = last.lock().unwrap().take();
    status.expect("a status").reason
}

#[test]
fn a_reading_beyond_the_limits_stops_the_robot_by_the_key_of_the_cell_file() {
    let limit = 90_f64.to_radians();
    assert_eq!(reason_at(&table(""), limit + 0.03, 1.0), "free");
    assert_eq!(reason_at(&table("overshoot = 2"), -limit - 0.03, 1.0), "free");
    let stopped =
        "joint `turn` is at 1.6008 rad, 0.0300 rad beyond its upper limit 1.5708 rad; 0.0175 rad are tolerated";
    assert_eq!(reason_at(&table("overshoot = [1]"), limit + 0.03, 0.0), stopped);
    let stopped =
        "joint `turn` is at -1.6308 rad, 0.0600 rad beyond its lower limit -1.5708 rad; 0.0500 rad are tolerated";
    assert_eq!(reason_at(&table(""), -limit - 0.06, 0.0), stopped);
}
