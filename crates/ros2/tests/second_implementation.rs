//! Bytes, hashes, keys, tokens and attachments compared with those of `natnet_zenoh`, which shares no code with us.

use elbowroom_ros2::Message as _;
use elbowroom_ros2::msgs::builtin_interfaces::Time;
use elbowroom_ros2::msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use elbowroom_ros2::msgs::geometry_msgs::{Pose, Quaternion, Transform, TransformStamped};
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::msgs::std_msgs::{ColorRGBA, Header, Text};
use elbowroom_ros2::msgs::tf2_msgs::TFMessage;
use elbowroom_ros2::msgs::visualization_msgs::{Marker, MarkerArray};
use elbowroom_ros2::rmw_zenoh::{Attachment, Distribution, Endpoint, EndpointKind, Gid, Node, Qos, Topic};
use natnet_zenoh::ros::attachment::Attachment as TheirAttachment;
use natnet_zenoh::ros::liveliness::{Entity, EntityKind, NodeInfo, TopicInfo};
use natnet_zenoh::ros::msgs as theirs;
use natnet_zenoh::ros::{Gid as TheirGid, Message as TheirMessage, QosProfile};

// What they do not have, declared with their macro: their code writes and reads it.
mod declared {
    use natnet_zenoh::ros::msgs::builtin_interfaces::Duration;
    use natnet_zenoh::ros::msgs::std_msgs::Header;

    natnet_zenoh::ros_message! {
        /// Joint states.
        pub struct JointState("sensor_msgs/msg/JointState") {
            /// Header.
            pub header: Header,
            /// Names.
            pub name: Vec<String>,
            /// Positions.
            pub position: Vec<f64>,
            /// Velocities.
            pub velocity: Vec<f64>,
            /// Efforts.
            pub effort: Vec<f64>,
        }
    }

    natnet_zenoh::ros_message! {
        /// A point of a trajectory.
        pub struct JointTrajectoryPoint("trajectory_msgs/msg/JointTrajectoryPoint") {
            /// Positions.
            pub positions: Vec<f64>,
            /// Velocities.
            pub velocities: Vec<f64>,
            /// Accelerations.
            pub accelerations: Vec<f64>,
            /// Efforts.
            pub effort: Vec<f64>,
            /// Time.
            pub time_from_start: Duration,
        }
    }

    natnet_zenoh::ros_message! {
        /// Speed scaling.
        pub struct SpeedScalingFactor("control_msgs/msg/SpeedScalingFactor") {
            /// Factor.
            pub factor: f64,
        }
    }
}

/// Our bytes are read by them and written as the same bytes, and the hashes agree.
fn same<Ours: elbowroom_ros2::Message + std::fmt::Debug + PartialEq, Theirs: TheirMessage>(ours: &Ours) {
    let bytes = ours.encode();
    let read = Theirs::from_cdr(&bytes).unwrap_or_else(|e| panic!("{}: {e}", Ours::NAME));
    assert_eq!(read.to_cdr().unwrap(), bytes, "{}", Ours::NAME);
    assert_eq!(&Ours::decode(&bytes).unwrap(), ours);
    assert_eq!(Ours::type_hash(), Theirs::type_hash(), "{}", Ours::NAME);
    assert_eq!(Ours::NAME, Theirs::TYPE_NAME);
}

fn header() -> Header {
    Header { stamp: Time { sec: -3, nanosec: 999_999_999 }, frame_id: "wörld".into() }
}

