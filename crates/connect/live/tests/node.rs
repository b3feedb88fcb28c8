//! A node under good, missing and hostile messages: no panic, and no override above 0 without fresh, valid joint values.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::common::{rail, start_node};
use elbowroom_live::messages::{AttachedVolume, JointState, OverrideAnswer};
use elbowroom_live::network::{LocalNetwork, Network, Publisher, Subscription, UdpNetwork, Urgency};
use elbowroom_live::{Clock, ControllerClient, ControllerState, Keys, Node, configuration_number};
use elbowroom_monitor::VolumeId;
use elbowroom_spatial::Pose;
use elbowroom_testkit::network::eventually;
use elbowroom_testkit::random::{split_mix, unit};

/// A node, and the controller's side of its network.
struct Setup {
    keys: Keys,
    answers: Arc<Mutex<Vec<OverrideAnswer>>>,
    clock: Clock,
    checksum: u64,
    joint_states: Box<dyn Publisher>,
    _node: Node,
    _subscription: Subscription,
}

fn start(of_node: Arc<dyn Network>, of_controller: &dyn Network) -> Setup {
    let cell = rail(100, "");
    let (clock, checksum, keys) = (Clock::start(), configuration_number(&cell), Keys::new(&cell.name));
    let node = start_node(&cell, clock, of_node);
    let answers: Arc<Mutex<Vec<OverrideAnswer>>> = Arc::default();
    let taken = answers.clone();
    let handler = Box::new(move |bytes: &[u8]| {
        taken.lock().unwrap().push(OverrideAnswer::decode(bytes).expect("what a node sends can be read"));
    });
    let subscription = of_controller.subscribe(&keys.speed_override("rail"), handler).expect("a key");
    let joint_states = of_controller.publisher(&keys.joint_states("rail"), Urgency::RealTime).expect("a key");
    Setup { keys, answers, clock, checksum, joint_states, _node: node, _subscription: subscription }
}

fn on_one_network() -> Setup {
    let network = LocalNetwork::default();
    start(Arc::new(network.clone()), &network)
}

/// Runs a controller far from the region until it may go, and then makes it silent.
fn go_and_stop(mut s: Setup) {
    let mut client = ControllerClient::new(7, s.checksum);
    eventually("no override 1 for a robot far from its region", || {
        let state = ControllerState { q: &[0.2], qd: &[0.0], programmed_override: 1.0, ..ControllerState::default() };
        s.joint_states.publish(client.joint_state(s.clock.micros(), &state));
        std::thread::sleep(Duration::from_millis(2));
        for answer in s.answers.lock().unwrap().drain(..) {
            let mut bytes = Vec::new();
            answer.encode(&mut bytes);
            // Late answers are refused.
            let _ = client.receive(&bytes);
        }
        client.speed_override(s.clock.micros()) == 1.0
    });
    // The node answers 0 once nothing more arrives; the client stops by itself, whatever the node does.
    eventually("a silent controller is not stopped", || {
        s.answers.lock().unwrap().last().is_some_and(|answer| answer.speed_override == 0.0 && answer.reason == 5)
    });
    assert_eq!(client.speed_override(s.clock.micros()), 0.0);
    assert_eq!(s.keys.status("rail"), "elbowroom/rail/rail/status");
}

#[test]
fn joint_values_are_answered_and_silence_is_override_zero() {
    go_and_stop(on_one_network());
}

#[test]
fn udp_carries_what_zenoh_does_to_a_node_that_does_not_know_its_controller() {
    let node = UdpNetwork::bind("127.0.0.1:0", &[]).unwrap();
    let address = node.local_address().unwrap().to_string();
    let controller = UdpNetwork::bind("127.0.0.1:0", &[&address]).unwrap();
    go_and_stop(start(Arc::new(node), &controller));
}

