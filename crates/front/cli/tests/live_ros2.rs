//! `elbowroom live --ros2` and its watchdog as processes on the loopback network.
#![cfg(feature = "live")]

use std::process::Stdio;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::common::answer;
use crate::common::live_process::{LiveProcess, live};
use elbowroom::live::network::{Network, Subscription, ZenohNetwork, ZenohSettings};
use elbowroom_testkit::network::free_address;

const BOUND: Duration = Duration::from_millis(200);
/// Time that a busy machine may add to the bound.
const BUSY: Duration = Duration::from_millis(800);

/// Speed scaling factors of the left robot, as its controller would receive them.
struct Factors {
    heard: Arc<Mutex<Vec<(f64, Instant)>>>,
    _network: ZenohNetwork,
    _subscription: Subscription,
}

impl Factors {
    fn at(address: &str) -> Self {
        let settings = ZenohSettings { connect: Some(address.to_owned()), ..ZenohSettings::default() };
        let network = ZenohNetwork::open(&settings).expect("a session");
        let heard: Arc<Mutex<Vec<(f64, Instant)>>> = Arc::default();
        let taken = heard.clone();
        let key = "3/left/speed_scaling_input/control_msgs::msg::dds_::SpeedScalingFactor_/\
                   RIHS01_0c240f349f2b74e33e8741f83e0f196ddeb6585923663876ed3c1f51f0566037";
        let handler = Box::new(move |bytes: &[u8]| {
            let factor = bytes.get(4..12).and_then(|b| b.try_into().ok()).map(f64::from_le_bytes);
            taken.lock().unwrap().push((factor.expect("a factor"), Instant::now()));
        });
        let subscription = network.subscribe(key, handler).expect("a key");
        Self { heard, _network: network, _subscription: subscription }
    }

    fn wait(&self, what: &str, longest: Duration, holds: impl Fn(f64) -> bool) {
        let began = Instant::now();
        while !self.heard.lock().unwrap().last().is_some_and(|(factor, _)| holds(*factor)) {
            assert!(began.elapsed() < longest, "{what}");
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

#[test]
fn the_watchdog_sends_zero_when_the_service_was_killed() {
    let router = free_address();
    let _router = LiveProcess::start(&["--arbiter", "--listen", &router]);
    let factors = Factors::at(&router);
    let ros2 = ["--ros2-domain", "3", "--ros2-router", &router];
    let service = || {
        let arguments = ["--robots", "left,right", "--connect", &router, "--simulate", "--ros2"];
        LiveProcess::start(&[&arguments[..], &ros2].concat())
    };
    // Without a watchdog the last factor remains; the watchdog exists for this case.
    let stands = (0..5).any(|_| {
        let first = service();
        factors.wait("the robot never goes", Duration::from_mins(1), |factor| factor > 0.0);
        drop(first);
        std::thread::sleep(BOUND + BUSY);
        // A service that ran late has sent 0 just before its end: try again.
        factors.heard.lock().unwrap().last().is_some_and(|(factor, _)| *factor > 0.0)
    });
    assert!(stands, "no factor stands after a kill");

    let _watchdog = LiveProcess::start(&[&["--ros2-watchdog", "200"][..], &ros2].concat());
    factors.wait("a watchdog that has heard nothing sends no 0", Duration::from_secs(20), |factor| factor == 0.0);
    let second = service();
    factors.wait("the robot does not go on", Duration::from_mins(1), |factor| factor > 0.0);
    let killed = Instant::now();
    drop(second);
    factors.wait("the watchdog sends no 0", BOUND + BUSY, |factor| factor == 0.0);
    println!("factor 0 came {:?} after the kill, with a bound of {BOUND:?}", killed.elapsed());
    std::thread::sleep(BOUND);
    let after = killed + BOUND + BUSY;
    assert!(factors.heard.lock().unwrap().iter().filter(|(_, at)| *at > after).all(|(factor, _)| *factor == 0.0));
    // The watchdog lets the next service take over.
    let _third = service();
    factors.wait("the robot does not go on after the watchdog", Duration::from_mins(1), |factor| factor > 0.0);
}

#[test]
fn wrong_calls_say_what_to_write() {
    let cases = [
        (vec!["--ros2-robot", "left=a b"], "help: write ROBOT=JOINT_STATES,SPEED_SCALING"),
        (vec!["--ros2-robot", "middle"], "no robot of the cell has this name\n  help: one of left, right"),
        (vec!["--ros2-robot", "left", "--ros2-robot", "left"], "left is named twice"),
        (vec!["--ros2", "--ros2-router", "7447"], "--ros2-router: 7447: not HOST:PORT"),
        (vec!["--ros2-domain", "3"], "--ros2"),
        (vec!["--ros2", "--ros2-distro", "foxy"], "humble, jazzy"),
        (vec!["--ros2-watchdog", "100", "--robots", "middle"], "help: one of left, right"),
        (vec!["--ros2-watchdog", "1"], "10..=60000"),
    ];
    for (arguments, message) in cases {
        let listen = ["--listen", "127.0.0.1:0", "--for", "1"];
        let listen = if arguments[0] == "--ros2-watchdog" { &listen[2..] } else { &listen[..] };
        let answer = answer(live(&arguments).args(listen).stderr(Stdio::piped()).output().unwrap());
        assert!(answer.status == 2 && answer.stderr.contains(message), "{arguments:?}: {}", answer.stderr);
    }
    let domain = live(&["--ros2", "--for", "1"]).env("ROS_DOMAIN_ID", "x").stderr(Stdio::piped()).output().unwrap();
    assert!(answer(domain).stderr.contains("ROS_DOMAIN_ID is x"));
}
