//! What the messages say.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

/// The value of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointValue {
    /// Name of the joint.
    pub joint: String,
    /// rad, m for prismatic joints; finite.
    pub value: f64,
}

/// A frame at a constant pose.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedFrame {
    /// Its name.
    pub name: String,
    /// The frame that it is in; empty for the world.
    pub parent: String,
    /// Its pose.
    pub in_parent: Pose,
}

impl FixedFrame {
    /// Goes from the frame `name` to its parents up to one that `is_known` or has no parent among `frames`: that frame, and
    /// the pose of `name` in it.
    pub fn ancestor<'f>(frames: &'f [Self], name: &'f str, is_known: impl Fn(&str) -> bool) -> (&'f str, Pose) {
        let (mut name, mut pose) = (name, Pose::IDENTITY);
        // As many steps as there are frames: more would be a circle.
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
    /// Unique among the objects of a scene.
    pub id: String,
    /// The frame of the poses; empty for the world.
    pub frame: String,
    /// Shapes with their poses; at least one.
    pub solids: Vec<(Shape, Pose)>,
}

impl CollisionObject {
    /// The solids with names of their own: the object's, or `ID:1`, `ID:2` where there are several.
    pub fn named_solids(&self) -> impl Iterator<Item = (String, &Shape, &Pose)> {
        let name = |i: usize| if self.solids.len() == 1 { self.id.clone() } else { format!("{}:{}", self.id, i + 1) };
        self.solids.iter().enumerate().map(move |(i, (shape, pose))| (name(i), shape, pose))
    }
}

/// An object that a link carries.
#[derive(Debug, Clone)]
pub struct AttachedObject {
    /// The object; without a frame of its own it is in that of the link.
    pub object: CollisionObject,
    /// Name of the link.
    pub link: String,
    /// Names of the links that may touch it.
    pub touch_links: Vec<String>,
}

/// The pairs that may touch, by an allowed collision matrix.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AllowedCollisions {
    /// Names of links and objects.
    pub names: Vec<String>,
    /// Pairs that may touch: indices of `names`, the smaller first.
    pub allowed: Vec<(usize, usize)>,
    /// Names of what may touch everything that the matrix does not name.
    pub allowed_by_default: Vec<String>,
}
