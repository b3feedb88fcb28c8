//! The page in headless Chromium, driven by Playwright: it shows what the engine computes, its controls work with mouse and
//! keyboard, it fits a narrow screen, and the console shows no errors.
//!
//! Needs Chromium, named by `ELBOWROOM_CHROMIUM`, and a Python with Playwright, named by `ELBOWROOM_PLAYWRIGHT`;
//! without them the tests pass with a message. `ELBOWROOM_SCREENSHOTS` names a folder for pictures of the page.
#![allow(clippy::print_stdout, reason = "a skipped test says so, and a frame rate is a measurement")]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::common::cell;
use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel, configure};
use elbowroom_monitor::{RegionId, RegionSweep};
use elbowroom_query::{Level, QueryKind, QueryStates, evaluate};
use elbowroom_status::{CellStatus, EventStatus, RobotStatus, SlotStatus};
use elbowroom_view::{Server, ServerSettings, StatusFeed};
use serde_json::{Value, json};

/// Largest difference between page and engine, m.
const AGREED_M: f64 = 1e-6;

/// Condition that is true at the start of the cell.
const AT_START: &str = "s.robots.every((r, i) => r.q.every((q, k) => Math.abs(q - [[110, 30, 40, 0, 50, 0], [-60, 30]][i][k] * Math.PI / 180) < 1e-9)) && !s.message";

/// Settings for any free port. With the default limits, as a browser on a busy machine is slow.
pub fn settings() -> ServerSettings {
    ServerSettings::at("127.0.0.1:0").unwrap()
}

/// Finds the browser, and the Python that drives it.
pub fn tools() -> Option<(PathBuf, PathBuf)> {
    let named = |name: &str| std::env::var_os(name).map(PathBuf::from);
    let tools = named("ELBOWROOM_CHROMIUM").zip(named("ELBOWROOM_PLAYWRIGHT"));
    if tools.is_none() {
        println!("skipped: no browser; cargo xtask test --only tests has one");
    }
    tools
}

/// Opens the page, performs steps, and returns the observation of each.
pub fn visit(url: &str, options: &Value, steps: &[Value]) -> Option<Vec<Value>> {
    let mut call = options.clone();
    call["steps"] = json!(steps);
    let seen = drive(url, &call)?;
    assert_eq!(seen["problems"], json!([]), "on the console");
    assert_eq!(seen["foreign"], json!([]), "requests to others");
    Some(seen["steps"].as_array().unwrap().clone())
}

