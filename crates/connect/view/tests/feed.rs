//! View of a running cell: published statuses arrive, and no browser delays the publisher.

use std::time::{Duration, Instant};

use crate::common::{Page, cell, limits, settings};
use elbowroom_status::{CellStatus, EventStatus, RobotStatus};
use elbowroom_view::{ClientLimits, Server, ServerSettings, StatusFeed};
use serde_json::json;

fn status(t_s: f64) -> CellStatus {
    let cell = cell();
    let robot = |r: &elbowroom_cell::CellRobot| RobotStatus {
        robot: r.name.clone(),
        q: r.start.clone(),
        speed_override: 0.5,
        reason: "near forbidden region `post`".into(),
        ..RobotStatus::default()
    };
    CellStatus {
        t_s,
        cell: cell.name.clone(),
        robots: cell.robots.iter().map(robot).collect(),
        ..CellStatus::default()
    }
}

fn event(k: usize) -> EventStatus {
    EventStatus { t_s: k as f64, robot: "left".into(), region: "post".into(), event: "warn_in".into() }
}

#[test]
fn before_the_first_status_robots_are_unknown() {
    let feed = StatusFeed::new();
    let server = Server::watch(&cell(), &feed, settings()).unwrap();
    let mut page = Page::of(&server);
    let frame = page.frame().unwrap();
    assert_eq!((&frame["robots"][0]["robot"], &frame["robots"][0]["q"]), (&json!("left"), &json!([])));
    assert_eq!(frame["robots"][0]["reason"], "no status has come");
    assert_eq!((&frame["nearest"], &frame["robots"][0]["override"]), (&json!(null), &json!(0.0)));
    // Only one robot's values are known: it has distances to objects, but not to the other robot.
    let mut half = status(0.1);
    half.robots.truncate(1);
    feed.publish(half);
    let frame = page.frame_where(|frame| frame["t_s"] == 0.1);
    assert!(frame["robots"][0]["nearest"]["distance_m"].as_f64().unwrap() > 0.0);
    assert!(!frame["robots"][0]["nearest"]["b"].as_str().unwrap().starts_with("right"));
    assert_eq!((&frame["robots"][1]["nearest"], &frame["robots"][1]["robot"]), (&json!(null), &json!("right")));
    // Robots are in the order of the cell, whatever the order of the status; joint values that do not fit are unknown.
    let mut turned = status(0.2);
    turned.robots.reverse();
    turned.robots[0].q.pop();
    feed.publish(turned);
    let frame = page.frame_where(|frame| frame["t_s"] == 0.2);
    assert_eq!((&frame["robots"][0]["robot"], &frame["robots"][1]["nearest"]), (&json!("left"), &json!(null)));
    assert_eq!(frame["robots"][0]["override"], 0.5);
}

#[test]
fn a_page_that_does_not_read_delays_neither_publisher_nor_other_pages() {
    const STATUSES: usize = 20_000;
    // Without the limit on unshown frames the network's buffers fill up, so that the server can no longer send.
    let settings = ServerSettings {
        limits: ClientLimits { unshown_frames: usize::MAX, frame_period: Duration::ZERO, ..limits() },
        ..settings()
    };
    let feed = StatusFeed::new();
    let server = Server::watch(&cell(), &feed, settings).unwrap();
    let deaf = Page::of(&server);
    let mut page = Page::of(&server);
    let template = status(0.0);
    let mut slowest = Duration::ZERO;
    for k in 1..=STATUSES {
        let mut next = template.clone();
        next.t_s = k as f64;
        next.robots[0].reason = "x".repeat(4000);
        let begin = Instant::now();
        feed.publish(next);
        slowest = slowest.max(begin.elapsed());
    }
    eprintln!("slowest of {STATUSES} calls: {slowest:?}");
    // Far below the longest time of sending; a busy machine may interrupt the process for a while.
    assert!(slowest < Duration::from_millis(200), "{slowest:?}");
    let mut received = 0;
    loop {
        received += 1;
        if page.frame().unwrap()["t_s"] == STATUSES as f64 {
            break;
        }
    }
    assert!(received < STATUSES, "the newest counts, older ones are left out");
    drop(deaf);
}

#[test]
fn a_page_that_shows_nothing_is_sent_no_more_than_a_few_frames() {
    let feed = StatusFeed::new();
    let server = Server::watch(&cell(), &feed, settings()).unwrap();
    let mut page = Page::of(&server);
    let publish = |from: usize| {
        for k in from..from + 20 {
            feed.publish(status(k as f64));
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    publish(1);
    let numbers: Vec<u64> =
        (0..limits().unshown_frames).map(|_| page.next().unwrap()["number"].as_u64().unwrap()).collect();
    page.send(&json!({ "shown": numbers.last() }));
    // The next frame is the newest, not the one that followed.
    let next = page.next().unwrap();
    assert_eq!(next["t_s"], 20.0);
    assert!(next["number"].as_u64().unwrap() > numbers.last().unwrap() + 1);
}

#[test]
fn every_event_arrives_once_however_fast_they_come() {
    let feed = StatusFeed::new();
    let server = Server::watch(&cell(), &feed, settings()).unwrap();
    let mut page = Page::of(&server);
    for k in 0..400 {
        // Listed at the cell, at the robot, or at both, it is one event.
        let mut next = status(k as f64);
        next.events.extend((k % 3 != 0).then(|| event(k)));
        next.robots[0].service.events.extend((k % 3 != 1).then(|| event(k)));
        feed.publish(next);
    }
    let mut seen = Vec::new();
    let mut frames = 0;
    while seen.len() < 400 {
        let document = page.next().unwrap();
        if let Some(number) = document["number"].as_u64() {
            frames += 1;
            page.send(&json!({ "shown": number }));
        } else {
            seen.extend(document["events"].as_array().unwrap().clone());
        }
    }
    let numbers: Vec<u64> = seen.iter().map(|e| e["number"].as_u64().unwrap()).collect();
    assert_eq!(numbers, (0..400).collect::<Vec<_>>());
    assert!(seen.iter().enumerate().all(|(k, e)| e["t_s"] == k as f64 && e["event"] == "warn_in"));
    assert!(frames < 400);
    // A page that is opened later has them too.
    let mut late = Page::of(&server);
    let events = loop {
        let document = late.next().unwrap();
        if document["type"] == "events" {
            break document;
        }
    };
    assert_eq!(events["events"].as_array().unwrap().len(), 400);
}

#[test]
fn a_running_cell_is_not_moved_by_a_page() {
    let feed = StatusFeed::new();
    let server = Server::watch(&cell(), &feed, settings()).unwrap();
    let mut page = Page::of(&server);
    feed.publish(status(1.0));
    page.frame_where(|frame| frame["t_s"] == 1.0);
    page.send(&json!({ "type": "jog", "robot": 1, "q": [0.0, 0.0] }));
    let frame = page.frame_where(|frame| frame["message"] != "");
    assert!(frame["message"].as_str().unwrap().contains("moved by their controllers"));
    assert_eq!(frame["robots"][1]["q"], json!(cell().robots[1].start));
}
