//! Robot as data, before it is written.

use crate::solid::Mesh;

/// A robot to generate.
pub struct Robot {
    /// Folder and file name.
    pub name: &'static str,
    /// Written at the head of the URDF.
    pub about: &'static str,
    /// Form in which it is written.
    pub form: Form,
    /// Links, in order from the root.
    pub links: Vec<Link>,
    /// Joints, in order from the root.
    pub joints: Vec<Joint>,
    /// Pairs that are never tested, beyond neighbours: link, link, reason.
    pub disabled: Vec<(&'static str, &'static str, &'static str)>,
}

/// Form in which a robot is written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// URDF, and a mesh per link.
    Urdf,
    /// One 3DS file, and the joints' names and speeds beside it. Solids are meshes.
    Tds,
}

/// One rigid body.
pub struct Link {
    /// Name, as in the URDF.
    pub name: &'static str,
    /// Mesh; `None` for a bare frame.
    pub solid: Option<Mesh>,
    /// Solids that a URDF describes without a mesh, in the link's frame; beside a mesh or instead of one.
    pub primitives: Vec<Primitive>,
    /// Red, green, blue, 0 to 1.
    pub colour: [f64; 3],
}

/// A solid that a URDF describes without a mesh.
pub struct Primitive {
    /// Kind and sizes.
    pub kind: PrimitiveKind,
    /// Its centre in the link, metres.
    pub at: [f64; 3],
    /// Its frame in the link: roll, pitch, yaw in radians.
    pub rpy: [f64; 3],
}

/// Kind of a primitive; sizes in metres.
pub enum PrimitiveKind {
    /// Edge lengths.
    Box([f64; 3]),
    /// A cylinder along its z.
    Cylinder {
        /// Radius of the round faces.
        radius: f64,
        /// Distance from face to face.
        length: f64,
    },
}

/// A joint between two links.
pub struct Joint {
    /// Name, as in the URDF.
    pub name: &'static str,
    /// Link nearer to the root.
    pub parent: &'static str,
    /// Link that the joint moves.
    pub child: &'static str,
    /// Position of the joint frame in the parent, m.
    pub xyz: [f64; 3],
    /// Rotation of the joint frame in the parent: roll, pitch, yaw in radians.
    pub rpy: [f64; 3],
    /// Rotation of a revolute joint; `None` for a fixed one.
    pub turns: Option<Turn>,
}

/// Rotation of a revolute joint.
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
