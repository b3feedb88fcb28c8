//! The service in the layout of `rmw_zenoh`: Zenoh sessions on the loopback network stand in for nodes of ROS 2.
//!
//! Keys, hashes, tokens and bytes of the other side are written out, from `rmw_zenoh`'s design document, or by
//! `natnet_zenoh`.

use crate::common::rail;
use crate::ros2_peer;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::ros2_peer::{Controller, Peer, cdr_joint_state};
use elbowroom_cell::Cell;
use elbowroom_live::ros2::{Ros2Robot, Ros2Settings, Watchdog};
use elbowroom_live::{Service, ServiceOptions};
use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::diagnostic_msgs::DiagnosticArray;
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::msgs::std_msgs::Text;
use elbowroom_ros2::msgs::tf2_msgs::TFMessage;
use elbowroom_ros2::msgs::visualization_msgs::MarkerArray;
use elbowroom_testkit::network::{eventually, free_address};

/// Returns the name of the only joint of the cell above.
fn joint() -> String {
    cell().robots[0].joint_names().remove(0)
}

fn cell() -> Cell {
    stale_after(200)
}

/// Returns the cell with this age limit of joint values.
fn stale_after(ms: u32) -> Cell {
    rail(400, &format!("[monitor]\nstale_ms = {ms}\n"))
}

/// Starts a service that publishes its cell, whose robot is controlled over ROS 2.
fn start(address: &str) -> (Service, Arc<Mutex<Vec<String>>>) {
    start_cell(cell(), address)
}

fn start_cell(cell: Cell, address: &str) -> (Service, Arc<Mutex<Vec<String>>>) {
    let events: Arc<Mutex<Vec<String>>> = Arc::default();
    let reported = events.clone();
    let options = ServiceOptions {
        listen: Some(address.to_owned()),
        ros2: Ros2Settings {
            publish: true,
            robots: vec![Ros2Robot::of("rail")],
            router: Some(address.to_owned()),
            ..Ros2Settings::default()
        },
        on_event: Some(Arc::new(move |event: &str| reported.lock().unwrap().push(event.to_owned()))),
        ..ServiceOptions::default()
    };
    (Service::start(cell, &options).expect("a service"), events)
}

/// Sends valid joint states every 5 ms until the robot, far from its region, may go.
fn go(controller: &mut Controller) {
    go_at(controller, 0.2);
}

fn go_at(controller: &mut Controller, q: f64) {
    let joint = joint();
    eventually("no factor 1 for a robot far from its region", || {
        controller.send(&cdr_joint_state(&[&joint], &[q], &[0.0]));
        std::thread::sleep(Duration::from_millis(5));
        controller.last_factor() == Some(1.0)
    });
}

fn stop(controller: &Controller) {
    eventually("silence does not stop the robot", || controller.last_factor() == Some(0.0));
}

#[test]
fn joint_states_are_answered_by_factors_and_silence_by_zero() {
    let address = free_address();
    let (service, _) = start(&address);
    let mut controller = Peer::at(&address).controller("rail");
    go_at(&mut controller, 1.5);
    let silent = Instant::now();
    stop(&controller);
    // `stale_ms` is 200; the rest is for a busy machine.
    assert!(silent.elapsed() < Duration::from_millis(1200), "{:?}", silent.elapsed());
    // Near the region the factor is between 0 and 1, and smaller when moving towards it than at rest far away.
    let joint = joint();
    for step in 0..90 {
        let q = 1.5 + 0.005 * f64::from(step);
        controller.send(&cdr_joint_state(&[&joint], &[q], &[0.9]));
        std::thread::sleep(Duration::from_millis(6));
    }
    let factors = controller.factors();
    assert!(factors.iter().any(|f| *f > 0.0 && *f < 1.0), "no factor between 0 and 1: {factors:?}");
    let attachments = controller.attachments();
    assert!(attachments.iter().all(|a| a.len() == 33 && a[16] == 16));
    let sequences: Vec<i64> = attachments.iter().map(|a| i64::from_le_bytes(a[..8].try_into().unwrap())).collect();
    assert!(sequences.windows(2).all(|pair| pair[1] > pair[0]), "numbers rise");
    assert!(attachments.iter().all(|a| a[17..] == attachments[0][17..]), "one publisher");
    // A stopped service sends the factor 0.
    go_at(&mut controller, 1.5);
    drop(service);
    stop(&controller);
}

