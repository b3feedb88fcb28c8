//! The content of a URDF.

use elbowroom_kinematics::{JointKind, Limits};
use elbowroom_spatial::{Pose, Vec3};

use crate::Warning;

/// The content of a URDF.
#[derive(Debug, Clone)]
pub struct UrdfModel {
    /// The robot's name; the stem of the file name where it has none.
    pub name: String,
    /// In the order of the file. At least one; names are unique.
    pub links: Vec<UrdfLink>,
    /// In the order of the file; they form a tree over all links.
    pub joints: Vec<UrdfJoint>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// A link and its geometry.
#[derive(Debug, Clone)]
pub struct UrdfLink {
    /// Unique among the links.
    pub name: String,
    /// Its line in the file.
    pub line: usize,
    /// Visual geometry.
    pub visuals: Vec<LinkGeometry>,
    /// Collision geometry.
    pub collisions: Vec<LinkGeometry>,
}

/// One `<collision>` or `<visual>`.
#[derive(Debug, Clone)]
pub struct LinkGeometry {
    /// Its name, where it has one.
    pub name: Option<String>,
    /// Its line in the file.
    pub line: usize,
    /// Its frame in that of the link.
    pub in_link: Pose,
    /// Its shape.
    pub geometry: Geometry,
}

/// A shape; lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// Centred; full edge lengths.
    Box(Vec3),
    /// Centred.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// Along z, centred.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its full length.
        length: f64,
    },
    /// Along z, centred.
    Capsule {
        /// Its radius.
        radius: f64,
        /// Its length without the caps.
        length: f64,
    },
    /// A file.
    Mesh {
        /// As written: relative, `package://` or `file://`.
        filename: String,
        /// Factor per axis; negative ones mirror.
        scale: Vec3,
    },
}

/// A joint.
#[derive(Debug, Clone)]
pub struct UrdfJoint {
    /// Unique among the joints.
    pub name: String,
    /// Its line in the file.
    pub line: usize,
    /// Its kind.
    pub kind: JointKind,
    /// Index of the parent in [`UrdfModel::links`].
    pub parent: usize,
    /// Index of the child in [`UrdfModel::links`].
    pub child: usize,
    /// The child's frame in that of the parent, at value 0.
    pub origin: Pose,
    /// Unit axis in the joint's frame; +x where a fixed joint has none.
    pub axis: Vec3,
    /// Limits of position, velocity, acceleration and effort.
    pub limits: Limits,
    /// The joint that it mimics.
    pub mimic: Option<UrdfMimic>,
}

/// `value = multiplier · value of joint + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UrdfMimic {
    /// Index in [`UrdfModel::joints`].
    pub joint: usize,
    /// Multiplier.
    pub multiplier: f64,
    /// Radians or metres.
    pub offset: f64,
}
