//! Settings and result of a contact query.

use elbowroom_spatial::{Pose, Vec3};

/// Level of detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Detail {
    /// Boxes of the BVHs of meshes down to this depth; 0 is the box around the whole mesh, along the axes of its own
    /// frame. [`TriMesh::bvh_depth`](crate::TriMesh::bvh_depth) is the largest depth. Shapes reported free are
    /// guaranteed to be free.
    Boxes(u8),
    /// Triangles.
    #[default]
    Exact,
}

/// Settings of a contact query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSettings {
    /// Largest distance, metres, at which shapes that do not touch return their nearest points. A negative limit counts
    /// as 0, NaN as infinite.
    pub limit: f64,
    /// Level of detail of meshes.
    pub detail: Detail,
}

impl Default for ContactSettings {
    /// Exact, and only for shapes that touch.
    fn default() -> Self {
        Self { limit: 0.0, detail: Detail::Exact }
    }
}

impl ContactSettings {
    pub(super) fn usable_limit(&self) -> f64 {
        if self.limit.is_nan() { f64::INFINITY } else { self.limit.max(0.0) }
    }
}

/// A point where two shapes touch, or where they are nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Point on the surface of the first shape, in the world.
    pub on_a: Vec3,
    /// Point on the surface of the second shape: the same point, or the corresponding one (see [the table](super)).
    pub on_b: Vec3,
    /// Outward normal of the first surface at its point, a unit vector in the world.
    pub normal_a: Vec3,
    /// Outward normal of the second surface at its point, a unit vector in the world.
    pub normal_b: Vec3,
    /// The triangle of the first shape that contains the point, if the shape is a mesh.
    pub triangle_a: Option<u32>,
    /// The triangle of the second shape that contains the point, if the shape is a mesh.
    pub triangle_b: Option<u32>,
    /// False if the shapes are apart; then the points are the nearest ones.
    pub touching: bool,
}

impl ContactPoint {
    /// The result with the shapes exchanged.
    pub(super) fn swapped(self) -> Self {
        Self {
            on_a: self.on_b,
            on_b: self.on_a,
            normal_a: self.normal_b,
            normal_b: self.normal_a,
            triangle_a: self.triangle_b,
            triangle_b: self.triangle_a,
            ..self
        }
    }

    /// The result for shapes or poses that are not usable: in contact, at the origins.
    pub(super) fn unknown(a_in_world: &Pose, b_in_world: &Pose) -> Self {
        Self {
            on_a: a_in_world.translation,
            on_b: b_in_world.translation,
            normal_a: Vec3::Z,
            normal_b: -Vec3::Z,
            triangle_a: None,
            triangle_b: None,
            touching: true,
        }
    }
}
