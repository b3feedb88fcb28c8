//! Content of the messages.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

/// The value of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointValue {
    /// Name of the joint.
    pub joint: String,
    /// Value, rad or m for prismatic joints; finite.
    pub value: f64,
}

/// A frame at a constant pose in its parent.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedFrame {
    /// Name of the frame.
    pub name: String,
    /// Name of the parent frame; empty for the world.
    pub parent: String,
    /// Pose of the frame in its parent.
    pub in_parent: Pose,
}

impl FixedFrame {
    /// Finds the nearest known ancestor of the frame `name`, and returns it with the pose of `name` in it.
    ///
    /// The search follows the parents up to a frame that `is_known`, or that has no parent among `frames`.
    pub fn ancestor<'f>(frames: &'f [Self], name: &'f str, is_known: impl Fn(&str) -> bool) -> (&'f str, Pose) {
        let (mut name, mut pose) = (name, Pose::IDENTITY);
        // At most as many steps as there are frames: more steps would mean a cycle.
        for _ in frames {
            let parent = frames.iter().find(|f| f.name == name && f.parent != name);
            match parent {
                Some(frame) if !is_known(name) => (name, pose) = (&frame.parent, frame.in_parent * pose),
                _ => break,
            }
        }
        (name, pose)
    }
}

/// An object of one or more solids.
#[derive(Debug, Clone)]
pub struct CollisionObject {
    /// Name, unique among the objects of a scene.
    pub id: String,
    /// Name of the frame of the poses; empty for the world.
    pub frame: String,
    /// Shapes with their poses in the frame; at least one.
    pub solids: Vec<(Shape, Pose)>,
}

impl CollisionObject {
    /// The solids with unique names: the object's name, or `ID:1`, `ID:2` for several solids.
    pub fn named_solids(&self) -> impl Iterator<Item = (String, &Shape, &Pose)> {
        let name = |i: usize| if self.solids.len() == 1 { self.id.clone() } else { format!("{}:{}", self.id, i + 1) };
        self.solids.iter().enumerate().map(move |(i, (shape, pose))| (name(i), shape, pose))
    }
}

/// An object that a link carries.
#[derive(Debug, Clone)]
pub struct AttachedObject {
    /// The object. Without its own frame, it is in the frame of the link.
    pub object: CollisionObject,
    /// Name of the link.
    pub link: String,
    /// Names of the links that may touch the object.
    pub touch_links: Vec<String>,
}

/// Pairs that may touch, from an allowed collision matrix.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AllowedCollisions {
    /// Names of links and objects.
    pub names: Vec<String>,
    /// Pairs that may touch: indices of `names`, the smaller first.
    pub allowed: Vec<(usize, usize)>,
    /// Names of links and objects that may touch everything that the matrix does not name.
    pub allowed_by_default: Vec<String>,
}
