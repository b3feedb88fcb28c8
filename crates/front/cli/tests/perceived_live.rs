//! `elbowroom live` with cameras and point clouds: pictures of a crate that no file names arrive while the cell runs, on standard
//! input and on a key. The truth is kept apart.
#![cfg(feature = "live")]
#![allow(clippy::print_stdout, reason = "figures of the evidence")]

use std::fmt::Write as _;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::common::command;
use crate::common::live_process::LiveProcess;
use crate::perceived_run::{
    CAMERA, CLOUD, FRAMES, LATENCY_S, LEARNING, cell, clearance, crate_at, stamp_s, write_clouds, write_pictures,
};
use elbowroom::cell::Cell;
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::live::Keys;
use elbowroom::live::messages::JointState;
use elbowroom::live::network::{Network, Publisher, Subscription, Urgency, ZenohNetwork, ZenohSettings};
use elbowroom_testkit::network::free_address;

/// The first joint at the end of the move, rad.
const GOAL: f64 = -60.0 * std::f64::consts::PI / 180.0;

/// However a test ends, the process ends by itself.
const FOR: [&str; 2] = ["--for", "100"];

/// Joint values and when they arrived.
type HeardJoints = Arc<Mutex<Vec<(Instant, Vec<f64>)>>>;

/// A live cell in a process, and what its robot does.
struct LiveCell {
    process: LiveProcess,
    events: Arc<Mutex<Vec<String>>>,
    joints: HeardJoints,
    network: ZenohNetwork,
    keys: Keys,
    _subscription: Subscription,
}

impl LiveCell {
    /// Starts the cell of a folder, and waits until its robot is heard.
    fn start(dir: &Path, frames: &str, others: &[&str]) -> Self {
        let address = free_address();
        let arguments = ["live", "cell.toml", "--simulate", "--listen", &address, "--frames", frames];
        let mut process =
            command(dir, &arguments).args(others).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let events: Arc<Mutex<Vec<String>>> = Arc::default();
        let lines = BufReader::new(process.stderr.take().unwrap()).lines();
        let told = events.clone();
        std::thread::spawn(move || lines.map_while(Result::ok).for_each(|line| told.lock().unwrap().push(line)));
        // A process that has ended is not waited for.
        let began = Instant::now();
        while !events.lock().unwrap().iter().any(|line| line.contains("robot(s) guarded")) {
            assert!(process.try_wait().unwrap().is_none() && began.elapsed().as_secs() < 30, "{:?}", events.lock());
            std::thread::sleep(Duration::from_millis(20));
        }
        let settings = ZenohSettings { connect: Some(address), ..ZenohSettings::default() };
        let network = ZenohNetwork::open(&settings).unwrap();
        let keys = Keys::new(&Cell::load(dir.join("cell.toml")).unwrap().name);
        let joints = HeardJoints::default();
        let heard = joints.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            let mut state = JointState::default();
            state.decode(bytes).unwrap();
            heard.lock().unwrap().push((Instant::now(), state.q));
        });
        let subscription = network.subscribe(&keys.joint_states("kr"), handler).unwrap();
        let cell = Self { process: LiveProcess(process), events, joints, network, keys, _subscription: subscription };
        cell.wait(30.0, |q| q.len() == 6);
        cell
    }

    fn child(&mut self) -> &mut Child {
        &mut self.process.0
    }

    fn last(&self) -> Option<Vec<f64>> {
        self.joints.lock().unwrap().last().map(|(_, q)| q.clone())
    }

    fn wait(&self, longest_s: f64, holds: impl Fn(&[f64]) -> bool) {
        let began = Instant::now();
        while !self.last().is_some_and(|q| holds(&q)) {
            assert!(began.elapsed().as_secs_f64() < longest_s, "{:?} {:?}", self.last(), self.events());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn events(&self) -> Vec<String> {
        self.events.lock().unwrap().clone()
    }

    /// How far the arm was from the true crate, m, and when. The crate moves from `begun` on.
    fn clearance(&self, begun: Instant) -> (f64, f64) {
        let mut trace = "head\n".to_owned();
        for (at, q) in self.joints.lock().unwrap().iter().filter(|(at, _)| *at >= begun) {
            let q: Vec<String> = q.iter().map(f64::to_string).collect();
            writeln!(trace, "{},,{}", (*at - begun).as_secs_f64(), q.join(",")).unwrap();
        }
        let robot = load(&elbowroom_testkit::folder::model("kr125"), &LoadOptions::default()).unwrap().robot;
        clearance(&trace, &robot, |t_s| crate_at(t_s, f64::INFINITY))
    }
}

/// Sends the pictures of a folder at their times, each `LATENCY_S` after it was taken, and the last one again and again, until
/// `is_over`. Returns when the first one was taken.
fn send(folder: &Path, ending: &str, mut is_over: impl FnMut(usize) -> bool, mut send: impl FnMut(&[u8])) -> Instant {
    let begun = Instant::now();
    for i in LEARNING.. {
        if is_over(i) {
            break;
        }
        let due = Duration::from_secs_f64(stamp_s(i) + LATENCY_S);
        std::thread::sleep(due.saturating_sub(begun.elapsed()));
        let stem = if ending == "png" { "frame" } else { "cloud" };
        send(&std::fs::read(folder.join(format!("{stem}_{:04}.{ending}", i.min(FRAMES - 1)))).unwrap());
    }
    begun
}

/// The robot has arrived beyond the crate, on a path of its own, and has never been near it.
fn check_arrival(cell: &LiveCell, begun: Instant) {
    let (least_m, when_s) = cell.clearance(begun);
    println!("least distance to the true crate {:.0} mm at {when_s:.2} s; {:?}", least_m * 1e3, cell.events());
    assert!(cell.last().is_some_and(|q| (q[0] - GOAL).abs() < 1e-3), "{:?}", cell.last());
    assert!(cell.events().iter().any(|event| event == "kr: continues on a new path"), "{:?}", cell.events());
    assert!(least_m > 0.03, "{least_m} m at {when_s} s");
}

#[test]
fn a_live_arm_goes_around_a_crate_that_only_a_camera_on_a_pipe_knows() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CAMERA, "planned")).unwrap();
    write_pictures(dir.path(), FRAMES, f64::INFINITY);
    let mut cell = LiveCell::start(dir.path(), "above=-", &FOR);
    let mut pipe = cell.child().stdin.take().unwrap();
    let has_arrived = |i: usize| cell.last().is_some_and(|q| (q[0] - GOAL).abs() < 1e-3) || i > 10 * FRAMES;
    let begun = send(&dir.path().join("pictures"), "png", has_arrived, |picture| pipe.write_all(picture).unwrap());
    check_arrival(&cell, begun);
}

