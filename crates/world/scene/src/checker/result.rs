//! Results of queries.

use elbowroom_proximity::Separation;
use elbowroom_proximity::contact::{ContactPoint, Detail};
use elbowroom_robot::GeometryId;
use elbowroom_spatial::Vec3;

use crate::Level;

/// A pair of links or objects in contact or, as the result of a tolerance query, within its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PairContact {
    /// First geometry of the pair, in the order of the allowed collision matrix.
    pub a: GeometryId,
    /// Second geometry of the pair.
    pub b: GeometryId,
    /// The finest resolution level used: the level of the models in contact or within the tolerance.
    ///
    /// The contact is certain only at [`Level::L3`]. At [`Level::L1`] the pair represents its robots.
    pub level: Level,
}

/// Distance of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairDistance {
    /// Distance between the shapes, less the pair's margin, metres; 0 on contact.
    pub metres: f64,
    /// Proven lower bound on the distance of every pair of the query, metres.
    pub lower_bound: f64,
    /// Witness point on `a` (without padding), in the world. On overlap: a point in or near both geometries.
    pub on_a: Vec3,
    /// Witness point on `b` (without padding), in the world.
    pub on_b: Vec3,
    /// First geometry of the pair.
    pub a: GeometryId,
    /// Second geometry of the pair.
    pub b: GeometryId,
    /// The finest resolution level used: the level of the models that were measured.
    pub level: Level,
}

/// The collision point of the colliding link nearest to a base (after Reichenbach and Kovačić 2003).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollisionPoint {
    /// The colliding link: the geometry of the pair that is nearer to its base, or the first one on a tie.
    pub link: GeometryId,
    /// Index of the link's collider; 0 for an object.
    pub collider: usize,
    /// Index of the collider's triangle that holds the point, if the collider is a mesh and the answer exact.
    pub triangle: Option<u32>,
    /// The point on the surface of the link (without padding), in the world.
    pub on_link: Vec3,
    /// Outward normal of the link's surface at that point, unit vector in the world.
    pub normal: Vec3,
    /// The geometry with which the link collides.
    pub other: GeometryId,
    /// Index of the other geometry's collider; 0 for an object.
    pub other_collider: usize,
    /// Index of the triangle of that collider, if it is a mesh and the answer exact.
    pub other_triangle: Option<u32>,
    /// The point on the other surface: `on_link` if surfaces of triangles or boxes intersect, else the nearest point.
    pub on_other: Vec3,
    /// Outward normal of the other surface at that point, unit vector in the world.
    pub other_normal: Vec3,
    /// The level of detail of the answer: only [`Detail::Exact`] is certain.
    pub detail: Detail,
    /// False if the surfaces (or boxes) do not touch but are within the pair's margin.
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
    /// From a contact point between `a` and `b`.
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

    /// Exchanges the two sides.
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

/// A pair in motion: its distance, and when it may meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApproachingPair {
    /// First geometry of the pair, in the order of the allowed collision matrix.
    pub a: GeometryId,
    /// Second geometry of the pair.
    pub b: GeometryId,
    /// Proven lower bound on the distance of the shapes, less the pair's margin, metres; 0 on contact.
    pub lower_bound: f64,
    /// Distance less the margin, metres, if [`ApproachingPair::detail`] is exact; else equal to `lower_bound`.
    ///
    /// Never too large.
    pub metres: f64,
    /// Witness point on `a`, in the world. If `detail` is not exact: a point of the nearest boxes, or near them.
    pub on_a: Vec3,
    /// Witness point on `b`, in the world.
    pub on_b: Vec3,
    /// Approach speed of the two witness points, m/s; negative if they separate.
    pub closing_m_s: f64,
    /// Time to collision, s, if the witness points meet and keep their velocities: `metres` divided by `closing_m_s`.
    ///
    /// Infinite if they separate.
    pub estimate_s: f64,
    /// Proven lower bound on the time of contact (margin included), seconds; at most the horizon of the query.
    ///
    /// As long as the velocities of both frames' origins and their angular velocities stay constant, the pair never meets
    /// before this time. Joints at constant rates curve the path of a link: [`sweep`](crate::Checker::sweep) proves that
    /// case.
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
