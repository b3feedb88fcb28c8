//! Processes of a live cell that start again, or start twice.

use crate::common::control_setup::{ControlSetup, INTEGRATOR, PROGRAMMER, rails};
use elbowroom_cell::access::NetworkKey;
use elbowroom_live::{EventHandler, Service, ServiceOptions, region_journal_of};
use elbowroom_testkit::network::{eventually, free_address};
use serde_json::json;
use std::sync::{Arc, Mutex};
use std::time::Duration;

const CELL: &str = concat!(rails!("900", "450, 0, 1900"), "[monitor]\nstale_ms = 200\n");
const TABLE: &str = "shape = \"sphere\"\ncentre = [0, 0, 1000]\nradius = 100\nwarning = 100\nlife = \"temporary\"\n";

fn setup() -> ControlSetup {
    ControlSetup::new(CELL, false, ServiceOptions { arbiter: true, ..ServiceOptions::default() })
}

fn is_on(setup: &ControlSetup, region: &str) -> Option<bool> {
    setup.region(region).map(|r| r["active"] == true)
}

#[test]
fn the_regions_are_the_same_after_a_restart_and_the_log_says_so() {
    let mut setup = setup();
    assert_eq!(is_on(&setup, "cart"), Some(false));
    for (path, body) in [
        ("/switch", json!({ "region": "cart", "active": true })),
        ("/move", json!({ "region": "cart", "toml": "centre = [0, 0, 1800]" })),
        ("/add", json!({ "region": "table", "toml": TABLE })),
        ("/add", json!({ "region": "spare", "toml": TABLE, "active": false })),
    ] {
        let (status, document) = setup.change(PROGRAMMER, path, &body);
        assert_eq!(status, 200, "{document}");
    }
    let before = setup.regions();
    setup.restart();
    let after = setup.regions();
    assert_eq!((&after["regions"], &after["checksum"]), (&before["regions"], &before["checksum"]));
    assert_eq!(
        [is_on(&setup, "cart"), is_on(&setup, "table"), is_on(&setup, "spare")],
        [Some(true), Some(true), Some(false)]
    );
    let start = setup.logged().pop().unwrap();
    assert_eq!((start.action.as_str(), start.name.as_str()), ("start", "the service"));
    assert!(start.note.as_ref().is_some_and(|note| note.contains("as they were")), "{start:?}");
    assert_eq!(start.changes.len(), 3);
    // The service continues from there.
    assert_eq!(setup.change(PROGRAMMER, "/remove", &json!({ "region": "table" })).0, 200);
    setup.restart();
    assert_eq!([is_on(&setup, "table"), is_on(&setup, "spare")], [None, Some(false)]);
}

/// The same in a cell whose file has no region that can be switched.
#[test]
fn a_region_that_was_removed_does_not_return() {
    let text = CELL.replace("life = \"temporary\"\n", "");
    let mut setup = ControlSetup::new(&text, false, ServiceOptions { arbiter: true, ..ServiceOptions::default() });
    for (path, body) in
        [("/add", json!({ "region": "table", "toml": TABLE })), ("/remove", json!({ "region": "table" }))]
    {
        let (status, document) = setup.change(PROGRAMMER, path, &body);
        assert_eq!(status, 200, "{document}");
    }
    setup.restart();
    assert_eq!(is_on(&setup, "table"), None);
}

#[test]
fn without_a_journal_that_can_be_trusted_all_regions_are_on() {
    let mut setup = setup();
    let journal = region_journal_of(&setup.cell.file);
    let off = std::fs::read_to_string(&journal).unwrap();
    let wrong = [
        None,
        Some(String::new()),
        Some(off.chars().take(off.len() / 2).collect()),
        Some(off.replace(&setup.cell.approval.checksum[..16], &"0".repeat(16))),
        Some(off.replace("\"edits\":[]", "\"edits\":[{\"name\":\"table\",\"table\":\"shape = 3\"}]")),
    ];
    for (case, text) in wrong.into_iter().enumerate() {
        match text {
            None => std::fs::remove_file(&journal).unwrap(),
            Some(text) => {
                assert_ne!(text, off);
                std::fs::write(&journal, text).unwrap();
            }
        }
        setup.restart();
        assert_eq!([is_on(&setup, "cart"), is_on(&setup, "wall")], [Some(true); 2], "case {case}");
        let start = setup.logged().pop().unwrap();
        assert!(start.note.as_ref().is_some_and(|n| n.contains("are on until they are switched")), "{start:?}");
        assert_eq!(setup.change(PROGRAMMER, "/switch", &json!({ "region": "cart", "active": false })).0, 200);
    }
    setup.restart();
    assert_eq!(is_on(&setup, "cart"), Some(false));
}

