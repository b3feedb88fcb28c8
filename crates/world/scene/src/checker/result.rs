//! Answers to queries.

use elbowroom_proximity::Separation;
use elbowroom_proximity::contact::{ContactPoint, Detail};
use elbowroom_robot::GeometryId;
use elbowroom_spatial::Vec3;

use crate::Level;

/// Two links or objects in contact or, as the answer to a tolerance query, not farther apart than its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PairContact {
    /// The first of the pair, in the order of the allowed collision matrix.
    pub a: GeometryId,
    /// The other.
    pub b: GeometryId,
    /// The finest resolution level used: that of the models in contact, or within the tolerance. Only at [`Level::L3`] this is
    /// certain; at [`Level::L1`] the pair stands for its robots.
    pub level: Level,
}

/// Distance of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairDistance {
    /// Metres between the shapes, less the pair's margin; 0 on contact.
    pub metres: f64,
    /// Proven lower bound on the distance of every pair of the query, metres.
    pub lower_bound: f64,
    /// Witness point on `a` (without padding), in the world. On overlap: a point in or near both.
    pub on_a: Vec3,
    /// Witness point on `b`.
    pub on_b: Vec3,
    /// The first of the pair.
    pub a: GeometryId,
    /// The other.
    pub b: GeometryId,
    /// The finest resolution level used: that of the models that were measured.
    pub level: Level,
}

/// The collision point of the colliding link nearest to a base (after Reichenbach and Kovačić 2003).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollisionPoint {
    /// The link that collides: of a pair the one nearer to its base, the first where both are as near.
    pub link: GeometryId,
    /// Index of its collider; 0 for an object.
    pub collider: usize,
    /// The triangle of the collider that the point is on, where it is a mesh and the answer exact.
    pub triangle: Option<u32>,
    /// The point on the surface of the link (without padding), in the world.
    pub on_link: Vec3,
    /// Outward normal of the link's surface there, unit vector in the world.
    pub normal: Vec3,
    /// The geometry that it collides with.
    pub other: GeometryId,
    /// Index of its collider.
    pub other_collider: usize,
    /// The triangle of that collider.
    pub other_triangle: Option<u32>,
    /// The point on the other surface: the same where surfaces of triangles or boxes intersect, else the nearest one.
    pub on_other: Vec3,
    /// Outward normal of the other surface there.
    pub other_normal: Vec3,
    /// The level of detail of the answer: only [`Detail::Exact`] is certain.
    pub detail: Detail,
    /// False if the surfaces (or boxes) do not touch, but are not farther apart than the pair's margin.
    pub touching: bool,
}

/// One collider of a link, or the shape of an object.
#[derive(Debug, Clone, Copy)]
pub(super) struct ColliderId {
    pub geometry: GeometryId,
    /// Index of the collider; 0 for an object.
    pub collider: usize,
}

impl CollisionPoint {
    /// A contact of `a` and `b`.
    pub(super) fn new(a: ColliderId, b: ColliderId, found: &ContactPoint, detail: Detail) -> Self {
        Self {
            link: a.geometry,
            collider: a.collider,
            triangle: found.triangle_a,
            on_link: found.on_a,
            normal: found.normal_a,
            other: b.geometry,
            other_collider: b.collider,
            other_triangle: found.triangle_b,
            on_other: found.on_b,
            other_normal: found.normal_b,
            detail,
            touching: found.touching,
        }
    }

    /// The same with the two sides exchanged.
    pub(super) fn swapped(self) -> Self {
        Self {
            link: self.other,
            collider: self.other_collider,
            triangle: self.other_triangle,
            on_link: self.on_other,
            normal: self.other_normal,
            other: self.link,
            other_collider: self.collider,
            other_triangle: self.triangle,
            on_other: self.on_link,
            other_normal: self.normal,
            ..self
        }
    }
}

/// A pair in motion: how far apart it is, and when it may meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApproachingPair {
    /// The first of the pair, in the order of the allowed collision matrix.
    pub a: GeometryId,
    /// The other.
    pub b: GeometryId,
    /// Proven lower bound on the distance of the shapes, less the pair's margin, metres; 0 on contact.
    pub lower_bound: f64,
    /// The distance less the margin where [`ApproachingPair::detail`] is exact; else the lower bound again. Never too large.
    pub metres: f64,
    /// Witness point on `a`, in the world; where not exact, a point of the nearest boxes, or near them.
    pub on_a: Vec3,
    /// Witness point on `b`.
    pub on_b: Vec3,
    /// Approach speed of the two points, m/s; negative if they separate.
    pub closing_m_s: f64,
    /// Metres over that speed, seconds: the time to collision if these points meet and keep their velocities. Infinite where
    /// they separate.
    pub estimate_s: f64,
    /// Proven: no contact (margin included) sooner, seconds, as long as the velocities of both frames' origins and their
    /// angular velocities stay constant. Joints at constant rates curve the path of a link:
    /// [`sweep`](crate::Checker::sweep) proves that. At most the horizon of the query.
    pub earliest_s: f64,
    /// The level of detail at which the pair was measured.
    pub detail: Detail,
}

/// Distance and proven lower bound, less the margin.
pub(super) fn less_margin(s: &Separation, margin: f64) -> (f64, f64) {
    if margin == 0.0 {
        return (s.distance, s.lower_bound);
    }
    let lower = s.lower_bound - margin - f64::EPSILON * (s.lower_bound + margin);
    ((s.distance - margin).max(0.0), lower.max(0.0))
}
