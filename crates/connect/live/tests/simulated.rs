//! Simulated controllers report the parts that their robots carry, so that the node guards them.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_live::network::{Network, Subscription};
use elbowroom_live::{Keys, Service, ServiceOptions};
use elbowroom_status::RobotStatus;
use elbowroom_testkit::network::free_address;

/// Makes a cell of a carriage that takes a thing of one metre to a place where only that thing is near a region, and
/// returns without it.
fn cell(thing: &str, take: &str, leave: &str) -> String {
    format!(
        r#"
version = 1
name = "carried"
units = {{ length = "mm", angle = "deg" }}
[robot.rail]
dh = [{{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }}]
links = [{{ sphere = {{ radius = 50 }} }}]
start = [800]
{thing}
[region.end]
shape = "sphere"
centre = [0, 0, 2500]
radius = 200
warning = 400
[program.rail]
steps = [
  {{ {take} }},
  {{ move = "joint", to = [1050], speed = 80 }},
  {{ move = "joint", to = [800], speed = 80 }},
  {{ {leave} }},
  {{ move = "joint", to = [1050], speed = 80 }},
  {{ move = "joint", to = [800], speed = 80 }},
]
"#
    )
}

type Statuses = Arc<Mutex<Vec<RobotStatus>>>;

/// Runs the cell in this process, with its statuses.
fn start(text: &str) -> (Service, Statuses, Subscription) {
    let cell = Cell::parse("carried.toml", text).expect("a cell");
    let key = Keys::new(&cell.name).status("rail");
    let listen = Some(free_address());
    let options = ServiceOptions { listen, simulate: true, ..ServiceOptions::default() };
    let service = Service::start(cell, &options).expect("a service");
    let statuses = Statuses::default();
    let taken = statuses.clone();
    let handler = Box::new(move |bytes: &[u8]| {
        taken.lock().unwrap().push(serde_json::from_slice(bytes).expect("a status"));
    });
    let subscription = service.network().subscribe(&key, handler).expect("a key");
    (service, statuses, subscription)
}

/// Waits for a status, at most 20 s.
fn wait_for(statuses: &Statuses, what: &str, mut is_it: impl FnMut(&RobotStatus) -> bool) {
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(20) {
        if statuses.lock().unwrap().drain(..).any(|status| is_it(&status)) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("{what}");
}

/// Checks that the carried part limits the override far out, and that the same place is free without it.
fn governs_while_carried(text: &str, part: &str) {
    let (service, statuses, _subscription) = start(text);
    let is_far = |status: &RobotStatus| status.q.first().is_some_and(|q| *q > 0.95);
    for pass in 1..=2 {
        wait_for(&statuses, &format!("{part} never limited the override, pass {pass}"), |status| {
            let governing = status.governing.as_ref();
            is_far(status) && status.speed_override < 1.0 && governing.is_some_and(|point| point.part == part)
        });
        wait_for(&statuses, &format!("{part} limits the override where it is not, pass {pass}"), |status| {
            is_far(status) && status.speed_override == 1.0 && status.governing.is_none()
        });
    }
    service.stop().expect("it ends");
}

#[test]
fn a_gripped_part_and_an_exchanged_tool_are_guarded_until_they_are_gone() {
    let bar = "[object.bar]\nshape = \"box\"\nat = [0, 0, 1300]\nsize = [60, 60, 1000]";
    let tools = "[robot.rail.tools.gripper]\nbox = { at = [0, 0, 50], size = [60, 60, 100] }\n\
        [robot.rail.tools.lance]\nbox = { at = [0, 0, 500], size = [60, 60, 1000] }\nmounted = false";
    // At the same time, as the tests wait more than they compute.
    std::thread::scope(|scope| {
        scope.spawn(|| governs_while_carried(&cell(bar, "grip = \"bar\"", "release = \"bar\""), "bar"));
        scope.spawn(|| governs_while_carried(&cell(tools, "tool = \"lance\"", "tool = \"gripper\""), "lance"));
        // A program of planned moves also begins again at its end.
        let planned = cell(tools, "tool = \"lance\"", "tool = \"gripper\"").replace("\"joint\", to", "\"planned\", to");
        scope.spawn(move || governs_while_carried(&planned, "lance"));
    });
}

/// The TCP and the cell of the grid are of the lance while it is on the robot, and of the gripper before and after.
#[test]
fn the_tcp_and_the_grid_of_a_status_are_of_the_tool_that_is_mounted() {
    let tools = "[robot.rail.tools.gripper]\ntcp = { at = [0, 0, 100] }\n\
        [robot.rail.tools.lance]\ntcp = { at = [0, 30, 1000] }\nmounted = false\n\
        [grid.rail]\nfrom = [-500, -500, 0]\nto = [500, 500, 4000]\ncells = [1, 1, 40]\noutput = 8";
    let (service, statuses, _subscription) = start(&cell(tools, "tool = \"lance\"", "tool = \"gripper\""));
    let mut seen = [0, 0];
    let place = |status: &RobotStatus| {
        Some((status.q.first().copied()?, status.tcp.as_ref()?.position_m, *status.grids.get("rail")?))
    };
    wait_for(&statuses, "both tools", |status| {
        let Some((q, tcp, cell)) = place(status) else { return false };
        let tool = usize::from(tcp[1] > 0.0);
        let (y, z) = [(0.0, 0.1), (0.03, 1.0)][tool];
        assert!((tcp[1] - y).abs() < 1e-9 && (tcp[2] - q - z).abs() < 1e-9, "{q} {tcp:?}");
        // Cells are 100 mm high and count from 1; near a border the former cell may stay.
        let from_border = ((q + z) * 10.0).rem_euclid(1.0);
        if (0.2..0.8).contains(&from_border) {
            assert_eq!(cell, 1 + ((q + z) * 10.0) as u32, "{q} {tcp:?}");
            seen[tool] += 1;
        }
        seen.iter().all(|count| *count > 1)
    });
    service.stop().expect("it ends");
}

/// The gate was never switched off when the service starts, so it is on. The program begins with it off, as in `run`, and a
/// switch in it lasts.
#[test]
fn a_program_switches_off_what_it_begins_without() {
    let gate =
        "[region.gate]\nshape = \"sphere\"\ncentre = [0, 0, 1200]\nradius = 50\nwarning = 100\nlife = \"temporary\"";
    let text = cell(gate, "wait = 0.1", "region = \"gate\", active = true");
    let (_service, statuses, _subscription) = start(&text);
    let is_on = |status: &RobotStatus| status.regions.iter().find(|r| r.name == "gate").map(|r| r.active);
    wait_for(&statuses, "the gate is off", |status| is_on(status) == Some(false));
    // Inside the gate's warning zone, which would have slowed the robot down.
    wait_for(&statuses, "it has passed", |status| status.q.first().is_some_and(|q| *q > 1.04));
    wait_for(&statuses, "the gate is on", |status| is_on(status) == Some(true));
}