#[test]
fn joint_states_have_the_same_bytes() {
    // Names of every length modulo eight: every alignment of the numbers behind them.
    for length in 0..9 {
        let name = vec!["j".repeat(length), "joint_2".into()];
        let position = vec![0.1, -0.0];
        let state = JointState { header: header(), name, position, velocity: vec![f64::MIN_POSITIVE], effort: vec![] };
        same::<JointState, declared::JointState>(&state);
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
    same::<Marker, theirs::visualization_msgs::Marker>(&marker);
    let array = MarkerArray { markers: vec![marker.clone(), Marker::default(), marker] };
    same::<MarkerArray, theirs::visualization_msgs::MarkerArray>(&array);
}

#[test]
fn transforms_diagnostics_and_texts_have_the_same_bytes() {
    let pose = elbowroom_spatial::Pose::from_xyz_rpy([1.0, 2.0, 3.0], [0.1, 0.2, 0.3]);
    let transform =
        TransformStamped { header: header(), child_frame_id: "ns16/link_6".into(), transform: Transform::from(&pose) };
    let transforms = vec![transform.clone(), TransformStamped::default(), transform];
    same::<TFMessage, theirs::tf2_msgs::TFMessage>(&TFMessage { transforms });
    let values = vec![KeyValue::new("override", 0.5), KeyValue::new("", "")];
    let status = DiagnosticStatus { level: DiagnosticStatus::STALE, values, ..DiagnosticStatus::default() };
    let array = DiagnosticArray { header: header(), status: vec![status.clone(), status] };
    same::<DiagnosticArray, theirs::diagnostic_msgs::DiagnosticArray>(&array);
    same::<Text, theirs::std_msgs::String>(&Text { data: "<robot name=\"ns16\"/>".into() });
}

#[test]
fn what_controllers_say_and_take_has_the_same_bytes() {
    use elbowroom_ros2::msgs::control_msgs::SpeedScalingFactor;
    use elbowroom_ros2::msgs::trajectory_msgs::JointTrajectoryPoint;
    same::<SpeedScalingFactor, declared::SpeedScalingFactor>(&SpeedScalingFactor { factor: 0.25 });
    let point = JointTrajectoryPoint { velocities: vec![0.5; 5], effort: vec![1.0], ..JointTrajectoryPoint::default() };
    same::<JointTrajectoryPoint, declared::JointTrajectoryPoint>(&point);
}

fn node() -> (Node, NodeInfo) {
    let node =
        Node { domain: 7, session: "a1b2c3".into(), id: 3, namespace: "/cell/left".into(), name: "elbowroom".into() };
    let info = NodeInfo { domain_id: 7, enclave: "/".into(), namespace: "/cell/left".into(), name: "elbowroom".into() };
    (node, info)
}

#[test]
fn tokens_keys_and_identities_are_the_same() {
    let (node, info) = node();
    let entity = |id: u64, kind: EntityKind, topic: Option<TopicInfo>| Entity {
        zid: "a1b2c3".into(),
        nid: 3,
        id,
        kind,
        node: info.clone(),
        topic,
    };
    let defaults = QosProfile::RMW_ZENOH_DEFAULT;
    assert_eq!(node.token(), entity(3, EntityKind::Node, None).liveliness_keyexpr(&defaults));
    let root = Node { namespace: "/".into(), ..node.clone() };
    assert!(root.token().contains("/NN/%/%/elbowroom"), "{}", root.token());

    let topic = Topic::of::<TFMessage>("/tf", Distribution::Jazzy);
    let profiles = [
        (Qos::keep_last(10), QosProfile::keep_last(10)),
        (Qos::keep_last(42), QosProfile::keep_last(42)),
        (Qos::latched(), QosProfile::transient_local(1)),
        (Qos::sensor_data(), QosProfile::sensor_data()),
    ];
    for (qos, profile) in profiles {
        for (kind, their_kind) in
            [(EndpointKind::Publisher, EntityKind::Publisher), (EndpointKind::Subscription, EntityKind::Subscription)]
        {
            let endpoint = Endpoint { node: &node, id: 11, kind, topic: &topic, qos };
            let their_topic = TopicInfo {
                name: "/tf".into(),
                type_name: theirs::tf2_msgs::TFMessage::dds_type_name(),
                type_hash: theirs::tf2_msgs::TFMessage::type_hash(),
                qos: profile.adapted(&defaults),
            };
            let their_entity = entity(11, their_kind, Some(their_topic));
            assert_eq!(endpoint.token(), their_entity.liveliness_keyexpr(&defaults));
            assert_eq!(endpoint.gid().0, their_entity.gid(&defaults).0);
            assert_eq!(Some(topic.key(7)), their_entity.topic_keyexpr());
        }
    }
    assert!(Topic::of::<TFMessage>("/tf", Distribution::Humble).key(0).ends_with("/TypeHashNotSupported"));
    assert!(topic.key_of_any_release(0).ends_with("TFMessage_/*"));
}

#[test]
fn attachments_are_the_same() {
    let ours = Attachment { sequence: 1, stamp_ns: -5, source: Gid([9; 16]) };
    let theirs = TheirAttachment { sequence_number: 1, source_timestamp: -5, source_gid: TheirGid([9; 16]) };
    assert_eq!(ours.encode()[..], theirs.encode()[..]);
    assert_eq!(TheirAttachment::decode(&ours.encode()).unwrap(), theirs);
    assert_eq!(Attachment::decode(&theirs.encode()).unwrap(), ours);
    assert!(Attachment::decode(&[0; 32]).is_err() && Attachment::decode(&[0; 33]).is_err());
}
