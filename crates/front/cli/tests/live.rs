//! `elbowroom live` as processes on the loopback network, observed through their messages.
#![cfg(feature = "live")]

use std::collections::BTreeMap;
use std::process::Stdio;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::common::live_process::{LiveProcess, live};
use crate::common::{answer, elbowroom};
use elbowroom::live::Keys;
use elbowroom::live::network::{Network, Subscription, ZenohNetwork, ZenohSettings};
use elbowroom::status::RobotStatus;
use elbowroom_testkit::network::free_address;

const CELL_NAME: &str = "two arms, one pallet";
const ROBOTS: [&str; 2] = ["left", "right"];

/// Observations of the two robots.
#[derive(Default)]
struct Seen {
    statuses: BTreeMap<String, (RobotStatus, Instant)>,
    count: usize,
    entries: BTreeMap<String, usize>,
    /// Number of times that two robots, both heard within 0.1 s, were inside.
    shared: usize,
}

impl Seen {
    fn take(&mut self, status: RobotStatus) {
        let is_inside = |s: &RobotStatus| s.exchange.values().any(|state| state == "inside");
        let now = Instant::now();
        let before = self.statuses.get(&status.robot).is_some_and(|(s, _)| is_inside(s));
        if is_inside(&status) && !before {
            *self.entries.entry(status.robot.clone()).or_default() += 1;
        }
        self.count += 1;
        self.statuses.insert(status.robot.clone(), (status, now));
        let recent = self.statuses.values().filter(|(_, at)| now - *at < Duration::from_millis(100));
        self.shared += usize::from(recent.filter(|(s, _)| is_inside(s)).count() > 1);
    }

    fn entered(&self, robot: &str) -> usize {
        self.entries.get(robot).copied().unwrap_or(0)
    }
}

struct Observer {
    seen: Arc<Mutex<Seen>>,
    _network: ZenohNetwork,
    _subscriptions: Vec<Subscription>,
}

impl Observer {
    fn at(address: &str) -> Self {
        let settings = ZenohSettings { connect: Some(address.to_owned()), ..ZenohSettings::default() };
        let network = ZenohNetwork::open(&settings).expect("a session");
        let seen: Arc<Mutex<Seen>> = Arc::default();
        let subscribe = |robot: &&str| {
            let seen = seen.clone();
            let handler = Box::new(move |bytes: &[u8]| {
                seen.lock().unwrap().take(serde_json::from_slice(bytes).expect("a status"));
            });
            network.subscribe(&Keys::new(CELL_NAME).status(robot), handler).expect("a key")
        };
        let subscriptions = ROBOTS.iter().map(subscribe).collect();
        Self { seen, _network: network, _subscriptions: subscriptions }
    }

