//! View of a cell at rest whose robots are moved: the distances equal those of the engine.

use crate::common::{Page, cell, settings};
use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel, configure};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{RegionId, RegionSweep};
use elbowroom_query::{Level, QueryKind, QueryStates, evaluate};
use elbowroom_testkit::random::{split_mix, unit};
use elbowroom_view::Server;
use serde_json::{Value, json};

const AGREED_M: f64 = 1e-9;

fn random_q(cell: &Cell, robot: usize, random: &mut u64) -> Vec<f64> {
    let chain = &cell.robots[robot].robot.chain;
    let range = chain.lower().into_iter().zip(chain.upper());
    range.map(|(lower, upper)| lower + (upper - lower) * unit(split_mix(random))).collect()
}

/// Returns the answer of `elbowroom query CELL --ask distance --states` for this state.
fn query(cell: &Cell, q: &[Vec<f64>]) -> (f64, [String; 2]) {
    let model = QueryModel::of_cell(cell);
    let names =
        |r: &elbowroom_cell::CellRobot| r.joint_names().iter().map(|j| format!("{}.{j}", r.name)).collect::<Vec<_>>();
    let header: Vec<String> = cell.robots.iter().flat_map(names).collect();
    let values: Vec<String> = q.iter().flatten().map(|v| format!("{v:?}")).collect();
    let text = format!("{}\n{}\n", header.join(","), values.join(","));
    let states = QueryStates::parse("states.csv".as_ref(), &text, &model).unwrap();
    let mut found = None;
    evaluate(&model.scene(OutOfReachProofs::Omit).unwrap(), &states, QueryKind::Distance, Level::Auto, &mut |rows| {
        let (a, b) = rows[0].pair.unwrap();
        found = Some((rows[0].distance_m.unwrap(), [model.geometry_name(a), model.geometry_name(b)]));
        true
    })
    .unwrap();
    found.unwrap()
}

/// Returns the monitors' distances of a robot from its regions.
fn regions(cell: &Cell, robot: usize, q: &[f64]) -> Vec<(String, f64)> {
    let setup = &configure::setups(cell).unwrap()[robot];
    let mut sweep = RegionSweep::new(&setup.configuration);
    assert!(sweep.advance(&setup.configuration, q, &[], cell.timing.tick_s));
    let names = setup.configuration.regions().iter().map(|r| r.name.clone()).enumerate();
    names.map(|(i, name)| (name, sweep.distance(&setup.configuration, RegionId(i), f64::INFINITY).unwrap())).collect()
}

/// Whether a frame shows a robot at these joint values; JSON may change the last bit of a number.
fn is_at(frame: &Value, robot: usize, q: &[f64]) -> bool {
    let shown = frame["robots"][robot]["q"].as_array().unwrap();
    shown.len() == q.len() && shown.iter().zip(q).all(|(a, b)| (a.as_f64().unwrap() - b).abs() < 1e-12)
}

fn metres(value: &Value) -> f64 {
    value["distance_m"].as_f64().unwrap()
}

#[test]
fn distances_are_those_of_query_and_of_the_monitors() {
    let cell = cell();
    let server = Server::jog(&cell, settings()).unwrap();
    let mut page = Page::of(&server);
    page.frame().unwrap();
    let mut random = 3;
    let mut contacts = 0;
    for _ in 0..60 {
        let q: Vec<Vec<f64>> = (0..2).map(|robot| random_q(&cell, robot, &mut random)).collect();
        for (robot, q) in q.iter().enumerate() {
            page.send(&json!({ "type": "jog", "robot": robot, "q": q }));
        }
        let frame = page.frame_where(|frame| (0..2).all(|r| is_at(frame, r, &q[r])));
        let (expected, pair) = query(&cell, &q);
        assert!((metres(&frame["nearest"]) - expected).abs() < AGREED_M, "{frame} {expected} {pair:?}");
        contacts += usize::from(expected == 0.0);
        let all = frame["robots"].as_array().unwrap().iter();
        let of_robots = all.flat_map(|r| [&r["nearest"], &r["nearest_self"]]).filter(|n| !n.is_null()).map(metres);
        assert_eq!(of_robots.fold(f64::INFINITY, f64::min), metres(&frame["nearest"]));
        for (robot, q) in q.iter().enumerate() {
            let measured = frame["robots"][robot]["distances"].as_array().unwrap();
            let expected = regions(&cell, robot, q);
            assert_eq!(measured.len(), expected.len());
            for (found, (name, expected)) in measured.iter().zip(&expected) {
                assert_eq!(found["region"], name.as_str());
                assert!((metres(found) - expected).abs() < AGREED_M, "{name}: {found} {expected}");
            }
        }
    }
    assert!((1..60).contains(&contacts), "{contacts} of 60 states are in contact");
}