/// Returns the answer of the script to a call.
fn drive(url: &str, call: &Value) -> Option<Value> {
    let (chromium, python) = tools()?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/page/visit.py");
    let mut child = Command::new(python)
        .arg(script)
        .arg(which(&chromium))
        .arg(url)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap_or_else(|e| panic!("the Python of Playwright: {e}"));
    child.stdin.take().unwrap().write_all(call.to_string().as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "the visit failed");
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

/// Finds the path of a program, as Playwright requires one.
fn which(program: &Path) -> PathBuf {
    if program.is_absolute() {
        return program.to_owned();
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).map(|folder| folder.join(program)).find(|p| p.is_file()).unwrap_or(program.to_owned())
}

/// Returns steps that take pictures, if a folder for them is given.
pub fn screenshots(name: &str) -> Vec<Value> {
    let Some(folder) = std::env::var_os("ELBOWROOM_SCREENSHOTS").map(PathBuf::from) else { return Vec::new() };
    vec![json!({ "do": "screenshot", "file": folder.join(format!("{name}.png")) })]
}

/// Returns the joint values on the page.
fn shown_q(state: &Value) -> Vec<Vec<f64>> {
    let robots = state["robots"].as_array().unwrap();
    robots.iter().map(|robot| serde_json::from_value(robot["q"].clone()).unwrap()).collect()
}

/// Compares everything that the page shows at its own joint values with `elbowroom query` and the monitors.
fn compare(cell: &Cell, state: &Value) {
    let q = shown_q(state);
    let model = QueryModel::of_cell(cell);
    let names =
        |r: &elbowroom_cell::CellRobot| r.joint_names().iter().map(|j| format!("{}.{j}", r.name)).collect::<Vec<_>>();
    let header: Vec<String> = cell.robots.iter().flat_map(names).collect();
    let values: Vec<String> = q.iter().flatten().map(|v| format!("{v:?}")).collect();
    let text = format!("{}\n{}\n", header.join(","), values.join(","));
    let states = QueryStates::parse("states.csv".as_ref(), &text, &model).unwrap();
    let scene = model.scene(OutOfReachProofs::Omit).unwrap();
    evaluate(&scene, &states, QueryKind::Distance, Level::Auto, &mut |rows| {
        let page = state["nearest"]["distance_m"].as_f64().unwrap();
        let engine = rows[0].distance_m.unwrap();
        assert!((page - engine).abs() < AGREED_M, "the page says {page}, query {engine}");
        true
    })
    .unwrap();
    for (robot, setup) in configure::setups(cell).unwrap().iter().enumerate() {
        let mut sweep = RegionSweep::new(&setup.configuration);
        assert!(sweep.advance(&setup.configuration, &q[robot], &[], cell.timing.tick_s));
        for (i, shown) in state["robots"][robot]["regions"].as_array().unwrap().iter().enumerate() {
            let engine = sweep.distance(&setup.configuration, RegionId(i), f64::INFINITY).unwrap();
            let page = shown["distance_m"].as_f64().unwrap();
            assert!((page - engine).abs() < AGREED_M, "{shown}: the engine says {engine}");
        }
    }
}

#[test]
fn sliders_and_dragging_move_the_robot_and_the_distances() {
    if tools().is_none() {
        return;
    }
    let cell = cell();
    let server = Server::jog(&cell, settings()).unwrap();
    let mut steps = vec![
        json!({ "do": "state" }),
        // Moved with the mouse, then set to exact values.
        json!({ "do": "slide", "id": "joint-0-1", "to": 0.7 }),
        json!({ "do": "set", "id": "joint-0-0", "value": 0.9, "until": "Math.abs(s.robots[0].q[0] - 0.9) < 1e-12" }),
        json!({ "do": "set", "id": "joint-1-0-number", "value": -20, "kind": "change", "until": "Math.abs(s.robots[1].q[0] + Math.PI / 9) < 1e-12" }),
        json!({ "do": "press", "key": "h", "until": AT_START }),
        json!({ "do": "drag", "robot": 0, "by": [25, 14] }),
        json!({ "do": "drag", "robot": 0, "axis": 2, "by": [0, 20] }),
        json!({ "do": "set", "id": "tcp-0-2", "value": 400, "kind": "change", "until": "Math.abs(s.robots[0].tcp.position_m[2] - 0.4) < 1e-6 || s.message" }),
        json!({ "do": "set", "id": "tcp-0-0", "value": 9000, "kind": "change", "until": "s.message" }),
        json!({ "do": "text", "at": "#message" }),
        json!({ "do": "press", "key": "h", "until": AT_START }),
        json!({ "do": "enter", "at": "#joint-0-0-number", "value": "500", "until": "s.message" }),
        json!({ "do": "text", "at": "#message" }),
        json!({ "do": "enter", "at": "#joint-0-0-number", "value": "-20", "until": "Math.abs(s.robots[0].q[0] + Math.PI / 9) < 1e-12" }),
    ];
    steps.extend(screenshots("jog"));
    let seen = visit(&server.url(), &json!({}), &steps).unwrap();
    for state in seen.iter().filter(|s| s.is_object()) {
        assert_eq!((&state["connection"], &state["mode"]), (&json!("open"), &json!("jog")));
        compare(&cell, state);
    }
    let q = |k: usize| shown_q(&seen[k]);
    let start: Vec<Vec<f64>> = cell.robots.iter().map(|r| r.start.clone()).collect();
    let near =
        |a: &[Vec<f64>], b: &[Vec<f64>]| a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(near(&q(0), &start));
    // 0.7 of the way from -90° to 90°, less the width of the slider's thumb.
    assert!((q(1)[0][1].to_degrees() - 36.0).abs() < 10.0, "{}", q(1)[0][1].to_degrees());
    assert!(near(&q(4), &start));
    let tcp =
        |k: usize| -> [f64; 3] { serde_json::from_value(seen[k]["robots"][0]["tcp"]["position_m"].clone()).unwrap() };
    let moved = |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|k| to[k] - from[k]);
    let by_ball = moved(tcp(4), tcp(5));
    assert!(by_ball.iter().map(|v| v * v).sum::<f64>().sqrt() > 0.02, "{by_ball:?}");
    let by_axis = moved(tcp(5), tcp(6));
    assert!(by_axis[2] < -0.01 && by_axis[0].abs() < 1e-6 && by_axis[1].abs() < 1e-6, "{by_axis:?}");
    assert_eq!(seen[7]["message"], "");
    // An unreachable target moves nothing, and causes a message.
    assert_eq!(tcp(7), tcp(8));
    assert!(seen[9].as_str().unwrap().contains("out of reach"), "{}", seen[9]);
    assert!(near(&q(10), &start));
    // A refused value does not stay in its field, and the message uses the field's unit.
    let start_deg = start[0][0].to_degrees();
    let shown: f64 = seen[11].as_str().unwrap().parse().unwrap();
    assert!((shown - start_deg).abs() < 0.01, "{shown} instead of {start_deg}");
    let message = seen[12].as_str().unwrap();
    assert!(message.contains("degrees, not at 500.00"), "{message}");
    assert_eq!(seen[13], "-20.00");
    // The drawn tool centre point equals that of the program.
    let drawn: [f64; 3] = serde_json::from_value(seen[5]["robots"][0]["tcp_drawn_m"].clone()).unwrap();
    assert!(moved(drawn, tcp(5)).iter().all(|v| v.abs() < 1e-9));
}

