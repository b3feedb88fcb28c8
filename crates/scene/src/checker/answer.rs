//! What questions are answered with.

use elbowroom_proximity::contact::{ContactPoint, Detail};
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

/// Where the member that collides nearest to a base touches something (S4: the collision point and its link).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollisionPoint {
    /// What collides: of a pair the link nearer to its base, the first where both are as near.
    pub link: Member,
    /// Which of the link's bodies; 0 for an object.
    pub body: usize,
    /// The triangle of the body that the point is on, where it is a mesh and the answer exact.
    pub triangle: Option<u32>,
    /// The point on the surface of the link (without padding), in the world.
    pub on_link: Vec3,
    /// Outward normal of the link's surface there, unit vector in the world.
    pub normal: Vec3,
    /// What it collides with.
    pub other: Member,
    /// Which of its bodies.
    pub other_body: usize,
    /// The triangle of that body.
    pub other_triangle: Option<u32>,
    /// The point on the other's surface: the same where surfaces of triangles or boxes cross, else the one beside it.
    pub on_other: Vec3,
    /// Outward normal of the other's surface there.
    pub other_normal: Vec3,
    /// The level of detail that says so: only [`Detail::Exact`] is certain.
    pub level: Detail,
    /// False where the surfaces (or boxes) do not touch, but are not farther apart than the pair's margin.
    pub touching: bool,
}

impl CollisionPoint {
    /// Of bodies `bodies` of `a` and `b`.
    pub(super) fn new((a, b): (Member, Member), bodies: (usize, usize), found: &ContactPoint, level: Detail) -> Self {
        Self {
            link: a,
            body: bodies.0,
            triangle: found.triangle_a,
            on_link: found.on_a,
            normal: found.normal_a,
            other: b,
            other_body: bodies.1,
            other_triangle: found.triangle_b,
            on_other: found.on_b,
            other_normal: found.normal_b,
            level,
            touching: found.touching,
        }
    }

    /// The same with the two sides exchanged.
    pub(super) fn swapped(self) -> Self {
        Self {
            link: self.other,
            body: self.other_body,
            triangle: self.other_triangle,
            on_link: self.on_other,
            normal: self.other_normal,
            other: self.link,
            other_body: self.body,
            other_triangle: self.triangle,
            on_other: self.on_link,
            other_normal: self.normal,
            ..self
        }
    }
}