/// Sends hostile messages of one kind, `count` times, for a robot at rest: none lets it go.
fn never_a_go(controller: &mut Controller, kind: &str, count: u32, mut send: impl FnMut(&mut Controller, u32)) {
    go(controller);
    stop(controller);
    controller.clear();
    for n in 0..count {
        send(controller, n);
        std::thread::sleep(Duration::from_millis(1));
    }
    // Factors are repeated every 20 ms, so the answer to the last message is among them.
    std::thread::sleep(Duration::from_millis(40));
    let factors = controller.factors();
    assert!(!factors.is_empty() && factors.iter().all(|f| *f == 0.0), "{kind}: {factors:?}");
}

#[test]
fn hostile_joint_states_are_no_go() {
    let address = free_address();
    // A short limit, as the robot stops before each kind.
    let (_service, events) = start_cell(stale_after(40), &address);
    let peer = Peer::at(&address);
    let (mut controller, joint) = (peer.controller("rail"), joint());
    let valid = cdr_joint_state(&[&joint], &[0.2], &[0.0]);
    let wrong = [
        ("more positions than names", cdr_joint_state(&[&joint], &[0.2, 0.2], &[0.0])),
        ("no positions", cdr_joint_state(&[&joint], &[], &[0.0])),
        ("more velocities than names", cdr_joint_state(&[&joint], &[0.2], &[0.0, 0.0])),
        ("nothing at all", cdr_joint_state(&[], &[], &[])),
        ("a name that is not known", cdr_joint_state(&["elbow"], &[0.2], &[0.0])),
        ("a further name that is not known", cdr_joint_state(&[&joint, "elbow"], &[0.2, 0.2], &[0.0, 0.0])),
        ("a joint twice", cdr_joint_state(&[&joint, &joint], &[0.2, 0.2], &[0.0, 0.0])),
        ("a position that is not a number", cdr_joint_state(&[&joint], &[f64::NAN], &[0.0])),
        ("a position without end", cdr_joint_state(&[&joint], &[f64::INFINITY], &[0.0])),
        ("a velocity without end", cdr_joint_state(&[&joint], &[0.2], &[f64::NEG_INFINITY])),
        ("a position beyond the limits", cdr_joint_state(&[&joint], &[7.0], &[0.0])),
        ("bytes that follow", [&valid[..], &[0; 8]].concat()),
        ("big-endian", [&[0, 0][..], &valid[2..]].concat()),
        ("too large", [valid.clone(), vec![0; 70_000]].concat()),
    ];
    for (kind, message) in &wrong {
        never_a_go(&mut controller, kind, 10, |controller, _| controller.send(message));
    }
    never_a_go(&mut controller, "cut off", valid.len() as u32, |controller, n| {
        controller.send(&valid[..n as usize]);
    });
    let word = |at: usize| u32::from_le_bytes(valid[at..at + 4].try_into().unwrap());
    let counts: Vec<usize> = (4..valid.len()).step_by(4).filter(|at| (1..64).contains(&word(*at))).collect();
    assert_eq!(counts.len(), 5, "of the frame, the names, the name, the positions, the velocities");
    never_a_go(&mut controller, "a claimed length", 20, |controller, n| {
        let (mut message, at) = (valid.clone(), counts[n as usize % counts.len()]);
        message[at..at + 4].copy_from_slice(&[u32::MAX, 1 << 31, 1 << 16, 100][n as usize / 5 % 4].to_le_bytes());
        controller.send(&message);
    });
    never_a_go(&mut controller, "no attachment", 10, |controller, _| controller.send_with(&valid, None));
    never_a_go(&mut controller, "an attachment of an old release", 10, |controller, _| {
        controller.send_with(&valid, Some(b"\x0fsequence_number"));
    });
    never_a_go(&mut controller, "replayed", 10, |controller, _| {
        let attachment = controller.last_attachment();
        controller.send_with(&valid, Some(&attachment));
    });
    let mut other = peer.controller_of_hash("rail", &format!("RIHS01_{}", "0".repeat(64)));
    never_a_go(&mut controller, "another hash of the type", 10, |_, _| other.send(&valid));
    // The service works, and has reported the reasons.
    go(&mut controller);
    let events = events.lock().unwrap();
    for reason in ["`elbow` is no joint", "is there twice", "values in `position`", "no attachment", "little-endian"] {
        assert!(events.iter().any(|event| event.contains(reason)), "{reason}: {events:?}");
    }
}