#[test]
fn everything_has_a_name_and_is_reached_by_the_keyboard() {
    if tools().is_none() {
        return;
    }
    let server = Server::jog(&cell(), settings()).unwrap();
    let mut steps = vec![json!({ "do": "audit" }), json!({ "do": "tab", "times": 30 })];
    // The arrow keys move a slider, the key D changes the colours.
    steps.push(json!({ "do": "focus", "at": "#joint-0-0" }));
    steps.push(json!({ "do": "press", "key": "ArrowRight", "until": "s.robots[0].q[0] > 1.93" }));
    steps.push(json!({ "do": "press", "key": "d" }));
    steps.push(json!({ "do": "audit" }));
    steps.extend(screenshots("dark"));
    let seen = visit(&server.url(), &json!({}), &steps).unwrap();
    assert_eq!((&seen[0]["unnamed"], &seen[0]["tables"], &seen[0]["lang"]), (&json!([]), &json!(0), &json!("en")));
    assert_eq!(seen[0]["title"], "two arms – elbowroom");
    assert!(seen[0]["controls"].as_u64().unwrap() > 20);
    let reached: Vec<&str> = seen[1].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    for id in [
        "theme",
        "canvas",
        "fit",
        "look-top",
        "play",
        "scrub",
        "speed",
        "now",
        "joint-0-0",
        "joint-0-0-number",
        "tcp-0-0",
    ] {
        assert!(reached.contains(&id), "{id} is not in {reached:?}");
    }
    let start = cell().robots[0].start[0];
    assert!(shown_q(&seen[3])[0][0] > start);
    assert_ne!(seen[0]["theme"], seen[5]["theme"]);
}

#[test]
fn a_telephone_does_not_scroll_sideways() {
    if tools().is_none() {
        return;
    }
    let server = Server::jog(&cell(), settings()).unwrap();
    let mut steps = vec![json!({ "do": "audit" })];
    steps.extend(screenshots("narrow"));
    let options = json!({ "width": 390, "height": 844, "scheme": "dark" });
    let seen = visit(&server.url(), &options, &steps).unwrap();
    assert_eq!((&seen[0]["width"], &seen[0]["wide"]), (&json!(390), &json!([])));
    assert!(seen[0]["scroll"].as_u64() <= Some(390), "{}", seen[0]);
}

