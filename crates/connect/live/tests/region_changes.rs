//! Regions moved, added and removed over the control interface of a service with nodes.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::SeqCst};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::common::control_setup::{ControlSetup, INTEGRATOR, OPERATOR, PROGRAMMER, rails};
use elbowroom_cell::Cell;
use elbowroom_live::messages::OverrideAnswer;
use elbowroom_live::network::{Network, Urgency};
use elbowroom_live::{
    Clock, ControllerClient, ControllerState, Keys, Service, ServiceOptions, boot_number, configuration_number,
};
use elbowroom_testkit::network::eventually;
use serde_json::{Value, json};

const CELL: &str = concat!(rails!("900", "450, 0, 1900"), "[monitor]\nstale_ms = 200\n");
const TABLE: &str = "shape = \"sphere\"\ncentre = [0, 0, 1000]\nradius = 100\nwarning = 100\nlife = \"temporary\"\n";

/// The whole cell, or the arbiter alone, with the changes that the test makes.
struct Setup(ControlSetup);

impl std::ops::Deref for Setup {
    type Target = ControlSetup;

    fn deref(&self) -> &ControlSetup {
        &self.0
    }
}

impl Setup {
    fn new(is_arbiter_alone: bool) -> Self {
        let options = ServiceOptions { arbiter: is_arbiter_alone, ..ServiceOptions::default() };
        Self(ControlSetup::new(CELL, false, options))
    }

    /// Makes a change, which must succeed.
    fn make(&self, path: &str, body: &Value) -> Value {
        let (status, document) = self.change(PROGRAMMER, path, body);
        assert_eq!(status, 200, "{path} {body}: {document}");
        document
    }
}

/// A controller on its own thread, whose robot is where the test says.
struct Controller {
    q_mm: Arc<AtomicU64>,
    is_closed: Arc<AtomicBool>,
    /// The last answer; beside it the highest override of all.
    last: Arc<Mutex<Option<OverrideAnswer>>>,
    highest: Arc<Mutex<f64>>,
    thread: Option<JoinHandle<()>>,
    _subscription: elbowroom_live::network::Subscription,
}

impl Controller {
    fn start(setup: &Setup, robot: &str, q_mm: u64) -> Self {
        let (network, keys) = (setup.network(), Keys::new(&setup.cell.name));
        let (last, highest) = (Arc::<Mutex<Option<OverrideAnswer>>>::default(), Arc::new(Mutex::new(0.0)));
        let (heard, most) = (last.clone(), highest.clone());
        let client = ControllerClient::new(boot_number(), configuration_number(&setup.cell));
        let client = Arc::new(Mutex::new(client));
        let obeying = client.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            let answer = OverrideAnswer::decode(bytes).unwrap();
            // A late answer is not obeyed.
            let _ = obeying.lock().unwrap().receive(bytes);
            let mut most = most.lock().unwrap();
            *most = f64::max(*most, answer.speed_override);
            *heard.lock().unwrap() = Some(answer);
        });
        let subscription = network.subscribe(&keys.speed_override(robot), handler).unwrap();
        let mut joint_states = network.publisher(&keys.joint_states(robot), Urgency::RealTime).unwrap();
        let (q, is_closed) = (Arc::new(AtomicU64::new(q_mm)), Arc::<AtomicBool>::default());
        let (at, closed) = (q.clone(), is_closed.clone());
        let run = move || {
            let clock = Clock::start();
            while !closed.load(SeqCst) {
                let q = [at.load(SeqCst) as f64 * 1e-3];
                let state =
                    ControllerState { q: &q, qd: &[0.0], programmed_override: 1.0, ..ControllerState::default() };
                joint_states.publish(client.lock().unwrap().joint_state(clock.micros(), &state));
                std::thread::sleep(Duration::from_millis(10));
            }
        };
        let thread = Some(std::thread::spawn(run));
        Self { q_mm: q, is_closed, last, highest, thread, _subscription: subscription }
    }

    fn speed_override(&self) -> f64 {
        self.last.lock().unwrap().as_ref().map_or(-1.0, |answer| answer.speed_override)
    }
}