#[test]
fn a_live_arm_goes_around_a_crate_that_only_clouds_on_a_key_know() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CLOUD, "planned")).unwrap();
    write_clouds(dir.path(), FRAMES, f64::INFINITY);
    let cell = LiveCell::start(dir.path(), "mast=key", &FOR);
    let mut clouds: Box<dyn Publisher> = cell.network.publisher(&cell.keys.frames("mast"), Urgency::RealTime).unwrap();
    let has_arrived = |i: usize| cell.last().is_some_and(|q| (q[0] - GOAL).abs() < 1e-3) || i > 10 * FRAMES;
    let begun = send(&dir.path().join("clouds"), "pcd", has_arrived, |cloud| clouds.publish(cloud));
    check_arrival(&cell, begun);
}

#[test]
fn a_live_arm_stops_if_its_camera_is_silent_and_never_starts_before_it_has_seen_anything() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CAMERA, "planned")).unwrap();
    write_pictures(dir.path(), FRAMES, f64::INFINITY);
    let mut cell = LiveCell::start(dir.path(), "above=-", &FOR);
    let start = cell.last().unwrap();
    std::thread::sleep(Duration::from_secs(2));
    assert_eq!(cell.last().unwrap(), start, "it moved before its camera had seen anything");
    let mut pipe = cell.child().stdin.take().unwrap();
    // Pictures until it moves: the crate is still far away then.
    let has_moved = |i: usize| cell.last().is_some_and(|q| (q[0] - start[0]).abs() > 0.1) || i > LEARNING + 140;
    send(&dir.path().join("pictures"), "png", has_moved, |picture| pipe.write_all(picture).unwrap());
    assert!((cell.last().unwrap()[0] - start[0]).abs() > 0.05, "it never moved");
    drop(pipe);
    std::thread::sleep(Duration::from_secs(2));
    let stopped = cell.last().unwrap();
    std::thread::sleep(Duration::from_secs(1));
    assert!(cell.last().unwrap() == stopped && (stopped[0] - GOAL).abs() > 0.3, "{stopped:?}");
    let events = cell.events();
    let told = |what: &str| events.iter().any(|event| event.starts_with(what));
    assert!(told("sensor above: there are no more pictures"), "{events:?}");
    assert!(told("kr: waits: the sensor above"), "{events:?}");
}