#[test]
fn the_tool_centre_point_follows_and_what_cannot_be_is_refused_with_a_reason() {
    let cell = cell();
    let server = Server::jog(&cell, settings()).unwrap();
    let mut page = Page::of(&server);
    let begin = page.frame().unwrap();
    let at = |frame: &Value| {
        let list = &frame["robots"][0]["tcp"]["position_m"];
        [0, 1, 2].map(|k| list[k].as_f64().unwrap())
    };
    let start = at(&begin);
    let target = [start[0] - 0.05, start[1] + 0.03, start[2] + 0.04];
    page.send(&json!({ "type": "tcp", "robot": 0, "position_m": target }));
    let moved = page.frame_where(|frame| frame["number"] != begin["number"]);
    assert_eq!(moved["message"], "");
    assert!(at(&moved).iter().zip(target).all(|(a, b)| (a - b).abs() < 1e-6), "{moved}");
    let turned = |frame: &Value| -> f64 {
        let q = |f: &Value| [0, 1, 2, 3].map(|k| f["robots"][0]["tcp"]["quaternion_xyzw"][k].as_f64().unwrap());
        let dot: f64 = q(frame).iter().zip(q(&begin)).map(|(a, b)| a * b).sum();
        2.0 * dot.abs().min(1.0).acos()
    };
    assert!(turned(&moved) < 1e-6, "the orientation is kept");
    // The server's forward kinematics equal the chain's.
    let robot = &cell.robots[0];
    let mut state = ChainState::new(&robot.robot.chain);
    let q: Vec<f64> = serde_json::from_value(moved["robots"][0]["q"].clone()).unwrap();
    state.q.copy_from_slice(&q);
    robot.robot.chain.forward_motion(&mut state);
    let tcp = robot.tcp(&state).0.to_array();
    assert!(at(&moved).iter().zip(tcp).all(|(a, b)| (a - b).abs() < 1e-12));

    for (command, reason) in [
        (json!({ "type": "tcp", "robot": 0, "position_m": [5.0, 0.0, 0.0] }), "out of reach"),
        (json!({ "type": "jog", "robot": 0, "q": [9.0, 0.0, 0.0, 0.0, 0.0, 0.0] }), "degrees, not at 515.66"),
        (json!({ "type": "jog", "robot": 0, "q": [0.0] }), "has 6 joints, not 1"),
        (json!({ "type": "jog", "robot": 7, "q": [0.0] }), "there is no robot 7"),
        (json!({ "type": "tcp", "robot": 7, "position_m": [0.0, 0.0, 0.0] }), "there is no robot 7"),
        (
            json!({ "type": "tcp", "robot": 0, "position_m": [0.5, 0.0, 0.5], "quaternion_xyzw": [0.0, 0.0, 0.0, 0.0] }),
            "the pose is not finite",
        ),
    ] {
        page.send(&command);
        let frame = page.frame_where(|frame| frame["message"].as_str().unwrap().contains(reason));
        assert_eq!(frame["robots"][0]["q"], moved["robots"][0]["q"], "{command}");
    }
    page.send(&json!({ "type": "home" }));
    let home = page.frame_where(|frame| frame["message"] == "");
    assert_eq!(home["robots"][0]["q"], begin["robots"][0]["q"]);
}

#[test]
fn regions_are_entered_left_and_held() {
    let cell = cell();
    let server = Server::jog(&cell, settings()).unwrap();
    let mut page = Page::of(&server);
    let state = |frame: &Value, robot: usize, name: &str| {
        let regions = frame["robots"][robot]["regions"].as_array().unwrap().clone();
        regions.into_iter().find(|r| r["name"] == name).unwrap()
    };
    let begin = page.frame().unwrap();
    assert_eq!(state(&begin, 0, "later")["active"], false);
    assert_eq!(begin["slots"][0]["holder"], json!(null));
    // The small arm reaches into the exchange region first; then the other one has to wait.
    page.send(&json!({ "type": "jog", "robot": 1, "q": [0.0, 0.0] }));
    let held = page.frame_where(|frame| frame["robots"][1]["q"] == json!([0.0, 0.0]));
    assert_eq!(held["slots"][0]["holder"], "right", "{held}");
    assert_eq!(state(&held, 1, "shared")["inside"], true);
    let reaching = [32.0_f64, 30.0, 40.0, 0.0, 50.0, 0.0].map(f64::to_radians);
    page.send(&json!({ "type": "jog", "robot": 0, "q": reaching }));
    let waits = page.frame_where(|frame| frame["number"].as_u64() > held["number"].as_u64());
    assert_eq!(waits["message"], "", "{waits}");
    assert_eq!(waits["slots"][0]["queue"], json!(["left"]), "{waits}");
    assert_eq!(state(&waits, 0, "shared")["closed"], true);
    assert!(waits["robots"][0]["override"].as_f64().unwrap() < 1.0);
    page.send(&json!({ "type": "home" }));
    let home = page.frame_where(|frame| frame["robots"][1]["q"] == begin["robots"][1]["q"]);
    assert_eq!(home["slots"][0]["holder"], json!(null));
    // A new page gets the earlier events.
    let mut late = Page::of(&server);
    let events = loop {
        let document = late.next().unwrap();
        if document["type"] == "events" {
            break document["events"].clone();
        }
    };
    let names: Vec<&str> = events.as_array().unwrap().iter().filter_map(|e| e["event"].as_str()).collect();
    for name in ["granted", "waiting", "released", "inside_in", "inside_out"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(!names.contains(&"fault"));
}
