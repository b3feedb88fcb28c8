//! Control interface of a service under correct, wrong and hostile requests.

use std::collections::VecDeque;
use std::io::Write as _;
use std::net::{SocketAddr, TcpStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::common::control_setup::{ControlSetup, INTEGRATOR, OPERATOR, PROGRAMMER, rails, read};
use elbowroom_cell::Cell;
use elbowroom_cell::access::{AccessTokens, control_history};
use elbowroom_interlock::wire::{self, Message};
use elbowroom_interlock::{Boot, Guard};
use elbowroom_live::network::{Network, Publisher, Subscription, Urgency};
use elbowroom_live::{
    Clock, ControlOptions, ControllerClient, ControllerState, DEFAULT_ADDRESS, Keys, RegionTableMessage, Service,
    ServiceOptions, boot_number, configuration_number,
};
use elbowroom_monitor::{AccessClass, Occupancy, RobotSlot, SlotId};
use elbowroom_testkit::network::eventually;
use elbowroom_view::http::Endpoint;
use serde_json::{Value, json};

/// Two rails side by side, with a region that both enter, one that is switched, and a permanent one.
const CELL: &str = rails!("300", "150, 0, 1000");

/// The whole cell, with the switches that the test makes.
struct Setup(ControlSetup);

impl std::ops::Deref for Setup {
    type Target = ControlSetup;

    fn deref(&self) -> &ControlSetup {
        &self.0
    }
}

impl Setup {
    fn new() -> Self {
        Self::with(false)
    }

    fn with(program_switches: bool) -> Self {
        let options = ServiceOptions { arbiter: true, ..ServiceOptions::default() };
        Self(ControlSetup::new(CELL, program_switches, options))
    }

    fn log(&self) -> PathBuf {
        self.folder.path().join("cell.control.jsonl")
    }

    fn is_on(&self, region: &str) -> bool {
        self.region(region).unwrap()["active"] == true
    }

    fn switch(&self, class: usize, region: &str, active: bool) -> (u16, Value) {
        self.change(class, "/switch", &json!({ "region": region, "active": active }))
    }

    /// Checks that the service works: a correct request is obeyed.
    fn assert_alive(&self) {
        let on = self.is_on("cart");
        let (status, document) = self.switch(PROGRAMMER, "cart", !on);
        assert_eq!(status, 200, "{document}");
        assert_eq!(self.is_on("cart"), !on);
    }
}

/// A controller that reports where its robot is.
struct Controller {
    client: ControllerClient,
    clock: Clock,
    joint_states: Box<dyn Publisher>,
}

impl Controller {
    fn new(setup: &Setup, robot: &str) -> Self {
        let key = Keys::new(&setup.cell.name).joint_states(robot);
        let joint_states = setup.network().publisher(&key, Urgency::RealTime).unwrap();
        let client = ControllerClient::new(boot_number(), configuration_number(&setup.cell));
        Self { client, clock: Clock::start(), joint_states }
    }

    fn say(&mut self, q: f64, qd: f64) {
        let state = ControllerState { q: &[q], qd: &[qd], programmed_override: 1.0, ..ControllerState::default() };
        self.joint_states.publish(self.client.joint_state(self.clock.micros(), &state));
    }
}

#[test]
fn roles_decide_who_may_switch() {
    let setup = Setup::new();
    let (status, document) = setup.switch(OPERATOR, "cart", true);
    assert_eq!(status, 403);
    assert!(document["error"].as_str().unwrap().contains("takes the programmer class, and \"operator\" is operator"));
    // Nobody may switch a permanent region; the role is checked first.
    assert_eq!(setup.switch(OPERATOR, "wall", false).0, 403);
    assert_eq!(setup.switch(PROGRAMMER, "wall", false).0, 409);
    let (status, document) = setup.switch(INTEGRATOR, "wall", false);
    assert_eq!(status, 409);
    assert!(document["error"].as_str().unwrap().contains("permanent"));
    assert!(setup.is_on("wall") && setup.is_on("pallet") && !setup.is_on("cart"));
    assert_eq!(setup.switch(PROGRAMMER, "cart", true).0, 200);
    assert!(setup.is_on("cart"));
    assert_eq!(setup.switch(INTEGRATOR, "cart", false).0, 200);
    assert!(!setup.is_on("cart"));
    let (status, document) = setup.switch(PROGRAMMER, "carts", true);
    assert_eq!((status, document["help"].as_str().unwrap()), (404, "one of pallet, cart, wall"));
    let events = setup.events.lock().unwrap();
    assert!(events.iter().any(|e| e == "cart: switched on by programmer (programmer)"), "{events:?}");
    assert!(events.iter().any(|e| e.contains("\"operator\" is operator")), "{events:?}");
}

#[test]
fn nobody_without_a_token_sees_or_changes_anything() {
    let setup = Setup::new();
    let revision = setup.revision();
    let wrong =
        ["0".repeat(64), setup.secrets[INTEGRATOR][1..].to_owned(), setup.secrets[INTEGRATOR].to_uppercase() + "0"];
    let secret = &setup.secrets[INTEGRATOR];
    let mut headers: Vec<String> = wrong.iter().map(|w| format!("Authorization: Bearer {w}\r\n")).collect();
    headers.extend([
        String::new(),
        "Authorization: Bearer \r\n".into(),
        format!("Authorization: Basic {secret}\r\n"),
        format!("Authorization: {secret}\r\n"),
        format!("Cookie: token={secret}\r\n"),
        format!("Authorization: Bearer {}\r\nAuthorization: Bearer {secret}\r\n", wrong[0]),
    ]);
    let rest = format!("If-Match: \"{revision}\"\r\nContent-Type: application/json\r\n");
    for headers in headers {
        let (status, document) = setup.request("GET", "/regions", &headers, "");
        assert_eq!(status, 401, "{headers}");
        assert!(document["regions"].is_null() && document["revision"].is_null());
        for (path, body) in [
            ("/switch", json!({ "region": "cart", "active": true })),
            ("/clear", json!({ "robot": "left", "regions": ["pallet"], "repeat_robot": "left" })),
        ] {
            let headers = headers.clone() + &rest;
            assert_eq!(setup.request("POST", path, &headers, &body.to_string()).0, 401, "{path} {headers}");
        }
    }
    // A secret in the address is not accepted: addresses are written to logs.
    assert_eq!(setup.request("GET", &format!("/regions?token={secret}"), "", "").0, 401);
    assert!(!setup.is_on("cart"));
    assert_eq!(setup.revision(), revision, "nothing was logged");
    setup.assert_alive();
}

#[test]
fn pages_of_others_and_other_hosts_are_refused() {
    let setup = Setup::new();
    let body = json!({ "region": "cart", "active": true }).to_string();
    let rest = format!("If-Match: \"{}\"\r\nContent-Type: application/json\r\n", setup.revision());
    for origin in ["http://evil.example", "null", &format!("https://{}", setup.address), "http://localhost:1"] {
        let headers = format!("Origin: {origin}\r\n{}{rest}", setup.bearer(PROGRAMMER));
        assert_eq!(setup.request("POST", "/switch", &headers, &body).0, 403, "{origin}");
        assert_eq!(setup.request("GET", "/regions", &headers, "").0, 403, "{origin}");
    }
    // A browser that asks for permission in advance gets none.
    let asks = "Origin: http://evil.example\r\nAccess-Control-Request-Method: POST\r\n\
                Access-Control-Request-Headers: authorization\r\n";
    let preflight = format!("OPTIONS /switch HTTP/1.1\r\nHost: {}\r\n{asks}\r\n", setup.address);
    let answer = setup.answer(preflight.as_bytes());
    assert!(read(&answer).0 == 405 && !answer.to_lowercase().contains("access-control-allow"), "{answer}");
    for host in ["evil.example", "evil.example:80", "127.0.0.1", "127.0.0.1:1", "0.0.0.0:80"] {
        let bearer = setup.bearer(PROGRAMMER);
        let request = format!("GET /regions HTTP/1.1\r\nHost: {host}\r\n{bearer}\r\n");
        assert_eq!(read(&setup.answer(request.as_bytes())).0, 421, "{host}");
    }
    assert!(!setup.is_on("cart"));
    setup.assert_alive();
}

#[test]
fn paths_bodies_and_documents_that_are_wrong_are_refused() {
    let setup = Setup::new();
    let bearer = setup.bearer(INTEGRATOR);
    for path in [
        "/../../etc/passwd",
        "/..%2f..%2fetc%2fpasswd",
        "/regions/../../etc/passwd",
        "//etc/passwd",
        "/%2e%2e/",
        "/tokens.toml",
    ] {
        let (status, document) = setup.request("GET", path, &bearer, "");
        assert!(status == 404 && !document.to_string().contains("root:"), "{path}: {status}");
    }
    for (method, path) in
        [("DELETE", "/regions"), ("POST", "/regions"), ("GET", "/switch"), ("PUT", "/clear"), ("TRACE", "/switch")]
    {
        assert_eq!(setup.request(method, path, &bearer, "").0, 405, "{method} {path}");
    }
    let right = format!("{bearer}If-Match: \"{}\"\r\n", setup.revision());
    let json = format!("{right}Content-Type: application/json\r\n");
    let body = json!({ "region": "cart", "active": true }).to_string();
    assert_eq!(setup.request("POST", "/switch", &right, &body).0, 415);
    assert_eq!(setup.request("POST", "/switch", &format!("{right}Content-Type: text/plain\r\n"), &body).0, 415);
    assert_eq!(setup.request("POST", "/switch", &format!("{bearer}Content-Type: application/json\r\n"), &body).0, 428);
    let deep = "[".repeat(60_000);
    for wrong in [
        "",
        "{",
        "null",
        "[]",
        "true",
        "{\"region\":\"cart\"}",
        "{\"region\":1,\"active\":true}",
        &deep,
        "{\"region\":\"cart\",\"active\":\"yes\"}",
        "{\"region\":\"cart\",\"active\":true,\"as\":\"integrator\"}",
        "{\"region\":\"cart\",\"region\":\"wall\",\"active\":true}",
        "\u{0}\u{1}\u{2}",
    ] {
        let (status, document) = setup.request("POST", "/switch", &json, wrong);
        assert!(status == 422 && document["error"].is_string(), "{wrong:.60}: {status} {document}");
    }
    let note = json!({ "region": "cart", "active": true, "note": "x".repeat(501) }).to_string();
    assert_eq!(setup.request("POST", "/switch", &json, &note).0, 422);
    let large = format!("{{\"region\":\"{}\",\"active\":true}}", "x".repeat(4 << 20));
    // A client that continues to write may not read the answer.
    assert!(matches!(setup.request("POST", "/switch", &json, &large).0, 413 | 0));
    let host = setup.address;
    let claims = format!("POST /switch HTTP/1.1\r\nHost: {host}\r\n{json}Content-Length: 99999999999999\r\n\r\n{{}}");
    assert_eq!(read(&setup.answer(claims.as_bytes())).0, 413);
    assert!(matches!(
        read(&setup.answer(format!("GET /{} HTTP/1.1\r\n", "x".repeat(100_000)).as_bytes())).0,
        400 | 414 | 431 | 0
    ));
    assert!(!setup.is_on("cart"));
    setup.assert_alive();
}

#[test]
fn a_request_that_is_sent_again_has_no_effect() {
    let setup = Setup::new();
    let before = setup.revision();
    let on = json!({ "region": "cart", "active": true });
    let (status, done) = setup.change_at(PROGRAMMER, "/switch", &before, &on);
    assert_eq!(status, 200);
    assert_ne!(done["revision"], json!(before));
    assert_eq!(setup.switch(PROGRAMMER, "cart", false).0, 200);
    // The first request is recorded and sent again, or another request was faster.
    let (status, document) = setup.change_at(PROGRAMMER, "/switch", &before, &on);
    assert_eq!(status, 412);
    assert!(document["error"].as_str().unwrap().contains(&setup.revision()));
    assert!(!setup.is_on("cart"));
    assert_eq!(setup.changes().len(), 2);
    setup.assert_alive();
}

#[test]
fn every_change_is_in_the_log_and_follows_the_one_before() {
    let mut setup = Setup::new();
    let noted = json!({ "region": "cart", "active": true, "note": "cart arrives" });
    assert_eq!(setup.change(PROGRAMMER, "/switch", &noted).0, 200);
    assert_eq!(setup.switch(OPERATOR, "cart", false).0, 403);
    let (_, done) = setup.switch(INTEGRATOR, "cart", false);
    let entries = setup.changes();
    let said = |i: usize| {
        let e = &entries[i];
        let change = &e.changes[0];
        let value = |v: &Option<String>| v.clone().unwrap_or_default();
        let (item, field) = (change.item.as_str(), change.field.as_str());
        format!(
            "{} {} {} {item} {field} {} {}",
            e.sequence,
            e.class,
            e.action,
            value(&change.before),
            value(&change.after)
        )
    };
    assert_eq!(entries.len(), 2);
    assert_eq!(said(0), "2 programmer switch region.cart region.cart active false true");
    assert_eq!(said(1), "3 integrator switch region.cart region.cart active true false");
    assert_eq!((entries[0].note.as_deref(), entries[0].name.as_str()), (Some("cart arrives"), "programmer"));
    for entry in &entries {
        assert_eq!(
            (&entry.checksum_before, &entry.checksum),
            (&setup.cell.approval.checksum, &setup.cell.approval.checksum)
        );
    }
    assert_eq!(done["entry"], serde_json::to_value(&entries[1]).unwrap());
    let written = std::fs::read_to_string(setup.log()).unwrap();
    assert!(setup.secrets.iter().all(|secret| !written.contains(secret)));
    // One service at a time writes the log; the next one continues where it ended.
    drop(setup.0.service.take());
    std::fs::write(setup.log(), written.replacen("cart arrives", "cart departs", 1)).unwrap();
    assert!(control_history(&setup.log()).unwrap_err().to_string().contains("was modified"));
}

#[test]
fn nodes_hear_what_was_switched_and_no_program_switches_without_a_token() {
    for obeys_programs in [false, true] {
        let setup = Setup::with(obeys_programs);
        let tables: Arc<Mutex<Option<RegionTableMessage>>> = Arc::default();
        let heard = tables.clone();
        let handler = Box::new(move |bytes: &[u8]| *heard.lock().unwrap() = serde_json::from_slice(bytes).ok());
        let keys = Keys::new(&setup.cell.name);
        let network = setup.network();
        let _subscription = network.subscribe(&keys.regions(), handler).unwrap();
        let is_published = |on: bool| {
            let table = tables.lock().unwrap();
            table.as_ref().is_some_and(|t| t.regions.contains(&("cart".to_owned(), on)))
        };
        assert_eq!(setup.switch(PROGRAMMER, "cart", true).0, 200);
        eventually("the nodes do not hear of it", || is_published(true));
        let mut programs = network.publisher(&keys.switch(), Urgency::RealTime).unwrap();
        for region in ["cart", "cart", "wall", "nothing"] {
            programs.publish(json!({ "robot": "left", "region": region, "active": false }).to_string().as_bytes());
        }
        if obeys_programs {
            eventually("a program does not switch", || is_published(false));
        } else {
            let reported = || setup.events.lock().unwrap().iter().filter(|e| e.contains("was ignored")).count();
            eventually("the request is not reported", || reported() == 1);
            assert!(setup.is_on("cart"));
            assert_eq!(reported(), 1, "{:?}", setup.events.lock().unwrap());
        }
        assert!(setup.is_on("wall"));
    }
}

#[test]
fn a_region_is_not_switched_on_around_a_robot() {
    let setup = Setup::new();
    let mut left = Controller::new(&setup, "left");
    let mut right = Controller::new(&setup, "right");
    let switched = |left: &mut Controller, right: &mut Controller, q: f64, qd: f64| {
        eventually("the joint values do not arrive", || {
            left.say(q, qd);
            right.say(0.0, 0.0);
            setup.regions()["robots"].as_array().unwrap().iter().all(|r| r["heard"] == true)
        });
        // Repeated until these joint values are the last ones received.
        for _ in 0..5 {
            left.say(q, qd);
            right.say(0.0, 0.0);
            std::thread::sleep(Duration::from_millis(20));
        }
        setup.switch(PROGRAMMER, "cart", true)
    };
    let (status, document) = switched(&mut left, &mut right, 1.7, 0.0);
    assert_eq!(
        (status, document["robot"].as_str(), document["distance_m"].as_f64()),
        (409, Some("left"), Some(0.0)),
        "{document}"
    );
    assert!(!setup.is_on("cart"));
    // 250 mm away, at 1 m/s: the robot cannot stop outside any more.
    let (status, document) = switched(&mut left, &mut right, 1.3, 1.0);
    let distance_m = document["distance_m"].as_f64().unwrap_or(0.0);
    assert!(status == 409 && (distance_m - 0.25).abs() < 1e-6, "{status} {document}");
    assert!(document["error"].as_str().unwrap().starts_with("robot `left` is 250 mm from region `cart` and may need"));
    assert!(!setup.is_on("cart"));
    assert_eq!(setup.changes(), [], "what was refused is no change");
    let (status, document) = switched(&mut left, &mut right, 1.3, 0.0);
    assert_eq!((status, &document["not_heard"]), (200, &json!([])), "{document}");
    assert!(setup.is_on("cart"));
    assert_eq!(setup.switch(PROGRAMMER, "cart", false).0, 200);
    // Robots that are not heard: the region is switched on, which protects, and the answer names them.
    eventually("the robots are still heard", || {
        setup.regions()["robots"].as_array().unwrap().iter().all(|r| r["heard"] == false)
    });
    let (status, document) = setup.switch(PROGRAMMER, "cart", true);
    assert_eq!((status, &document["not_heard"]), (200, &json!(["left", "right"])));
}

/// The guard of a robot, as its node has it: it reports where the robot is, and receives its grants.
struct SpokenFor {
    guard: Arc<Mutex<Guard>>,
    clock: Clock,
    states: Box<dyn Publisher>,
    _grants: Subscription,
}

impl SpokenFor {
    fn new(setup: &Setup, robot: usize) -> Self {
        let (keys, network, name) = (Keys::new(&setup.cell.name), setup.network(), &setup.cell.robots[robot].name);
        let guard = Guard::new(RobotSlot(robot), 1, configuration_number(&setup.cell), Boot(boot_number()));
        let guard = Arc::new(Mutex::new(guard));
        let heard = guard.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            if let Ok(Message::Grants(grants)) = wire::decode(bytes) {
                let _ = heard.lock().unwrap().receive(&grants);
            }
        });
        let grants = network.subscribe(&keys.interlock_grants(name), handler).unwrap();
        let states = network.publisher(&keys.interlock_state(name), Urgency::RealTime).unwrap();
        Self { guard, clock: Clock::start(), states, _grants: grants }
    }

    fn say(&mut self, occupancy: Occupancy) {
        let mut guard = self.guard.lock().unwrap();
        guard.observe(SlotId(0), occupancy);
        let state = guard.state(self.clock.micros());
        drop(guard);
        self.states.publish(&wire::encode(&Message::State(state)).unwrap());
    }
}