impl Drop for Controller {
    fn drop(&mut self) {
        self.is_closed.store(true, SeqCst);
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

#[test]
fn a_region_is_added_moved_and_removed_and_the_robot_obeys_at_once() {
    let setup = Setup::new(false);
    let controller = Controller::start(&setup, "left", 800);
    eventually("free", || controller.speed_override() == 1.0);
    // 50 mm before the border of the new region, in the middle of its warning zone.
    let done = setup.make("/add", &json!({ "region": "table", "toml": TABLE, "note": "set up" }));
    eventually("the added region limits", || (0.0..1.0).contains(&controller.speed_override()));
    assert!(done["stopped"].is_null(), "{done}");
    let entry = &done["entry"];
    assert_eq!((entry["action"].as_str(), entry["note"].as_str()), (Some("add region.table"), Some("set up")));
    assert_eq!(entry["checksum_before"], setup.cell.approval.checksum.as_str());
    assert_ne!(entry["checksum"], entry["checksum_before"]);
    let shown = setup.regions();
    assert_eq!(shown["checksum"], entry["checksum"]);
    let region = setup.region("table").unwrap();
    assert!(region["active"] == true && region["life"] == "temporary", "{region}");
    // The region is moved away, and back.
    setup.make("/move", &json!({ "region": "table", "toml": "centre = [0, 0, 1900]" }));
    eventually("free again", || controller.speed_override() == 1.0);
    let names: Vec<Value> = setup.regions()["regions"].as_array().unwrap().iter().map(|r| r["name"].clone()).collect();
    assert_eq!(names, ["pallet", "cart", "wall", "table"], "no second place is left over");
    let done = setup.make("/move", &json!({ "region": "table", "toml": "centre = [0, 0, 1000]" }));
    let change = &done["entry"]["changes"][0];
    assert_eq!((&change["field"], &change["before"]), (&json!("centre"), &json!("[0, 0, 1900]")));
    eventually("limited again", || (0.0..1.0).contains(&controller.speed_override()));
    setup.make("/remove", &json!({ "region": "table" }));
    eventually("free at the end", || controller.speed_override() == 1.0);
    assert_eq!(setup.region("table"), None);
    assert_eq!(setup.regions()["checksum"], setup.cell.approval.checksum.as_str(), "as it began");
    // A temporary region of the file, switched off, is moved and switched on.
    setup.make("/move", &json!({ "region": "cart", "toml": "centre = [0, 0, 1000]" }));
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(controller.speed_override(), 1.0);
    setup.make("/switch", &json!({ "region": "cart", "active": true }));
    eventually("the moved region limits", || (0.0..1.0).contains(&controller.speed_override()));
    let entries = setup.changes();
    assert_eq!(entries.len(), 6);
    for pair in entries.windows(2) {
        assert_eq!(pair[1].checksum_before, pair[0].checksum);
    }
}

#[test]
fn what_is_not_allowed_is_refused_with_the_reason_and_changes_nothing() {
    let setup = Setup::new(false);
    let controller = Controller::start(&setup, "left", 800);
    eventually("free", || controller.speed_override() == 1.0);
    eventually("heard", || setup.regions()["robots"][0]["heard"] == true);
    let before = setup.regions();
    let add = |toml: &str| json!({ "region": "table", "toml": toml });
    let to = |region: &str, toml: &str| json!({ "region": region, "toml": toml });
    let permanent = TABLE.replace("temporary", "permanent");
    let inside = "centre = [0, 0, 860]";
    let around = TABLE.replace("1000", "860");
    let cases: [(usize, &str, Value, u16, &str); 17] = [
        (OPERATOR, "/add", add(TABLE), 403, "takes the programmer class"),
        (OPERATOR, "/move", to("cart", inside), 403, "takes the programmer class"),
        (OPERATOR, "/remove", json!({ "region": "cart" }), 403, "takes the programmer class"),
        (PROGRAMMER, "/add", add(&permanent), 403, "takes the integrator class"),
        (PROGRAMMER, "/move", to("wall", "centre = [0, 950, 0]"), 403, "takes the integrator class"),
        (INTEGRATOR, "/move", to("wall", "centre = [0, 950, 0]"), 409, "is permanent and in the cell file"),
        (INTEGRATOR, "/remove", json!({ "region": "wall" }), 409, "is permanent and in the cell file"),
        (INTEGRATOR, "/remove", json!({ "region": "pallet" }), 409, "is an exchange region"),
        (INTEGRATOR, "/add", add(&TABLE.replace("life = \"temporary\"", "kind = \"exchange\"")), 409, "exchange"),
        (PROGRAMMER, "/move", to("carts", inside), 404, "there is no region `carts`"),
        (PROGRAMMER, "/add", to("cart", TABLE), 409, "there is a region `cart` already"),
        (PROGRAMMER, "/move", to("cart", "radius = 5"), 400, "`radius` does not say where region `cart` is"),
        (PROGRAMMER, "/add", add("shape = \"cube\""), 400, "line 1: "),
        (PROGRAMMER, "/add", add("shape = \"sphere\"\ncentre = [0, 0"), 400, "not TOML"),
        (PROGRAMMER, "/add", add("shape = \"mesh\"\nmesh = \"/etc/passwd\""), 400, "outside of the cell's folder"),
        (PROGRAMMER, "/add", json!({ "region": "a\nb", "toml": TABLE }), 400, "not a valid name for a region"),
        (PROGRAMMER, "/add", add(&around), 409, "is inside region `table`"),
    ];
    for (class, path, body, expected, message) in cases {
        let (status, document) = setup.change(class, path, &body);
        let error = document["error"].as_str().unwrap_or_default();
        assert!(status == expected && error.contains(message), "{path} {body}: {status} {document}");
    }
    // The same file gives the same message.
    let wrong = "shape = \"sphere\"\ncentre = [0, 0, 1]\nradius = -5";
    let of_file = Cell::parse("cell.toml", &format!("{CELL}\n[region.table]\n{wrong}")).unwrap_err();
    let (_, document) = setup.change(PROGRAMMER, "/add", &add(wrong));
    assert_eq!(document["error"].as_str().unwrap(), format!("line 3: {}", of_file.message));
    // The answer names the distance of a region that would stop the robot; a region that only slows it is permitted.
    let (status, document) = setup.change(PROGRAMMER, "/add", &add(&around));
    assert_eq!((status, document["robot"].as_str(), document["distance_m"].as_f64()), (409, Some("left"), Some(0.0)));
    let revision = before["revision"].as_str().unwrap();
    let (status, document) = setup.change_at(PROGRAMMER, "/add", &"1".repeat(16), &add(TABLE));
    assert_eq!(status, 412, "{document}");
    assert_eq!(setup.regions(), before, "nothing has changed");
    assert_eq!(controller.speed_override(), 1.0);
    let (status, _) = setup.change_at(PROGRAMMER, "/add", revision, &add(TABLE));
    assert_eq!(status, 200);
    assert_eq!(setup.change_at(PROGRAMMER, "/remove", revision, &json!({ "region": "table" })).0, 412);
    // An active region may not be moved over the robot; only an integrator removes a region that an integrator has
    // added permanently.
    let (status, document) = setup.change(PROGRAMMER, "/move", &to("table", inside));
    assert!(status == 409 && document["distance_m"] == 0.0, "{document}");
    let lasting = json!({ "region": "lasting", "toml": permanent.replace("1000", "1900") });
    assert_eq!(setup.change(INTEGRATOR, "/add", &lasting).0, 200);
    assert_eq!(setup.change(PROGRAMMER, "/remove", &json!({ "region": "lasting" })).0, 403);
    assert_eq!(setup.change(INTEGRATOR, "/remove", &json!({ "region": "lasting" })).0, 200);
}

/// The answer to a request that changes nothing.
fn ask(setup: &Setup, body: &Value) -> (u16, Value) {
    let headers = format!("{}Content-Type: application/json\r\n", setup.bearer(OPERATOR));
    setup.request("POST", "/distance", &headers, &body.to_string())
}

#[test]
fn who_teaches_at_a_robot_sees_where_it_is_and_its_distance_from_what_is_taught() {
    let setup = Setup::new(false);
    let unheard = setup.regions()["robots"][0].clone();
    assert!(unheard["heard"] == false && unheard["tcp"].is_null(), "{unheard}");
    let body = |toml: &str| json!({ "robot": "left", "region": "lamp", "toml": toml });
    let (status, document) = ask(&setup, &body(TABLE));
    assert!(status == 200 && document["distance_m"].is_null(), "not heard: {document}");
    let controller = Controller::start(&setup, "left", 400);
    eventually("heard", || setup.regions()["robots"][0]["heard"] == true);
    let before = setup.regions();
    assert_eq!((before["units"]["length"].as_str(), before["units"]["angle"].as_str()), (Some("mm"), Some("deg")));
    for frame in ["tcp", "flange"] {
        let place = &before["robots"][0][frame]["position_m"];
        assert!((place[2].as_f64().unwrap() - 0.4).abs() < 1e-9, "{frame}: {before}");
    }
    // The ball of the robot, 50 mm, and the region's, 100 mm, at 1000 mm.
    let distance = |toml: &str| ask(&setup, &body(toml)).1["distance_m"].as_f64().unwrap();
    assert!((distance(TABLE) - 0.45).abs() < 1e-6, "{}", distance(TABLE));
    controller.q_mm.store(820, SeqCst);
    eventually("inside", || distance(TABLE) == 0.0 || (distance(TABLE) - 0.03).abs() < 1e-6);
    // A fence: its walls are 500 mm away, on both sides of the ball.
    let fence = "[fence.lamp]\ncorners = [[-500, -500], [500, -500], [500, 500], [-500, 500]]\nheight = 3000\n";
    assert!((distance(fence) - 0.45).abs() < 1e-6, "{}", distance(fence));
    // A name that the cell has is compared with the new shape.
    let (_, document) =
        ask(&setup, &json!({ "robot": "left", "region": "cart", "toml": TABLE.replace("1000", "1500") }));
    assert!((document["distance_m"].as_f64().unwrap() - 0.53).abs() < 1e-6, "{document}");
    for (wrong, status, message) in [
        (json!({ "robot": "lift", "region": "lamp", "toml": TABLE }), 404, "there is no robot `lift`"),
        (json!({ "robot": "left", "region": "lamp", "toml": "shape = \"cube\"" }), 400, "line 1: "),
        (
            json!({ "robot": "left", "region": "lamp", "toml": "shape = \"mesh\"\nmesh = \"/etc/passwd\"" }),
            400,
            "outside of",
        ),
        (json!({ "robot": "left", "region": "lamp" }), 422, "not such a request"),
    ] {
        let (found, document) = ask(&setup, &wrong);
        let error = document["error"].as_str().unwrap_or_default();
        assert!(found == status && error.contains(message), "{wrong}: {found} {document}");
    }
    let (status, _) =
        setup.request("POST", "/distance", "Content-Type: application/json\r\n", &body(TABLE).to_string());
    assert_eq!(status, 401);
    let after = setup.regions();
    assert!(after["regions"] == before["regions"] && after["revision"] == before["revision"], "nothing has changed");
    assert!(setup.changes().is_empty());
}

#[test]
fn a_fence_stays_as_it_is_while_the_cell_runs() {
    let fence = "[fence.pen]\ncorners = [[-3000, -3000], [3000, -3000], [3000, 3000], [-3000, 3000]]\nheight = 500\n\
                 life = \"temporary\"\nwarning = 50\n";
    let setup = Setup(ControlSetup::new(&format!("{CELL}{fence}"), false, ServiceOptions::default()));
    let before = setup.regions();
    for (path, body) in [
        ("/remove", json!({ "region": "pen" })),
        ("/move", json!({ "region": "pen", "toml": "corners = [[0, 0], [1, 0], [0, 1]]" })),
    ] {
        let (status, document) = setup.change(PROGRAMMER, path, &body);
        let error = document["error"].as_str().unwrap_or_default();
        assert!(status == 409 && error.contains("region `pen` is a fence"), "{path}: {status} {document}");
    }
    assert_eq!(setup.regions(), before);
    setup.make("/switch", &json!({ "region": "pen", "active": true }));
    assert!(setup.region("pen").unwrap()["active"] == true);
}

#[test]
fn a_node_that_starts_later_has_the_present_regions_before_its_robot_may_move() {
    let setup = Setup::new(true);
    // No node guards the robots yet.
    setup.make("/add", &json!({ "region": "table", "toml": TABLE }));
    let connect = Some(setup.listen.clone());
    let options = ServiceOptions { robots: vec!["left".into()], connect, ..ServiceOptions::default() };
    // The robot is inside the region that the cell file does not have.
    let controller = Controller::start(&setup, "left", 1000);
    let node = Service::start(setup.cell.clone(), &options).unwrap_or_else(|e| panic!("{e}"));
    eventually("it answers with the region's reason", || {
        controller.last.lock().unwrap().as_ref().is_some_and(|a| a.reason == 1 && a.speed_override == 0.0)
    });
    assert_eq!(*controller.highest.lock().unwrap(), 0.0, "never more");
    // After the removal it may go; a node that starts again knows that too.
    setup.make("/remove", &json!({ "region": "table" }));
    eventually("free", || controller.speed_override() == 1.0);
    drop(node);
    setup.make("/add", &json!({ "region": "table", "toml": TABLE.replace("1000", "500") }));
    controller.q_mm.store(500, SeqCst);
    *controller.highest.lock().unwrap() = 0.0;
    let _node = Service::start(setup.cell.clone(), &options).unwrap_or_else(|e| panic!("{e}"));
    eventually("stopped by the region", || controller.last.lock().unwrap().as_ref().is_some_and(|a| a.reason == 1));
    assert_eq!(*controller.highest.lock().unwrap(), 0.0);
}