/// A second service with the same cell file, started as a trial, does not write the file that the first one reads.
#[test]
fn a_journal_has_one_keeper() {
    let mut setup = setup();
    let journal = region_journal_of(&setup.cell.file);
    let off = std::fs::read_to_string(&journal).unwrap();
    let heard: Arc<Mutex<Vec<String>>> = Arc::default();
    let events = heard.clone();
    let on_event: EventHandler = Arc::new(move |event: &str| events.lock().unwrap().push(event.to_owned()));
    let options = ServiceOptions {
        arbiter: true,
        listen: Some(free_address()),
        journal: Some(journal.clone()),
        on_event: Some(on_event),
        ..ServiceOptions::default()
    };
    let second = Service::start(setup.cell.clone(), &options).unwrap_or_else(|e| panic!("{e}"));
    let is_said = |e: &String| e.contains("are on until they are switched") && e.contains("is kept by another process");
    assert!(heard.lock().unwrap().iter().any(is_said), "{heard:?}");
    drop(second);
    assert_eq!(std::fs::read_to_string(&journal).unwrap(), off);
    setup.restart();
    assert_eq!(is_on(&setup, "cart"), Some(false));
}

/// The arbiter counts the silence of a robot without messages from its own start, not from the first question.
#[test]
fn a_robot_that_never_spoke_is_cleared_at_the_first_request() {
    let setup = setup();
    std::thread::sleep(Duration::from_millis(1500));
    let request = json!({ "robot": "left", "regions": ["pallet"], "repeat_robot": "left" });
    let (status, document) = setup.change(INTEGRATOR, "/clear", &request);
    assert_eq!(status, 200, "{document}");
}

#[test]
fn two_nodes_that_start_at_once_never_both_go_on() {
    // Processes with a key prove their starts before their messages are accepted.
    for network_key in [None, Some(NetworkKey::generate().unwrap())] {
        let options = ServiceOptions { arbiter: true, network_key: network_key.clone(), ..ServiceOptions::default() };
        let setup = ControlSetup::new(CELL, false, options);
        let starts = std::sync::Barrier::new(2);
        let start = || {
            let (connect, network_key) = (Some(setup.listen.clone()), network_key.clone());
            let robots = vec!["left".into()];
            let options = ServiceOptions { robots, connect, network_key, ..ServiceOptions::default() };
            starts.wait();
            Service::start(setup.cell.clone(), &options)
        };
        let both = std::thread::scope(|scope| [scope.spawn(start), scope.spawn(start)].map(|t| t.join().unwrap()));
        let refused: Vec<String> = both.iter().filter_map(|s| s.as_ref().err().map(ToString::to_string)).collect();
        // On a machine that is too busy both may be refused, but never neither.
        let is_said = |why: &String| why.contains("robot left: another process guards it already");
        assert!(!refused.is_empty() && refused.iter().all(is_said), "{refused:?}");
    }
}

#[test]
fn a_second_node_for_a_robot_does_not_start() {
    let setup = setup();
    let left = || {
        let connect = Some(setup.listen.clone());
        let options = ServiceOptions { robots: vec!["left".into()], connect, ..ServiceOptions::default() };
        Service::start(setup.cell.clone(), &options)
    };
    let first = left().unwrap_or_else(|e| panic!("{e}"));
    let Err(error) = left() else { panic!("it started") };
    assert!(error.to_string().contains("robot left: another process guards it already"), "{error}");
    drop(first);
    let mut again = None;
    eventually("the first one has ended", || {
        again = left().ok();
        again.is_some()
    });
}

/// Each process reports other processes of the cell that come and go, and that nobody answers at the address of
/// `--connect`.
#[test]
fn whoever_comes_and_goes_is_named() {
    let mut setup = setup();
    let heard: Arc<Mutex<Vec<String>>> = Arc::default();
    let robot = |name: &str, listen: &str| {
        let (heard, connect) = (heard.clone(), Some(listen.to_owned()));
        let on_event: EventHandler = Arc::new(move |event: &str| heard.lock().unwrap().push(event.to_owned()));
        let options = ServiceOptions {
            robots: vec![name.into()],
            connect,
            on_event: Some(on_event),
            ..ServiceOptions::default()
        };
        Service::start(setup.cell.clone(), &options).unwrap_or_else(|e| panic!("{e}"))
    };
    let says = |what: &str, times: usize| {
        eventually(what, || heard.lock().unwrap().iter().filter(|event| event.contains(what)).count() == times);
    };
    let left = robot("left", &setup.listen);
    says("the arbiter's process is there", 1);
    // No process guards the other robot yet.
    says("robot right: no process guards it yet", 1);
    let right = robot("right", &setup.listen);
    says("robot right: its process is there", 1);
    let arbiter_says = |what: &str| eventually(what, || setup.events.lock().unwrap().iter().any(|e| e.contains(what)));
    drop(right);
    says("robot right: its process is gone", 1);
    arbiter_says("robot right: its process is gone");
    arbiter_says("robot right: not heard for");
    // If nobody listens yet, the process waits and reports that.
    drop(setup.service.take());
    says("the arbiter's process is gone", 1);
    let waits = std::thread::scope(|scope| {
        let waits = scope.spawn(|| robot("right", &setup.listen));
        says("nobody answers at", 1);
        drop(left);
        let options = ServiceOptions { arbiter: true, listen: Some(setup.listen.clone()), ..ServiceOptions::default() };
        let arbiter = Service::start(setup.cell.clone(), &options).unwrap_or_else(|e| panic!("{e}"));
        let right = waits.join();
        drop(arbiter);
        right
    });
    assert!(waits.is_ok());
}