#[test]
fn a_robot_is_cleared_by_name_by_an_integrator_and_only_in_silence() {
    let setup = Setup::new();
    let (mut left, mut right) = (SpokenFor::new(&setup, 0), SpokenFor::new(&setup, 1));
    let holder = || setup.regions()["regions"][0]["holder"].clone();
    eventually("left does not get the region", || {
        left.say(Occupancy::Inside);
        right.say(Occupancy::Warning);
        holder() == json!("left")
    });
    let right_request =
        json!({ "robot": "left", "regions": ["pallet"], "repeat_robot": "left", "note": "stands outside" });
    let with = |key: &str, value: Value| {
        let mut request = right_request.clone();
        request[key] = value;
        request
    };
    assert_eq!(setup.change(PROGRAMMER, "/clear", &right_request).0, 403);
    assert_eq!(setup.change(OPERATOR, "/clear", &right_request).0, 403);
    for (wrong, expected) in [
        (with("robot", json!("lift")), 404),
        (with("repeat_robot", json!("right")), 422),
        (with("repeat_robot", json!("")), 422),
        (with("regions", json!([])), 422),
        (with("regions", json!(["pallets"])), 422),
        (with("regions", json!(["pallet", "pallet"])), 422),
        (with("regions", json!(["pallet", "cart"])), 422),
        (with("regions", json!("pallet")), 422),
    ] {
        let (status, document) = setup.change(INTEGRATOR, "/clear", &wrong);
        assert_eq!(status, expected, "{wrong}: {document}");
    }
    // The robot still reports.
    left.say(Occupancy::Inside);
    let (status, document) = setup.change(INTEGRATOR, "/clear", &right_request);
    assert!(status == 409 && document["wait_s"].as_f64().unwrap() > 0.1, "{document}");
    assert_eq!(setup.changes(), [], "what was refused is no change");
    // The left robot is silent from now on; the right one keeps waiting, and gets the region only after the clearing.
    let silent = Instant::now();
    let mut refused = 0;
    eventually("it cannot be cleared", || {
        right.say(Occupancy::Warning);
        assert_eq!(holder(), json!("left"));
        let (status, document) = setup.change(INTEGRATOR, "/clear", &right_request);
        refused += usize::from(status == 409);
        assert!(status == 200 || document["wait_s"].is_number(), "{document}");
        status == 200
    });
    assert!(refused > 0 && silent.elapsed() > Duration::from_millis(50), "after {:?}", silent.elapsed());
    eventually("right does not get the region", || {
        right.say(Occupancy::Warning);
        holder() == json!("right")
    });
    let entries = setup.changes();
    assert_eq!(
        (entries.len(), entries[0].action.as_str(), entries[0].class.as_str()),
        (1, "clear robot.left", "integrator")
    );
    assert!(entries[0].changes.iter().any(|c| c.item == "robot.left" && c.field == "cleared of region.pallet"));
    // A repeated request now has an outdated revision.
    assert_eq!(setup.change_at(INTEGRATOR, "/clear", &"0".repeat(16), &right_request).0, 412);
    setup.assert_alive();
}