/// Makes a cell of four arms around a pallet, in a file of this name.
fn four_arms(name: &str) -> Cell {
    let models = elbowroom_testkit::folder::examples().join("models");
    let text = r#"
version = 1
name = "four arms"
units = { length = "mm", angle = "deg" }
[robot.north]
model = "MODELS/ns16/ns16.urdf"
base = { at = [0, 1900, 0], rpy = [0, 0, -90] }
[robot.east]
model = "MODELS/kr125/kr125.urdf"
base = { at = [2600, 0, 0], rpy = [0, 0, 180] }
[robot.south]
model = "MODELS/ns16/ns16.urdf"
base = { at = [0, -1900, 0], rpy = [0, 0, 90] }
[robot.west]
model = "MODELS/rx60b/rx60b.urdf"
base = { at = [-1400, 0, 0] }
[object.pallet]
shape = "box"
at = [0, 0, 200]
size = [800, 500, 400]
[region.pallet]
shape = "box"
base = [0, 0, 0]
size = [1000, 700, 1200]
kind = "exchange"
warning = 300
[grid.area]
from = [-500, -1500, 0]
to = [1500, 1500, 1800]
cells = [4, 6, 2]
output = 8
[region.post]
shape = "cylinder"
base = [-1300, -1300, 0]
radius = 120
height = 1500
warning = 250
"#;
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&file, text.replace("MODELS", &models.display().to_string())).unwrap();
    Cell::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

/// Makes the status of a service at a time: arms that swing, one that holds the pallet and one that waits.
fn running(cell: &Cell, t_s: f64) -> CellStatus {
    let robot = |(i, r): (usize, &elbowroom_cell::CellRobot)| RobotStatus {
        t_s,
        robot: r.name.clone(),
        q: r.start.iter().enumerate().map(|(k, q)| q + 0.4 * (t_s + (i + k) as f64).sin()).collect(),
        speed_override: 0.5 + 0.5 * t_s.cos(),
        reason: if i == 1 { "waiting for exchange region `pallet`".into() } else { "free".into() },
        region: (i == 1).then(|| "pallet".to_owned()),
        exchange: [("pallet".to_owned(), if i == 1 { "waiting" } else { "outside" }.to_owned())].into(),
        ..RobotStatus::default()
    };
    let tick = (100.0 * t_s) as u64;
    let event = |robot: &str, region: &str, event: &str| {
        let [robot, region, event] = [robot, region, event].map(str::to_owned);
        EventStatus { t_s, robot, region, event }
    };
    // One event per second, at 100 statuses per second; and a robot whose joint values come and go all the time.
    let waiting = tick.is_multiple_of(100).then(|| event("east", "pallet", "waiting"));
    let flapping = ["fault", "recovered"].map(|what| event("south", "", what));
    CellStatus {
        t_s,
        cell: cell.name.clone(),
        robots: cell.robots.iter().enumerate().map(robot).collect(),
        slots: vec![SlotStatus {
            regions: vec!["pallet".into()],
            holder: Some("north".into()),
            queue: vec!["east".into()],
            // The arbiter is silent.
            age_s: 2.0,
        }],
        events: waiting.into_iter().chain(flapping).collect(),
        ..CellStatus::default()
    }
}

#[test]
fn details_that_are_not_seen_are_not_drawn() {
    if tools().is_none() {
        return;
    }
    let server = Server::jog(&four_arms("four_arms_afar.toml"), settings()).unwrap();
    let farther = std::iter::repeat_n(json!({ "do": "press", "key": "-" }), 8);
    let mut steps = vec![json!({ "do": "sleep", "ms": 1500 })];
    steps.extend(farther);
    steps.push(json!({ "do": "sleep", "ms": 1500 }));
    steps.push(json!({ "do": "press", "key": "f" }));
    steps.push(json!({ "do": "sleep", "ms": 1500 }));
    let seen = visit(&server.url(), &json!({}), &steps).unwrap();
    let triangles = |k: usize| seen[k]["triangles"].as_f64().unwrap();
    println!("{} triangles, {} from afar", triangles(0), triangles(9));
    assert!(triangles(9) < 0.5 * triangles(0), "{} {}", triangles(9), triangles(0));
    // They are back when the camera is.
    assert_eq!(triangles(11), triangles(0));
}

struct OnDrop<'a>(&'a AtomicBool);