#[test]
fn two_that_know_each_other_hear_each_datagram_once() {
    let first = UdpNetwork::bind("127.0.0.1:0", &[]).unwrap();
    let address = first.local_address().unwrap().to_string();
    let second = UdpNetwork::bind("127.0.0.1:0", &[&address]).unwrap();
    let of_second = second.local_address().unwrap().to_string();
    drop(first);
    let first = UdpNetwork::bind(&address, &[&of_second]).unwrap();
    let (mut publisher, heard) = (first.publisher("k", Urgency::RealTime).unwrap(), Arc::new(Mutex::new(Vec::new())));
    let to = heard.clone();
    let _subscription = second.subscribe("k", Box::new(move |bytes| to.lock().unwrap().push(bytes[0]))).unwrap();
    // Until its subscription arrives, `second` receives as a known peer; afterwards as a peer and a subscriber.
    for n in 0..100 {
        publisher.publish(&[n]);
        std::thread::sleep(Duration::from_millis(2));
    }
    eventually("the last datagram does not arrive", || heard.lock().unwrap().last() == Some(&99));
    assert_eq!(*heard.lock().unwrap(), (0..100).collect::<Vec<u8>>());
}

/// Makes the `n`-th message of a hostile controller; `old` are messages that were once valid.
fn hostile(n: u64, s: &Setup, random: &mut u64, old: &mut Vec<Vec<u8>>) -> Vec<u8> {
    let mut state = JointState {
        checksum: s.checksum,
        boot: 5,
        sequence: n + 1,
        stamp_us: s.clock.micros().0,
        programmed_override: 1.0,
        q: vec![0.2],
        qd: vec![0.0],
        ..JointState::default()
    };
    match n % 8 {
        0 => state.q = vec![f64::NAN],
        1 => (state.q, state.qd) = (vec![0.2; 2], vec![0.0; 2]),
        2 => state.programmed_override = 1.1 + unit(split_mix(random)),
        3 => state.checksum = s.checksum ^ 1,
        4 => state.qd = vec![f64::INFINITY],
        5 => state.sequence = 0,
        _ => {}
    }
    let mut bytes = Vec::new();
    state.encode(&mut bytes);
    match n % 8 {
        6 => {
            let at = split_mix(random) as usize % bytes.len();
            bytes[at] ^= 1 << (split_mix(random) % 8);
        }
        7 if old.len() < 64 => old.push(bytes.clone()),
        7 => bytes.clone_from(&old[split_mix(random) as usize % old.len()]),
        _ => {}
    }
    bytes
}

#[test]
fn nothing_but_fresh_valid_values_is_answered_with_more_than_zero() {
    let mut s = on_one_network();
    let count: u64 = std::env::var("ELBOWROOM_MESSAGES").ok().and_then(|n| n.parse().ok()).unwrap_or(200_000);
    let (mut random, mut old) = (17, Vec::new());
    for n in 0..count {
        let bytes = hostile(n, &s, &mut random, &mut old);
        s.joint_states.publish(&bytes);
        if n % 4096 == 0 || n < 512 {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    eventually("the last answer is not 0", || {
        s.answers.lock().unwrap().last().is_some_and(|answer| answer.speed_override == 0.0)
    });
    let answers = s.answers.lock().unwrap();
    // Only the first 64 messages of the last kind were valid when they were sent.
    let was_valid = |a: &&OverrideAnswer| a.boot == 5 && a.echo.is_multiple_of(8) && a.echo <= 64 * 8;
    let go: Vec<&OverrideAnswer> = answers.iter().filter(|a| a.speed_override > 0.0).collect();
    assert!(!go.is_empty() && go.iter().all(was_valid), "{:?}", go.iter().find(|a| !was_valid(a)));
}

#[test]
fn random_bytes_are_no_message() {
    let mut random = 3;
    let mut state = JointState::with_capacity();
    for length in (0..1200).cycle().take(100_000) {
        let bytes: Vec<u8> = (0..length).map(|_| split_mix(&mut random) as u8).collect();
        assert!(state.decode(&bytes).is_err() && OverrideAnswer::decode(&bytes).is_err());
    }
}

#[test]
fn more_volumes_or_joints_than_a_message_has_are_refused() {
    let attached = AttachedVolume { volume: VolumeId(0), in_link: Pose::IDENTITY };
    let mut read = JointState::with_capacity();
    for (joints, volumes, is_message) in
        [(32, 16, true), (33, 0, false), (6, 17, false), (300, 0, false), (6, 272, false)]
    {
        let state = JointState { q: vec![0.5; joints], attached: vec![attached; volumes], ..JointState::default() };
        let mut bytes = Vec::new();
        state.encode(&mut bytes);
        assert_eq!(read.decode(&bytes).is_ok(), is_message, "{joints} joints, {volumes} volumes");
        assert!(!is_message || read == state);
    }
}
