//! What questions are answered with.

use elbowroom_spatial::Vec3;

use crate::{Level, Member};

/// Two members in contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Contact {
    /// The first of the pair, in the order of the pair matrix.
    pub a: Member,
    /// The other.
    pub b: Member,
    /// The level that says so. Only at [`Level::L3`] it is certain; at [`Level::L1`] the pair stands for its robots.
    pub level: Level,
}

/// The nearest pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Metres between the solids, less the pair's margin; 0 on contact.
    pub metres: f64,
    /// Proven: no pair is nearer than this, metres.
    pub lower_bound: f64,
    /// Nearest point on the solid of `a` (without padding), in the world. On overlap: a point in or near both.
    pub on_a: Vec3,
    /// Nearest point on the solid of `b`.
    pub on_b: Vec3,
    /// The first of the pair.
    pub a: Member,
    /// The other.
    pub b: Member,
    /// The level that was measured.
    pub level: Level,
}
