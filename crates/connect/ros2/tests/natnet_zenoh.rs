//! Comparison of bytes, hashes, keys, tokens and attachments with `natnet_zenoh` 0.1.0, which shares no code with
//! elbowroom. Its output is in `golden/natnet_zenoh.txt`, made by `golden/generator`.

use std::collections::HashMap;

use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::builtin_interfaces::Time;
use elbowroom_ros2::msgs::control_msgs::SpeedScalingFactor;
use elbowroom_ros2::msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use elbowroom_ros2::msgs::geometry_msgs::{Pose, Quaternion, Transform, TransformStamped};
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::msgs::std_msgs::{ColorRGBA, Header, Text};
use elbowroom_ros2::msgs::tf2_msgs::TFMessage;
use elbowroom_ros2::msgs::trajectory_msgs::JointTrajectoryPoint;
use elbowroom_ros2::msgs::visualization_msgs::{Marker, MarkerArray};
use elbowroom_ros2::rmw_zenoh::{Attachment, Distribution, Endpoint, EndpointKind, Gid, Node, Qos, Topic};

/// Output of the other implementation, by label.
struct Golden(HashMap<&'static str, &'static str>);

impl Golden {
    fn new() -> Self {
        let lines = include_str!("golden/natnet_zenoh.txt").lines();
        Self(lines.map(|line| line.split_once('\t').unwrap()).collect())
    }

    fn text(&self, label: &str) -> &str {
        self.0.get(label).unwrap_or_else(|| panic!("`{label}` is not in the file"))
    }

    fn bytes(&self, label: &str) -> Vec<u8> {
        let hex = self.text(label);
        (0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()).collect()
    }

    /// Checks that the message is written to and read from these bytes, and that its type has this hash.
    fn check<M: Message + PartialEq + std::fmt::Debug>(&self, label: &str, message: &M) {
        let bytes = self.bytes(label);
        assert_eq!(message.encode(), bytes, "{label}");
        assert_eq!(&M::decode(&bytes).unwrap(), message, "{label}");
        assert_eq!(M::type_hash(), self.text(&format!("hash {}", M::NAME)));
    }
}

fn header() -> Header {
    Header { stamp: Time { sec: -3, nanosec: 999_999_999 }, frame_id: "wörld".into() }
}

#[test]
fn joint_states_have_the_same_bytes() {
    // Names of every length modulo eight: every alignment of the following numbers.
    for length in 0..9 {
        let name = vec!["j".repeat(length), "joint_2".into()];
        let (position, velocity) = (vec![0.1, -0.0], vec![f64::MIN_POSITIVE]);
        let state = JointState { header: header(), name, position, velocity, effort: vec![] };
        Golden::new().check(&format!("joint states {length}"), &state);
    }
}

#[test]
fn markers_have_the_same_bytes() {
    let mut marker = Marker {
        header: header(),
        ns: "region/column".into(),
        id: -7,
        r#type: Marker::TRIANGLE_LIST,
        scale: [1.0, 2.0, 3.0].into(),
        color: ColorRGBA { r: 0.1, g: 0.2, b: 0.3, a: 1.0 },
        frame_locked: true,
        points: vec![[1.0, 2.0, 3.0].into(); 3],
        colors: vec![ColorRGBA { r: 1.0, ..ColorRGBA::default() }; 2],
        text: "60 mm".into(),
        ..Marker::default()
    };
    marker.mesh_file.data = vec![1, 2, 3];
    marker.pose = Pose { orientation: Quaternion { w: 1.0, ..Quaternion::default() }, ..Pose::default() };
    let array = MarkerArray { markers: vec![marker.clone(), Marker::default(), marker] };
    Golden::new().check("markers", &array);
}

#[test]
fn other_messages_have_the_same_bytes() {
    let golden = Golden::new();
    let rotation = Quaternion { x: 0.5, y: -0.5, z: 0.5, w: -0.5 };
    let transform = TransformStamped {
        header: header(),
        child_frame_id: "ns16/link_6".into(),
        transform: Transform { translation: [1.0, 2.0, 3.0].into(), rotation },
    };
    golden.check("transforms", &TFMessage { transforms: vec![transform.clone(), transform] });
    let values = vec![KeyValue::new("override", 0.5), KeyValue::new("", "")];
    let status = DiagnosticStatus { level: DiagnosticStatus::STALE, values, ..DiagnosticStatus::default() };
    golden.check("diagnostics", &DiagnosticArray { header: header(), status: vec![status.clone(), status] });
    golden.check("text", &Text { data: "<robot name=\"ns16\"/>".into() });
    golden.check("factor", &SpeedScalingFactor { factor: 0.25 });
    let point = JointTrajectoryPoint { velocities: vec![0.5; 5], effort: vec![1.0], ..JointTrajectoryPoint::default() };
    golden.check("point", &point);
}

fn node(namespace: &str) -> Node {
    Node { domain: 7, session: "a1b2c3".into(), id: 3, namespace: namespace.into(), name: "elbowroom".into() }
}

#[test]
fn tokens_keys_and_identities_are_the_same() {
    let golden = Golden::new();
    for namespace in ["/", "/cell/left"] {
        assert_eq!(node(namespace).token(), golden.text(&format!("node {namespace}")));
    }
    assert_eq!(node("").token(), node("/").token());
    let (node, topic) = (node("/cell/left"), Topic::of::<TFMessage>("/tf", Distribution::Jazzy));
    let profiles = [
        ("keep_last 10", Qos::keep_last(10)),
        ("keep_last 42", Qos::keep_last(42)),
        ("latched", Qos::latched()),
        ("sensor_data", Qos::sensor_data()),
    ];
    for (label, qos) in profiles {
        for (kind, short) in [(EndpointKind::Publisher, "MP"), (EndpointKind::Subscription, "MS")] {
            let endpoint = Endpoint { node: &node, id: 11, kind, topic: &topic, qos };
            assert_eq!(endpoint.token(), golden.text(&format!("token {label} {short}")));
            assert_eq!(endpoint.gid().0[..], golden.bytes(&format!("gid {label} {short}")));
        }
    }
    assert_eq!(topic.key(7), golden.text("key"));
    assert!(Topic::of::<TFMessage>("/tf", Distribution::Humble).key(0).ends_with("/TypeHashNotSupported"));
    assert!(topic.key_of_any_release(0).ends_with("TFMessage_/*"));
}

#[test]
fn attachments_are_the_same() {
    let ours = Attachment { sequence: 1, stamp_ns: -5, source: Gid([9; 16]) };
    let theirs = Golden::new().bytes("attachment");
    assert_eq!(ours.encode()[..], theirs);
    assert_eq!(Attachment::decode(&theirs), Ok(ours));
    assert!(Attachment::decode(&[0; 32]).is_err() && Attachment::decode(&[0; 33]).is_err());
}
