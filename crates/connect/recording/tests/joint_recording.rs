//! Joint states of recordings that other programs wrote.

use elbowroom_recording::{BagError, JointRecording};
use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

fn record(opcode: u8, body: &[&[u8]]) -> Vec<u8> {
    let body = body.concat();
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), &body].concat()
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

fn schema(id: u16, name: &str) -> Vec<u8> {
    record(3, &[&id.to_le_bytes(), &text(name), &text("ros2msg"), &text("")])
}

fn channel(id: u16, schema: u16, topic: &str) -> Vec<u8> {
    record(4, &[&id.to_le_bytes(), &schema.to_le_bytes(), &text(topic), &text("cdr"), &0_u32.to_le_bytes()])
}

fn message(channel: u16, time_ns: u64, payload: &[u8]) -> Vec<u8> {
    let time = time_ns.to_le_bytes();
    record(5, &[&channel.to_le_bytes(), &0_u32.to_le_bytes(), &time, &time, payload])
}

/// Makes a chunk of records, compressed as rosbag2 does it in its fast setting.
fn chunk(records: &[Vec<u8>]) -> Vec<u8> {
    let plain = records.concat();
    let compressed = compress_to_vec(&plain[..], CompressionLevel::Fastest);
    let size = |n: usize| (n as u64).to_le_bytes();
    let head =
        [&[0; 16][..], &size(plain.len()), &0_u32.to_le_bytes(), &text("zstd"), &size(compressed.len())].concat();
    record(6, &[&head, &compressed])
}

fn file(records: &[Vec<u8>]) -> Vec<u8> {
    [MAGIC, &records.concat(), &record(15, &[&[0; 4]]), MAGIC].concat()
}

/// Makes a state at a time in milliseconds; 0 for a state without a stamp.
fn state(t_ms: u32, joints: &[(&str, f64)]) -> Vec<u8> {
    let mut state = JointState::default();
    if t_ms > 0 {
        state.header.stamp.sec = 1_700_000_000 + i32::try_from(t_ms / 1000).unwrap();
        state.header.stamp.nanosec = t_ms % 1000 * 1_000_000;
    }
    state.name = joints.iter().map(|(name, _)| (*name).to_owned()).collect();
    state.position = joints.iter().map(|(_, value)| *value).collect();
    state.encode()
}

fn one_topic(messages: &[Vec<u8>]) -> Vec<Vec<u8>> {
    let all = messages.iter().zip(1_u64..).map(|(payload, n)| message(7, n * 1_000_000, payload));
    [schema(2, JointState::NAME), channel(7, 2, "/joint_states")].into_iter().chain(all).collect()
}

#[test]
fn parts_of_the_joints_are_joined() {
    let messages = [
        state(1, &[("b", 1.0), ("a", 2.0)]),
        state(2, &[("gripper", 0.01)]),
        state(10, &[("a", 3.0), ("b", 1.5)]),
        state(10, &[("gripper", 0.02)]),
        state(9, &[("a", 4.0)]),
        state(1012, &[("a", 5.0), ("b", 6.0)]),
    ];
    let expected: &[(f64, &[f64])] = &[(0.0, &[1.0, 2.0, 0.01]), (0.008, &[1.5, 4.0, 0.02]), (1.01, &[6.0, 5.0, 0.02])];
    let records = one_topic(&messages);
    for bytes in [file(&records), file(&[records[..2].concat(), chunk(&records[2..])])] {
        let read = JointRecording::read(&bytes[..], None).unwrap();
        assert_eq!(read.joints, ["b", "a", "gripper"]);
        assert_eq!(read.topic, "/joint_states");
        assert!(!read.cut_off);
        let rows: Vec<(f64, &[f64])> = read.rows.iter().map(|(t, q)| ((t * 1e9).round() / 1e9, &q[..])).collect();
        assert_eq!(rows, expected);
        let mut csv = Vec::new();
        read.write_csv(&mut csv).unwrap();
        assert!(String::from_utf8(csv).unwrap().starts_with("t_s,b,a,gripper\n0,1,2,0.01\n"));
    }
}

#[test]
fn without_a_stamp_the_time_of_the_recording_counts() {
    let read = JointRecording::read(&file(&one_topic(&[state(0, &[("a", 1.0)]), state(0, &[("a", 2.0)])]))[..], None);
    assert_eq!(read.unwrap().rows, [(0.0, vec![1.0]), (1_000_000_f64 * 1e-9, vec![2.0])]);
}

#[test]
fn what_cannot_be_read_is_named() {
    let two = [schema(2, JointState::NAME), channel(7, 2, "/left"), channel(8, 2, "/right")];
    let two = [&two[..], &[message(7, 1, &state(1, &[("a", 1.0)])), message(8, 2, &state(1, &[("a", 9.0)]))]].concat();
    let error = JointRecording::read(&file(&two)[..], None).unwrap_err();
    assert!(error.to_string().contains("--topic /left or --topic /right"), "{error}");
    assert_eq!(JointRecording::read(&file(&two)[..], Some("/right")).unwrap().rows, [(0.0, vec![9.0])]);
    let error = JointRecording::read(&file(&two)[..], Some("/middle")).unwrap_err();
    assert!(matches!(&error, BagError::NoJointStates { found, .. } if found.len() == 2), "{error}");

    let other = [schema(2, "std_msgs/msg/String"), channel(7, 2, "/text"), message(7, 1, b"abc")];
    let error = JointRecording::read(&file(&other)[..], None).unwrap_err();
    assert!(error.to_string().contains("ros2 bag record"), "{error}");
    let error = JointRecording::read(&file(&one_topic(&[b"abc".to_vec()]))[..], None).unwrap_err();
    assert!(matches!(error, BagError::Message { message: 0, .. }), "{error}");
    let mut unequal = JointState::decode(&state(1, &[("a", 1.0)])).unwrap();
    unequal.position.clear();
    let error = JointRecording::read(&file(&one_topic(&[unequal.encode()]))[..], None).unwrap_err();
    assert!(matches!(error, BagError::JointStateLength { names: 1, positions: 0, .. }), "{error}");
    assert!(matches!(JointRecording::read(&b"t_s,a\n0,1\n"[..], None), Err(BagError::Foreign)));
    let mut broken = chunk(&one_topic(&[state(1, &[("a", 1.0)])]));
    let end = broken.len() - 6;
    broken[end..].fill(0xff);
    assert!(matches!(JointRecording::read(&file(&[broken])[..], None), Err(BagError::Damaged { .. })));
}

#[test]
fn a_cut_off_recording_gives_what_it_has() {
    let bytes = file(&one_topic(&[state(1, &[("a", 1.0)]), state(5, &[("a", 2.0)])]));
    let read = JointRecording::read(&bytes[..bytes.len() - 40], None).unwrap();
    assert!(read.cut_off && read.rows.len() == 1, "{read:?}");
}
