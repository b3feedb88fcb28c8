//! Writes bytes, hashes, keys, tokens and attachments as `natnet_zenoh` makes them: a label and a text per line.

use natnet_zenoh::ros::attachment::Attachment;
use natnet_zenoh::ros::liveliness::{Entity, EntityKind, NodeInfo, TopicInfo};
use natnet_zenoh::ros::msgs::builtin_interfaces::{Duration, Time};
use natnet_zenoh::ros::msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use natnet_zenoh::ros::msgs::geometry_msgs::{Point, Pose, Quaternion, Transform, TransformStamped, Vector3};
use natnet_zenoh::ros::msgs::std_msgs::{ColorRGBA, Header, String as Text};
use natnet_zenoh::ros::msgs::tf2_msgs::TFMessage;
use natnet_zenoh::ros::msgs::visualization_msgs::{Marker, MarkerArray};
use natnet_zenoh::ros::{Gid, Message, QosProfile};

natnet_zenoh::ros_message! {
    /// Missing in the crate, so declared with its macro.
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
    /// Missing in the crate, so declared with its macro.
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
    /// Missing in the crate, so declared with its macro.
    pub struct SpeedScalingFactor("control_msgs/msg/SpeedScalingFactor") {
        /// Factor.
        pub factor: f64,
    }
}

fn line<M: Message>(label: &str, message: &M) {
    let bytes = message.to_cdr().expect("it can be written");
    println!("{label}\t{}", bytes.iter().map(|b| format!("{b:02x}")).collect::<String>());
    println!("hash {}\t{}", M::TYPE_NAME, M::type_hash());
}

fn header() -> Header {
    Header { stamp: Time { sec: -3, nanosec: 999_999_999 }, frame_id: "wörld".into() }
}

fn main() {
    messages();
    tokens();
    let attachment = Attachment { sequence_number: 1, source_timestamp: -5, source_gid: Gid([9; 16]) };
    println!("attachment\t{}", attachment.encode().iter().map(|b| format!("{b:02x}")).collect::<String>());
}

fn messages() {
    for length in 0..9 {
        let name = vec!["j".repeat(length), "joint_2".into()];
        let (position, velocity) = (vec![0.1, -0.0], vec![f64::MIN_POSITIVE]);
        line(&format!("joint states {length}"), &JointState { header: header(), name, position, velocity, effort: vec![] });
    }
    let color = |r: f32, g: f32, b: f32, a: f32| ColorRGBA { r, g, b, a };
    let mut marker = Marker::default();
    marker.header = header();
    marker.ns = "region/column".into();
    marker.id = -7;
    marker.r#type = Marker::TRIANGLE_LIST;
    marker.pose = Pose { orientation: Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }, ..Pose::default() };
    marker.scale = Vector3 { x: 1.0, y: 2.0, z: 3.0 };
    marker.color = color(0.1, 0.2, 0.3, 1.0);
    marker.frame_locked = true;
    marker.points = vec![Point { x: 1.0, y: 2.0, z: 3.0 }; 3];
    marker.colors = vec![color(1.0, 0.0, 0.0, 0.0); 2];
    marker.text = "60 mm".into();
    marker.mesh_file.data = vec![1, 2, 3];
    // The default rotation of `natnet_zenoh` is the identity, that of elbowroom is all zeros, so both are written out.
    let mut empty = Marker::default();
    empty.pose.orientation = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 0.0 };
    line("markers", &MarkerArray { markers: vec![marker.clone(), empty, marker] });
    let transform = TransformStamped {
        header: header(),
        child_frame_id: "ns16/link_6".into(),
        transform: Transform {
            translation: Vector3 { x: 1.0, y: 2.0, z: 3.0 },
            rotation: Quaternion { x: 0.5, y: -0.5, z: 0.5, w: -0.5 },
        },
    };
    line("transforms", &TFMessage { transforms: vec![transform.clone(), transform] });
    let values = vec![KeyValue::new("override", 0.5), KeyValue::new("", "")];
    let mut status = DiagnosticStatus::default();
    status.level = DiagnosticStatus::STALE;
    status.values = values;
    line("diagnostics", &DiagnosticArray { header: header(), status: vec![status.clone(), status] });
    line("text", &Text { data: "<robot name=\"ns16\"/>".into() });
    line("factor", &SpeedScalingFactor { factor: 0.25 });
    let point = JointTrajectoryPoint { velocities: vec![0.5; 5], effort: vec![1.0], ..JointTrajectoryPoint::default() };
    line("point", &point);
}

fn tokens() {
    let defaults = QosProfile::RMW_ZENOH_DEFAULT;
    let node = |namespace: &str| NodeInfo {
        domain_id: 7,
        enclave: "/".into(),
        namespace: namespace.into(),
        name: "elbowroom".into(),
    };
    let entity = |id: u64, kind: EntityKind, namespace: &str, topic: Option<TopicInfo>| Entity {
        zid: "a1b2c3".into(),
        nid: 3,
        id,
        kind,
        node: node(namespace),
        topic,
    };
    for namespace in ["/", "/cell/left"] {
        let token = entity(3, EntityKind::Node, namespace, None).liveliness_keyexpr(&defaults);
        println!("node {namespace}\t{token}");
    }
    let profiles = [
        ("keep_last 10", QosProfile::keep_last(10)),
        ("keep_last 42", QosProfile::keep_last(42)),
        ("latched", QosProfile::transient_local(1)),
        ("sensor_data", QosProfile::sensor_data()),
    ];
    for (label, profile) in profiles {
        for kind in [EntityKind::Publisher, EntityKind::Subscription] {
            let topic = TopicInfo {
                name: "/tf".into(),
                type_name: TFMessage::dds_type_name(),
                type_hash: TFMessage::type_hash(),
                qos: profile.adapted(&defaults),
            };
            let entity = entity(11, kind, "/cell/left", Some(topic));
            println!("token {label} {}\t{}", kind.as_str(), entity.liveliness_keyexpr(&defaults));
            let gid = entity.gid(&defaults);
            println!("gid {label} {}\t{}", kind.as_str(), gid.0.iter().map(|b| format!("{b:02x}")).collect::<String>());
            println!("key\t{}", entity.topic_keyexpr().expect("it has a topic"));
        }
    }
}
