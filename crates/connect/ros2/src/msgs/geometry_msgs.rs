//! Points and poses.

use elbowroom_spatial::{Pose as SpatialPose, Vec3};

use super::std_msgs::Header;
use crate::message::message;

message! {
    /// A position, m.
    Point = "geometry_msgs/msg/Point" {
        /// Along x.
        x: f64,
        /// Along y.
        y: f64,
        /// Along z.
        z: f64,
    }
}

message! {
    /// A vector.
    Vector3 = "geometry_msgs/msg/Vector3" {
        /// Along x.
        x: f64,
        /// Along y.
        y: f64,
        /// Along z.
        z: f64,
    }
}

message! {
    /// A rotation as a unit quaternion.
    Quaternion = "geometry_msgs/msg/Quaternion" {
        /// i.
        x: f64,
        /// j.
        y: f64,
        /// k.
        z: f64,
        /// The real part.
        w: f64,
    }
}

message! {
    /// Position and rotation.
    Pose = "geometry_msgs/msg/Pose" {
        /// Position, m.
        position: Point,
        /// Rotation.
        orientation: Quaternion,
    }
}

message! {
    /// Position and rotation of a child frame in its parent.
    Transform = "geometry_msgs/msg/Transform" {
        /// Position, m.
        translation: Vector3,
        /// Rotation.
        rotation: Quaternion,
    }
}

message! {
    /// A transform between named frames.
    TransformStamped = "geometry_msgs/msg/TransformStamped" {
        /// Time and parent frame.
        header: Header,
        /// The child frame.
        child_frame_id: String,
        /// Pose of the child in the parent.
        transform: Transform,
    }
}

message! {
    /// A velocity.
    Twist = "geometry_msgs/msg/Twist" {
        /// Linear velocity, m/s.
        linear: Vector3,
        /// Angular velocity, rad/s.
        angular: Vector3,
    }
}

impl From<[f64; 3]> for Point {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl From<[f64; 3]> for Vector3 {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl From<[f64; 4]> for Quaternion {
    fn from([x, y, z, w]: [f64; 4]) -> Self {
        Self { x, y, z, w }
    }
}

impl From<Vec3> for Point {
    fn from(v: Vec3) -> Self {
        v.to_array().into()
    }
}

impl From<&SpatialPose> for Pose {
    fn from(pose: &SpatialPose) -> Self {
        let orientation = pose.rotation.to_quaternion_xyzw().into();
        Self { position: pose.translation.into(), orientation }
    }
}

impl From<&SpatialPose> for Transform {
    fn from(pose: &SpatialPose) -> Self {
        let rotation = pose.rotation.to_quaternion_xyzw().into();
        Self { translation: pose.translation.to_array().into(), rotation }
    }
}
