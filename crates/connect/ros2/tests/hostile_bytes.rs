//! A million changed messages cause no panic, in bounded time and memory.
#![allow(clippy::print_stdout)]

use std::time::{Duration, Instant};

use elbowroom_ros2::msgs::control_msgs::{JointTrajectoryControllerState, JointTrajectoryReference};
use elbowroom_ros2::msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use elbowroom_ros2::msgs::elbowroom_msgs::{MonitorConfiguration, MonitorTick};
use elbowroom_ros2::msgs::geometry_msgs::TransformStamped;
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::msgs::std_msgs::Text;
use elbowroom_ros2::msgs::tf2_msgs::TFMessage;
use elbowroom_ros2::msgs::visualization_msgs::{Marker, MarkerArray};
use elbowroom_ros2::rmw_zenoh::Attachment;
use elbowroom_ros2::{CdrError, Message};
use elbowroom_testkit::extent::amount;
use elbowroom_testkit::random::SplitMix;

/// Time limit, for a debug build on a busy machine.
const AT_MOST: Duration = Duration::from_mins(5);

fn joint_state() -> JointState {
    JointState {
        name: (1..=6).map(|i| format!("joint_{i}")).collect(),
        position: vec![0.1, -0.2, 1.3, f64::NAN, 0.0, -0.0],
        velocity: vec![1.0; 6],
        ..JointState::default()
    }
}

fn diagnostics() -> DiagnosticArray {
    let values = vec![KeyValue::new("override", 0.5), KeyValue::new("reason", "near forbidden region `column`")];
    let status =
        DiagnosticStatus { level: DiagnosticStatus::WARN, name: "ns16".into(), values, ..DiagnosticStatus::default() };
    DiagnosticArray { status: vec![status.clone(), status], ..DiagnosticArray::default() }
}

fn markers() -> MarkerArray {
    let points = (0..5).map(|i| [f64::from(i), 2.0, 3.0].into()).collect();
    let marker = Marker { ns: "region/column".into(), points, text: "60 mm".into(), ..Marker::default() };
    MarkerArray { markers: vec![marker; 3] }
}

type Decode = fn(&[u8]) -> Result<(), CdrError>;

fn decode<M: Message>(bytes: &[u8]) -> Result<(), CdrError> {
    let message = M::decode(bytes)?;
    // A message that was read is written again; reading it again gives the same bytes.
    let again = message.encode();
    assert_eq!(M::decode(&again)?.encode(), again);
    Ok(())
}

fn seeds() -> Vec<(Vec<u8>, Decode)> {
    let transform = TransformStamped { child_frame_id: "ns16/link_6".into(), ..TransformStamped::default() };
    let tick = MonitorTick { q: vec![0.5; 6], granted: vec![1, 2], ..MonitorTick::default() };
    vec![
        (joint_state().encode(), decode::<JointState>),
        (diagnostics().encode(), decode::<DiagnosticArray>),
        (markers().encode(), decode::<MarkerArray>),
        (TFMessage { transforms: vec![transform; 4] }.encode(), decode::<TFMessage>),
        (Text { data: "<robot/>".into() }.encode(), decode::<Text>),
        (JointTrajectoryControllerState::default().encode(), decode::<JointTrajectoryControllerState>),
        (JointTrajectoryControllerState::default().encode(), |b| {
            JointTrajectoryReference::decode_prefix(b).map(|_| ())
        }),
        (tick.encode(), decode::<MonitorTick>),
        (MonitorConfiguration::default().encode(), decode::<MonitorConfiguration>),
        (Attachment::default().encode().to_vec(), |b| {
            let _ = Attachment::decode(b);
            Ok(())
        }),
    ]
}

/// Changes, truncates, lengthens or repeats bytes.
fn mutate(bytes: &mut Vec<u8>, random: &mut SplitMix) {
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len().max(1));
        match random.below(6) {
            0 => bytes.truncate(at),
            1 => bytes.extend((0..random.below(16)).map(|_| random.below(256) as u8).collect::<Vec<_>>()),
            // A changed length.
            2 => {
                let length = [u32::MAX, 0, 1, 1 << 16, 1 << 31][random.below(5)].to_le_bytes();
                let at = at & !3;
                bytes.iter_mut().skip(at).zip(length).for_each(|(byte, new)| *byte = new);
            }
            3 => {
                let part = bytes[at.min(bytes.len())..].to_vec();
                bytes.extend(part);
                bytes.truncate(1 << 16);
            }
            _ => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.below(8)),
        }
    }
}

#[test]
fn changed_messages_are_refused_or_read() {
    let seeds = seeds();
    for (bytes, decode) in &seeds {
        decode(bytes).unwrap();
    }
    let mut random = SplitMix(17);
    let begin = Instant::now();
    let (mut read, mut slowest) = (0, Duration::ZERO);
    let messages = amount(250_000, 1_000_000);
    for i in 0..messages {
        let (seed, decode) = &seeds[i % seeds.len()];
        let mut bytes = seed.clone();
        mutate(&mut bytes, &mut random);
        let one = Instant::now();
        read += usize::from(decode(&bytes).is_ok());
        slowest = slowest.max(one.elapsed());
    }
    println!("{messages} messages in {:?}, {read} of them still read, the slowest in {slowest:?}", begin.elapsed());
    assert!(begin.elapsed() < AT_MOST);
    assert!(read > messages / 20 && read < messages, "the changes test nothing: {read} are read");
}

#[test]
fn a_length_that_cannot_be_is_refused_before_memory_is_taken() {
    let mut bytes = TFMessage::default().encode();
    bytes[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(matches!(TFMessage::decode(&bytes), Err(CdrError::Count { count: u32::MAX, remaining: 0, .. })));
    let mut text = Text { data: "abc".into() }.encode();
    text[4] = 200;
    assert!(matches!(Text::decode(&text), Err(CdrError::Count { count: 200, .. })));
}

#[test]
fn every_refusal_says_what_is_wrong() {
    let big_endian = [0, 0, 0, 0, 0, 0, 0, 1, 0];
    assert!(Text::decode(&big_endian).unwrap_err().to_string().contains("little-endian"));
    assert!(Text::decode(&[]).unwrap_err().to_string().contains("little-endian"));
    let mut text = Text { data: "abc".into() }.encode();
    *text.last_mut().unwrap() = b'd';
    assert!(Text::decode(&text).unwrap_err().to_string().contains("closing zero"));
    let mut trailing = Text { data: "abc".into() }.encode();
    trailing.extend([0; 4]);
    assert_eq!(Text::decode(&trailing), Err(CdrError::Trailing(4)));
}
