//! The content of a URDF.

use elbowroom_kinematics::{JointKind, Limits};
use elbowroom_spatial::{Pose, Vec3};

use crate::Diagnostic;

/// The content of a URDF.
#[derive(Debug, Clone)]
pub struct UrdfModel {
    /// Name of the robot; the stem of the file name if the URDF has none.
    pub name: String,
    /// Links in the order of the file. At least one; names are unique.
    pub links: Vec<UrdfLink>,
    /// Joints in the order of the file. They form a tree over all links.
    pub joints: Vec<UrdfJoint>,
    /// Warnings for the user.
    pub warnings: Vec<Diagnostic>,
}

/// A link and its geometry.
#[derive(Debug, Clone)]
pub struct UrdfLink {
    /// Name, unique among the links.
    pub name: String,
    /// Line in the file.
    pub line: usize,
    /// Visual geometry.
    pub visuals: Vec<LinkGeometry>,
    /// Collision geometry.
    pub collisions: Vec<LinkGeometry>,
}

/// One `<collision>` or `<visual>`.
#[derive(Debug, Clone)]
pub struct LinkGeometry {
    /// Name, if it has one.
    pub name: Option<String>,
    /// Line in the file.
    pub line: usize,
    /// Pose of its frame in the link's frame.
    pub in_link: Pose,
    /// Shape.
    pub geometry: Geometry,
}

/// A shape; lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A centred box with full edge lengths.
    Box(Vec3),
    /// A centred sphere.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A centred cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Full length.
        length: f64,
    },
    /// A centred capsule along z.
    Capsule {
        /// Radius.
        radius: f64,
        /// Length without the caps.
        length: f64,
    },
    /// A mesh file.
    Mesh {
        /// Reference as written: relative, `package://` or `file://`.
        filename: String,
        /// Factor per axis; negative factors mirror.
        scale: Vec3,
    },
}

/// A joint.
#[derive(Debug, Clone)]
pub struct UrdfJoint {
    /// Name, unique among the joints.
    pub name: String,
    /// Line in the file.
    pub line: usize,
    /// Kind of the joint.
    pub kind: JointKind,
    /// Index of the parent in [`UrdfModel::links`].
    pub parent: usize,
    /// Index of the child in [`UrdfModel::links`].
    pub child: usize,
    /// Pose of the child's frame in the parent's frame, at value 0.
    pub origin: Pose,
    /// Unit axis in the joint's frame; +x for a fixed joint without an axis.
    pub axis: Vec3,
    /// Limits of position, velocity, acceleration and effort.
    pub limits: Limits,
    /// Relation to the joint that it mimics.
    pub mimic: Option<UrdfMimic>,
}

/// Mimic relation `value = multiplier · value of joint + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UrdfMimic {
    /// Index of the source joint in [`UrdfModel::joints`].
    pub joint: usize,
    /// Multiplier.
    pub multiplier: f64,
    /// Offset, rad or m.
    pub offset: f64,
}
