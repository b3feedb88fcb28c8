//! Errors of a chain.

use std::fmt;

/// Why links and joints do not form a chain. Every message names the link or joint and says what to write instead.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// The chain has no link.
    #[error("the chain has no links; name at least its root link")]
    NoLinks,
    /// Two links have the same name.
    #[error("two links are called `{name}`; give every link a name of its own")]
    DuplicateLink {
        /// The name.
        name: String,
    },
    /// Two joints have the same name.
    #[error("two joints are called `{name}`; give every joint a name of its own")]
    DuplicateJoint {
        /// The name.
        name: String,
    },
    /// A joint's parent or child is not among the links.
    #[error("joint `{joint}` names link {link} as its {end}, but there are only {count} links (0 to {last}); declare the link first",
        last = count.saturating_sub(1))]
    UnknownLink {
        /// The joint.
        joint: String,
        /// The given index.
        link: usize,
        /// Which end of the joint.
        end: JointEnd,
        /// Number of links.
        count: usize,
    },
    /// A link is the child of two joints.
    #[error(
        "link `{link}` is the child of both `{first}` and `{second}`; a link has one parent, so turn one of the joints around or split the link"
    )]
    TwoParents {
        /// The link.
        link: String,
        /// One joint.
        first: String,
        /// The other joint.
        second: String,
    },
    /// More than one link has no parent.
    #[error(
        "links {roots:?} have no parent joint; a chain has one root, so connect the others to it, with fixed joints if need be"
    )]
    ManyRoots {
        /// The links without a parent.
        roots: Vec<String>,
    },
    /// Joints form a cycle.
    #[error(
        "joints form a cycle through link `{link}`; a chain is a tree, so remove a joint of the cycle (a closed linkage is described by a mimic joint)"
    )]
    Cycle {
        /// A link of the cycle.
        link: String,
    },
    /// The axis has no direction.
    #[error(
        "joint `{joint}` has the axis ({x}, {y}, {z}), which is no direction; write a finite vector other than zero, e.g. 0 0 1"
    )]
    BadAxis {
        /// The joint.
        joint: String,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
        /// Third component.
        z: f64,
    },
    /// The origin has a NaN or infinite number.
    #[error("the origin of joint `{joint}` is not finite; write numbers of metres and radians")]
    BadOrigin {
        /// The joint.
        joint: String,
    },
    /// The limits are out of order or NaN.
    #[error(
        "joint `{joint}` may move from {lower} to {upper}; write the smaller bound as lower (leave both out where there is none)"
    )]
    BadLimits {
        /// The joint.
        joint: String,
        /// The given lower bound, rad or m.
        lower: f64,
        /// The given upper bound, rad or m.
        upper: f64,
    },
    /// The tolerated overshoot is negative, infinite or NaN.
    #[error("joint `{joint}` may overshoot its limits by {tolerance}; write a finite number, 0 or more")]
    BadOvershoot {
        /// The joint.
        joint: String,
        /// The given tolerance, rad or m.
        tolerance: f64,
    },
    /// A mimic joint follows an unknown joint.
    #[error("joint `{joint}` mimics joint {source_joint}, which does not exist; name a joint of this chain")]
    UnknownMimic {
        /// The mimic joint.
        joint: String,
        /// The given index.
        source_joint: usize,
    },
    /// A mimic joint follows a fixed joint.
    #[error(
        "joint `{joint}` mimics `{source_joint}`, which is fixed; make `{joint}` fixed, or name a joint that moves"
    )]
    MimicOfFixed {
        /// The mimic joint.
        joint: String,
        /// The fixed joint.
        source_joint: String,
    },
    /// Mimic joints follow each other.
    #[error(
        "joint `{joint}` mimics itself, directly or through others; one joint of such a cycle has to be independent"
    )]
    MimicCycle {
        /// A joint of the cycle.
        joint: String,
    },
    /// The multiplier or offset of a mimic joint is not finite.
    #[error("joint `{joint}` mimics with multiplier {multiplier} and offset {offset}; both must be finite")]
    BadMimic {
        /// The mimic joint.
        joint: String,
        /// The given multiplier.
        multiplier: f64,
        /// The given offset, rad or m.
        offset: f64,
    },
}

/// One end of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointEnd {
    /// The parent link.
    Parent,
    /// The child link.
    Child,
}

impl fmt::Display for JointEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Parent => "parent",
            Self::Child => "child",
        })
    }
}