impl Drop for OnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[test]
fn a_running_cell_moves_is_replayed_and_found_again() {
    if tools().is_none() {
        return;
    }
    let cell = four_arms("four_arms.toml");
    let feed = StatusFeed::new();
    let server = Server::watch(&cell, &feed, settings()).unwrap();
    let ended = AtomicBool::new(false);
    let mut steps = vec![
        json!({ "do": "wait", "until": "s.t_s > 3" }),
        json!({ "do": "sleep", "ms": 3300 }),
        json!({ "do": "press", "key": " ", "until": "!s.live" }),
        json!({ "do": "sleep", "ms": 700 }),
        json!({ "do": "press", "key": "ArrowLeft" }),
        json!({ "do": "set", "id": "scrub", "value": 1.0 }),
        json!({ "do": "press", "key": "l", "until": "s.live" }),
        json!({ "do": "text", "at": "#slots" }),
        json!({ "do": "text", "at": "#events" }),
        json!({ "do": "text", "at": "#arbiter-silent" }),
        json!({ "do": "audit" }),
    ];
    steps.extend(screenshots("running"));
    let seen = std::thread::scope(|scope| {
        // Ends the other thread, even if the visit fails.
        let _end = OnDrop(&ended);
        scope.spawn(|| {
            // The service has run for a while when the page is opened.
            let begin = Instant::now();
            while !ended.load(Ordering::Relaxed) {
                feed.publish(running(&cell, begin.elapsed().as_secs_f64()));
                std::thread::sleep(Duration::from_millis(10));
            }
        });
        std::thread::sleep(Duration::from_secs(2));
        visit(&server.url(), &json!({}), &steps).unwrap()
    });
    let t = |k: usize| seen[k]["t_s"].as_f64().unwrap();
    for state in &seen[..7] {
        compare(&cell, state);
        assert_eq!((&state["mode"], &state["connection"]), (&json!("watch"), &json!("open")));
    }
    assert!(t(1) > t(0) + 3.0);
    let passed = |key: &str| seen[1][key].as_f64().unwrap() - seen[0][key].as_f64().unwrap();
    println!(
        "{:.1} pictures per second with four arms, pixels of 1/{}; the distances of an instant took {:.2} ms",
        passed("pictures") / passed("clock_s"),
        seen[1]["pixel_ratio"],
        1e3 * seen[1]["measured_in_s"].as_f64().unwrap()
    );
    assert!(passed("pictures") >= 2.0, "it moves");
    // A paused page stays at its time, a step back goes back by one, and the time line leads to any time.
    assert_eq!((t(2), &seen[2]["live"]), (t(3), &json!(false)));
    assert!((t(3) - t(4) - 0.1).abs() < 0.02, "{} {}", t(3), t(4));
    // Also to a time before the page was opened.
    assert!((t(5) - 1.0).abs() < 1e-9);
    // Earlier frames are some tenths of a second apart, more on a busy machine: the page shows one of them unchanged.
    let frame_s = seen[5]["frame_t_s"].as_f64().unwrap();
    assert!((frame_s - 1.0).abs() < 0.6, "{frame_s}");
    let expected = running(&cell, frame_s);
    let difference = (shown_q(&seen[5])[0][0] - expected.robots[0].q[0]).abs();
    assert!(difference < 1e-6, "the arm is where it was: {difference}");
    assert!(seen[6]["live"] == json!(true) && t(6) > t(3));
    let region = &seen[6]["regions"][0];
    assert_eq!((&region["holder"], &region["queue"]), (&json!("north"), &json!(["east"])));
    assert!(
        seen[7].as_str().unwrap().contains("north") && seen[8].as_str().unwrap().contains("east · waiting · pallet")
    );
    // Consecutive faults are one line.
    let events = seen[8].as_str().unwrap();
    assert_eq!(events.matches("south · fault").count(), 1, "{events}");
    // The oldest event that the page got may be the second half of a pair.
    assert!(events.matches("recovered").count() <= 2, "{events}");
    assert!(events.contains(" times in ") && events.contains(" · recovered"), "{events}");
    assert!(seen[9].as_str().unwrap().contains("2.0 s ago"), "{}", seen[9]);
    assert_eq!(seen[10]["unnamed"], json!([]));
}

#[test]
fn a_page_without_its_token_says_what_to_do() {
    let server = Server::jog(&cell(), settings()).unwrap();
    let wrong = server.url().replace("#token=", "#token=0");
    let call = json!({ "ready": false, "steps": [{ "do": "text", "at": "#trouble:visible" }] });
    let Some(seen) = drive(&wrong, &call) else { return };
    assert!(seen["steps"][0].as_str().unwrap().contains("Open the address that the program has printed"), "{seen}");
}