#[test]
fn a_live_arm_waits_while_another_robot_of_the_cell_is_not_heard() {
    let dir = tempfile::tempdir().unwrap();
    let alone = cell(CLOUD, "planned").replace("[cloud.mast]", "[cloud.mast]\nrobot = \"kr\"\nrobots = [\"kr\"]");
    let other = "[robot.absent]\nbase = { at = [0, 9000, 0] }\ndh = [{ a = 400, min = -90, max = 90, speed = 90 }]\n\
                 links = [{ sphere = { radius = 50 } }]\n";
    std::fs::write(dir.path().join("cell.toml"), format!("{alone}\n{other}")).unwrap();
    write_clouds(dir.path(), FRAMES, f64::INFINITY);
    let cell = LiveCell::start(dir.path(), "mast=key", &["--robots", "kr", "--arbiter", "--for", "100"]);
    let start = cell.last().unwrap();
    let mut clouds: Box<dyn Publisher> = cell.network.publisher(&cell.keys.frames("mast"), Urgency::RealTime).unwrap();
    send(&dir.path().join("clouds"), "pcd", |i| i >= LEARNING + 75, |cloud| clouds.publish(cloud));
    assert_eq!(cell.last().unwrap(), start, "it moved, though nobody knew where the other robot was");
    let events = cell.events();
    let told = "absent: its joint values are not received; the robots that sensors guard wait";
    assert!(events.iter().any(|event| event == told), "{events:?}");
}

#[test]
fn clouds_that_are_too_many_or_unreadable_stop_the_arm_and_not_the_process() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CLOUD, "planned")).unwrap();
    write_clouds(dir.path(), LEARNING + 1, f64::INFINITY);
    let mut cell = LiveCell::start(dir.path(), "mast=key", &["--for", "4"]);
    let mut clouds: Box<dyn Publisher> = cell.network.publisher(&cell.keys.frames("mast"), Urgency::RealTime).unwrap();
    let cloud = std::fs::read(dir.path().join(format!("clouds/cloud_{LEARNING:04}.pcd"))).unwrap();
    let began = Instant::now();
    while cell.child().try_wait().unwrap().is_none() {
        assert!(began.elapsed().as_secs() < 30, "it does not end: {:?}", cell.events());
        let unreadable = began.elapsed().as_secs_f64() < 1.0;
        clouds.publish(if unreadable { b"no cloud" } else { &cloud });
        std::thread::sleep(Duration::from_millis(1));
    }
    let events = cell.events();
    assert!(events.iter().any(|event| event.starts_with("sensor mast: rejected: ")), "{events:?}");
    assert!(events.iter().any(|event| event == "sensor mast: is used again"), "{events:?}");
}

#[test]
fn what_is_no_sensor_or_no_pipe_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CLOUD, "planned")).unwrap();
    write_clouds(dir.path(), LEARNING, f64::INFINITY);
    let refused = |frames: &[&str]| {
        let frames = frames.iter().flat_map(|source| ["--frames", source]);
        let mut live = command(dir.path(), &["live", "cell.toml", "--simulate", "--listen", "127.0.0.1:0"]);
        let answer = live.args(frames).output().unwrap();
        assert_eq!(answer.status.code(), Some(2));
        String::from_utf8(answer.stderr).unwrap()
    };
    for (frames, message) in [
        (&["mast=nowhere"][..], "no named pipe is there\n  write: mkfifo nowhere before it"),
        (&["mast=clouds"], "a folder belongs into the cell file"),
        (&["mast=cell.toml"], "no named pipe is there"),
        (&["above=-"], "no sensor of this name guards a simulated robot of this process\n  help: mast"),
        (&["mast=-"], "clouds do not come from a pipe\n  help: --frames mast=key"),
        (&["mast=key", "mast=key"], "is given twice\n  help: one source"),
    ] {
        let told = refused(frames);
        assert!(told.contains(message), "{told}");
    }
}