    fn wait(&self, what: &str, longest_s: u64, holds: impl Fn(&Seen) -> bool) {
        let began = Instant::now();
        while !holds(&self.seen.lock().unwrap()) {
            let seen = || {
                let seen = self.seen.lock().unwrap();
                let last = |(s, at): &(RobotStatus, Instant)| (at.elapsed(), s.exchange.clone(), s.reason.clone());
                (seen.count, seen.entries.clone(), seen.statuses.values().map(last).collect::<Vec<_>>())
            };
            assert!(began.elapsed() < Duration::from_secs(longest_s), "{what}: {:?}", seen());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn shared(&self) -> usize {
        self.seen.lock().unwrap().shared
    }
}

#[test]
fn a_whole_cell_in_one_process_is_published_and_never_shares_its_region() {
    let address = free_address();
    let _cell = LiveProcess::start(&["--simulate", "--listen", &address]);
    let observer = Observer::at(&address);
    observer.wait("no status", 20, |seen| seen.statuses.len() == 2);
    let (before, began) = (observer.seen.lock().unwrap().count, Instant::now());
    observer.wait("a robot never enters", 60, |seen| ROBOTS.iter().all(|r| seen.entered(r) > 0));
    let rate = (observer.seen.lock().unwrap().count - before) as f64 / began.elapsed().as_secs_f64() / 2.0;
    assert!(rate >= 10.0, "{rate} statuses per second");
    assert_eq!(observer.shared(), 0);
}

#[test]
fn processes_that_are_killed_never_make_two_robots_share_a_region() {
    let address = free_address();
    let start = |robot: &str| LiveProcess::start(&["--simulate", "--robots", robot, "--connect", &address]);
    // Robots may start before their arbiter.
    let mut robots = ROBOTS.map(start);
    let mut arbiter = LiveProcess::start(&["--arbiter", "--listen", &address]);
    let observer = Observer::at(&address);
    observer.wait("a robot never enters", 60, |seen| ROBOTS.iter().all(|r| seen.entered(r) > 0));
    let is_inside = |seen: &Seen, robot: &str| {
        seen.statuses.get(robot).is_some_and(|(s, _)| s.exchange.values().any(|state| state == "inside"))
    };
    // If a robot's process dies inside, no other robot enters until it is heard again.
    observer.wait("left never leaves", 60, |seen| !is_inside(seen, "left"));
    observer.wait("left is never inside", 60, |seen| is_inside(seen, "left"));
    robots[0] = {
        let LiveProcess(child) = &mut robots[0];
        child.kill().expect("it is killed");
        let right = observer.seen.lock().unwrap().entered("right");
        // Longer than a round of the right robot, and than the time after which a silent process is dropped.
        std::thread::sleep(Duration::from_secs(2));
        assert_eq!(
            observer.seen.lock().unwrap().entered("right"),
            right,
            "right entered beside a robot that is not known"
        );
        start("left")
    };
    // After the arbiter dies, another one continues.
    drop(arbiter);
    arbiter = LiveProcess::start(&["--arbiter", "--listen", &address]);
    let before = ROBOTS.map(|r| observer.seen.lock().unwrap().entered(r));
    observer.wait("robots do not go on with a new arbiter", 60, |seen| {
        ROBOTS.iter().zip(before).all(|(r, before)| seen.entered(r) > before)
    });
    assert_eq!(observer.shared(), 0);
    drop(arbiter);
}

#[test]
fn a_recording_of_the_service_replays_to_the_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("live.mcap");
    let arguments = ["--simulate", "--listen", &free_address(), "--for", "1.5", "--record"];
    answer(live(&arguments).arg(&file).stderr(Stdio::piped()).output().unwrap()).expect(0);
    let replay = elbowroom(folder.path(), &["replay", "live.mcap"]).expect(0);
    assert!(replay.stdout.contains("the same to the bit") && replay.stderr.is_empty(), "{}", replay.stderr);
}

#[test]
fn wrong_calls_say_what_to_write() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let taken = taken.local_addr().expect("its address").to_string();
    let folder = tempfile::tempdir().expect("a folder");
    let recorded = folder.path().join("shift.mcap").display().to_string();
    std::fs::write(&recorded, "a former recording").expect("a file");
    let cases = [
        (
            vec!["--robots", "middle", "--listen", "127.0.0.1:0"],
            "--robots middle: no robot of the cell has this name\n  help: one of left, right",
        ),
        (vec!["--connect", "nowhere"], "nowhere: not HOST:PORT\n  help: write HOST:PORT, such as 127.0.0.1:7447"),
        (vec!["--listen", "udp/127.0.0.1:7447"], "only tcp is supported"),
        (vec!["--listen", &taken], "another program listens there\n  help: another port"),
        (vec!["--web", "0.0.0.0:8080", "--listen", "127.0.0.1:0"], "--web: "),
        (vec!["--record", "/nowhere/live.mcap", "--listen", "127.0.0.1:0"], "--record: "),
        (vec!["--record", &recorded, "--listen", "127.0.0.1:0"], "is there already\n  write: the name of a recording"),
    ];
    for (arguments, message) in cases {
        let answer = answer(live(&arguments).args(["--for", "100"]).stderr(Stdio::piped()).output().unwrap());
        assert!(answer.status == 2 && answer.stderr.contains(message), "{arguments:?}: {}", answer.stderr);
    }
    assert_eq!(std::fs::read_to_string(&recorded).expect("a file"), "a former recording");
}

#[test]
fn a_network_that_others_reach_without_a_key_is_warned_of() {
    let says = |address: &str| {
        let arguments = ["--simulate", "--for", "0.2", "--listen", address];
        answer(live(&arguments).stderr(Stdio::piped()).output().unwrap()).expect(0).stderr
    };
    let warning = "warning: --listen 0.0.0.0:0: whoever reaches this network can send joint values";
    assert!(says("0.0.0.0:0").contains(warning));
    assert!(!says(&free_address()).contains("warning: --listen"));
}