#[test]
fn hanging_connections_keep_nobody_out() {
    const WAVES: usize = 10;
    const WAVE: usize = 100;
    let setup = Setup::new();
    let address = setup.address;
    let mut hanging: Vec<TcpStream> = Vec::new();
    let mut slowest = Duration::ZERO;
    for _ in 0..WAVES {
        hanging.clear();
        for k in 0..WAVE {
            let Ok(mut stream) = TcpStream::connect(address) else { continue };
            let sent = match k % 3 {
                // Nothing, half a head, and a head without its body.
                0 => String::new(),
                1 => format!("GET /regions HTTP/1.1\r\nHost: {address}\r\nX-Slow: "),
                _ => format!("POST /switch HTTP/1.1\r\nHost: {address}\r\nContent-Length: 1000\r\n\r\n"),
            };
            let _ = stream.write_all(sent.as_bytes());
            hanging.push(stream);
        }
        let asked = Instant::now();
        setup.assert_alive();
        slowest = slowest.max(asked.elapsed());
    }
    eprintln!("{} connections, the slowest of four requests in a row took {slowest:?}", WAVES * WAVE);
    assert!(slowest < Duration::from_secs(10), "{slowest:?}");
}

/// Documented in `docs/security.md`: a client without a token at the control address.
#[test]
fn a_flood_of_connections_keeps_nobody_out() {
    let setup = Setup::new();
    let (address, is_over, connections) = (setup.address, AtomicBool::new(false), AtomicU64::new(0));
    let flood = || {
        let mut hanging = VecDeque::new();
        while !is_over.load(Ordering::SeqCst) {
            let Ok(mut stream) = TcpStream::connect(address) else { continue };
            let _ = stream.write_all(b"GET /r");
            hanging.push_back(stream);
            connections.fetch_add(1, Ordering::SeqCst);
            // Earlier connections are closed, so that the flood does not run out of open files.
            if hanging.len() > 150 {
                hanging.pop_front();
            }
        }
    };
    let (mut answered, mut slowest) = (0, Duration::ZERO);
    std::thread::scope(|scope| {
        let _floods = [scope.spawn(flood), scope.spawn(flood)];
        // More connections than the server has places.
        eventually("a flood", || connections.load(Ordering::SeqCst) > 400);
        for _ in 0..40 {
            let asked = Instant::now();
            let request = format!(
                "GET /regions HTTP/1.1\r\nHost: {address}\r\nAuthorization: Bearer {}\r\nConnection: close\r\n\r\n",
                setup.secrets[OPERATOR]
            );
            answered += usize::from(setup.answer(request.as_bytes()).starts_with("HTTP/1.1 200"));
            slowest = slowest.max(asked.elapsed());
        }
        is_over.store(true, Ordering::SeqCst);
    });
    eprintln!("{connections:?} connections, {answered} of 40 requests answered, the slowest took {slowest:?}");
    assert!(answered >= 38 && slowest < Duration::from_secs(10), "{answered} of 40, {slowest:?}");
}

