//! A robot as data, before it is written.

use crate::solid::Mesh;

/// A robot to generate.
pub struct Robot {
    /// Folder and file name.
    pub name: &'static str,
    /// Written at the head of the URDF.
    pub about: &'static str,
    /// In what form it is written.
    pub form: Form,
    /// In order from the root.
    pub links: Vec<Link>,
    /// In order from the root.
    pub joints: Vec<Joint>,
    /// Pairs that are never tested, beyond neighbours: link, link, reason.
    pub disabled: Vec<(&'static str, &'static str, &'static str)>,
}

/// In what form a robot is written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// URDF, and a mesh per link.
    Urdf,
    /// One 3DS file, and the joints' names and speeds beside it. Solids are meshes.
    Tds,
}

/// One rigid body.
pub struct Link {
    /// As in the URDF.
    pub name: &'static str,
    /// None for a bare frame.
    pub solid: Option<Mesh>,
    /// Solids that a URDF can write down itself, in the link's frame; beside a mesh or instead of one.
    pub primitives: Vec<Primitive>,
    /// Red, green, blue, 0 to 1.
    pub colour: [f64; 3],
}

/// A solid that a URDF can write down itself.
pub struct Primitive {
    /// What it is.
    pub kind: PrimitiveKind,
    /// Its centre in the link, metres.
    pub at: [f64; 3],
    /// Its frame in the link: roll, pitch, yaw in radians.
    pub rpy: [f64; 3],
}

/// Sizes in metres.
pub enum PrimitiveKind {
    /// Edge lengths.
    Box([f64; 3]),
    /// Along its z.
    Cylinder {
        /// Of the round faces.
        radius: f64,
        /// From face to face.
        length: f64,
    },
}

/// A joint between two links.
pub struct Joint {
    /// As in the URDF.
    pub name: &'static str,
    /// Nearer to the root.
    pub parent: &'static str,
    /// Moved by the joint.
    pub child: &'static str,
    /// Joint frame in the parent, metres.
    pub xyz: [f64; 3],
    /// Joint frame in the parent: roll, pitch, yaw in radians.
    pub rpy: [f64; 3],
    /// None: fixed.
    pub turns: Option<Turn>,
}

/// How a revolute joint turns.
pub struct Turn {
    /// Unit vector in the joint frame.
    pub axis: [f64; 3],
    /// Lower and upper limit, degrees.
    pub range_deg: [f64; 2],
    /// Greatest speed, degrees per second.
    pub speed_deg_s: f64,
}

/// A generated file: path below `examples/models`, contents.
pub type File = (String, Vec<u8>);