#[test]
fn another_publisher_of_the_same_topic_is_not_mixed_in() {
    let address = free_address();
    let (_service, events) = start(&address);
    let peer = Peer::at(&address);
    let (mut controller, mut intruder, joint) = (peer.controller("rail"), peer.controller("rail"), joint());
    go(&mut controller);
    // The controller says that the robot is in the region; the stranger says that it is far away.
    for _ in 0..60 {
        controller.send(&cdr_joint_state(&[&joint], &[0.2], &[0.0]));
        intruder.send(&cdr_joint_state(&[&joint], &[1.99], &[0.0]));
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(controller.last_factor(), Some(1.0), "the other one's joint values count");
    assert!(events.lock().unwrap().iter().any(|event| event.contains("another publisher")));
}

#[test]
fn late_subscriptions_get_what_is_latched_and_every_topic_is_on_the_graph() {
    let address = free_address();
    let (_service, _) = start(&address);
    let peer = Peer::at(&address);
    let graph = |what: &str| peer.tokens().into_iter().any(|token| token.ends_with(what));
    eventually("no node on the graph", || graph("/NN/%/%/elbowroom"));
    let latched = ":1:,1:,:,:,,";
    let topics = [
        format!("MP/%/%/elbowroom/%robot_description/std_msgs::msg::dds_::String_/{TEXT_HASH}/{latched}"),
        format!("MP/%/%/elbowroom/%tf_static/tf2_msgs::msg::dds_::TFMessage_/{TF_HASH}/{latched}"),
        format!("MP/%/%/elbowroom/%tf/tf2_msgs::msg::dds_::TFMessage_/{TF_HASH}/::,100:,:,:,,"),
        format!(
            "MP/%/%/elbowroom/%rail%speed_scaling_input/control_msgs::msg::dds_::SpeedScalingFactor_/{}/{latched}",
            ros2_peer::FACTOR_HASH
        ),
        format!(
            "MS/%/%/elbowroom/%rail%joint_states/sensor_msgs::msg::dds_::JointState_/{}/2::,5:,:,:,,",
            ros2_peer::JOINT_STATE_HASH
        ),
    ];
    for topic in &topics {
        eventually(topic, || graph(topic));
    }
    // Some time after the messages were sent.
    std::thread::sleep(Duration::from_millis(500));
    let key = format!("0/robot_description/std_msgs::msg::dds_::String_/{TEXT_HASH}");
    let description = peer.transient_local(&key);
    eventually("no robot_description for a late subscription", || !description.lock().unwrap().is_empty());
    let text = Text::decode(&description.lock().unwrap()[0]).unwrap();
    assert!(text.data.contains("<robot") && text.data.contains("rail"), "{}", text.data);
    assert_eq!(description.lock().unwrap().len(), 1, "only the last one");
    let fixed = peer.transient_local(&format!("0/tf_static/tf2_msgs::msg::dds_::TFMessage_/{TF_HASH}"));
    eventually("no tf_static for a late subscription", || !fixed.lock().unwrap().is_empty());
    assert!(!TFMessage::decode(&fixed.lock().unwrap()[0]).unwrap().transforms.is_empty());
}

const TEXT_HASH: &str = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18";
const TF_HASH: &str = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087";
const DIAGNOSTICS_HASH: &str = "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e";
const MARKERS_HASH: &str = "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf";

#[test]
fn the_cell_is_published_while_the_robot_moves() {
    let address = free_address();
    let (_service, _) = start(&address);
    let peer = Peer::at(&address);
    let mut controller = peer.controller("rail");
    let hash = ros2_peer::JOINT_STATE_HASH;
    let joint_states = peer.volatile(&format!("0/elbowroom/joint_states/sensor_msgs::msg::dds_::JointState_/{hash}"));
    let tf = peer.volatile(&format!("0/tf/tf2_msgs::msg::dds_::TFMessage_/{TF_HASH}"));
    let diagnostics =
        peer.volatile(&format!("0/diagnostics/diagnostic_msgs::msg::dds_::DiagnosticArray_/{DIAGNOSTICS_HASH}"));
    let markers =
        |topic: &str| format!("0/elbowroom/{topic}/visualization_msgs::msg::dds_::MarkerArray_/{MARKERS_HASH}");
    let (regions, points) = (peer.transient_local(&markers("regions")), peer.volatile(&markers("nearest_points")));
    // Further along the rail than at its start, and in the warning zone.
    let joint = joint();
    let at = |q: f64| {
        let newest = joint_states.lock().unwrap().last().map(|m| JointState::decode(m).unwrap());
        newest.is_some_and(|m| {
            m.position.first().is_some_and(|p| (p - q).abs() < 1e-9) && m.name == [format!("rail/{joint}")]
        })
    };
    eventually("the joint values are not published", || {
        controller.send(&cdr_joint_state(&[&joint], &[1.95], &[0.0]));
        std::thread::sleep(Duration::from_millis(5));
        at(1.95) && !points.lock().unwrap().is_empty()
    });
    assert!(
        TFMessage::decode(tf.lock().unwrap().last().unwrap())
            .unwrap()
            .transforms
            .iter()
            .any(|t| t.child_frame_id == "rail/tcp")
    );
    eventually("no diagnostics of the input", || {
        let diagnostics = diagnostics.lock().unwrap();
        let newest = diagnostics.last().map(|m| DiagnosticArray::decode(m).unwrap().status);
        controller.send(&cdr_joint_state(&[&joint], &[1.95], &[0.0]));
        newest.is_some_and(|s| s.iter().any(|s| s.name == "elbowroom: rail input" && s.message == "arrives"))
    });
    assert!(!MarkerArray::decode(regions.lock().unwrap().last().unwrap()).unwrap().markers.is_empty());
    assert!(MarkerArray::decode(points.lock().unwrap().last().unwrap()).is_ok());
}

#[test]
fn a_service_without_a_router_of_ros_2_guards_as_before() {
    let settings = Ros2Settings { publish: true, router: Some(free_address()), ..Ros2Settings::default() };
    let options = ServiceOptions { listen: Some(free_address()), ros2: settings, ..ServiceOptions::default() };
    let began = Instant::now();
    let service = Service::start(cell(), &options).expect("a service");
    assert_eq!(service.guarded(), 1);
    drop(service);
    assert!(began.elapsed() < Duration::from_secs(10), "{:?}", began.elapsed());
}

#[test]
fn a_watchdog_is_quiet_while_the_service_is_heard_and_zero_when_it_is_not() {
    let address = free_address();
    let (service, _) = start(&address);
    let peer = Peer::at(&address);
    let mut controller = peer.controller("rail");
    let settings = Ros2Settings { router: Some(address), ..Ros2Settings::default() };
    let bound = Duration::from_millis(300);
    let _watchdog = Watchdog::start(&cell(), &settings, &[], bound, None).expect("a watchdog");
    eventually("no watchdog on the graph", || {
        peer.tokens().iter().any(|token| token.contains("/NN/%/%/elbowroom_watchdog"))
    });
    go(&mut controller);
    let sources = |controller: &Controller| {
        let mut sources: Vec<Vec<u8>> = controller.attachments().iter().map(|a| a[17..].to_vec()).collect();
        sources.sort();
        sources.dedup();
        sources.len()
    };
    controller.clear();
    std::thread::sleep(Duration::from_millis(600));
    assert_eq!(sources(&controller), 1, "the watchdog sends although the service is heard");
    // The router ends with the service: the watchdog finds the next one.
    drop(service);
    let (_service, _) = start(&controller.address);
    go(&mut controller);
}