#[test]
fn a_service_that_cannot_be_protected_does_not_start() {
    let folder = tempfile::tempdir().unwrap();
    let (file, tokens) = (folder.path().join("cell.toml"), folder.path().join("tokens.toml"));
    std::fs::write(&file, CELL).unwrap();
    let start = |address: &str, arbiter: bool| {
        let endpoint = Endpoint::new(address, None).map_err(|e| e.to_string())?;
        let control = ControlOptions { endpoint, tokens: tokens.clone(), log: None, program_switches: false };
        let robots = if arbiter { Vec::new() } else { vec!["left".into()] };
        let listen = Some("127.0.0.1:0".into());
        let options = ServiceOptions { listen, arbiter, robots, control: Some(control), ..ServiceOptions::default() };
        Service::start(Cell::load(&file).unwrap(), &options).map(drop).map_err(|e| e.to_string())
    };
    // By default only this computer reaches the service.
    assert!(DEFAULT_ADDRESS.parse::<SocketAddr>().unwrap().ip().is_loopback());
    assert!(start("127.0.0.1:0", true).unwrap_err().contains("tokens.toml"));
    AccessTokens::add(&tokens, AccessClass::Operator, "panel").unwrap();
    assert!(start("0.0.0.0:7448", true).unwrap_err().contains("ssh -L 7448"));
    assert!(start("cell.local:7448", true).unwrap_err().contains("is no address"));
    assert!(start("127.0.0.1:0", false).unwrap_err().contains("does not have the arbiter"));
    assert_eq!(start("127.0.0.1:0", true), Ok(()));
    std::fs::write(file.with_extension("control.jsonl"), "{}\n").unwrap();
    assert!(start("127.0.0.1:0", true).unwrap_err().contains("cell.control.jsonl:1"));
}
