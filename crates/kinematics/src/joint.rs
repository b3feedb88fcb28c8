//! What a chain is made of.

use elbowroom_spatial::{Pose, Vec3};

/// Index of a link in [`Chain::links`](crate::Chain::links).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LinkId(pub usize);

/// Index of a joint in [`Chain::joints`](crate::Chain::joints).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JointId(pub usize);

/// How a joint moves its child.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JointKind {
    /// Not at all.
    Fixed,
    /// Turns about its axis between limits (rad).
    Revolute,
    /// Turns about its axis without limits (rad).
    Continuous,
    /// Slides along its axis between limits (m).
    Prismatic,
}

impl JointKind {
    /// True for the kinds that turn: revolute and continuous.
    pub fn turns(self) -> bool {
        matches!(self, Self::Revolute | Self::Continuous)
    }

    /// True for the kinds that move at all.
    pub fn moves(self) -> bool {
        self != Self::Fixed
    }
}

/// What a joint may do, in rad or m (and per second, per second squared); effort in N·m or N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest value; −∞ where there is none.
    pub lower: f64,
    /// Largest value; +∞ where there is none.
    pub upper: f64,
    /// Largest speed, rad/s or m/s; `None` where unknown (a 0 in a file means unknown, too).
    pub velocity: Option<f64>,
    /// Largest acceleration, rad/s² or m/s²; `None` where unknown.
    pub acceleration: Option<f64>,
    /// Largest torque (N·m) or force (N); `None` where unknown.
    pub effort: Option<f64>,
}

impl Limits {
    /// No limits at all.
    pub const UNLIMITED: Self =
        Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY, velocity: None, acceleration: None, effort: None };

    /// From `lower` to `upper` (rad or m), nothing else known.
    pub const fn range(lower: f64, upper: f64) -> Self {
        Self { lower, upper, ..Self::UNLIMITED }
    }

    /// From `-bound` to `bound` (rad or m), nothing else known.
    pub const fn symmetric(bound: f64) -> Self {
        Self::range(-bound, bound)
    }

    /// True where `value` (rad or m) lies between the bounds, or beyond by at most `tolerance`. NaN does not.
    pub fn contains(&self, value: f64, tolerance: f64) -> bool {
        value >= self.lower - tolerance && value <= self.upper + tolerance
    }
}

/// A joint that follows another: its value is `multiplier · q(joint) + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// The joint that is followed.
    pub joint: JointId,
    /// Factor on its value.
    pub multiplier: f64,
    /// Added afterwards, rad or m.
    pub offset: f64,
}

/// A joint between two links. The child's frame is the joint's frame, turned or moved along `axis` by the joint's value.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Unique among the chain's joints.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The link it sits on.
    pub parent: LinkId,
    /// The link it carries.
    pub child: LinkId,
    /// The child's frame in the parent's, at value 0.
    pub origin: Pose,
    /// Unit axis in the joint's frame. [`Chain::new`](crate::Chain::new) normalizes it; ignored where fixed.
    pub axis: Vec3,
    /// What it may do. [`Chain::new`](crate::Chain::new) takes the bounds away from continuous joints.
    pub limits: Limits,
    /// Whom it follows; ignored where fixed.
    pub mimic: Option<Mimic>,
}
