//! Hashes of types, as ROS 2 Jazzy computes them.

use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::builtin_interfaces::{Duration, Time};
use elbowroom_ros2::msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use elbowroom_ros2::msgs::sensor_msgs::{CompressedImage, JointState};
use elbowroom_ros2::msgs::std_msgs::{Header, Text};
use elbowroom_ros2::msgs::tf2_msgs::TFMessage;
use elbowroom_ros2::msgs::visualization_msgs::{Marker, MarkerArray, MeshFile, UVCoordinate};

#[test]
fn hashes_are_those_of_jazzy() {
    let check = |hash: String, expected: &str| assert_eq!(hash, format!("RIHS01_{expected}"));
    check(Time::type_hash(), "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197");
    check(Duration::type_hash(), "e8d009f659816f758b75334ee1a9ca5b5c0b859843261f14c7f937349599d93b");
    check(Header::type_hash(), "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01");
    check(Text::type_hash(), "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
    check(JointState::type_hash(), "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e");
    check(TFMessage::type_hash(), "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087");
    check(KeyValue::type_hash(), "d68081eaa540288c5440753baecef0c4e16e81a5f78ad68902ded5100413bb42");
    check(DiagnosticStatus::type_hash(), "b0e3e692ea2d54a8af2f4ef1930e81556a2db55216b771f8a7d2724ed47bf0e4");
    check(DiagnosticArray::type_hash(), "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e");
    check(CompressedImage::type_hash(), "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a");
    check(UVCoordinate::type_hash(), "f27f7ed21fe360c6066944f856b801a0c0d1e94e815b6886444b42d90b196a26");
    check(MeshFile::type_hash(), "7710ece15a148fb7c9b546364cfb215bb06098087bd6394fe5b73a493508f8c4");
    check(Marker::type_hash(), "45b13ccf791f225962bf74e746f9644518855d783a6f42ba0cc14fde2b4f3ce0");
    check(MarkerArray::type_hash(), "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf");
}
